// Laws give the same bits in hosts of every sort: compiled with -ffast-math, trapping floating-point
// exceptions, with another rounding mode, threaded, with libraries loaded twice, globally, or again.
// SPDX-License-Identifier: BSD-3-Clause
#include "support/program.hpp"

#include <sstream>
#include <string>

namespace {

using namespace ilaw::testing::programs;

// The output of the host, and its exit status where it failed.
std::string digest_of(const std::string& host, const std::string& mode) {
  std::string command = std::string(ILAW_HOSTS) + "/" + host + " " + mode;
  std::istringstream laws(ILAW_ALL_LAWS);
  for (std::string law; laws >> law;) command += " " ILAW_PLUGIN_FOLDER "/" + law + ".so";
  return run_command(command + " || echo status $?").output;
}

class UnusualHost : public testing::TestWithParam<const char*> {
 protected:
  static const std::string& plain() {
    static const std::string digest = digest_of("unusual_host", "plain");
    return digest;
  }
};

TEST_P(UnusualHost, GetsTheSameBits) {
  ASSERT_EQ(plain().size(), 17U) << plain();
  EXPECT_EQ(digest_of("unusual_host", GetParam()), plain());
}

INSTANTIATE_TEST_SUITE_P(Loader, UnusualHost,
                         testing::Values("trap", "flags", "upward", "flush", "threads", "twice", "global",
                                         "reload"),
                         [](const auto& drawn) { return std::string(drawn.param); });

TEST_F(UnusualHost, CompiledWithFastMathGetsTheSameBits) {
  ASSERT_EQ(plain().size(), 17U) << plain();
  EXPECT_EQ(digest_of("unusual_host_fast", "plain"), plain());
}

}  // namespace
