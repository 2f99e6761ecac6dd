// The normal equation of the implicit penalty, through the ABI, against its defining equation in long double.
#include "spring.hpp"
#include "support/law_runner.hpp"
#include "support/sizes.hpp"

namespace ilaw::testing {
namespace {

Parameters implicit(std::map<std::string, double> numbers) {
  return {std::move(numbers), {{"integration", "implicit"}}};
}

// The right-hand side less r at a trial r, which falls as r grows: positive below the solution, negative
// above. Written from the page, term by term.
struct Equation {
  long double indentation, free, previous, delassus, step, stiffness, exponent, damping, lead;
  long double withheld = 0.0L;

  long double potential(long double x) const {
    return stiffness * std::pow(x, exponent + 1.0L) / (exponent + 1.0L);
  }
  // Mean of k x^p over a short way, by three points of Gauss: where the difference above would cancel.
  long double gauss_mean(long double way) const {
    const long double middle = indentation - 0.5L * way, off = 0.5L * way * std::sqrt(0.6L);
    const auto force = [this](long double x) { return stiffness * std::pow(x, exponent); };
    return (5.0L * force(middle - off) + 8.0L * force(middle) + 5.0L * force(middle + off)) / 18.0L;
  }
  long double force_along(long double way) const {
    const long double end = std::max(indentation - way, 0.0L);
    const bool still = std::abs(way) < 1e-3L * indentation;
    const long double spring = still ? gauss_mean(way) : (potential(indentation) - potential(end)) / way;
    return way == 0.0L && indentation == 0.0L ? 0.0L : spring;
  }
  // The part of the lead of v < v^- that the withheld work lasts for: force times lead, which grows with it.
  long double lead_back(long double mean, long double all) const {
    long double least = all, most = 0.0L;
    if (-all * force_along(mean + all) <= withheld) return all;
    for (int k = 0; k < 200; ++k) {
      const long double middle = 0.5L * (least + most);
      (-middle * force_along(mean + middle) <= withheld ? most : least) = middle;
    }
    return most;
  }
  long double excess(long double r) const {
    const long double v = free + delassus * r, mean = 0.5L * (previous + v);
    const long double all = step * lead * (v - previous);
    const long double way = step * mean + (all > 0.0L ? all : lead_back(step * mean, all));
    const long double closed = way > indentation ? indentation / way : 1.0L;
    const long double force = force_along(way);
    return step * std::max(force - closed * damping * mean, 0.0L) - r;
  }
};

// The law's impulse brackets the solution within a relative tolerance of itself and of the terms that cancel
// in the equation.
void expect_solution(const Equation& e, double given, double tolerance) {
  const long double r = given, speeds = std::abs(e.free) + std::abs(e.previous);
  const long double spring = e.stiffness * std::pow(e.indentation + e.step * speeds, e.exponent);
  const long double terms = e.step * (e.exponent * spring + e.damping * speeds);
  const long double slack = tolerance * (r + std::min(terms, (speeds + e.indentation / e.step) / e.delassus));
  ASSERT_LE(e.excess(r + slack), 0.0L) << "r = " << given;
  if (given > 0.0) {
    ASSERT_GE(e.excess(r - slack), 0.0L) << "r = " << given;
  }
}

// The damper that a restitution stands for, as the page gives it.
double damper_of(double restitution, double stiffness, double delassus, double h) {
  const double zeta = penalty_law::damping_ratio(restitution);
  const double pace = h * std::sqrt(stiffness * delassus);
  return 2.0 * zeta * std::sqrt(stiffness / delassus) / (1.0 + (0.25 + 0.5 * zeta) * pace);
}

// Closes, holds and opens; stiffness, mass and speed over 100 decades.
TEST(Compression, LinearSolvesItsEquation) {
  Random random(1);
  const int instances = part_of(1000);
  int closed = 0, opening = 0, returned = 0, spent = 0;
  for (int instance = 0; instance < instances && !::testing::Test::HasFatalFailure(); ++instance) {
    const double h = 1e-3, delassus = random.decades(50.0);
    const double stiffness = random.decades(3.0) / (h * h * delassus);
    const double given = instance % 3 ? 0.0 : random.decades(3.0) / (h * delassus);
    const double e = instance % 3 ? 0.5 + 0.5 * random() : 1.0;
    NodeRun node("penalty", implicit({{"stiffness", stiffness}, {"damping", given}, {"restitution", e}}), h);
    node.h[0] = delassus;
    node.gap = -1e300;
    const double damping =
        given / (1.0 + 0.5 * h * given * delassus) + (e < 1.0 ? damper_of(e, stiffness, delassus, h) : 0.0);
    for (int k = 0; k < 1000 && !::testing::Test::HasFatalFailure(); ++k) {
      const double scale = random.decades(50.0), v = scale * random();
      node.v_previous = {scale * random(), 0.0, 0.0};
      const double previous = node.v_previous[0];
      const double x = k % 3 ? h * scale * random.decades(3.0) : 0.0;
      const double withheld = e < 1.0 && k % 2 ? 0.5 * stiffness * x * x * random.decades(3.0) : 0.0;
      node.state = {x, 0.0, 0.0, withheld};
      ASSERT_EQ(node.step({v, 0.3 * scale, 0.0}), ILAW_OK) << node.report.reason;
      expect_solution(
          {x, v, previous, delassus, h, stiffness, 1.0L, damping, 1.0L / (1.0L + e) - 0.5L, withheld},
          node.r[0], 2e-14);
      const bool turns = withheld > 0.0 && node.v[0] < previous;
      returned += turns && node.state[3] > 0.0;
      spent += turns && node.state[0] > 0.0 && node.state[3] == 0.0;
      closed += node.r[0] > 0.0;
      opening += node.r[0] > 0.0 && node.state[0] == 0.0;
    }
  }
  EXPECT_GT(closed, 400 * instances);
  EXPECT_GT(opening, 50 * instances);
  EXPECT_GT(returned, 10 * instances);
  EXPECT_GT(spent, 10 * instances);
}

TEST(Compression, PowerLawSolvesItsEquation) {
  Random random(2);
  const int instances = part_of(300);
  int closed = 0;
  for (int instance = 0; instance < instances && !::testing::Test::HasFatalFailure(); ++instance) {
    const double h = 1e-3, delassus = random.decades(12.0);
    const double exponent = instance % 2 ? 1.5 : random(1.0, 8.0);
    const double given = instance % 3 ? 0.0 : random.decades(3.0) / (h * delassus);
    const double length = random.decades(3.0);
    const double stiffness = random.decades(3.0) / (h * h * delassus) / std::pow(length, exponent - 1.0);
    NodeRun node("penalty", implicit({{"stiffness", stiffness}, {"damping", given}, {"exponent", exponent}}),
                 h);
    node.h[0] = delassus;
    node.gap = -1e300;
    const double damping = given / (1.0 + 0.5 * h * given * delassus);
    for (int k = 0; k < 300 && !::testing::Test::HasFatalFailure(); ++k) {
      const double scale = length / h, v = scale * random(), previous = scale * random();
      node.v_previous = {previous, 0.0, 0.0};
      const double x = k % 3 ? length * random.decades(1.5) : 0.0;
      node.state = {x, 0.0, 0.0, 0.0};
      ASSERT_EQ(node.step({v, 0.0, 0.0}), ILAW_OK) << node.report.reason;
      SCOPED_TRACE("exponent " + std::to_string(exponent) + ", k " + std::to_string(k));
      expect_solution({x, v, previous, delassus, h, stiffness, exponent, damping, 0.0L}, node.r[0],
                      1e-13 * exponent);
      closed += node.r[0] > 0.0;
    }
  }
  EXPECT_GT(closed, 100 * instances);
}

// k -> inf: v = -e v^- of a node that arrives; one that leaves but is pulled back may turn round, at most at
// the speed with which it left. At k = inf to the last bits, and at the rate 1/(1 + h^2 k H/4) before.
TEST(Compression, TendsToNewtonsImpact) {
  Random random(3);
  for (const double stiffness : {1e12, 1e15, 1e18, inf_value})
    for (const double e : {0.0, 0.4, 1.0}) {
      NodeRun node("penalty", implicit({{"stiffness", stiffness}, {"restitution", e}}));
      for (int k = 0; k < 20000; ++k) {
        const double v = random(), previous = random();
        node.h[0] = 1.0 + 0.9 * random();
        node.state = {0.0, 0.0, 0.0, 0.0};
        node.gap = 2e-3 * random();
        node.v_previous = {previous, 0, 0};
        const bool in_reach = node.gap <= 0.0 || node.gap + node.dt * v <= 0.0;
        const bool closed = in_reach && node.gap + 0.5 * node.dt * previous <= 0.0;
        ASSERT_EQ(node.step({v, random(), 0.0}), ILAW_OK);
        const double returned = (previous < 0.0 ? e : 1.0) * previous;
        const double rigid = closed ? std::max(-(v + returned) / node.h[0], 0.0) : 0.0;
        const double gain = 0.25 * 1e-6 * stiffness * node.h[0];
        ASSERT_NEAR(node.r[0], rigid, rigid * 4.0 / gain + 4e-16 * (std::abs(v) + 1.0) / node.h[0])
            << "stiffness " << stiffness << ", e " << e << ", k " << k;
      }
    }
}

// zeta of a restitution, against the speed with which a damped spring that does not pull lets go.
TEST(Compression, DampingRatioGivesTheRestitution) {
  for (double e = 0.03; e < 1.0; e += 0.01) {
    const double zeta = penalty_law::damping_ratio(e), w = std::sqrt(std::abs(1.0 - zeta * zeta));
    const double angle = zeta < 1.0 ? std::acos(zeta) : std::acosh(zeta);
    EXPECT_NEAR(std::exp(-2.0 * zeta * angle / w), e, 4e-4) << zeta;
  }
  EXPECT_EQ(penalty_law::damping_ratio(1.0), 0.0);
}

}  // namespace
}  // namespace ilaw::testing
