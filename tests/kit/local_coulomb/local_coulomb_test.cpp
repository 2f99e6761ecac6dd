// The local problem's own conditions on random draws, closed forms, limits and scales.
#include "draw.hpp"
#include "natural_map.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace ilaw::testing {
namespace {

using kit::contact_mode;
using kit::local_coulomb;

constexpr long double ulp = std::numeric_limits<double>::epsilon();
constexpr double inf_value = std::numeric_limits<double>::infinity();

long double largest(const Exact& a) { return std::max({std::abs(a[0]), std::abs(a[1]), std::abs(a[2])}); }

struct Solved {
  contact_mode mode;
  double r[3];
  Exact v;
  long double natural;  // what H r and q are made of: rounding of r alone leaves some ulp of it
};

Solved solved(const local_coulomb& p) {
  Solved s;
  s.mode = kit::solve(p, s.r);
  const Exact r{s.r[0], s.r[1], s.r[2]};
  s.v = velocity(p, r);
  s.natural = largest({p.q[0], p.q[1], p.q[2]}) + std::max({p.h[0], p.h[1], p.h[2]}) * largest(r);
  return s;
}

// Largest violation of the conditions in units of natural * ulp. The cone holds to ulps of r_N itself.
long double violation(const local_coulomb& p, const Solved& s) {
  if (s.mode == contact_mode::free) return p.q[0] >= 0.0 && s.r[0] == 0.0 ? 0.0L : inf_value;
  if (s.mode == contact_mode::none || !(s.r[0] >= 0.0)) return inf_value;
  long double worst = std::abs(s.v[0]);
  const long double d1 = p.mu[0] / std::max(p.mu[0], p.mu[1]), d2 = p.mu[1] / std::max(p.mu[0], p.mu[1]);
  const long double on_cone =
      std::hypot(s.r[1] / static_cast<long double>(p.mu[0]), s.r[2] / static_cast<long double>(p.mu[1])) /
      s.r[0];
  if (on_cone > 1.0L + 8.0L * ulp) return inf_value;
  if (s.mode == contact_mode::stick)
    return std::max({worst, std::abs(s.v[1]), std::abs(s.v[2])}) / (s.natural * ulp);
  if (on_cone < 1.0L - 8.0L * ulp) return inf_value;
  // Slip opposite to the impulse, in the coordinates where the cone is round.
  const long double speed = std::hypot(d1 * s.v[1], d2 * s.v[2]);
  worst = std::max(worst, std::abs(d1 * s.v[1] + speed * s.r[1] / (p.mu[0] * s.r[0])));
  worst = std::max(worst, std::abs(d2 * s.v[2] + speed * s.r[2] / (p.mu[1] * s.r[0])));
  return worst / (s.natural * ulp);
}

TEST(LocalCoulomb, HoldsItsConditionsForAnyFullH) {
  Draw draw(1);
  long double worst = 0.0L;
  int slips = 0, sticks = 0;
  for (int k = 0; k < 500000; ++k) {
    local_coulomb p = draw.pressed_coupled(1e-3);
    p.mu[0] = p.mu[1] = draw.decades(-2.0, 1.0);
    const Solved s = solved(p);
    (s.mode == contact_mode::slip ? slips : sticks) += 1;
    worst = std::max(worst, violation(p, s));
    ASSERT_LE(worst, 8.0L) << "draw " << k;
  }
  EXPECT_GT(slips, 100000);
  EXPECT_GT(sticks, 100000);
  RecordProperty("worst_ulp", std::to_string(worst));
}

// Where the impulse cancels most of what it does, what is left is the rounding of the impulse itself.
TEST(LocalCoulomb, IsRoundedOnceWhereHAmplifies) {
  Draw draw(10);
  long double worst = 0.0L;
  int amplified = 0;
  for (int k = 0; k < 300000; ++k) {
    local_coulomb p = draw.pressed_coupled(1e-3);
    p.mu[0] = p.mu[1] = draw.decades(-1.0, 0.5);
    const Solved s = solved(p);
    if (s.natural < 50.0L * largest({p.q[0], p.q[1], p.q[2]})) continue;
    ++amplified;
    worst = std::max(worst, violation(p, s));
  }
  EXPECT_LE(worst, 1.0L);
  EXPECT_GT(amplified, 10000);
  RecordProperty("worst_ulp", std::to_string(worst));
}

TEST(LocalCoulomb, HoldsThemForIllConditionedHEllipsesAndAllScales) {
  Draw draw(2);
  long double worst = 0.0L;
  for (int k = 0; k < 500000; ++k) {
    local_coulomb p{};
    draw.fill_ill_conditioned(p);
    const double speed_decade = draw(-300.0, 150.0);
    draw.fill_pressed_velocity(p, std::pow(10.0, speed_decade));
    const double mass = draw.decades(-60.0, std::min(60.0, speed_decade + 270.0));  // r stays a normal number
    for (double& h : p.h) h *= mass;
    p.mu[0] = draw.decades(-6.0, 6.0);
    p.mu[1] = p.mu[0] * draw.decades(-2.0, 0.0);
    const Solved s = solved(p);
    worst = std::max(worst, violation(p, s));
    ASSERT_LE(worst, 16.0L) << "draw " << k;
  }
  RecordProperty("worst_ulp", std::to_string(worst));
}

// Siconos's test data FrictionContact3D_1c: reaction and slip speed as published there.
TEST(LocalCoulomb, FindsThePublishedReaction) {
  local_coulomb p{{15.0, 14.0, 16.0, -1.0, -2.0, 1.0}, {-1.0, 2.0, 3.0}, {0.1, 0.1}};
  const Solved s = solved(p);
  EXPECT_EQ(s.mode, contact_mode::slip);
  EXPECT_NEAR(s.r[0], 0.065695682897738, 1e-15);
  EXPECT_NEAR(s.r[1], -0.003678614906807, 1e-15);
  EXPECT_NEAR(s.r[2], -0.005443070813559, 1e-15);
  EXPECT_NEAR(static_cast<double>(std::hypot(s.v[1], s.v[2])), 3.352742601673777, 1e-14);
  // It sticks from |r_T|/r_N of the bilateral impulse on.
  p.mu[0] = p.mu[1] = 6.2338;
  EXPECT_EQ(solved(p).mode, contact_mode::slip);
  p.mu[0] = p.mu[1] = 6.2339;
  EXPECT_EQ(solved(p).mode, contact_mode::stick);
}

TEST(LocalCoulomb, IsFreeWhereTheNormalVelocityOpens) {
  Draw draw(6);
  for (int k = 0; k < 10000; ++k) {
    local_coulomb p = draw.pressed_coupled(0.1);
    p.q[0] = k % 2 ? -p.q[0] : 0.0;
    p.mu[0] = p.mu[1] = draw.decades(-3.0, 3.0);
    const Solved s = solved(p);
    ASSERT_EQ(s.mode, contact_mode::free) << "k " << k;
    ASSERT_EQ(s.r[0], 0.0) << "k " << k;
    ASSERT_EQ(s.r[1], 0.0) << "k " << k;
    ASSERT_EQ(s.r[2], 0.0) << "k " << k;
  }
}

// Infinite friction holds all of v at zero where that presses, else there is no solution: a contact that
// would have to pull to keep its tangents still.
TEST(LocalCoulomb, InfiniteFrictionSticksOrHasNoSolution) {
  Draw draw(7);
  int none = 0, held = 0;
  for (int k = 0; k < 100000; ++k) {
    local_coulomb p = draw.pressed_coupled(0.1);
    p.mu[0] = p.mu[1] = inf_value;
    const Solved s = solved(p);
    const Solved rough =
        solved({{p.h[0], p.h[1], p.h[2], p.h[3], p.h[4], p.h[5]}, {p.q[0], p.q[1], p.q[2]}, {1e9, 1e9}});
    if (rough.r[0] < 1e-6) continue;  // at the border, where the two differ by as much as 1/mu
    if (s.mode == contact_mode::none) {
      ++none;
      ASSERT_EQ(s.r[0], 0.0) << "k " << k;
      continue;
    }
    ++held;
    ASSERT_EQ(s.mode, contact_mode::stick) << "k " << k;
    ASSERT_EQ(rough.mode, contact_mode::stick) << "k " << k;
    ASSERT_LE(largest(s.v), 16.0L * ulp * s.natural) << "k " << k;
    ASSERT_GT(s.r[0], 0.0) << "k " << k;
  }
  EXPECT_EQ(none, 0);  // where 1e9 presses, so does infinity
  EXPECT_GT(held, 50000);
  local_coulomb pulled{{1.0, 1.0, 1.0, 0.9, 0.0, 0.0}, {-0.1, -1.0, 0.0}, {inf_value, inf_value}};
  double r[3];
  EXPECT_EQ(kit::solve(pulled, r), contact_mode::none);  // r_N = (0.1 - 0.9)/0.19 < 0
}

// One axis held, one of finite friction, and one of no friction: limits of the ellipse.
TEST(LocalCoulomb, ExtremeEllipsesAreTheirLimits) {
  Draw draw(8);
  int compared = 0;
  for (int k = 0; k < 20000; ++k) {
    local_coulomb p = draw.pressed_coupled(0.3);
    for (int axis = 0; axis < 2; ++axis)
      for (const double extreme : {0.0, inf_value}) {
        p.mu[axis] = extreme;
        p.mu[1 - axis] = 0.2;
        double limit[3], near[3];
        const contact_mode mode = kit::solve(p, limit);
        p.mu[axis] = extreme == 0.0 ? 1e-12 : 1e12;
        const contact_mode near_mode = kit::solve(p, near);
        if (mode == contact_mode::none || mode != near_mode || near[0] < 1e-3) continue;
        ++compared;
        for (int c = 0; c < 3; ++c) ASSERT_NEAR(limit[c], near[c], 1e-7) << "draw " << k << ", axis " << axis;
      }
  }
  EXPECT_GT(compared, 60000);
}

}  // namespace
}  // namespace ilaw::testing
