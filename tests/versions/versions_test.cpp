// Hosts of this version, of 1.0 and of a later one with laws of this version and of a later one, in C, C++
// and Fortran: the same results, bit for bit.
// SPDX-License-Identifier: BSD-3-Clause
#include <ilaw/loader.hpp>

#include "support/program.hpp"

#include <cstdio>
#include <sstream>
#include <string>
#include <vector>

namespace {

using namespace ilaw::testing::matchers;
using namespace ilaw::testing::programs;
const std::vector<std::string> versions{"", "grown_"}, versions_of_hosts{"", "grown_", "past_"};

std::string library(const std::string& version, const std::string& law) {
  return (version.empty() ? ILAW_PLUGIN_FOLDER : ILAW_GROWN_PLUGINS) + ("/" + law + ".so");
}

std::string all_libraries(const std::string& version) {
  std::string all;
  std::istringstream laws(ILAW_ALL_LAWS);
  for (std::string law; laws >> law;) all += " " + library(version, law);
  return all;
}

std::string output_of(const std::string& program, const std::string& arguments) {
  return run_command(ILAW_HOSTS "/" + program + " " + arguments + "; echo status $?").output;
}

TEST(Versions, AllLawsGiveTheSameInHostsOfBoth) {
  const std::string expected = output_of("unusual_host", "plain" + all_libraries(""));
  ASSERT_THAT(expected, HasSubstr("\nstatus 0\n"));
  for (const std::string& host : versions_of_hosts)
    for (const std::string& laws : versions)
      EXPECT_EQ(output_of(host + "unusual_host", "plain" + all_libraries(laws)), expected)
          << "host '" << host << "', laws '" << laws << "'";
}

TEST(Versions, ExampleHostsPrintTheSameInEveryLanguage) {
  std::istringstream names(ILAW_BLOCKS);
  for (std::string name; names >> name;) {
    const std::string expected = output_of(name, library("", "coulomb"));
    ASSERT_THAT(expected, HasSubstr("\nstatus 0\n"));
    for (const std::string& host : versions_of_hosts)
      for (const std::string& laws : versions)
        EXPECT_EQ(output_of(host + name, library(laws, "coulomb")), expected)
            << host << name << ", laws '" << laws << "'";
  }
}

// A law of 1.0 gives hosts of today its own bits, and refuses forms that it does not know.
TEST(Versions, LawsOfTheFirstVersionServeTodaysHosts) {
  const std::string past = ILAW_SAMPLES "/past/sample.so", today = ILAW_SAMPLES "/today/sample.so";
  const std::string expected = output_of("unusual_host", "plain " + today);
  ASSERT_THAT(expected, HasSubstr("\nstatus 0\n"));
  EXPECT_EQ(output_of("unusual_host", "plain " + past), expected);
  const ilaw::library library(past);
  EXPECT_EQ(library.plugin().abi_minor, 0);
  EXPECT_EQ(ilaw::library(today).plugin().abi_minor, ILAW_ABI_MINOR);
  ilaw_setup setup{};
  setup.struct_size = sizeof setup;
  setup.dimension = 3;
  setup.delassus_form = ILAW_DELASSUS_TRANSVERSE_SPIN;
  setup.frame = ILAW_FRAME_LOCAL;
  setup.numbers = ILAW_NUMBERS_DOUBLE;
  try {
    const ilaw::interface made(library, "sample", setup);
    ADD_FAILURE() << "a form with spins was not refused";
  } catch (const ilaw::error& refused) {
    EXPECT_EQ(refused.code(), ILAW_UNSUPPORTED) << refused.what();
  }
}

TEST(Versions, WhatOlderLawsDoNotKnowIsZero) {
  for (const std::string& laws : versions)
    EXPECT_EQ(output_of("grown_members", all_libraries(laws)), "status 0\n") << "laws " << laws;
}

}  // namespace
