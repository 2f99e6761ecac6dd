// Regularised friction, invariances, and bad parameters of the penalty law.
#include "support/law_runner.hpp"

#include <limits>
#include <random>

namespace ilaw::testing {
namespace {

constexpr double inf_value = std::numeric_limits<double>::infinity();
constexpr double ulp = 2.3e-16;

Parameters with(const std::string& integration, std::map<std::string, double> numbers) {
  return {std::move(numbers), {{"integration", integration}}};
}

// Pressed to r_N = h k 0.01 and dragged at speed (0.6, -0.8) V: the spring gives k_T V t until mu N, then
// slides. Explicit, the spring lags by the step it is found at.
TEST(PenaltyFriction, SticksUpToTheConeThenSlides) {
  constexpr double h = 1e-3, stiffness = 1e4, tangential = 2e3, friction = 0.4, speed = 0.5;
  for (const char* integration : {"explicit", "implicit"}) {
    NodeRun node(
        "penalty",
        with(integration,
             {{"stiffness", stiffness}, {"tangential_stiffness", tangential}, {"friction", friction}}),
        h);
    node.gap = -0.01;   // a normal force of 100
    node.h[0] = 1e-12;  // a driven node
    double dissipated = 0.0;
    for (int k = 1; k <= 100; ++k) {
      ASSERT_EQ(node.step({0.0, 0.6 * speed, -0.8 * speed}), ILAW_OK);
      const double lag = integration == std::string("explicit") ? 1.0 : 0.0;
      const double force = std::min(tangential * speed * h * (k - lag), friction * 100.0);
      EXPECT_NEAR(node.r[1], -0.6 * h * force, 1e-14) << integration << " " << k;
      EXPECT_NEAR(node.r[2], 0.8 * h * force, 1e-14);
      EXPECT_NEAR(node.r[0], h * 100.0, 1e-12);
      if (k > 1 && k != 40 && k != 41) {  // on the cone itself rounding decides
        EXPECT_EQ(node.status, force < friction * 100.0 ? ILAW_STICK : ILAW_SLIP) << k;
      }
      dissipated += node.energy[ILAW_ENERGY_FRICTION];
    }
    // Sliding from 0.04 s on, with the force 40; the spring holds 40^2/(2 k_T) = 0.4.
    EXPECT_NEAR(dissipated, 40.0 * speed * (0.1 - 0.04), 40.0 * speed * 2.0 * h) << integration;
    EXPECT_NEAR(node.energy[ILAW_ENERGY_STORED], 0.5 * stiffness * 1e-4 + 0.4, 40.0 * speed * 2.0 * h);
  }
}

// Opening forgets the spring.
TEST(PenaltyFriction, LiftedContactForgets) {
  for (const char* integration : {"explicit", "implicit"}) {
    NodeRun node("penalty",
                 with(integration, {{"stiffness", 1e4}, {"tangential_stiffness", 1e3}, {"friction", 1.0}}));
    node.gap = -0.01;
    ASSERT_EQ(node.step({0.0, 1.0, 0.0}), ILAW_OK);
    EXPECT_NE(node.state[1], 0.0);
    node.gap = 1.0;
    ASSERT_EQ(node.step({0.0, 1.0, 0.0}), ILAW_OK);
    for (const double entry : node.state) EXPECT_EQ(entry, 0.0);
    EXPECT_EQ(node.status, ILAW_FREE);
  }
}

// Both stiffnesses infinite: Coulomb friction with predictive contact, bit for bit, also for mu = inf.
TEST(PenaltyFriction, RigidSpringsAreCoulomb) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0), exponent(-100.0, 100.0);
  for (const double friction : {0.0, 0.4, inf_value}) {
    NodeRun node("penalty", with("implicit", {{"stiffness", inf_value}, {"friction", friction}}));
    NodeRun coulomb("coulomb", {{{"friction", friction}}, {{"activation", "predictive"}}});
    for (int k = 0; k < 200000; ++k) {
      const double scale = std::pow(10.0, exponent(random));
      const Vector v{scale * uniform(random), scale * uniform(random), scale * uniform(random)};
      node.gap = coulomb.gap = 1e-3 * scale * uniform(random);
      node.h[0] = coulomb.h[0] = 1.0 + 0.9 * uniform(random);
      ASSERT_EQ(node.step(v), ILAW_OK);
      ASSERT_EQ(coulomb.step(v), ILAW_OK);
      ASSERT_EQ(node.r, coulomb.r);
      for (const double entry : node.state) ASSERT_EQ(entry, 0.0);
      if (friction > 0.0) {
        ASSERT_EQ(node.status, coulomb.status);
      }
    }
  }
}

// Without friction only the normal row of H counts.
TEST(Penalty, WithoutFrictionServesAnyH) {
  NodeRun smooth("penalty", with("implicit", {{"stiffness", 1e3}}), 1e-2, ILAW_DELASSUS_FULL);
  smooth.h = {4.0, 3.0, 2.0, 1.0, -0.5, 0.25};
  smooth.gap = -0.1;
  ASSERT_EQ(smooth.step({-2.0, 1.0, 1.0}), ILAW_OK);
  // r (1/(h^2 k) + H_NN) = -(v + g/h) = 12.
  EXPECT_NEAR(smooth.r[0], 12.0 / 14.0, 1e-15);
  EXPECT_NEAR(smooth.v[1], 1.0 + 12.0 / 14.0, 1e-15);
}

// With friction: the spring of a sticking node is in equilibrium, and one that slides is at the cone, its
// rate of slip u_T = (xi + h v_T - xi')/h against it. Each of the springs and H as they are, coupling and
// all.
TEST(Penalty, WithFrictionServesAnyH) {
  constexpr double h = 1e-2, k = 1e3, tangential = 600.0, mu = 0.3;
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  int sticking = 0, slipping = 0;
  NodeRun node("penalty",
               with("implicit", {{"stiffness", k}, {"tangential_stiffness", tangential}, {"friction", mu}}),
               h, ILAW_DELASSUS_FULL);
  for (int trial = 0; trial < 20000; ++trial) {
    node.h = {4.0, 3.0, 2.0, uniform(random), uniform(random), uniform(random)};
    node.gap = 0.05 * uniform(random);
    const double before[] = {node.state[1], node.state[2]};
    ASSERT_EQ(node.step({uniform(random), 0.2 * uniform(random), 0.2 * uniform(random)}), ILAW_OK);
    const double next = node.gap + h * node.v[0];
    ASSERT_NEAR(node.r[0], h * k * std::max(-next, 0.0), 1e-14);
    const double shear = std::hypot(node.r[1], node.r[2]);
    ASSERT_LE(shear, mu * node.r[0] * (1.0 + 8 * ulp));
    double against = 0.0, slip = 0.0;
    for (std::size_t c = 0; c < 2; ++c) {
      ASSERT_NEAR(node.r[c + 1], -h * tangential * node.state[c + 1], 1e-15);
      const double u = before[c] + h * node.v[c + 1] - node.state[c + 1];
      against -= u * node.r[c + 1];
      slip = std::hypot(slip, u);
    }
    if (node.r[0] > 0.0) {
      ASSERT_NEAR(against, slip * mu * node.r[0], 1e-16);
    }
    sticking += node.status == ILAW_STICK;
    slipping += node.status == ILAW_SLIP;
  }
  EXPECT_GT(sticking, 1000);
  EXPECT_GT(slipping, 1000);
}

// A normal spring that is no inverse mass cannot be coupled to the tangents; uncoupled it serves any H.
TEST(Penalty, RefusesACouplingThatItHasNoSolutionFor) {
  for (const std::map<std::string, double>& more :
       {std::map<std::string, double>{{"damping", 1.0}}, {{"exponent", 1.5}}}) {
    std::map<std::string, double> numbers = more;
    numbers.insert({{"stiffness", 1e3}, {"friction", 0.2}});
    NodeRun node("penalty", with("implicit", numbers), 1e-2, ILAW_DELASSUS_FULL);
    node.gap = -0.1;
    node.h = {4.0, 3.0, 2.0, 1.0, -0.5, 0.25};
    EXPECT_EQ(node.step({-2.0, 1.0, 1.0}), ILAW_BAD_NODES);
    node.h = {4.0, 3.0, 2.0, 0.0, 0.0, 0.25};
    EXPECT_EQ(node.step({-2.0, 1.0, 1.0}), ILAW_OK);
  }
}

// The two steps: an impulse is a force times the velocity step, a gap moves by the position step.
TEST(Penalty, UsesEachStepWhereItBelongs) {
  NodeRun node(
      "penalty",
      with("implicit",
           {{"stiffness", 500.0}, {"damping", 7.0}, {"tangential_stiffness", 90.0}, {"friction", 5.0}}));
  const double hv = 2e-3, hp = 3e-3, gap = -0.02, inverse_mass = 0.5;
  const Vector v_free{-1.0, 0.3, 0.0};
  ilaw_batch b = node.batch();
  Vector r{}, v{};
  std::vector<double> state(node.state.size());
  b.velocity_step = hv;
  b.position_step = hp;
  b.v_free = {v_free.data(), 0, 1};
  b.delassus = {&inverse_mass, 0, 1};
  b.gap = {&gap, 0, 1};
  b.state_in = {state.data(), 0, 1};
  b.state_out = {state.data(), 0, 1};
  b.impulse = {r.data(), 0, 1};
  b.velocity = {v.data(), 0, 1};
  ASSERT_EQ(node.interface.evaluate(b), ILAW_OK);
  EXPECT_NEAR(r[0], hv * (500.0 * -(gap + hp * v[0]) - 7.0 * v[0]), 1e-15);
  EXPECT_NEAR(r[1], -hv * 90.0 * hp * v[1], 1e-16);
  EXPECT_NEAR(state[1], hp * v[1], 1e-17);
}

// The explicit form: the configuration and the half step before, not what the step leads to.
TEST(Penalty, ExplicitReadsWhatIsKnownBefore) {
  for (const double exponent : {1.0, 1.5}) {
    NodeRun node("penalty",
                 with("explicit", {{"stiffness", 500.0}, {"damping", 7.0}, {"exponent", exponent}}));
    node.gap = -0.04;
    node.v_previous = {0.2, 0.0, 0.0};
    ASSERT_EQ(node.step({-9.0, 1.0, 0.0}), ILAW_OK);
    EXPECT_NEAR(node.r[0], 1e-3 * (500.0 * std::pow(0.04, exponent) - 7.0 * 0.2), 1e-17);
    EXPECT_EQ(node.status, ILAW_CLOSED);
    node.v_previous = {100.0, 0.0, 0.0};  // the damper would pull
    ASSERT_EQ(node.step({-9.0, 1.0, 0.0}), ILAW_OK);
    EXPECT_EQ(node.r[0], 0.0);
  }
}

// A stiffness given per node takes another way through the kit: the same bits.
TEST(Penalty, PerNodeStiffnessGivesTheSameBits) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (const char* integration : {"explicit", "implicit"})
    for (const double exponent : {1.0, 1.5}) {
      const Parameters constant = with(
          integration,
          {{"stiffness", 3e3}, {"exponent", exponent}, {"friction", 0.3}, {"tangential_stiffness", 1e3}});
      NodeRun node("penalty", constant);
      SetupBuilder setup(constant);
      std::vector<ilaw_argument> arguments;
      for (std::uint32_t k = 0; k < setup.setup.argument_count; ++k)
        arguments.push_back(*setup.setup.arguments[k]);
      std::vector<const ilaw_argument*> pointers;
      for (ilaw_argument& a : arguments) {
        if (std::string(a.name) == "stiffness") a.kind = ILAW_VALUE_PER_NODE;
        pointers.push_back(&a);
      }
      setup.setup.arguments = pointers.data();
      const ilaw::interface varying = make_law("penalty", setup);
      const double stiffness = 3e3;
      const ilaw_input per_node{&stiffness, 0, 0};
      std::vector<double> state(node.state.size());
      Vector r{};
      for (int k = 0; k < 1000; ++k) {
        const Vector v{uniform(random), uniform(random), uniform(random)};
        node.gap = 1e-3 * uniform(random) - 5e-4;
        ASSERT_EQ(node.step(v), ILAW_OK);
        ilaw_batch b = node.batch();
        b.state_in = {state.data(), 0, 1};
        b.state_out = {state.data(), 0, 1};
        b.impulse = {r.data(), 0, 1};
        b.per_node_parameters = &per_node;
        ASSERT_EQ(varying.evaluate(b), ILAW_OK);
        ASSERT_EQ(r, node.r);
        ASSERT_EQ(state, node.state);
      }
    }
}

// A million random steps of nodes with memory: r_N pushes, |r_T| <= mu r_N, a power of ten in stiffness at a
// time; where no force acts (v_free = v^-), no implicit step creates energy, and none counts as negative.
TEST(Penalty, RandomHistoriesKeepTheCone) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0), decades(-4.0, 8.0), stable(-4.0, 3.0);
  int slipping = 0, sticking = 0;
  for (int history = 0; history < 1000 && !::testing::Test::HasFailure(); ++history) {
    const bool implicit = history % 2 == 0;
    const double h = 1e-2, friction = history % 7 == 0 ? inf_value : 0.3;
    const double stiffness = std::pow(10.0, implicit ? decades(random) : stable(random));
    const double tangential = std::pow(10.0, implicit ? decades(random) : stable(random));
    NodeRun node("penalty",
                 with(implicit ? "implicit" : "explicit", {{"stiffness", stiffness},
                                                           {"tangential_stiffness", tangential},
                                                           {"friction", friction},
                                                           {"damping", history % 3 ? 0.0 : 5.0},
                                                           {"exponent", history % 5 ? 1.0 : 1.5}}),
                 h);
    for (int k = 0; k < 1000; ++k) {
      node.h[0] = 1.0 + 0.9 * uniform(random);
      // The gap is its own from step to step for a while, so that springs strain.
      node.gap = k % 20 == 0 ? 0.02 * uniform(random) : node.gap + h * node.v[0];
      const Vector v{uniform(random) - 0.3, uniform(random), uniform(random)};
      node.v_previous = v;
      const Vector spring{0.0, node.state[1], node.state[2]};
      ASSERT_EQ(node.step(v), ILAW_OK) << node.report.reason;
      ASSERT_GE(node.r[0], 0.0);
      const double shear = std::hypot(node.r[1], node.r[2]);
      if (friction < inf_value) {
        ASSERT_LE(shear, friction * node.r[0] * (1.0 + 4 * ulp));
      }
      for (const double energy : node.energy) ASSERT_GE(energy, 0.0);
      slipping += node.status == ILAW_SLIP;
      sticking += node.status == ILAW_STICK;
      if (!implicit) continue;
      const double p = history % 5 ? 1.0 : 1.5, sunk = std::max(-node.gap, 0.0);
      const double before = stiffness * std::pow(sunk, p + 1.0) / (p + 1.0) +
                            0.5 * tangential * (spring[1] * spring[1] + spring[2] * spring[2]);
      double work = 0.0;
      for (std::size_t c = 0; c < 3; ++c) work += 0.5 * node.r[c] * (v[c] + node.v[c]);
      const double after = node.energy[ILAW_ENERGY_STORED];
      ASSERT_LE(work + after - before, 1e-13 * (std::abs(work) + after + before))
          << "stiffness " << stiffness;
    }
  }
  EXPECT_GT(slipping, 100000);
  EXPECT_GT(sticking, 10000);
}

// Units of mass, length and time scaled by powers of two give the same bits scaled, a mirror image the
// mirrored ones. A length scale that is a power of four keeps the root in Hertz's stiffness a power of two.
TEST(Penalty, ScalesWithUnitsAndMirrors) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  constexpr double mass = 0x1p+20, length = 0x1p-12, duration = 0x1p+7;
  const double speed = length / duration, impulse = mass * speed, rate = mass / (duration * duration);
  for (const char* integration : {"explicit", "implicit"})
    for (const double exponent : {1.0, 1.5}) {
      const auto parameters = [&](double unit_rate, double unit_length, double unit_time) {
        return with(integration,
                    {{"stiffness", 900.0 * unit_rate / (exponent == 1.0 ? 1.0 : std::sqrt(unit_length))},
                     {"exponent", exponent},
                     {"damping", 3.0 * unit_rate * unit_time},
                     {"tangential_stiffness", 400.0 * unit_rate},
                     {"friction", 0.3}});
      };
      NodeRun a("penalty", parameters(1.0, 1.0, 1.0), 1e-2),
          b("penalty", parameters(rate, length, duration), 1e-2 * duration),
          mirror("penalty", parameters(1.0, 1.0, 1.0), 1e-2);
      int closed = 0;
      for (int k = 0; k < 20000; ++k) {
        const Vector v{uniform(random), uniform(random), uniform(random)};
        a.gap = mirror.gap = 0.03 * uniform(random) - 0.01;
        b.gap = a.gap * length;
        a.h[0] = mirror.h[0] = 1.0 + 0.9 * uniform(random);
        b.h[0] = a.h[0] / mass;
        ASSERT_EQ(a.step(v), ILAW_OK);
        ASSERT_EQ(b.step({v[0] * speed, v[1] * speed, v[2] * speed}), ILAW_OK);
        ASSERT_EQ(mirror.step({v[0], -v[1], v[2]}), ILAW_OK);
        ASSERT_EQ(a.status, b.status);
        for (std::size_t c = 0; c < 3; ++c) {
          ASSERT_EQ(a.r[c] * impulse, b.r[c]);
          ASSERT_EQ(c == 1 ? -a.r[c] : a.r[c], mirror.r[c]);
        }
        for (std::size_t e = 0; e < 4; ++e) ASSERT_EQ(a.energy[e] * impulse * speed, b.energy[e]);
        closed += a.r[0] > 0.0;
      }
      EXPECT_GT(closed, 5000);
    }
}

TEST(Penalty, RefusesBadParameters) {
  using Given = std::map<std::string, double>;
  for (const auto& [integration, numbers, named] :
       {std::tuple<const char*, Given, const char*>{"implicit", {}, "'stiffness' is missing"},
        {"implicit", {{"stiffness", -1.0}}, "'stiffness' = -1"},
        {"explicit", {{"stiffness", inf_value}}, "; found stiffness = inf, integration = \"explicit\""},
        {"explicit",
         {{"stiffness", 1.0}, {"friction", 0.1}},
         "; found friction = 0.1, tangential_stiffness = inf, "},
        {"implicit", {{"stiffness", 1.0}, {"tangential_stiffness", 0.0}}, "'tangential_stiffness' = 0"},
        {"implicit", {{"stiffness", 1.0}, {"exponent", 0.5}}, "'exponent' = 0.5"},
        {"implicit", {{"stiffness", 1.0}, {"damping", inf_value}}, "'damping' = inf"},
        {"backwards", {{"stiffness", 1.0}}, "'integration' = \"backwards\""}}) {
    const SetupBuilder setup(with(integration, numbers));
    try {
      make_law("penalty", setup);
      ADD_FAILURE() << named << " was accepted";
    } catch (const std::exception& refusal) {
      EXPECT_NE(std::string(refusal.what()).find(named), std::string::npos) << refusal.what();
    }
  }
}

}  // namespace
}  // namespace ilaw::testing
