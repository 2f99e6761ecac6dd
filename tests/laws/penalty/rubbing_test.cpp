// Normal spring and friction coupled by H: the solvers in packs against their equations in long double,
// against the one that takes a node alone, and with the bits of a node on its own.
#include "alone.hpp"
#include "support/sizes.hpp"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <random>

namespace ilaw::testing {
namespace {

using penalty_law::normal_spring;
using penalty_law::rubbed;
using penalty_law::rubbing;

constexpr double friction = 0.4;
constexpr std::size_t problem_size = sizeof(rubbing<double>) / sizeof(double);
constexpr std::size_t answer_size = sizeof(rubbed<double>) / sizeof(double);

struct Draw {
  std::mt19937_64 random{5};
  std::uniform_real_distribution<double> unit{-1.0, 1.0};

  double uniform() { return unit(random); }
  double decades(double most) { return std::pow(10.0, most * uniform()); }

  // Time, mass and length have sizes of their own, so that nothing depends on one of them being near 1.
  normal_spring spring(double exponent, bool loses) {
    const double step = decades(2.0), e = loses && exponent == 1.0 ? 0.5 + 0.5 * uniform() : 1.0;
    const double damping = loses && exponent != 1.0 ? decades(1.0) / step : 0.0;
    return {.step = step,
            .stiffness = decades(3.0) / (step * step),
            .exponent = exponent,
            .lead = 1.0 / (1.0 + e) - 0.5,
            .damping = damping,
            .ratio = e < 1.0 ? penalty_law::damping_ratio(e) : 0.0};
  }
  // Weakly coupled; a tangential spring, too, in every second one.
  rubbing<double> problem(double step) {
    const double soft = uniform() > 0.0 ? decades(1.0) : 0.0;
    return {.step = step,
            .free = uniform(),
            .previous = uniform(),
            .delassus = 2.0 + uniform(),
            .indentation = std::max(uniform(), 0.0) * step * decades(1.0),
            .c1 = 0.7 * uniform(),
            .c2 = 0.7 * uniform(),
            .a11 = 1.0 + 0.5 * uniform() + soft,
            .a22 = 1.0 + 0.5 * uniform() + soft,
            .a12 = 0.3 * uniform(),
            .q1 = uniform(),
            .q2 = uniform()};
  }
};

// What the normal spring gives for an impulse less the impulse itself, which falls as the impulse grows.
long double excess_of(const normal_spring& spring, const rubbing<double>& p, const rubbed<double>& a,
                      long double r) {
  const long double h = spring.step, k = spring.stiffness, x = p.indentation;
  const long double v = p.free + p.delassus * r + p.c1 * a.t1 + p.c2 * a.t2, mean = 0.5L * (p.previous + v);
  const long double way = h * (mean + spring.lead * std::max(v - p.previous, 0.0L));
  const long double end = std::max(x - way, 0.0L), part = way > x ? x / way : 1.0L,
                    power = spring.exponent + 1.0L;
  const auto energy = [&](long double at) { return k * std::pow(at, power) / power; };
  const long double near = k * std::pow(std::max(x - 0.5L * way, 0.0L), power - 1.0L);
  const long double force =
      std::abs(way) <= 1e-7L * x ? near : (way == 0.0L ? 0.0L : (energy(x) - energy(end)) / way);
  return h * std::max(force - part * spring.damper(p.delassus) * mean, 0.0L) - r;
}

// How far an answer is from the equations of friction, relative to the terms that cancel in them.
struct Residual {
  long double slip, cone;
};
Residual residual_of(const rubbing<double>& p, const rubbed<double>& a) {
  const long double r = a.impulse, t1 = a.t1, t2 = a.t2;
  const long double u1 = p.q1 + 0.5L * p.c1 * r + p.a11 * t1 + p.a12 * t2;
  const long double u2 = p.q2 + 0.5L * p.c2 * r + p.a12 * t1 + p.a22 * t2;
  const long double length = std::hypot(t1, t2), speed = std::hypot(p.q1, p.q2) + r + length;
  if (a.outcome == penalty_law::sticks)
    return {std::hypot(u1, u2) / speed, std::max(length / (friction * r) - 1.0L, 0.0L)};
  const long double across = std::abs(u1 * t2 - u2 * t1), along = std::max(u1 * t1 + u2 * t2, 0.0L);
  return {(across + along) / (length * speed), std::abs(length / (friction * r) - 1.0L)};
}

// One problem in each lane, and what becomes of it.
template <bool IsLinear, bool IsPlain>
struct Packs {
  static constexpr auto lanes = static_cast<std::size_t>(kit::pack_size);
  std::array<rubbed<double>, lanes> answers;
  std::array<bool, lanes> left;

  Packs(const normal_spring& spring, const std::array<rubbing<double>, lanes>& problems) {
    std::array<kit::pack, problem_size> columns;
    for (std::size_t c = 0; c < problem_size; ++c) {
      double values[lanes];
      for (std::size_t j = 0; j < lanes; ++j) values[j] = doubles(problems[j])[c];
      columns[c] = kit::pack::load(values);
    }
    rubbed<kit::pack> answer{};
    const auto problem = std::bit_cast<rubbing<kit::pack>>(columns);
    const penalty_law::rubbing_node<kit::pack, IsLinear, IsPlain> node(spring, friction, problem);
    const kit::mask not_solved = node.solve(answer);
    const auto packs = std::bit_cast<std::array<kit::pack, answer_size>>(answer);
    for (std::size_t j = 0; j < lanes; ++j) {
      std::array<double, answer_size> own;
      for (std::size_t c = 0; c < answer_size; ++c) own[c] = packs[c][j];
      answers[j] = std::bit_cast<rubbed<double>>(own);
      left[j] = not_solved[static_cast<int>(j)];
    }
  }
  static std::array<double, problem_size> doubles(const rubbing<double>& p) {
    return std::bit_cast<std::array<double, problem_size>>(p);
  }
};

rubbed<double> solve_alone(const normal_spring& spring, const rubbing<double>& p) {
  return penalty_law::solve_alone(spring, friction, 1.0, {p, 0.0, 0.0});
}

using Bits = std::array<std::uint64_t, answer_size>;

template <bool IsLinear, bool IsPlain>
void expect_solved(double exponent, bool loses) {
  using Solved = Packs<IsLinear, IsPlain>;
  Draw draw;
  int left = 0, sticking = 0, sliding = 0, opening = 0, total = 0;
  for (int trial = 0; trial < part_of(4000) && !::testing::Test::HasFailure(); ++trial) {
    const normal_spring spring = draw.spring(exponent, loses);
    std::array<rubbing<double>, Solved::lanes> problems;
    for (auto& p : problems) p = draw.problem(spring.step);
    const Solved packs(spring, problems);
    for (std::size_t j = 0; j < Solved::lanes; ++j, ++total) {
      const std::string at = "trial " + std::to_string(trial) + ", lane " + std::to_string(j);
      rubbed<double> own{};
      const penalty_law::rubbing_node<double, IsLinear, IsPlain> node(spring, friction, problems[j]);
      ASSERT_EQ(node.solve(own), packs.left[j]) << at;
      left += packs.left[j] ? 1 : 0;
      if (packs.left[j]) own = solve_alone(spring, problems[j]);
      if (!packs.left[j]) {
        ASSERT_EQ(std::bit_cast<Bits>(own), std::bit_cast<Bits>(packs.answers[j])) << at;
      }
      if (!(own.impulse > 0.0)) continue;
      const rubbing<double>& p = problems[j];
      const long double speed = std::abs(p.free) + std::abs(p.previous) + p.indentation / spring.step;
      const long double slack = 1e-13L * (own.impulse + speed / p.delassus);
      ASSERT_LE(excess_of(spring, p, own, own.impulse + slack), 0.0L) << at << ", r " << own.impulse;
      ASSERT_GE(excess_of(spring, p, own, own.impulse - slack), 0.0L) << at << ", r " << own.impulse;
      const Residual r = residual_of(p, own);
      ASSERT_LE(r.slip, 1e-13L) << at << ", outcome " << own.outcome;
      ASSERT_LE(r.cone, 1e-15L) << at << ", outcome " << own.outcome;
      (own.outcome == penalty_law::slides ? sliding : sticking) += 1;
      opening += own.indentation == 0.0 ? 1 : 0;
    }
  }
  EXPECT_LE(left, total / 20);
  EXPECT_GT(sliding, total / 5);
  EXPECT_GT(sticking, total / 50);
  EXPECT_GT(opening, total / 50);
}

TEST(PenaltyRubbing, SolvesItsEquationsWithTheBitsOfANodeAlone) {
  expect_solved<true, true>(1.0, false);
  expect_solved<true, false>(1.0, true);
  expect_solved<false, false>(1.5, false);
  expect_solved<false, false>(1.5, true);
}

// Where the step closes the spring, and friction and couplings are as large as they may be: on the way to the
// solution Newton's method passes motions that would let go.
TEST(PenaltyRubbing, GivesWhatItsSpringGivesWhereItCloses) {
  Draw draw;
  int solved = 0;
  for (int trial = 0; trial < part_of(2000000) && !::testing::Test::HasFailure(); ++trial) {
    const normal_spring spring = draw.spring(1.0, false);
    rubbing<double> p = draw.problem(spring.step);
    p.indentation = 0.0;
    const double mu = draw.decades(0.7), n1 = 0.95 * draw.uniform(), n2 = 0.95 * draw.uniform(),
                 t12 = 0.95 * draw.uniform();
    if (1.0 + 2.0 * n1 * n2 * t12 - n1 * n1 - n2 * n2 - t12 * t12 < 0.01) continue;
    p.c1 = n1 * std::sqrt(2.0 * p.delassus * p.a11);
    p.c2 = n2 * std::sqrt(2.0 * p.delassus * p.a22);
    p.a12 = t12 * std::sqrt(p.a11 * p.a22);
    rubbed<double> own{};
    if (penalty_law::rubbing_node<double, true, true>(spring, mu, p).solve(own)) continue;
    if (!(own.impulse > 0.0)) continue;
    ++solved;
    const long double slack = 1e-11L * (own.impulse + (std::abs(p.free) + std::abs(p.previous)) / p.delassus);
    ASSERT_LE(excess_of(spring, p, own, own.impulse + slack), 0.0L) << trial << ", r " << own.impulse;
    ASSERT_GE(excess_of(spring, p, own, own.impulse - slack), 0.0L) << trial << ", r " << own.impulse;
  }
  EXPECT_GT(solved, part_of(2000000) / 10);
}

// Sticking nodes, sliding ones and such that let go, by brackets and by Newton's method.
TEST(PenaltyRubbing, AgreesWithTheSolverOfOneNode) {
  Draw draw;
  for (int trial = 0; trial < part_of(4000); ++trial) {
    const bool is_linear = trial % 2 == 0;
    const normal_spring spring = draw.spring(is_linear ? 1.0 : 1.5, trial % 3 == 0);
    const rubbing<double> p = draw.problem(spring.step);
    rubbed<double> quick{};
    const bool left = is_linear
                          ? penalty_law::rubbing_node<double, true, false>(spring, friction, p).solve(quick)
                          : penalty_law::rubbing_node<double, false, false>(spring, friction, p).solve(quick);
    if (left) continue;
    const rubbed<double> slow = solve_alone(spring, p);
    const double size = slow.impulse + (1.0 + p.indentation / spring.step) / p.delassus;
    ASSERT_NEAR(quick.impulse, slow.impulse, 1e-12 * size) << trial;
    ASSERT_NEAR(quick.t1, slow.t1, 1e-12 * size) << trial;
    ASSERT_NEAR(quick.t2, slow.t2, 1e-12 * size) << trial;
    ASSERT_NEAR(quick.indentation, slow.indentation,
                1e-12 * spring.step * (1.0 + p.indentation / spring.step))
        << trial;
  }
}

}  // namespace
}  // namespace ilaw::testing
