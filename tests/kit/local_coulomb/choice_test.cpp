// Where several solutions exist, the one with the least slip is given: the least kinetic energy after the
// step.
#include "draw.hpp"
#include "natural_map.hpp"
#include "support/sizes.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace ilaw::testing {
namespace {

using kit::contact_mode;
using kit::local_coulomb;

// The sliding impulse at multiplier alpha, from the three rows by Cramer's rule: v_N = 0, v_T = -alpha r_T.
Exact sliding_impulse(const local_coulomb& p, long double alpha) {
  const Exact a{p.h[0], p.h[3], p.h[4]}, b{p.h[3], p.h[1] + alpha, p.h[5]}, c{p.h[4], p.h[5], p.h[2] + alpha};
  const auto triple = [](const Exact& x, const Exact& y, const Exact& z) {
    return x[0] * (y[1] * z[2] - y[2] * z[1]) - y[0] * (x[1] * z[2] - x[2] * z[1]) +
           z[0] * (x[1] * y[2] - x[2] * y[1]);
  };
  const Exact q{-p.q[0], -p.q[1], -p.q[2]};
  const long double det = triple(a, b, c);
  return {triple(q, b, c) / det, triple(a, q, c) / det, triple(a, b, q) / det};
}

// Distance to the cone, positive outside: the roots in alpha are the sliding solutions.
long double outside(const local_coulomb& p, long double alpha) {
  const Exact r = sliding_impulse(p, alpha);
  return std::hypot(r[1], r[2]) - p.mu[0] * r[0];
}

// Multipliers where outside() changes sign, by bisection between the points of a fine geometric grid.
std::vector<long double> all_roots(const local_coulomb& p) {
  std::vector<long double> roots;
  constexpr long double step = 1.01L;
  long double low = 0.0L, at_low = outside(p, low);
  for (long double high = 1e-6L; high < 1e6L; high *= step) {
    const long double at_high = outside(p, high);
    if ((at_low > 0.0L) != (at_high > 0.0L)) {
      long double a = low, b = high;
      for (int k = 0; k < 60; ++k)
        ((outside(p, 0.5L * (a + b)) > 0.0L) == (at_low > 0.0L) ? a : b) = 0.5L * (a + b);
      roots.push_back(a);
    }
    low = high;
    at_low = at_high;
  }
  return roots;
}

// v.H^-1 v, the kinetic energy that the step leaves in the contact's own degrees of freedom, twice.
long double energy(const local_coulomb& p, const Exact& r) {
  const Exact v = velocity(p, r);
  local_coulomb other = p;
  for (int c = 0; c < 3; ++c) other.q[c] = static_cast<double>(-v[static_cast<std::size_t>(c)]);
  const Exact solved = sliding_impulse(other, 0.0L);
  return v[0] * solved[0] + v[1] * solved[1] + v[2] * solved[2];
}

// A coupling that strong needs a nearly singular H and a large coefficient.
local_coulomb strongly_coupled(Draw& draw) {
  local_coulomb p = draw.pressed_coupled(1e-3);
  p.mu[0] = p.mu[1] = draw.decades(-0.5, 1.0);
  return p;
}

// Three sliding solutions are rare in general: a stiff and a soft tangential direction, both coupled
// strongly. In tangential axes that diagonalise the condensed block S: T = S + w w^T, q_T = c - w n for h_N
// = 1.
local_coulomb stiff_and_soft(Draw& draw) {
  const double s1 = draw.decades(-4.0, -1.0), s2 = draw.decades(-1.0, 1.0), n = draw.decades(-2.0, 0.0);
  const double w1 = draw.normal(), w2 = draw.normal(), c1 = draw.normal() * draw.decades(-2.0, 0.0),
               c2 = draw.normal();
  const double mu = draw.decades(-0.5, 0.5);
  return {{1.0, s1 + w1 * w1, s2 + w2 * w2, w1, w2, w1 * w2}, {-n, c1 - w1 * n, c2 - w2 * n}, {mu, mu}};
}

TEST(LocalCoulombChoice, IsTheSlidingSolutionOfLeastEnergy) {
  Draw draw(21);
  const int draws = part_of(10000);
  int several = 0;
  for (int k = 0; k < draws; ++k) {
    const local_coulomb p = stiff_and_soft(draw);
    double r[3];
    if (kit::solve(p, r) != contact_mode::slip) continue;
    const std::vector<long double> roots = all_roots(p);
    if (roots.size() < 2) continue;
    ++several;
    const Exact chosen{r[0], r[1], r[2]};
    long double least = energy(p, chosen);
    EXPECT_NEAR(std::hypot(chosen[1], chosen[2]),
                std::hypot(sliding_impulse(p, roots[0])[1], sliding_impulse(p, roots[0])[2]),
                1e-6 * (1.0 + r[0]))
        << "k " << k;
    for (std::size_t i = 1; i < roots.size(); ++i)
      EXPECT_LT(least, energy(p, sliding_impulse(p, roots[i]))) << "draw " << k << ", root " << i;
  }
  EXPECT_GE(several, draws / 1000);
}

// Sticking where it is in the cone, although it may also slide: v = 0 has no energy at all.
TEST(LocalCoulombChoice, SticksWhereItCan) {
  Draw draw(22);
  int both = 0;
  for (int k = 0; k < 10000; ++k) {
    const local_coulomb p = strongly_coupled(draw);
    double r[3];
    const contact_mode mode = kit::solve(p, r);
    if (!(outside(p, 0.0L) < -1e-6L)) continue;
    ASSERT_EQ(mode, contact_mode::stick) << "k " << k;
    both += k % 10 == 0 && !all_roots(p).empty();
  }
  EXPECT_GE(both, 1);
}

// Along a path of q on which sliding has one solution, the impulse moves in proportion to q.
TEST(LocalCoulombChoice, FollowsQContinuouslyWhereTheSolutionIsAlone) {
  Draw draw(23);
  for (int path = 0; path < 50; ++path) {
    local_coulomb p = draw.pressed_coupled(0.5);
    p.mu[0] = p.mu[1] = 0.3;
    const double from[] = {p.q[0], p.q[1], p.q[2]}, angle = draw(0.0, 6.28);
    double before[3];
    kit::solve(p, before);
    constexpr int steps = 2000;
    for (int k = 1; k <= steps; ++k) {
      const double s = static_cast<double>(k) / steps;
      p.q[0] = from[0] * (1.0 - s);  // to take-off, where the impulse must have gone
      p.q[1] = from[1] + s * std::cos(angle);
      p.q[2] = from[2] + s * std::sin(angle);
      double r[3];
      kit::solve(p, r);
      const double change = std::hypot(r[0] - before[0], r[1] - before[1], r[2] - before[2]);
      ASSERT_LE(change, 20.0 * (std::abs(from[0]) + 1.0) / steps) << "path " << path << ", step " << k;
      std::copy(r, r + 3, before);
    }
    ASSERT_EQ(before[0], 0.0) << "path " << path;
  }
}

}  // namespace
}  // namespace ilaw::testing
