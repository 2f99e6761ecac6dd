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

// Two dimensions, one coupling: slip against sign(c) gives r_N (1 - mu s w) = n with n = -q_N/h_N, w =
// h_NT/h_N and c = q_T + w h_N n, s = sign(c): r_N = n/(1 - mu s w), r_T = -mu s r_N.
TEST(LocalCoulomb, IsTheEnumerationInTwoDimensions) {
  Draw draw(3);
  int slips = 0;
  for (int k = 0; k < 100000; ++k) {
    local_coulomb p{};
    const double nn = draw.decades(-1.0, 1.0), tt = draw.decades(-1.0, 1.0);
    const double nt = draw(-0.99, 0.99) * std::sqrt(nn * tt), mu = draw.decades(-2.0, 1.0);
    p = {{nn, tt, tt, nt, 0.0, 0.0}, {-draw(0.01, 1.0), draw(-1.0, 1.0), 0.0}, {mu, mu}};
    const Solved s = solved(p);
    EXPECT_EQ(s.r[2], 0.0) << "k " << k;
    const double n = -p.q[0] / nn, w = nt / nn, c = p.q[1] + nt * n, side = c > 0.0 ? 1.0 : -1.0;
    const double schur = tt - w * nt, stuck = -c / schur, pressed = n - w * stuck;
    const double margin = mu * pressed - std::abs(stuck);
    if (std::abs(margin) < 1e-9 * (mu + 1.0) * (n + std::abs(stuck))) continue;  // rounding decides
    ASSERT_EQ(s.mode, margin > 0.0 ? contact_mode::stick : contact_mode::slip) << "k " << k;
    const double expected = margin > 0.0 ? pressed : n / (1.0 - mu * side * w);
    const double tolerance = 1e-11 * (1.0 + std::abs(expected));
    ASSERT_NEAR(s.r[0], expected, tolerance) << "k " << k;
    ASSERT_NEAR(s.r[1], margin > 0.0 ? stuck : -mu * side * expected, tolerance * (1.0 + mu)) << "k " << k;
    slips += s.mode == contact_mode::slip;
  }
  EXPECT_GT(slips, 10000);
}

// H = diag(h_N, h_T, h_T): the sticking impulse, scaled back to the cone (Moreau 1988).
TEST(LocalCoulomb, IsTheClosedFormWithoutCouplingAndAnisotropy) {
  Draw draw(4);
  for (int k = 0; k < 100000; ++k) {
    const double nn = draw.decades(-3.0, 3.0), tt = draw.decades(-3.0, 3.0), mu = draw.decades(-4.0, 2.0);
    local_coulomb p{{nn, tt, tt, 0.0, 0.0, 0.0}, {}, {mu, mu}};
    draw.fill_pressed_velocity(p, 1.0);
    const Solved s = solved(p);
    const double normal = -p.q[0] / nn, speed = std::hypot(p.q[1], p.q[2]);
    const double factor = std::min(1.0 / tt, mu * normal / speed);
    ASSERT_NEAR(s.r[0], normal, 8 * static_cast<double>(ulp) * normal) << "k " << k;
    ASSERT_NEAR(s.r[1], -factor * p.q[1], 16 * static_cast<double>(ulp) * factor * speed) << "k " << k;
    ASSERT_NEAR(s.r[2], -factor * p.q[2], 16 * static_cast<double>(ulp) * factor * speed) << "k " << k;
  }
}

TEST(LocalCoulomb, WithoutFrictionIsTheNormalRowAlone) {
  Draw draw(5);
  for (int k = 0; k < 10000; ++k) {
    local_coulomb p = draw.pressed_coupled(0.1);
    double r[3];
    ASSERT_EQ(kit::solve(p, r), contact_mode::slip) << "k " << k;
    ASSERT_NEAR(r[0], -p.q[0] / p.h[0], 4 * static_cast<double>(ulp) * r[0]) << "k " << k;
    ASSERT_EQ(r[1], 0.0) << "k " << k;
    ASSERT_EQ(r[2], 0.0) << "k " << k;
  }
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

// Units change by powers of two: the same bits. Axes exchanged or mirrored: the same to rounding.
TEST(LocalCoulomb, IsTheSameInOtherUnitsAndAxes) {
  Draw draw(9);
  for (int k = 0; k < 100000; ++k) {
    local_coulomb p = draw.pressed_coupled(0.3);
    p.mu[0] = draw.decades(-1.0, 0.0);
    p.mu[1] = draw.decades(-1.0, 0.0);
    double r[3], other[3], exchanged[3];
    const contact_mode mode = kit::solve(p, r);
    local_coulomb scaled = p;
    for (double& h : scaled.h) h *= 0x1p-37;
    for (double& q : scaled.q) q *= 0x1p-90;
    ASSERT_EQ(kit::solve(scaled, other), mode) << "k " << k;
    for (int c = 0; c < 3; ++c) ASSERT_EQ(other[c], r[c] * 0x1p-53);
    const local_coulomb swapped{
        {p.h[0], p.h[2], p.h[1], p.h[4], p.h[3], p.h[5]}, {p.q[0], p.q[2], p.q[1]}, {p.mu[1], p.mu[0]}};
    if (kit::solve(swapped, exchanged) != mode) continue;
    const double tolerance = 1e-12 * (1.0 + r[0]);
    ASSERT_NEAR(exchanged[0], r[0], tolerance) << "k " << k;
    ASSERT_NEAR(exchanged[1], r[2], tolerance) << "k " << k;
    ASSERT_NEAR(exchanged[2], r[1], tolerance) << "k " << k;
  }
}

}  // namespace
}  // namespace ilaw::testing
