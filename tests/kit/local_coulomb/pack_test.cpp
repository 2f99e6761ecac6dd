// The solver in packs: the bits of a double in every lane, whatever stands
// beside it, and the solutions of the exact solver.
#include "draw.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <vector>

namespace ilaw::testing {
namespace {

using kit::local_coulomb;
using kit::local_problem;
using kit::pack;
constexpr int pack_size = pack::size;
template <class Mask>
bool lane_of(Mask m, int lane) {
  return m.bits() >> lane & 1;
}

bool same_bits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; }

// Problems of all kinds beside each other: weak and strong coupling,
// ill-conditioned, ellipses, held axes, no friction, opening and not a number;
// without coupling, and at rest along a tangent.
std::vector<local_coulomb> mixed_problems(unsigned seed, int count) {
  Draw draw(seed);
  std::vector<local_coulomb> problems(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k) {
    local_coulomb p{};
    if (k % 5 == 4)
      draw.fill_ill_conditioned(p);
    else
      draw.fill_coupled(p, k % 5 == 3 ? 1e-3 : 0.5);
    draw.fill_pressed_velocity(p, k % 7 == 6 ? draw.decades(-300.0, 200.0) : 1.0);
    p.mu[0] = p.mu[1] = draw.decades(-2.0, 1.0);
    if (k % 3 == 2) p.mu[1] = draw.decades(-2.0, 1.0);
    if (k % 11 == 10) p.mu[k % 2] = k % 4 < 2 ? 0.0 : kit::infinity;
    if (k % 6 == 5) p.h[3] = p.h[4] = p.h[5] = k % 4 < 2 ? 0.0 : -0.0;
    if (k % 17 == 16) p.q[1 + k % 2] = k % 4 < 2 ? 0.0 : -0.0;
    if (k % 13 == 12) p.q[0] = k % 2 ? -p.q[0] : std::numeric_limits<double>::quiet_NaN();
    problems[static_cast<std::size_t>(k)] = p;
  }
  return problems;
}

local_problem<pack> packed(const std::vector<local_coulomb>& problems,
                           const std::vector<std::size_t>& lanes) {
  constexpr std::size_t numbers = sizeof(local_coulomb) / sizeof(double);
  double values[numbers][pack_size];
  for (std::size_t lane = 0; lane < lanes.size(); ++lane) {
    double one[numbers];
    std::memcpy(one, &problems[lanes[lane]], sizeof one);
    for (std::size_t k = 0; k < numbers; ++k) values[k][lane] = one[k];
  }
  local_problem<pack> p;
  std::memcpy(static_cast<void*>(&p), values, sizeof p);  // h, q, mu
  return p;
}

TEST(LocalCoulombPack, EveryLaneHasTheBitsOfADoubleWhateverStandsBesideIt) {
  const std::vector<local_coulomb> problems = mixed_problems(51, 20000);
  std::mt19937_64 random(52);
  std::uniform_int_distribution<std::size_t> any_problem(0, problems.size() - 1);
  int found = 0, left = 0;
  for (int k = 0; k < 20000; ++k) {
    std::vector<std::size_t> lanes(pack_size);
    for (std::size_t& lane : lanes) lane = any_problem(random);
    const auto together = kit::solve_regular(packed(problems, lanes));
    for (int lane = 0; lane < pack_size; ++lane) {
      const std::size_t which = lanes[static_cast<std::size_t>(lane)];
      const auto alone = kit::solve_regular(problems[which]);
      ASSERT_EQ(lane_of(together.found, lane), alone.found) << "problem " << which << " in lane " << lane;
      (alone.found ? found : left) += 1;
      if (!alone.found) continue;
      ASSERT_EQ(lane_of(together.sticks, lane), alone.sticks) << "problem " << which;
      for (int c = 0; c < 3; ++c)
        ASSERT_TRUE(same_bits(together.r[c][lane], alone.r[c]))
            << "problem " << which << ", component " << c << ": " << together.r[c][lane] << ", "
            << alone.r[c];
    }
  }
  EXPECT_GT(found, 5000);
  EXPECT_GT(left, 5000);
}

// Two solvers that share no equation.
TEST(LocalCoulombPack, FindsTheSolutionOfTheExactSolver) {
  const std::vector<local_coulomb> problems = mixed_problems(53, 100000);
  for (std::size_t k = 0; k < problems.size(); ++k) {
    const auto regular = kit::solve_regular(problems[k]);
    if (!regular.found) continue;
    double r[3] = {};
    const kit::contact_mode mode = kit::solve_pressed(problems[k], r);
    const double size = std::abs(r[0]) + std::abs(r[1]) + std::abs(r[2]);
    double off = 0.0;
    for (int c = 0; c < 3; ++c) off = std::max(off, std::abs(regular.r[c] - r[c]));
    ASSERT_LE(off, 1e-9 * size) << "problem " << k;
    const double edge = std::hypot(r[1] / problems[k].mu[0], r[2] / problems[k].mu[1]) / r[0];
    const bool both_stick = regular.sticks && mode == kit::contact_mode::stick;
    ASSERT_TRUE(both_stick || edge > 1.0 - 1e-9) << "problem " << k;
  }
}

// How often the scalar path is taken: see docs/theory/local_coulomb.md.
TEST(LocalCoulombPack, LeavesFewOfTheUsualProblems) {
  Draw draw(54);
  constexpr int draws = 50000;
  const auto left = [&draw](double floor) {
    int count = 0;
    for (int k = 0; k < draws; ++k) {
      local_coulomb p = draw.pressed_coupled(floor);
      p.mu[0] = p.mu[1] = 0.3;
      count += !kit::solve_regular(p).found;
    }
    return count;
  };
  EXPECT_LT(left(0.5), draws / 300);
  EXPECT_LT(left(0.05), draws / 20);  // strong coupling: a fifth without the quartic
}

TEST(Pack, ComputesWhatDoublesDo) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const double values[] = {1.5, -0.0, 0.0, kit::infinity, -kit::infinity, nan, 0x1p-1074, -7.25, 1e308};
  for (const double a : values)
    for (const double b : values) {
      const pack x(a), y(b);
      ASSERT_TRUE(same_bits(pack(a)[0], a)) << "b " << b;
      ASSERT_TRUE(same_bits(larger(x, y)[0], kit::larger(a, b))) << a << ' ' << b;
      ASSERT_TRUE(same_bits(smaller(x, y)[0], kit::smaller(a, b))) << a << ' ' << b;
      ASSERT_TRUE(same_bits(absolute(x)[0], kit::absolute(a))) << "b " << b;
      ASSERT_TRUE(same_bits(positive_part(x)[0], kit::positive_part(a))) << "b " << b;
      ASSERT_EQ(lane_of(x < y, pack_size - 1), a < b) << "b " << b;
      ASSERT_EQ(lane_of(x != y, pack_size - 1), a != b) << "b " << b;
      ASSERT_EQ(any((x <= y) & !(x == y)), (a <= b) && a != b) << "b " << b;
      const double root = square_root(x)[pack_size - 1];
      ASSERT_TRUE(!(a >= 0.0) || same_bits(root, std::sqrt(a))) << a;
    }
}

}  // namespace
}  // namespace ilaw::testing
