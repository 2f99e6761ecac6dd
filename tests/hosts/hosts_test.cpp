// The example hosts in C99, C++, Fortran 2008 and Python: their results against closed forms, and bit for bit
// against each other. Their problem: blocks on springs on a floor, friction 0.3, gravity 10, h = 1e-3, three
// seconds.
// SPDX-License-Identifier: BSD-3-Clause
#include "support/program.hpp"

#include <ilaw/ilaw.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

namespace {

using namespace ilaw::testing::matchers;
using namespace ilaw::testing::programs;
constexpr double h = 1e-3, g = 10.0, mu = 0.3, end = 3.0;
constexpr double rounding = 1e-12;  // of three thousand additions of numbers around 1

Outcome run(const std::string& program, const std::string& arguments) {
  setenv("ILAW_PATH", ILAW_PLUGIN_FOLDER, 1);
  return run_command("'" + program + "' " + arguments);
}

struct block {
  int number;
  double u[3], friction_work;
  int status;
};

std::vector<block> blocks_of(const std::string& text) {
  std::istringstream lines(text);
  std::vector<block> blocks;
  for (block b; lines >> b.number >> b.u[0] >> b.u[1] >> b.u[2] >> b.friction_work >> b.status;)
    blocks.push_back(b);
  return blocks;
}

class Host : public testing::TestWithParam<const char*> {
 protected:
  static const block& result(std::size_t number) {
    static std::string program;
    static std::vector<block> blocks;
    if (program != GetParam()) {
      program = GetParam();
      blocks = blocks_of(run(program, "coulomb").output);
    }
    if (blocks.size() != 7) throw std::runtime_error(program + " did not print seven blocks");
    return blocks[number];
  }
};

void expect_at(const block& b, double x, double y, double tolerance) {
  EXPECT_NEAR(b.u[0], x, tolerance);
  EXPECT_NEAR(b.u[1], y, tolerance);
}

// Friction then took all of 1/2 m v0^2: the work of the impulse, r.(v^- + v)/2, telescopes.
TEST_P(Host, SlidingBlockLosesItsEnergyToFriction) {
  EXPECT_NEAR(result(0).friction_work, 0.5 * 1.0 * 1.44, rounding);
  EXPECT_NEAR(result(1).friction_work, 0.5 * 2.5 * 4.0, 5 * rounding);
  EXPECT_NEAR(result(2).friction_work, 0.5 * 0.7 * 9.0, 5 * rounding);
}

// The law acts in the half kick of the start: a floor that it left out would stand g h^2/2 too low.
TEST_P(Host, FloorHoldsTheBlocks) {
  for (const std::size_t number : {0, 1, 3, 4, 5}) {
    EXPECT_NEAR(result(number).u[2], 0.0, rounding) << "number " << number;
    EXPECT_EQ(result(number).status, ILAW_STICK) << "number " << number;
  }
}

// A spring of 2 against a friction of 4.5: nothing moves, and nothing works.
TEST_P(Host, HoldsABlockWhoseSpringIsTooWeak) {
  expect_at(result(4), 0.06, 0.08, 1e-17);
  EXPECT_EQ(result(4).friction_work, 0.0);
}

// The last block hangs on its spring and is not in the index list: it swings freely about -m g/k, at the
// frequency of central differences, sin(w_h h/2) = w h/2.
TEST_P(Host, BlockOutsideTheIndexListIsLeftAlone) {
  const double m = 0.8, k = 30.0, start = 0.1, middle = -m * g / k;
  const double frequency = 2 / h * std::asin(std::sqrt(k / m) * h / 2);
  EXPECT_NEAR(result(6).u[2], middle + (start - middle) * std::cos(frequency * end), 1e-10);
  EXPECT_EQ(result(6).u[0], 0.0);
  EXPECT_EQ(result(6).friction_work, 0.0);
  EXPECT_EQ(result(6).status, 0);
}

// 17 significant digits: equal text is equal bits.
TEST_P(Host, PrintsTheSameBitsAsTheHostInC) {
  const Outcome c = run(ILAW_blocks_c, "coulomb");
  EXPECT_EQ(c.code, 0);
  EXPECT_EQ(run(GetParam(), "coulomb").output, c.output);
}

TEST_P(Host, PassesOnWhyALawIsRefused) {
  EXPECT_THAT(run(GetParam(), "no_such_law"), Exits(1, HasSubstr("no_such_law")));
  EXPECT_THAT(run(GetParam(), "contact"), Exits(1, AllOf(HasSubstr("friction"), HasSubstr("restitution"))));
}

TEST_P(Host, AsksForALibrary) { EXPECT_THAT(run(GetParam(), ""), Exits(1, HasSubstr("LIBRARY"))); }

INSTANTIATE_TEST_SUITE_P(C, Host, testing::Values(ILAW_blocks_c));
INSTANTIATE_TEST_SUITE_P(Cpp, Host, testing::Values(ILAW_blocks_cpp));
#ifdef ILAW_blocks_fortran
INSTANTIATE_TEST_SUITE_P(Fortran, Host, testing::Values(ILAW_blocks_fortran));
#endif
#ifdef ILAW_blocks_python
INSTANTIATE_TEST_SUITE_P(Python, Host, testing::Values(ILAW_blocks_python));
#endif

}  // namespace
