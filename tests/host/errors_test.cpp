// Errors and their orders: the norms, on motions made by hand.
#include "study/errors.hpp"
#include "study/convergence.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace ilaw::host::testing::errors {
namespace {

constexpr double no_instant = ContactInstants::none;

// A point that comes at speed 1, meets something at an instant, and goes back at speed 1.
ExactNode bounce(double instant) {
  ExactNode node;
  node.displacement = [=](double t) { return t < instant ? t : 2.0 * instant - t; };
  node.velocity = [=](double t) { return t < instant ? 1.0 : -1.0; };
  node.instants.first_impulse = instant;
  return node;
}

// The trace that a run of the node would leave.
Trace trace_of(const ExactNode& node, double dt, int steps) {
  Trace trace;
  trace.dt = dt;
  trace.steps = steps;
  for (int k = 1; k <= steps; ++k) {
    trace.displacement.push_back(Dofs::Constant(1, node.displacement(k * dt)));
    trace.velocity.push_back(Dofs::Constant(1, node.velocity((k + 0.5) * dt)));
    trace.impulse.push_back(Dofs::Constant(1, trace.velocity.back()[0] - node.velocity(0.0)));
    trace.work.push_back(0.0);
  }
  trace.instants = {node.instants};
  trace.energy = 1.0;
  return trace;
}

// A bounce that is seen one step late: one velocity of N is wrong, by 2 where the mean is 1, and positions
// after it by 2 h where the largest is 0.5. All is first order, and so is the order that is found.
TEST(Norms, OfAJumpDisplacedByOneStepAreOfFirstOrder) {
  std::vector<double> steps;
  std::map<std::string, std::vector<double>> found;
  for (int n = 50; n <= 800; n *= 2) {
    const double h = 1.0 / n;
    const double instant = 0.5;
    const Errors errors = errors_against({bounce(instant)}, trace_of(bounce(instant + h), h, n));
    EXPECT_NEAR(errors.v_L1, 2.0 / n, 1e-12) << "n " << n;
    EXPECT_NEAR(errors.u_max, 2.0 * h / 0.5, 1e-12) << "n " << n;
    EXPECT_NEAR(errors.instant, h, 1e-15) << "n " << n;
    // Half of the errors are 2 h; the mean square of the motion is 1/12.
    EXPECT_NEAR(errors.u_L2, std::sqrt(0.5) * 2.0 * h / std::sqrt(1.0 / 12.0), 3.0 * h * h * 10.0)
        << "n " << n;
    steps.push_back(h);
    found["u_L2"].push_back(errors.u_L2);
    found["u_max"].push_back(errors.u_max);
    found["v_L1"].push_back(errors.v_L1);
    found["instant"].push_back(errors.instant);
  }
  for (const auto& [norm, errors] : found) EXPECT_NEAR(order_of(steps, errors), 1.0, 0.05) << norm;
}

// Against a finer run of the same motion, whose positions are linear between its instants.
TEST(Norms, AgainstAFinerRunOfTheSameMotionAreThoseOfTheMotion) {
  const double h = 1e-2;
  const Errors same = errors_against(trace_of(bounce(0.505), h / 8.0, 800), trace_of(bounce(0.505), h, 99));
  EXPECT_LE(same.u_L2, 1e-14);
  EXPECT_LE(same.u_max, 1e-14);
  EXPECT_LE(same.v_L1, 2.0 / 99 * 1.001);  // the jump falls on an instant of the half steps
  EXPECT_EQ(same.instant, 0.0);
  const Errors late = errors_against(trace_of(bounce(0.505), h / 8.0, 800), trace_of(bounce(0.515), h, 99));
  EXPECT_NEAR(late.u_max, 2.0 * h / 0.5, 1e-12);  // the largest of the reference where the trace looks
  EXPECT_NEAR(late.instant, h, 1e-15);
}

TEST(Norms, TakeTheInstantThatIsFarthestOffOfThoseThatBothHave) {
  Trace trace = trace_of(bounce(0.5), 1e-2, 100);
  ExactNode exact = bounce(0.5);
  trace.instants[0] = {0.51, no_instant, 0.7};
  exact.instants = {0.5, 0.6, 0.75};
  EXPECT_NEAR(errors_against({exact}, trace).instant, 0.05, 1e-15);
  exact.instants = {no_instant, 0.6, no_instant};
  EXPECT_TRUE(std::isnan(errors_against({exact}, trace).instant));
}

TEST(Order, IsTheSlopeByLeastSquares) {
  const std::vector<double> h{1.0, 0.5, 0.2, 0.1};
  std::vector<double> errors;
  for (const double step : h) errors.push_back(3.0 * std::pow(step, 1.7));
  EXPECT_NEAR(order_of(h, errors), 1.7, 1e-14);
  // Errors 1, 1, 1/4 at steps 1, 1/2, 1/4: slopes 0 and 2, least squares the mean.
  EXPECT_NEAR(order_of({1.0, 0.5, 0.25}, {1.0, 1.0, 0.25}), 1.0, 1e-14);
}

// Errors at rounding level say nothing of the scheme: they are left out, zeros among them.
TEST(Order, LeavesOutWhatIsAtRoundingLevel) {
  const std::vector<double> h{1.0, 0.5, 0.25, 0.125, 0.0625};
  const double r = 0.5 * rounding_level;
  EXPECT_NEAR(order_of(h, {0.4, r, 0.1, 0.0, 0.025}), 1.0, 1e-14);
  // Relative to the quantity: instants near 1e6 are not known to 1e-9.
  EXPECT_NEAR(order_of(h, {0.4, 0.2, 0.1, 1e-9, 1e-9}, 1e6), 1.0, 1e-14);
  EXPECT_GT(order_of(h, {0.4, 0.2, 0.1, 1e-9, 1e-9}), 5.0);
  // Two make no order.
  EXPECT_TRUE(std::isnan(order_of(h, {0.4, 0.2, r, 0.0, r})));
  EXPECT_TRUE(std::isnan(order_of(h, {r, r, r, r, r})));
  EXPECT_TRUE(std::isnan(order_of({1.0, 0.5}, {0.4, 0.1})));
  // An error that is missing is not small.
  EXPECT_TRUE(std::isnan(order_of(h, {0.4, 0.2, 0.1, no_instant, 0.025})));
}

// Errors of instants are times: those of a run of 1e6 s are at rounding level below 1e-5 s. All others are
// relative.
TEST(Order, OfATableScalesInstantsByTheRun) {
  ErrorTable table;
  double h = 1e3;
  for (const double error : {0.4, 0.2, 0.1, 1e-9, 1e-9}) {
    Trace run;
    run.dt = h;
    run.steps = std::llround(1e6 / h);
    table.runs.push_back(run);
    table.errors.push_back({error, error, error, error, error, error});
    h *= 0.5;
  }
  EXPECT_NEAR(table.order(norm_instant), 1.0, 1e-12);
  for (const Norm norm : {norm_u_L2, norm_u_max, norm_v_L1, norm_impulse, norm_energy})
    EXPECT_GT(table.order(norm), 5.0) << norm;
}

}  // namespace
}  // namespace ilaw::host::testing::errors
