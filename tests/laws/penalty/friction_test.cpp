// Normal spring and friction coupled by H: the solver of packs against their equations in long double,
// against the scalar fallback, and with the bits of a node on its own.
#include "friction.hpp"
#include "support/sizes.hpp"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <random>

namespace ilaw::testing {
namespace {

using penalty_law::answer;
using penalty_law::normal_spring;
using penalty_law::problem;

constexpr double friction = 0.4;
constexpr auto lanes = static_cast<std::size_t>(kit::pack_of<2>::size);
constexpr std::size_t problem_size = sizeof(problem<double>) / sizeof(double);
constexpr std::size_t answer_size = sizeof(answer<double>) / sizeof(double);

struct Spring {
  double step, stiffness, exponent, damping, lead;

  template <class V, class Loss>
  normal_spring<V, Loss> at(const problem<V>& p, V free) const {
    normal_spring<V, Loss> s{step, stiffness, exponent, free, p.previous, p.delassus, p.indentation, {}, {}};
    if constexpr (std::is_same_v<Loss, V>) {
      s.damping = damping;
      s.lead = lead;
    }
    return s;
  }
  template <class Loss, class V>
  auto solve_with(const problem<V>& p, double mu, answer<V>& a) const {
    const auto at_free = [&](V free) { return at<V, Loss>(p, free); };
    return penalty_law::solve(p, V(mu), V(0.0) > 0.0, at_free, a);
  }
  // Which nodes are left.
  template <class V>
  auto solve(const problem<V>& p, double mu, answer<V>& a) const {
    const bool loses = exponent != 1.0 || damping > 0.0 || lead > 0.0;
    return loses ? solve_with<V>(p, mu, a) : solve_with<kit::sure_zero>(p, mu, a);
  }
  answer<double> solve_scalar(const problem<double>& p) const {
    return penalty_law::scalar_friction{p, at<double, double>(p, p.free), friction}.solve();
  }
};

struct Draw : Random {
  Draw() : Random(5) {}

  // Time, mass and length have sizes of their own, so that nothing depends on one of them being near 1.
  Spring spring(double exponent, bool loses) {
    const double step = decades(2.0), e = loses && exponent == 1.0 ? 0.5 + 0.5 * (*this)() : 1.0;
    const double damping = loses ? decades(1.0) / step : 0.0;
    return {step, decades(3.0) / (step * step), exponent, damping, 1.0 / (1.0 + e) - 0.5};
  }
  // Weakly coupled; a tangential spring, too, in every second one.
  problem<double> problem_of(double step) {
    const double soft = (*this)() > 0.0 ? decades(1.0) : 0.0;
    return {.free = (*this)(),
            .previous = (*this)(),
            .delassus = 2.0 + (*this)(),
            .indentation = std::max((*this)(), 0.0) * step * decades(1.0),
            .c1 = 0.7 * (*this)(),
            .c2 = 0.7 * (*this)(),
            .a11 = 1.0 + 0.5 * (*this)() + soft,
            .a22 = 1.0 + 0.5 * (*this)() + soft,
            .a12 = 0.3 * (*this)(),
            .q1 = (*this)(),
            .q2 = (*this)(),
            .before1 = 0.0,
            .before2 = 0.0};
  }
};

// The normal spring's answer to an impulse less the impulse itself, which falls as the impulse grows.
long double excess_of(const Spring& spring, const problem<double>& p, const answer<double>& a,
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
  return h * std::max(force - part * spring.damping * mean, 0.0L) - r;
}

// How far an answer is from the equations of friction, relative to the terms that cancel in them.
struct Residual {
  long double slip, cone;
};
bool sticks(const answer<double>& a) { return a.status == kit::status::stick.code; }
Residual residual_of(const problem<double>& p, const answer<double>& a) {
  const long double r = a.normal, t1 = a.t1, t2 = a.t2;
  const long double u1 = p.q1 + 0.5L * p.c1 * r + p.a11 * t1 + p.a12 * t2;
  const long double u2 = p.q2 + 0.5L * p.c2 * r + p.a12 * t1 + p.a22 * t2;
  const long double length = std::hypot(t1, t2), speed = std::hypot(p.q1, p.q2) + r + length;
  if (sticks(a)) return {std::hypot(u1, u2) / speed, std::max(length / (friction * r) - 1.0L, 0.0L)};
  const long double across = std::abs(u1 * t2 - u2 * t1), along = std::max(u1 * t1 + u2 * t2, 0.0L);
  return {(across + along) / (length * speed), std::abs(length / (friction * r) - 1.0L)};
}

// One problem in each lane, and what becomes of it.
struct Packs {
  std::array<answer<double>, lanes> answers;
  std::array<bool, lanes> left;

  Packs(const Spring& spring, const std::array<problem<double>, lanes>& problems) {
    using V = kit::pack_of<2>;
    std::array<std::array<double, lanes>, problem_size> columns;
    for (std::size_t j = 0; j < lanes; ++j) {
      const auto numbers = std::bit_cast<std::array<double, problem_size>>(problems[j]);
      for (std::size_t c = 0; c < problem_size; ++c) columns[c][j] = numbers[c];
    }
    // Packs are columns, but no types that bit_cast takes.
    problem<V> packed{};
    static_assert(sizeof packed == sizeof columns);
    std::memcpy(static_cast<void*>(&packed), &columns, sizeof packed);
    answer<V> answer{};
    const auto not_solved = spring.solve(packed, friction, answer);
    std::array<std::array<double, lanes>, answer_size> packs;
    static_assert(sizeof answer == sizeof packs);
    std::memcpy(static_cast<void*>(&packs), &answer, sizeof answer);
    for (std::size_t j = 0; j < lanes; ++j) {
      std::array<double, answer_size> own;
      for (std::size_t c = 0; c < answer_size; ++c) own[c] = packs[c][j];
      answers[j] = std::bit_cast<penalty_law::answer<double>>(own);
      left[j] = (not_solved.bits() >> j & 1U) != 0;
    }
  }
};

using Bits = std::array<std::uint64_t, answer_size>;

void expect_solved(double exponent, bool loses) {
  Draw random;
  int left = 0, sticking = 0, sliding = 0, opening = 0, total = 0;
  for (int trial = 0; trial < part_of(4000) && !::testing::Test::HasFailure(); ++trial) {
    const Spring spring = random.spring(exponent, loses);
    std::array<problem<double>, lanes> problems;
    for (auto& p : problems) p = random.problem_of(spring.step);
    const Packs packs(spring, problems);
    for (std::size_t j = 0; j < lanes; ++j, ++total) {
      const std::string at = "trial " + std::to_string(trial) + ", lane " + std::to_string(j);
      answer<double> own{};
      ASSERT_EQ(spring.solve(problems[j], friction, own), packs.left[j]) << at;
      left += packs.left[j] ? 1 : 0;
      if (packs.left[j]) own = spring.solve_scalar(problems[j]);
      if (!packs.left[j]) {
        ASSERT_EQ(std::bit_cast<Bits>(own), std::bit_cast<Bits>(packs.answers[j])) << at;
      }
      if (!(own.normal > 0.0)) continue;
      const problem<double>& p = problems[j];
      const long double speed = std::abs(p.free) + std::abs(p.previous) + p.indentation / spring.step;
      const long double slack = 1e-13L * (own.normal + speed / p.delassus);
      ASSERT_LE(excess_of(spring, p, own, own.normal + slack), 0.0L) << at << ", r " << own.normal;
      ASSERT_GE(excess_of(spring, p, own, own.normal - slack), 0.0L) << at << ", r " << own.normal;
      const Residual r = residual_of(p, own);
      ASSERT_LE(r.slip, 1e-13L) << at << ", status " << own.status;
      ASSERT_LE(r.cone, 1e-15L) << at << ", status " << own.status;
      (sticks(own) ? sticking : sliding) += 1;
      opening += own.indentation == 0.0 ? 1 : 0;
    }
  }
  EXPECT_LE(left, total / 500);  // one of 4000
  EXPECT_GT(sliding, total / 5);
  EXPECT_GT(sticking, total / 50);
  EXPECT_GT(opening, total / 50);
}

TEST(PenaltyFriction, SolvesItsEquationsWithTheBitsOfANodeAlone) {
  expect_solved(1.0, false);
  expect_solved(1.0, true);
  expect_solved(1.5, false);
  expect_solved(1.5, true);
}

// Where the step closes the spring, and friction and couplings are as large as they may be: on the way to the
// solution Newton's method passes motions that would let go.
TEST(PenaltyFriction, GivesWhatItsSpringGivesWhereItCloses) {
  Draw random;
  int solved = 0;
  for (int trial = 0; trial < part_of(2000000) && !::testing::Test::HasFailure(); ++trial) {
    const Spring spring = random.spring(1.0, false);
    problem<double> p = random.problem_of(spring.step);
    p.indentation = 0.0;
    const double mu = random.decades(0.7), n1 = 0.95 * random(), n2 = 0.95 * random(), t12 = 0.95 * random();
    if (1.0 + 2.0 * n1 * n2 * t12 - n1 * n1 - n2 * n2 - t12 * t12 < 0.01) continue;
    p.c1 = n1 * std::sqrt(2.0 * p.delassus * p.a11);
    p.c2 = n2 * std::sqrt(2.0 * p.delassus * p.a22);
    p.a12 = t12 * std::sqrt(p.a11 * p.a22);
    answer<double> own{};
    if (spring.solve(p, mu, own)) continue;
    if (!(own.normal > 0.0)) continue;
    ++solved;
    const long double slack = 1e-11L * (own.normal + (std::abs(p.free) + std::abs(p.previous)) / p.delassus);
    ASSERT_LE(excess_of(spring, p, own, own.normal + slack), 0.0L) << trial << ", r " << own.normal;
    ASSERT_GE(excess_of(spring, p, own, own.normal - slack), 0.0L) << trial << ", r " << own.normal;
  }
  EXPECT_GT(solved, part_of(2000000) / 10);
}

// Sticking nodes, sliding ones and such that let go, by brackets and by Newton's method.
TEST(PenaltyFriction, AgreesWithTheScalarFallback) {
  Draw random;
  for (int trial = 0; trial < part_of(4000); ++trial) {
    const Spring spring = random.spring(trial % 2 == 0 ? 1.0 : 1.5, trial % 3 == 0);
    const problem<double> p = random.problem_of(spring.step);
    answer<double> quick{};
    if (spring.solve(p, friction, quick)) continue;
    const answer<double> slow = spring.solve_scalar(p);
    const double size = slow.normal + (1.0 + p.indentation / spring.step) / p.delassus;
    ASSERT_NEAR(quick.normal, slow.normal, 1e-12 * size) << trial;
    ASSERT_NEAR(quick.t1, slow.t1, 1e-12 * size) << trial;
    ASSERT_NEAR(quick.t2, slow.t2, 1e-12 * size) << trial;
    ASSERT_NEAR(quick.indentation, slow.indentation,
                1e-12 * spring.step * (1.0 + p.indentation / spring.step))
        << trial;
  }
}

}  // namespace
}  // namespace ilaw::testing
