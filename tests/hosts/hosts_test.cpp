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

// Thrown along (cx, cy) with speed v0, a block decelerates by mu g and stops after v0^2/(2 mu g). In the
// scheme V_{n+1/2} = v0 - mu g t_{n+1/2}, from the half kick on, in which the law acts, too: so U_n is on the
// exact parabola until the block sticks, at the instant nearest to the exact one, where the parabola is at
// most mu g (h/2)^2/2 below its vertex.
TEST_P(Host, SlidingBlockStopsWhereItMust) {
  const double tolerance = mu * g * h * h / 8 + rounding;
  const auto distance = [](double speed) { return speed * speed / (2 * mu * g); };
  expect_at(result(0), 0.6 * distance(1.2), 0.8 * distance(1.2), tolerance);
  expect_at(result(1), -0.8 * distance(2.0), 0.6 * distance(2.0), tolerance);
}

// Friction then took all of 1/2 m v0^2: the work of the impulse, r.(v^- + v)/2, telescopes.
TEST_P(Host, SlidingBlockLosesItsEnergyToFriction) {
  EXPECT_NEAR(result(0).friction_work, 0.5 * 1.0 * 1.44, rounding);
  EXPECT_NEAR(result(1).friction_work, 0.5 * 2.5 * 4.0, 5 * rounding);
  EXPECT_NEAR(result(2).friction_work, 0.5 * 0.7 * 9.0, 5 * rounding);
}

// Dropped from height z0 with speed v0 along the floor, it lands at t_f = sqrt(2 z0/g) and loses mu g t_f at
// once, so that from then on it is as fast as if it had slid all the time; in flight it gained mu g t_f^2/2.
// The code lands within a step of t_f, and gains mu g t_j^2/2. No block is below the floor at any instant.
TEST_P(Host, DroppedBlockSlidesFarther) {
  const double t_f = std::sqrt(2 * 0.05 / g);
  const double distance = 9.0 / (2 * mu * g) + mu * g * t_f * t_f / 2;
  const double tolerance = mu * g * (t_f * h + h * h / 2 + h * h / 8) + rounding;
  expect_at(result(2), 0.6 * distance, 0.8 * distance, tolerance);
  EXPECT_NEAR(result(2).u[2], 0.0, rounding);
}

struct coulomb_oscillator {
  double mass, stiffness, amplitude;
  double friction_offset() const { return mu * mass * g / stiffness; }

  // Each swing is half an oscillation about the friction offset on its own side: position a becomes 2 offset
  // - a, until the spring is too weak to move the block.
  struct stop {
    double position;
    int swings;
  };
  stop rest() const {
    stop at{amplitude, 0};
    for (; std::abs(at.position) > friction_offset(); ++at.swings)
      at.position = std::copysign(2 * friction_offset(), at.position) - at.position;
    return at;
  }

  // With a the largest acceleration: a turn is seen at most half a step off, which is a h^2/8 of path, and
  // the next swing then starts as if at rest half a step before, which makes it a h^2/8 wider.
  double tolerance() const {
    return rest().swings / 4.0 * (stiffness / mass * amplitude + mu * g) * h * h + rounding;
  }

  // A block that turns round within a step leaves it no faster than a h; friction against that velocity works
  // on the block, at most mu m g h (a h)/2, which is not dissipation and does not count.
  double work_at_turns() const {
    return rest().swings * mu * mass * g * h * (stiffness / mass * amplitude + mu * g) * h / 2;
  }

  // All that friction takes, if the block ends at rest at u: the discrete energy 1/2 m V_{n+1/2}^2 + 1/2 k
  // U_n U_{n+1} changes by the work of the impulse in each step, and in the half kick at the start by as much
  // less 1/4 h k U_0 V_{1/2}, where V_{1/2} = -h/2 (k U_0/m - mu g).
  double loss(double u) const {
    const double first_speed = h / 2 * std::max(0.0, stiffness / mass * amplitude - mu * g);
    return 0.5 * stiffness * (amplitude * amplitude - u * u) - h / 4 * stiffness * amplitude * first_speed;
  }
};

void expect_rest(const block& b, const coulomb_oscillator& o, double cx, double cy) {
  expect_at(b, cx * o.rest().position, cy * o.rest().position, o.tolerance());
  EXPECT_NEAR(b.u[0] * cy, b.u[1] * cx, rounding);  // the motion keeps its oblique line
  const double loss = o.loss(std::hypot(b.u[0], b.u[1]));
  EXPECT_GE(b.friction_work, loss - 5 * rounding);
  EXPECT_LE(b.friction_work, loss + o.work_at_turns() + 5 * rounding);
}

TEST_P(Host, BlockOnSpringComesToRestWhereItMust) {
  const coulomb_oscillator two_swings{2.0, 50.0, 0.5}, none{1.5, 20.0, 0.1}, seven{1.0, 100.0, 0.4};
  ASSERT_EQ(two_swings.rest().swings, 2);
  ASSERT_EQ(none.rest().swings, 0);
  ASSERT_EQ(seven.rest().swings, 7);
  expect_rest(result(3), two_swings, 0.8, -0.6);
  expect_rest(result(4), none, 0.6, 0.8);
  expect_rest(result(5), seven, -0.6, 0.8);
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
