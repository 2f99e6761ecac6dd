// The Post-it law through the ABI, against histories derived by hand.
#include "support/order.hpp"
#include "support/rupture_instants.hpp"

#include <cstring>

namespace ilaw::testing {
namespace {

// A unit point mass on the plane, with a pull F(t) and shocks: v_free = v + h F + shocks.
struct Glued : NodeRun {
  Glued(const Parameters& parameters, double step) : NodeRun("postit", parameters, step) {}

  // One step of the point with this impulse from outside; returns the status.
  int push(const Vector& impulse) {
    ++steps;
    time = static_cast<double>(steps) * dt;
    position = position + dt * v;
    gap = position[0];
    EXPECT_EQ(step(v + impulse), ILAW_OK);
    return status;
  }
  Vector position{};
  std::int64_t steps = 0;
};

// Time of the first rupture under a pull F(t) from time 0 after a press of impulse p; -1 if it holds until
// end.
template <class Pull>
double rupture_time(const Parameters& parameters, double h, double press, Pull pull, double end) {
  Glued node(parameters, h);
  node.push({-press, 0, 0});
  // Let the press leave the window first.
  const auto rest = static_cast<std::int64_t>(std::ceil((parameters.numbers.at("memory") + h) / h));
  for (std::int64_t k = 0; k < rest; ++k) node.push({0, 0, 0});
  const auto steps = static_cast<std::int64_t>(std::llround(end / h));
  for (std::int64_t k = 1; k <= steps; ++k)
    if (node.push({h * pull(static_cast<double>(k) * h), 0, 0}) == ILAW_BROKEN)
      return static_cast<double>(k) * h;
  return -1.0;
}

// Constant pull F, adhesion R: the windowed impulse is F min(t, tau). It holds for ever when F tau <= R, else
// breaks when F t = R, at R/F; in steps at the first n h F > R, so at most h late.
TEST(Postit, ConstantPullBreaksAtAdhesionOverForce) {
  const auto pull = [](double) { return 2.0; };
  for (const double h : {0.01, 0.005, 0.0025, 0.00125}) {
    GIVEN(h);
    EXPECT_EQ(rupture_time({{{"memory", 0.2}, {"buckets", 4096}}, {}}, h, 0.4, pull, 3.0), -1.0)
        << "F tau = R holds";
    EXPECT_EQ(rupture_time({{{"memory", 0.2}, {"buckets", 4096}}, {}}, h, 0.41, pull, 3.0), -1.0);
    const double time = rupture_time({{{"memory", 0.2}, {"buckets", 4096}}, {}}, h, 0.39, pull, 3.0);
    EXPECT_GE(time, 0.195 - 1e-12);
    EXPECT_LE(time, 0.195 + h);
  }
}

const BondLaw bond{
    "postit",
    [](double limit, double buckets) {
      return Parameters{{{"initial_adhesion", limit}, {"memory", 1.0}, {"buckets", buckets}}, {}};
    },
    {1.0, 0.0, 0.0}};

TEST(Postit, BreaksWhenTheExactIntegralPassesTheAdhesion) { expect_rupture_instants(bond); }

TEST(Postit, DoubleShocksBreakWithinTheWindow) { expect_double_shocks(bond); }

// A single impulse p breaks iff p > R, whatever tau, also tau = 0 and tau = inf.
TEST(Postit, ASingleShockBreaksIffItExceedsTheAdhesion) {
  for (const double tau : {0.0, 1e-4, 1e-3, 0.02, 1.0})
    for (const auto& [shock, breaks] : {std::pair{0.5, false}, {0.5000001, true}}) {
      Glued node({{{"memory", tau}, {"buckets", 2000}}, {}}, 1e-3);
      node.push({-0.5, 0, 0});
      for (int k = 0; k < 1100; ++k) node.push({0, 0, 0});
      EXPECT_EQ(node.push({shock, 0, 0}) == ILAW_BROKEN, breaks) << tau << " " << shock;
    }
}

// After b ruptures a press of impulse p gives exp(-b/n_b) p, capped by R_Y,max times the area.
TEST(Postit, AdhesionFollowsRupturesLimitAndArea) {
  Glued node({{{"efficiency_decrease", 10.0}, {"adhesion_limit", 0.2}}, {}}, 1e-3);
  node.area = 0.5;
  int limited = 0;
  for (int ruptures = 0; ruptures < 25; ++ruptures) {
    const double press = 0.1 + 0.02 * ruptures;
    node.position = {};
    node.v = node.v_previous = {};
    EXPECT_EQ(node.push({-press, 0, 0}), ILAW_HEALED) << "ruptures " << ruptures;
    const double expected = std::min(std::exp(-ruptures / 10.0) * press, 0.1);
    limited += expected == 0.1 ? 1 : 0;
    EXPECT_NEAR(node.named("adhesion"), expected, 4e-16) << "ruptures " << ruptures;
    EXPECT_EQ(node.push({0.99 * expected, 0, 0}), ILAW_BONDED) << "ruptures " << ruptures;
    EXPECT_EQ(node.push({1.01 * expected, 0, 0}), ILAW_BROKEN) << "ruptures " << ruptures;
    EXPECT_EQ(node.named("ruptures"), ruptures + 1.0) << "ruptures " << ruptures;
    EXPECT_EQ(node.named("adhesion"), 0.0) << "ruptures " << ruptures;
  }
  EXPECT_GT(limited, 5);
  EXPECT_LT(limited, 20);
}

// Pressed with S_N = p and sheared: friction carries mu p, the bond lambda R beyond it.
TEST(Postit, ShearBreaksBeyondFrictionAndTangentialAdhesion) {
  for (const auto& [shear, breaks] :
       {std::pair{0.1 * 0.5 + 0.8 * 0.3 - 1e-6, false}, {0.1 * 0.5 + 0.8 * 0.3 + 1e-6, true}}) {
    Glued node(
        {{{"initial_adhesion", 0.3}, {"adhesion_limit", 0.3}, {"friction", 0.1}, {"tangent_influence", 0.8}},
         {}},
        1e-3);
    EXPECT_EQ(node.push({-0.5, 0.6 * shear, 0.8 * shear}) == ILAW_BROKEN, breaks);
    if (!breaks) continue;
    // Then contact with friction: mu r_N against the slip, and the press bonds again.
    EXPECT_NEAR(node.r[0], 0.5, 1e-15);
    EXPECT_NEAR(node.r[1], -0.6 * 0.05, 1e-15);
    EXPECT_NEAR(node.r[2], -0.8 * 0.05, 1e-15);
    EXPECT_NEAR(node.named("adhesion"), 0.3, 1e-15);
  }
}

// A rupture in shear under a press that has lasted: what was pressed before no longer heals, only the press
// of the step itself.
TEST(Postit, ARuptureUnderPressureHealsByItsOwnStepAlone) {
  Glued node(
      {{{"efficiency_decrease", 10.0}, {"memory", 1.0}, {"friction", 0.1}, {"tangent_influence", 0.8}}, {}},
      1e-3);
  for (int k = 1; k <= 3; ++k) {
    node.push({-0.2, 0, 0});
    EXPECT_NEAR(node.named("adhesion"), 0.2 * k, 1e-15) << "k " << k;
  }
  const double most = 0.1 * 0.65 + 0.8 * 0.6;  // friction carries mu S_N, the bond lambda R
  EXPECT_EQ(node.push({-0.05, most + 0.01, 0}), ILAW_BROKEN);
  EXPECT_EQ(node.named("ruptures"), 1.0);
  EXPECT_NEAR(node.named("adhesion"), std::exp(-0.1) * 0.05, 1e-15);
  // The window begins anew with that press.
  EXPECT_EQ(node.push({-0.03, -node.v[1], 0}), ILAW_BONDED);
  EXPECT_NEAR(node.named("adhesion"), std::exp(-0.1) * 0.08, 1e-15);
}

// A press that holds a bond against later pulls leaves the window while the node is pressed again: the bond
// breaks, and contact is left. Where no energies are asked the kit tries the usual step, which this is not.
TEST(Postit, ABondThatBreaksUnderPressureGivesContactTriedOrNot) {
  const Parameters parameters{{{"memory", 0.01}, {"friction", 0.3}, {"buckets", 4.0}}, {}};
  Glued node(parameters, 1e-3), tried(parameters, 1e-3);
  int broken_under_pressure = 0;
  for (int k = 0; k < 16; ++k) {
    const Vector push = k == 0 ? Vector{-1.0, 0, 0} : Vector{k < 9 ? 0.2 : -0.01, 0.002, 0};
    tried.v_previous = node.v_previous;
    node.push(push);
    tried.gap = node.gap;
    tried.time = node.time;
    tried.v_free = node.v_free;
    ilaw_batch b = tried.batch();
    b.state_in = ilaw::input(tried.state.data(), 0, 1);
    b.state_out = ilaw::output(tried.state.data(), 0, 1);
    b.impulse = ilaw::output(tried.r.data(), 0, 1);
    ASSERT_EQ(tried.interface.evaluate(b), ILAW_OK);
    ASSERT_EQ(std::memcmp(tried.r.data(), node.r.data(), sizeof node.r), 0) << "k " << k;
    ASSERT_EQ(tried.state, node.state) << "k " << k;
    broken_under_pressure += node.status == ILAW_BROKEN && node.r[0] > 0.0 ? 1 : 0;
  }
  EXPECT_EQ(broken_under_pressure, 1);
}

// Presses that add up to more than a double holds: the one that would make the adhesion infinite is refused.
TEST(Postit, AnAdhesionThatOverflowsIsRefused) {
  NodeRun node("postit", {{{"memory", inf_value}}, {}}, 1e-3);
  int presses = 0;
  while (presses < 8 && node.step({-4e307, 0, 0}) == ILAW_OK) {
    ++presses;
    ASSERT_TRUE(std::isfinite(node.named("adhesion"))) << presses;
  }
  EXPECT_EQ(presses, 4);
  EXPECT_STREQ(node.report.reason, "the impulse or the state overflows");
  EXPECT_EQ(node.named("adhesion"), 1.6e308);
}

// An adhesion in subnormal numbers is as good as none: scaled to it, pressure and shear overflow.
TEST(Postit, ShearBreaksAnAdhesionThatUnderflows) {
  for (const double friction : {0.0, 0.2, 0.3})
    for (const double tangential : {1e-3, 1.0, 1e3}) {
      Glued node({{{"memory", inf_value},
                   {"initial_adhesion", 5e-316},
                   {"adhesion_limit", 5e-316},
                   {"tangent_influence", tangential},
                   {"friction", friction}},
                  {}},
                 1e-3);
      EXPECT_EQ(node.push({-4.0, 0.0, 0.0}), ILAW_BONDED);
      // |S_T| - mu S_N = 1 - 4 mu
      EXPECT_EQ(node.push({0.0, 1.0, 0.0}), friction < 0.25 ? ILAW_BROKEN : ILAW_BONDED) << friction;
    }
}

// Pull and shear together: the ellipse (a/R)^2 + (b/(lambda R))^2 = 1.
TEST(Postit, MixedModeFollowsTheEllipse) {
  for (double angle = 0.0; angle < 1.58; angle += 0.1)
    for (const double factor : {0.999999, 1.000001}) {
      Glued node({{{"initial_adhesion", 2.0}, {"friction", 0.3}, {"tangent_influence", 0.5}}, {}}, 1e-3);
      const Vector pull{factor * 2.0 * std::cos(angle), 0.0, -factor * 1.0 * std::sin(angle)};
      EXPECT_EQ(node.push(pull) == ILAW_BROKEN, factor > 1.0) << angle;
    }
}

// Saturated rupture hands over what was left: a pull p > R from rest leaves with p - R, and dissipates R v/2.
TEST(Postit, SaturatedRuptureGivesWhatWasLeft) {
  Glued node({{{"initial_adhesion", 0.3}}, {{"rupture", "saturated"}}}, 1e-3);
  EXPECT_EQ(node.push({0.5, 0, 0}), ILAW_BROKEN);
  EXPECT_NEAR(node.r[0], -0.3, 1e-15);
  EXPECT_NEAR(node.v[0], 0.2, 1e-15);
  EXPECT_NEAR(node.energy[ILAW_ENERGY_RUPTURE], 0.5 * 0.3 * 0.2, 1e-15);
  Glued brittle({{{"initial_adhesion", 0.3}}, {}}, 1e-3);
  EXPECT_EQ(brittle.push({0.5, 0, 0}), ILAW_BROKEN);
  EXPECT_EQ(brittle.r[0], 0.0);
}

// The impulse of a bond takes nothing from contact: where H does not couple, a node on the plane that
// breaks in shear does not enter it, unless it was leaving, and then no faster than it left. So it is also
// where its sliding turned round within the step and friction is scaled for the work of both.
TEST(Postit, SaturatedRuptureUnderPressureStaysOnThePlane) {
  NodeRun node("postit",
               {{{"tangent_influence", 0.3}, {"friction", 5.0}, {"initial_adhesion", 0.2}},
                {{"rupture", "saturated"}}},
               1e-3, ILAW_DELASSUS_DIAGONAL);
  Random random(7);
  int broke = 0, scaled = 0;
  for (int k = 0; k < 100000 && !HasFailure(); ++k) {
    for (std::size_t c = 0; c < 3; ++c) node.h[c] = std::exp2(2.5 * random());
    const Vector free{-0.05 - 0.05 * random(), random(), random()};
    const double back = 0.5 + 0.5 * random();
    node.v_previous = {k % 2 * 0.1 * random(), -back * free[1], 0.2 * random() - back * free[2]};
    const double limit = std::min(0.0, -node.v_previous[0]);
    node.initialise();
    ASSERT_EQ(node.step(free), ILAW_OK);
    if (node.status != ILAW_BROKEN) continue;
    ++broke;
    scaled += node.energy[ILAW_ENERGY_RUPTURE] < 1e-14;
    EXPECT_GE(node.v[0], limit - 1e-12) << "draw " << k;
    EXPECT_LE(node.v[0], 1e-12) << "draw " << k;
  }
  EXPECT_GT(broke, 20000);
  EXPECT_GT(scaled, 10);
}

// A block under a press of 1 that is pushed sideways at 2, from rest on a bond of P tau, and then back gently
// until it sticks again; steps share no factor with the times or with each other.
constexpr double sliding_steps[] = {0.0097, 0.00113, 0.000107};

struct Pushed : Glued {
  Pushed(double step, double friction, const char* rupture)
      : Glued({{{"efficiency_decrease", 10.0},
                {"memory", 0.05},
                {"friction", friction},
                {"tangent_influence", 0.8}},
               {{"rupture", rupture}}},
              step) {}

  void hold(double end, double press, double shear) {
    while (time < end) push({-dt * press, dt * shear, 0.0});
  }
};

template <class Check>
void slide(Check check) {
  for (const double h : sliding_steps)
    for (const double friction : {0.5, 0.0})
      for (const char* rupture : {"brittle", "saturated"}) {
        SCOPED_TRACE(::testing::Message() << "h " << h << ", mu " << friction << ", " << rupture);
        Pushed node(h, friction, rupture);
        check(node);
      }
}

// One rupture: the adhesion left is exp(-1/10) P tau. The ramp 20 (t - 1.25) then puts 20 tau (t - 1.25 -
// tau/2) into the window, which is that adhesion at t = 1.32024.
TEST(Postit, ASlideUnderPressureIsOneRupture) {
  slide([](Pushed& node) {
    node.hold(0.3, 1.0, 0.0);
    node.hold(0.4, 1.0, 2.0);
    EXPECT_EQ(node.status, ILAW_BROKEN);  // still sliding
    node.hold(1.0, 1.0, -0.5);
    EXPECT_EQ(node.status, ILAW_BONDED);
    node.hold(1.2, 1.0, 0.0);
    EXPECT_EQ(node.named("ruptures"), 1.0);
    const double adhesion = std::exp(-0.1) * 0.05;
    EXPECT_NEAR(node.named("adhesion"), adhesion, 1e-12);
    node.hold(1.25, 0.0, 0.0);
    while (node.time < 1.5 && node.status != ILAW_BROKEN)
      node.push({node.dt * 20.0 * (node.time + node.dt - 1.25), 0.0, 0.0});
    EXPECT_NEAR(node.time, 1.25 + 0.025 + adhesion / (20.0 * 0.05), 0.6 * node.dt);
    EXPECT_EQ(node.named("ruptures"), 2.0);  // the bond had held
  });
}

// Each of ten pulses breaks a bond that has held, and counts.
TEST(Postit, ShearPulsesCountOnceEach) {
  slide([](Pushed& node) {
    for (int pulse = 0; pulse < 10; ++pulse) {
      node.hold(pulse + 0.3, 1.0, 0.0);
      EXPECT_EQ(node.status, ILAW_BONDED) << pulse;
      node.hold(pulse + 0.36, 1.0, 2.0);
      node.hold(pulse + 1.0, 1.0, -0.2);
    }
    node.hold(10.3, 1.0, 0.0);
    EXPECT_EQ(node.named("ruptures"), 10.0);
    EXPECT_NEAR(node.named("adhesion"), std::exp(-1.0) * 0.05, 1e-12);
  });
}

// The rupture of a bond that was torn off and pressed on again counts, however short it held.
TEST(Postit, ASeparationMakesTheNextRuptureCount) {
  Glued node({{{"efficiency_decrease", 10.0}, {"memory", 0.05}}, {}}, 1e-3);
  for (int k = 0; k < 7; ++k) {
    node.position = {};
    node.v = node.v_previous = {};
    EXPECT_EQ(node.push({-0.1, 0, 0}), ILAW_HEALED) << "k " << k;
    EXPECT_EQ(node.push({0.5, 0, 0}), ILAW_BROKEN) << "k " << k;
    for (int free = 0; free < 60; ++free) EXPECT_EQ(node.push({0, 0, 0}), ILAW_FREE);
    EXPECT_EQ(node.named("ruptures"), k + 1.0) << "k " << k;
  }
}

}  // namespace
}  // namespace ilaw::testing
