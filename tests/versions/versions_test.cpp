// Hosts of this version and of a later one with laws of this version and of a later one, in C, C++ and
// Fortran: the same results, bit for bit.
// SPDX-License-Identifier: BSD-3-Clause
#include "support/program.hpp"

#include <sstream>
#include <string>
#include <vector>

namespace {

using namespace ilaw::testing::matchers;
using namespace ilaw::testing::programs;
const std::vector<std::string> hosts{"", "grown_"}, laws{ILAW_TODAYS_LAWS, ILAW_GROWN_LAWS};

std::string output_of(const std::string& program, const std::string& arguments) {
  return run_command(ILAW_HOSTS "/" + program + " " + arguments + "; echo status $?").output;
}

TEST(Versions, GiveTheSameInHostsOfBoth) {
  const std::string expected = output_of("random_batches", "--batches 10000 " ILAW_TODAYS_LAWS);
  ASSERT_THAT(expected, HasSubstr("\nstatus 0\n"));
  for (const std::string& host : hosts)
    for (const std::string& libraries : laws)
      EXPECT_EQ(output_of(host + "random_batches", "--batches 10000 " + libraries), expected)
          << "host '" << host << "', laws '" << libraries << "'";
}

TEST(Versions, ExampleHostsPrintTheSameInEveryLanguage) {
  std::istringstream names(ILAW_BLOCKS);
  for (std::string name; names >> name;) {
    const std::string expected = output_of(name, ILAW_PLUGIN_FOLDER "/coulomb.so");
    ASSERT_THAT(expected, HasSubstr("\nstatus 0\n"));
    EXPECT_EQ(output_of("grown_" + name, ILAW_PLUGIN_FOLDER "/coulomb.so"), expected) << name;
  }
}

TEST(Versions, WhatOlderLawsDoNotKnowIsZero) {
  for (const std::string& libraries : laws)
    EXPECT_EQ(output_of("grown_members", libraries), "status 0\n") << libraries;
}

}  // namespace
