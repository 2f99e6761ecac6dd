// What the penalty's springs take and give back, step by step, on random draws: any state, any velocity
// before (any external force, then), any H, two steps that have nothing to do with each other.
#include "support/law_runner.hpp"
#include "support/numbers.hpp"

#include <random>

namespace ilaw::testing {
namespace {

// Parameters of one draw and what the page says is stored.
struct Springs {
  double stiffness, exponent, tangential, friction;

  double normal(double x) const {
    return stiffness < inf_value ? stiffness * std::pow(x, exponent + 1.0) / (exponent + 1.0) : 0.0;
  }
  double tangent(double a, double b) const {
    return tangential < inf_value ? 0.5 * tangential * (a * a + b * b) : 0.0;
  }
};

class ImplicitEnergy : public ::testing::TestWithParam<std::uint32_t> {
 protected:
  double decades(double most) { return std::pow(10.0, most * uniform()); }
  double uniform() { return uniform_(random_); }

  // A positive definite H of the form; isotropic in the tangent plane where a rigid tangential spring needs
  // it.
  void draw_inertia(NodeRun& node, bool isotropic) {
    const double size = decades(1.0);
    const double other = isotropic ? 1.0 : 1.0 + 0.5 * uniform();
    node.h = {size * (1.0 + 0.5 * uniform()), size, size * other};
    if (GetParam() == ILAW_DELASSUS_FULL)
      for (std::size_t k = 3; k < 6; ++k) node.h[k] = isotropic ? 0.0 : 0.2 * size * uniform();
  }

  // -r.(v^- + v)/2 = what is stored more + what is dissipated, the latter not negative in either part.
  void check(NodeRun& node, const Springs& springs, std::vector<double> before, int seed) {
    const Vector previous = node.v_previous;
    const double stored = springs.normal(before[0]) + springs.tangent(before[2], before[3]);
    ASSERT_EQ(node.step({uniform(), uniform(), uniform()}), ILAW_OK) << node.report.reason;
    double work[3];
    for (std::size_t c = 0; c < 3; ++c) work[c] = 0.5 * node.r[c] * (previous[c] + node.v[c]);
    const double normal = springs.normal(node.state[0]),
                 tangent = springs.tangent(node.state[2], node.state[3]);
    const double impact = -work[0] - (normal - springs.normal(before[0]));
    const double rubbed = -work[1] - work[2] - (tangent - springs.tangent(before[2], before[3]));
    double scale = normal + tangent + stored;
    for (std::size_t c = 0; c < 3; ++c)
      scale += std::abs(node.r[c]) * (std::abs(previous[c]) + std::abs(node.v[c]) + std::abs(node.v_free[c]));
    const double slack = 1e-12 * scale;
    ASSERT_GE(impact, -slack) << "draw " << seed << ", x " << before[0] << " -> " << node.state[0];
    ASSERT_GE(rubbed, -slack) << "draw " << seed << ", slip " << before[2] << " -> " << node.state[2];
    ASSERT_NEAR(node.energy[ILAW_ENERGY_IMPACT], impact, slack) << "draw " << seed;
    ASSERT_NEAR(node.energy[ILAW_ENERGY_FRICTION], rubbed, slack) << "draw " << seed;
    ASSERT_NEAR(node.energy[ILAW_ENERGY_STORED], normal + tangent, 1e-14 * (normal + tangent));
    if (node.status == ILAW_STICK && springs.tangential < inf_value) {
      ASSERT_LE(rubbed, slack) << "draw " << seed;
    }
  }

 private:
  std::mt19937_64 random_{11};
  std::uniform_real_distribution<double> uniform_{-1.0, 1.0};
};

// A soft spring that presses little, and a velocity that was turned round in part: what rounding leaves of
// the tangential velocity is large beside the normal impulse, and may do no work.
TEST(PenaltyStick, OfWhatTurnedRoundDoesNoWork) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  NodeRun node("penalty", {{{"stiffness", 1e-6}, {"friction", 1.0}}, {{"integration", "implicit"}}});
  for (int draw = 0; draw < 100000 && !::testing::Test::HasFatalFailure(); ++draw) {
    const double part = 1.2 * uniform(random);
    const Vector previous{-1.0, uniform(random) - 0.5, uniform(random) - 0.5};
    node.state.assign(node.state.size(), 0.0);
    node.gap = 0.0;
    node.v_previous = previous;
    ASSERT_EQ(node.step({-1.0, -part * previous[1], -part * previous[2]}), ILAW_OK);
    const double work = 0.5 * (node.r[1] * (previous[1] + node.v[1]) + node.r[2] * (previous[2] + node.v[2]));
    const double scale = std::abs(node.r[1]) + std::abs(node.r[2]);
    ASSERT_LE(work, 16 * ulp * scale) << "draw " << draw << ", turned " << part;
  }
}

TEST_P(ImplicitEnergy, GivesBackWhatItDoesNotDissipate) {
  std::map<int, int> seen;
  for (int instance = 0; instance < 500 && !HasFatalFailure(); ++instance) {
    const bool rigid_tangent = instance % 5 == 0, rigid = instance % 17 == 0;
    const double scale = decades(1.0), h = decades(1.0);
    const Springs springs{rigid ? inf_value : decades(3.0) / (h * h),
                          instance % 4 == 1 ? 1.5 : (instance % 16 == 2 ? 3.3 : 1.0),
                          rigid_tangent ? inf_value : decades(3.0) / (h * h), instance % 7 ? 0.5 : inf_value};
    std::map<std::string, double> numbers{{"stiffness", springs.stiffness},
                                          {"exponent", springs.exponent},
                                          {"friction", springs.friction},
                                          {"tangential_stiffness", springs.tangential}};
    if (instance % 3 == 1) numbers["damping"] = decades(2.0) / h;
    if (instance % 3 == 2 && springs.exponent == 1.0) numbers["restitution"] = 0.5 + 0.5 * uniform();
    NodeRun node("penalty", {numbers, {{"integration", "implicit"}}}, h, GetParam());
    node.position_dt = decades(1.0);
    for (int k = 0; k < 100 && !HasFatalFailure(); ++k) {
      draw_inertia(node, rigid_tangent || rigid || springs.friction == inf_value);
      node.gap = scale * uniform();
      node.v_previous = {uniform(), uniform(), uniform()};
      node.state = {rigid || k % 4 == 0 ? 0.0 : h * std::abs(uniform()) * decades(1.0), 0.0,
                    rigid_tangent ? 0.0 : h * uniform(), rigid_tangent ? 0.0 : h * uniform()};
      check(node, springs, node.state, 100 * instance + k);
      ++seen[node.status];
    }
  }
  for (const int status : {ILAW_FREE, ILAW_STICK, ILAW_SLIP}) EXPECT_GT(seen[status], 1500) << status;
}

INSTANTIATE_TEST_SUITE_P(Inertia, ImplicitEnergy,
                         ::testing::Values(ILAW_DELASSUS_SCALAR, ILAW_DELASSUS_DIAGONAL, ILAW_DELASSUS_FULL));

// Two steps of an undamped explicit spring in contact: the energy of the page, 1/2 k g g', with g' the gap
// that the position step leads to, is kept exactly where the impulse of the velocity step does the work.
TEST(ExplicitEnergy, KeepsItsOwnWhateverTheSteps) {
  for (const double ratio : {0.37, 1.0, 1.71}) {
    const double k = 10.0, l = 1e-2, h = ratio * l;
    NodeRun node("penalty", {{{"stiffness", k}}, {}}, h);
    node.position_dt = l;
    node.v = node.v_previous = {-1.0, 0, 0};
    node.gap = -0.3;
    double before = 0.0;
    for (int step = 0; step < 30; ++step) {
      const double previous = node.v[0];
      ASSERT_EQ(node.step(node.v), ILAW_OK);
      const double next = node.gap + l * node.v[0];
      EXPECT_NEAR(node.energy[ILAW_ENERGY_STORED], 0.5 * k * node.gap * next, 1e-14);
      // The impulse is h times the force and the way l times the velocity: h/l of what is stored is given.
      const double work = 0.5 * node.r[0] * (previous + node.v[0]);
      if (step > 0) {
        EXPECT_NEAR(work, (h / l) * (before - node.energy[ILAW_ENERGY_STORED]), 1e-13) << ratio;
      }
      before = node.energy[ILAW_ENERGY_STORED];
      node.gap = next;
    }
  }
}

// The same for its tangential spring: a sticking node, as it swings.
TEST(ExplicitEnergy, KeepsThatOfSlipWhateverTheSteps) {
  for (const double ratio : {0.37, 1.0, 1.71}) {
    const double k = 40.0, l = 1e-2, h = ratio * l;
    NodeRun node("penalty", {{{"stiffness", 1.0}, {"tangential_stiffness", k}, {"friction", inf_value}}, {}},
                 h);
    node.position_dt = l;
    node.gap = -1.0;
    node.v = node.v_previous = {0.0, 0.3, -0.4};
    double before = 0.0;
    for (int step = 0; step < 100; ++step) {
      const Vector previous = node.v;
      node.v[0] = 0.0;  // held in the normal direction
      const Vector free{0.0, node.v[1], node.v[2]};
      node.v_previous = {0.0, previous[1], previous[2]};
      ASSERT_EQ(node.step(free), ILAW_OK);
      const double spring = node.energy[ILAW_ENERGY_STORED] - 0.5 * node.gap * (node.gap + l * node.v[0]);
      double work = 0.0;
      for (std::size_t c = 1; c < 3; ++c) work += 0.5 * node.r[c] * (previous[c] + node.v[c]);
      if (step > 0) {
        EXPECT_NEAR(work, (h / l) * (before - spring), 1e-13) << ratio;
      }
      EXPECT_NEAR(node.energy[ILAW_ENERGY_FRICTION], 0.0, 1e-15) << ratio << " " << step;
      before = spring;
    }
  }
}

}  // namespace
}  // namespace ilaw::testing
