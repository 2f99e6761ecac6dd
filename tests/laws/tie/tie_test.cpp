// The tie through the ABI: a bilateral constraint for any H, and its rupture, against closed forms.
#include "support/rupture_instants.hpp"

namespace ilaw::testing {
namespace {

// A unit point mass pushed by impulses from outside: v_free = v + impulse.
struct Tied : NodeRun {
  Tied(const Parameters& parameters, double step) : NodeRun("tie", parameters, step) { gap = 0.0; }

  int push(const Vector& impulse) {
    ++steps;
    time = static_cast<double>(steps) * dt;
    EXPECT_EQ(this->step({v[0] + impulse[0], v[1] + impulse[1], v[2] + impulse[2]}), ILAW_OK);
    return status;
  }
  std::int64_t steps = 0;
};

// The bilateral constraint v = 0 has the closed form r = -H^-1 v_free; for H = A A^T + c I of moderate
// condition LDL^T leaves a residual of some ulp of |H| |r|. Free gaps play no part.
TEST(Tie, UnbrokenIsTheBilateralConstraintForAnyH) {
  Random random(1);
  NodeRun node("tie", {}, 1e-3, ILAW_DELASSUS_FULL);
  EXPECT_EQ(node.interface.info().inputs, std::uint32_t{ILAW_INPUT_V_PREVIOUS});
  for (int k = 0; k < 1000000; ++k) {
    double a[3][3], h[3][3] = {};
    for (auto& row : a)
      for (double& entry : row) entry = random();
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        for (int l = 0; l < 3; ++l) h[i][j] += a[i][l] * a[j][l];
        h[i][j] += i == j ? 0.3 : 0.0;
      }
    node.h = {h[0][0], h[1][1], h[2][2], h[0][1], h[0][2], h[1][2]};
    node.gap = random();
    const double scale = random.decades(-250.0, 150.0);
    node.v_previous = {};
    ASSERT_EQ(node.step(random.vector(scale)), ILAW_OK) << "k " << k;
    ASSERT_EQ(node.status, ILAW_BONDED) << "k " << k;
    const double r = std::abs(node.r[0]) + std::abs(node.r[1]) + std::abs(node.r[2]);
    for (const double v : node.v) ASSERT_LE(std::abs(v), 64 * ulp * 4.0 * r);
  }
}

// A scalar H divides exactly once: r = -v_free / h, bit for bit.
TEST(Tie, OnAPointMassIsItsMomentum) {
  NodeRun node("tie", {});
  node.h[0] = 3.0;
  node.gap = 7.0;  // held at any distance
  ASSERT_EQ(node.step({1.0, -2.0, 0.5}), ILAW_OK);
  EXPECT_EQ(node.r, (Vector{-1.0 / 3.0, 2.0 / 3.0, -0.5 / 3.0}));
}

// Constant force F in pull, shear or both: the window holds F min(t, tau), so the bond holds for ever when
// F tau <= R, and else breaks at the first t_n = n h with n h F > R. A press never breaks it.
TEST(Tie, ConstantForceBreaksAtStrengthOverForce) {
  constexpr double h = 1e-2, tau = 0.2, force = 2.0;
  const Parameters strong{{{"strength", 0.4}, {"memory", tau}, {"buckets", 20}}, {}},
      weak{{{"strength", 0.29}, {"memory", tau}, {"buckets", 20}}, {}};
  for (const Vector& direction : {Vector{1, 0, 0}, Vector{0, 1, 0}, Vector{0, 0, -1}, Vector{0.6, 0, 0.8}}) {
    const Vector pull{h * force * direction[0], h * force * direction[1], h * force * direction[2]};
    Tied holds(strong, h), breaks(weak, h);
    for (int n = 1; n <= 300; ++n) ASSERT_EQ(holds.push(pull), ILAW_BONDED) << n;
    for (int n = 1; n <= 14; ++n) ASSERT_EQ(breaks.push(pull), ILAW_BONDED) << n;
    EXPECT_EQ(breaks.push(pull), ILAW_BROKEN);  // 15 h F = 0.3 > 0.29 at last
    EXPECT_EQ(breaks.named("broken"), 1.0);
  }
  Tied pressed(weak, h);
  for (int n = 1; n <= 300; ++n) ASSERT_EQ(pressed.push({-100.0, 0, 0}), ILAW_BONDED);
}

// The strength is per area; a single impulse p breaks iff p > R A, whatever the memory.
TEST(Tie, ASingleShockBreaksIffItExceedsStrengthTimesArea) {
  for (const double tau : {0.0, 1e-3, 0.02, inf_value})
    for (const auto& [shock, breaks] : {std::pair{0.5, false}, {0.5000001, true}}) {
      Tied node({{{"strength", 2.0}, {"memory", tau}}, {}}, 1e-3);
      node.area = 0.25;
      EXPECT_EQ(node.push({0.6 * shock, -0.8 * shock, 0}) == ILAW_BROKEN, breaks) << tau << " " << shock;
    }
}

// The force is that of a node, whatever its area: a pull P breaks it after F tau/P, one of F never does;
// where F tau = R A, the bits are those of the strength R.
TEST(Tie, ForceIsOfANode) {
  constexpr double h = 1e-2, tau = 0.2, force = 1.45;
  Random random(6);
  for (const double area : {0.125, 1.0, 4.0}) {
    const Parameters by_force{{{"force", force}, {"memory", tau}, {"buckets", 20}}, {}};
    Tied holds(by_force, h), breaks(by_force, h), node(by_force, h),
        same({{{"strength", force * tau / area}, {"memory", tau}, {"buckets", 20}}, {}}, h);
    for (Tied* one : {&holds, &breaks, &node, &same}) one->area = area;
    for (int n = 1; n <= 300; ++n) ASSERT_EQ(holds.push({0.6 * h * force, 0.8 * h * force, 0}), ILAW_BONDED);
    for (int n = 1; n <= 14; ++n) ASSERT_EQ(breaks.push({0, h * 2.0, 0}), ILAW_BONDED) << n;
    EXPECT_EQ(breaks.push({0, h * 2.0, 0}), ILAW_BROKEN);  // 15 h P = 0.3 > 0.29 at last
    for (int n = 0; n < 500; ++n) {
      const Vector push = random.vector(0.05);
      ASSERT_EQ(node.push(push), same.push(push)) << "area " << area << ", step " << n;
      ASSERT_EQ(node.r, same.r) << "area " << area << ", step " << n;
    }
    EXPECT_EQ(node.named("broken"), 1.0);
  }
}

// In shear, which the windowed sum carries through frames and slopes of its own.
const BondLaw bond{"tie",
                   [](double limit, double buckets) {
                     return Parameters{{{"strength", limit}, {"memory", 1.0}, {"buckets", buckets}}, {}};
                   },
                   {0.0, 0.6, -0.8}};

TEST(Tie, BreaksWhenTheExactIntegralPassesTheStrength) { expect_rupture_instants(bond); }

TEST(Tie, ShocksAddUpWithinTheWindow) { expect_double_shocks(bond); }

// The interval of a step whose position step is short may begin a bucket before one that is open already:
// what falls there leaves the window with that bucket. Buckets of 1; 3/4 of the second pull act before 2.
TEST(Tie, AStepThatBeginsInTheBucketBeforeSpreadsOverBoth) {
  NodeRun node("tie", {{{"strength", 1.0}, {"memory", 4.0}, {"buckets", 4.0}}, {}}, 0.2);
  const auto pull = [&](double impulse, double time, double velocity_step, double position_step) {
    node.time = time;
    node.dt = velocity_step;
    node.position_dt = position_step;
    EXPECT_EQ(node.step({impulse, 0.0, 0.0}), ILAW_OK);
    return int{node.status};
  };
  EXPECT_EQ(pull(0.1, 2.0, 0.2, 0.4), ILAW_BONDED);  // [2.0, 2.2]
  EXPECT_EQ(pull(0.8, 2.1, 0.8, 0.2), ILAW_BONDED);  // [1.4, 2.2]
  EXPECT_EQ(pull(0.5, 6.0, 0.1, 0.1), ILAW_BONDED);  // 0.3 are left, all but 1/20
  EXPECT_EQ(pull(0.25, 6.01, 0.01, 0.1), ILAW_BROKEN);
}

// A clock may fall back by a part of a step, into the bucket before the newest, and not further.
TEST(Tie, AClockFallsBackByOneBucketAtMost) {
  for (const auto& [time, code] : {std::pair{1.05, ILAW_OK}, {0.95, ILAW_BAD_NODES}}) {
    NodeRun node("tie", {{{"strength", 1.0}, {"memory", 4.0}, {"buckets", 4.0}}, {}}, 0.2);
    node.position_dt = 0.0625;
    node.time = 2.125;
    ASSERT_EQ(node.step({0.1, 0.0, 0.0}), ILAW_OK);
    node.time = time - 0.03125;
    EXPECT_EQ(node.step({0.1, 0.0, 0.0}), code) << time;
  }
}

}  // namespace
}  // namespace ilaw::testing
