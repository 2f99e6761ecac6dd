// Laws give the same bits in hosts of every sort: compiled with -ffast-math, trapping floating-point
// exceptions, with another rounding mode, threaded, with libraries loaded twice, globally, or again; and by
// each level of instructions.
// SPDX-License-Identifier: BSD-3-Clause
#include "support/program.hpp"

#include <cstdlib>
#include <sstream>
#include <string>

namespace {

using namespace ilaw::testing::programs;

// The output of the host, and its exit status where it failed.
std::string output_of(const std::string& host, const std::string& mode = "plain") {
  std::string command = std::string(ILAW_HOSTS) + "/" + host + " --batches 20000 --mode " + mode;
  std::istringstream laws(ILAW_ALL_LAWS);
  for (std::string law; laws >> law;) command += " " ILAW_PLUGIN_FOLDER "/" + law + ".so";
  return run_command(command + " || echo status $?").output;
}

class UnusualHost : public testing::TestWithParam<const char*> {
 protected:
  static void SetUpTestSuite() { ASSERT_EQ(plain().find("status"), std::string::npos) << plain(); }
  static const std::string& plain() {
    static const std::string output = output_of("random_batches");
    return output;
  }
};

TEST_P(UnusualHost, GetsTheSameBits) { EXPECT_EQ(output_of("random_batches", GetParam()), plain()); }

INSTANTIATE_TEST_SUITE_P(Loader, UnusualHost,
                         testing::Values("trap", "flags", "upward", "flush", "threads", "twice", "global",
                                         "reload"),
                         [](const auto& drawn) { return std::string(drawn.param); });

TEST_F(UnusualHost, CompiledWithFastMathGetsTheSameBits) {
  EXPECT_EQ(output_of("random_batches_fast"), plain());
}

TEST_F(UnusualHost, GetsTheSameBitsFromEveryInstructionSet) {
  for (const char* level : {"baseline", "v3", "v4"}) {
    setenv("ILAW_ISA", level, 1);
    EXPECT_EQ(output_of("random_batches"), plain()) << level;
  }
  unsetenv("ILAW_ISA");
}

}  // namespace
