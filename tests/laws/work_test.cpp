// An impulse of contact and friction, or of a rigid bond, holding or breaking, does no positive work,
// whatever comes in: v_free and v^- of a stiff body near its critical step have nothing to do with each
// other. The work over a step of central difference is r.(v^- + v)/2, exactly; a law that never does any
// cannot make such a body diverge.
#include "random_nodes.hpp"

#include <ostream>
#include <tuple>

namespace ilaw::testing {
namespace {

// Nodes of each case, shared by all forms of H, 1D to 3D and three pairs of steps: each with an H, v_free,
// v^- and gap of its own, drawn independently of each other.
constexpr int draws = 400000;

struct Case {
  const char* name;
  const char* law;
  Parameters parameters;
  bool rubs = false;             // slips at times
  bool unsolvable = false;       // for some H: such a node is refused
  const char* broken = nullptr;  // state variable to set to 1
  bool bonded = false;           // from the start
  bool breaks = false;           // some of these bonds
  int steps = 1;                 // that a bond may have gone through, for its window
  Inertia inertia = Inertia::any;
};
std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name; }

const std::map<std::string, std::string> predictive{{"activation", "predictive"}};

// Bonds of postit with an adhesion that is drawn for each node; tau: of the window, in steps.
Case bonds_of_postit(const char* name, const char* rupture, double lambda, double friction,
                     double tau = 0.0) {
  return {.name = name,
          .law = "postit",
          .parameters = {{{"tangent_influence", lambda},
                          {"friction", friction},
                          {"efficiency_decrease", 5.0},
                          {"memory", tau * RandomNodes::step},
                          {"buckets", 4.0}},
                         {{"rupture", rupture}}},
          .bonded = true,
          .breaks = true,
          .steps = (tau > 0.0 ? 3 : 1)};
}
Case bonds_of_tie(const char* name, double strength, double tau = 0.0) {
  return {.name = name,
          .law = "tie",
          .parameters = {{{"strength", strength}, {"memory", tau * RandomNodes::step}, {"buckets", 4.0}}, {}},
          .bonded = true,
          .breaks = (strength < inf_value),
          .steps = (tau > 0.0 ? 3 : 1)};
}

const std::vector<Case> cases = {
    {"contact", "contact", {}},
    {"contact_05", "contact", {{{"restitution", 0.5}}, {}}},
    {"contact_1", "contact", {{{"restitution", 1.0}}, {}}},
    {"contact_predictive", "contact", {{}, predictive}},
    {"contact_predictive_05", "contact", {{{"restitution", 0.5}}, predictive}},
    {"contact_predictive_1", "contact", {{{"restitution", 1.0}}, predictive}},
    {"coulomb_without_friction", "coulomb", {{{"friction", 0.0}}, {}}, true},
    {"coulomb", "coulomb", {{{"friction", 0.3}}, {}}, true},
    {"coulomb_rough", "coulomb", {{{"friction", inf_value}}, {}}, true, true},
    {"coulomb_05", "coulomb", {{{"friction", 0.3}, {"restitution", 0.5}}, {}}, true},
    {"coulomb_rough_05", "coulomb", {{{"friction", inf_value}, {"restitution", 0.5}}, {}}, true, true},
    {"coulomb_moreau_05",
     "coulomb",
     {{{"friction", 2.0}, {"restitution", 0.5}, {"tangential_restitution", 0.5}}, {}},
     true},
    {"coulomb_1", "coulomb", {{{"friction", 0.3}, {"restitution", 1.0}}, {}}, true},
    {"coulomb_predictive", "coulomb", {{{"friction", 0.3}}, predictive}, true},
    {"coulomb_predictive_05", "coulomb", {{{"friction", 0.3}, {"restitution", 0.5}}, predictive}, true},
    {"coulomb_predictive_1", "coulomb", {{{"friction", 0.3}, {"restitution", 1.0}}, predictive}, true},
    {"coulomb_elliptical", "coulomb", {{{"friction", 0.8}, {"friction_2", 0.2}}, {}}, true},
    {"coulomb_rail", "coulomb", {{{"friction", inf_value}, {"friction_2", 0.2}}, {}}, true, true},
    {"coulomb_falling",
     "coulomb",
     {{{"friction", 0.9}, {"kinetic_friction", 0.2}, {"decay", 3.0}}, {}},
     true},
    {"postit_that_never_bonds", "postit", {{{"friction", 0.3}, {"adhesion_limit", 0.0}}, {}}, true},
    {"tie_broken", "tie", {{{"strength", 1.0}}, {}}, false, false, "broken"},
    {"cohesive_broken",
     "cohesive",
     {{{"strength", 1.0}, {"toughness", 1.0}, {"friction", 0.3}}, {}},
     true,
     false,
     "damage"},
    {.name = "impact", .law = "impact", .parameters = {{{"restitution", 0.9}}, {}}, .steps = 10},
    {.name = "impact_rough",
     .law = "impact",
     .parameters = {{{"friction", 0.3}, {"restitution", 0.4}}, {}},
     .rubs = true,
     .steps = 10,
     .inertia = Inertia::isotropic},
    bonds_of_postit("postit_brittle", "brittle", inf_value, 0.3),
    bonds_of_postit("postit_brittle_in_shear", "brittle", 0.5, 0.3),
    bonds_of_postit("postit_brittle_with_memory", "brittle", 0.5, 0.3, 3.0),
    bonds_of_postit("postit_saturated", "saturated", inf_value, 0.3),
    bonds_of_postit("postit_saturated_without_friction", "saturated", 0.5, 0.0),
    bonds_of_postit("postit_saturated_in_shear", "saturated", 0.5, 0.3),
    bonds_of_postit("postit_saturated_rough", "saturated", 0.5, 5.0),
    bonds_of_postit("postit_saturated_with_memory", "saturated", 0.5, 0.3, 3.0),
    bonds_of_tie("tie", inf_value),
    bonds_of_tie("tie_that_breaks", 1.0),
    bonds_of_tie("tie_with_a_memory_of_one_step", 1.0, 1.0),
    bonds_of_tie("tie_with_memory", 1.0, 3.0)};

constexpr std::size_t node_count = 4000;
constexpr std::uint32_t forms[] = {ILAW_DELASSUS_SCALAR, ILAW_DELASSUS_DIAGONAL, ILAW_DELASSUS_FULL,
                                   ILAW_DELASSUS_TRANSVERSE};
constexpr std::pair<double, double> pairs_of_steps[] = {
    {1.0, 1.0}, {0.7, 1.3}, {3.1, 0.11}};  // velocity, position

// Many nodes, each with steps of its own.
class Work : public ::testing::TestWithParam<Case> {
 protected:
  const Case& law = GetParam();
  std::size_t done = 0, pushed = 0, slid = 0, held = 0, broke = 0;
  std::optional<std::string> wrong;
  std::vector<double> stored;  // before the step

  // A quarter of the nodes was held up to rounding, the others moved by less or more than v_free.
  static void draw(RandomNodes& nodes) {
    nodes.draw();
    for (std::size_t i = 0; i < nodes.count; ++i) {
      const double size = i % 4 == 0 ? ulp : std::exp2(nodes.uniform(-4.0, 4.0));
      for (std::size_t c = 0; c < 3; ++c) {
        if (c >= nodes.dimension) nodes.v_free[i][c] = 0.0;
        nodes.v_previous[i][c] = c < nodes.dimension ? size * nodes.uniform() : 0.0;
      }
      nodes.gap[i] = nodes.uniform(-2.0, 0.5) * RandomNodes::step;
    }
  }

  void begin(RandomNodes& nodes, Runner& run) const {
    run.initialise();
    for (std::size_t i = 0; i < nodes.count; ++i) {
      if (law.broken) run.set(law.broken, i, 1.0);
      if (law.bonded && std::string(law.law) == "postit") run.set("adhesion", i, nodes.uniform(0.0, 2.0));
    }
  }

  // The violation at node i; none where it keeps its promises.
  std::optional<std::string> judge(const RandomNodes& nodes, const Runner& run, std::size_t i) const {
    const Vector &r = run.r[i], &v = run.v[i], &before = nodes.v_previous[i];
    const double now = run.energy[i][ILAW_ENERGY_STORED];
    double work = now - stored[i], size = now + stored[i], parts = 0.0;
    for (std::size_t a = 0; a < nodes.dimension; ++a) {
      work += 0.5 * r[a] * (before[a] + v[a]);
      double natural = std::abs(before[a]) + std::abs(nodes.v_free[i][a]);
      for (std::size_t b = 0; b < nodes.dimension; ++b) natural += std::abs(nodes.h[i][a][b] * r[b]);
      size += std::abs(r[a]) * natural;
    }
    for (int part = 0; part < ILAW_ENERGY_STORED; ++part) {
      parts += run.energy[i][static_cast<std::size_t>(part)];
      if (run.energy[i][static_cast<std::size_t>(part)] < 0.0) return "a dissipation is negative";
    }
    const bool breaks = run.status[i] == ILAW_BROKEN, bonded = run.status[i] == ILAW_BONDED;
    const std::string values = "work " + std::to_string(work / size) + " of " + std::to_string(size);
    if (r[0] < 0.0 && !breaks && !bonded) return "pulls";
    if (work > 8 * ulp * size) return "puts energy in: " + values;
    if (std::abs(work + parts) > 16 * ulp * size) return "its parts are not the work: " + values;
    if (breaks && run.energy[i][ILAW_ENERGY_RUPTURE] != parts) return "a rupture dissipates by other parts";
    return std::nullopt;
  }

  void judge_all(const RandomNodes& nodes, const Runner& run) {
    for (std::size_t i = 0; i < nodes.count && !wrong; ++i) {
      wrong = judge(nodes, run, i);
      stored[i] = run.energy[i][ILAW_ENERGY_STORED];
      if (wrong) *wrong += ", node " + std::to_string(i);
      pushed += run.r[i][0] > 0.0;
      slid += run.status[i] == ILAW_SLIP;
      held += run.status[i] == ILAW_BONDED;
      broke += run.status[i] == ILAW_BROKEN;
    }
    done += nodes.count;
  }

  void follow(std::uint32_t form, std::uint32_t dimension, unsigned seed) {
    RandomNodes nodes(node_count, dimension, form, law.inertia, seed);
    Runner run(law.law, law.parameters, nodes);
    const auto& [velocity_step, position_step] = pairs_of_steps[seed % 3];
    run.velocity_step = velocity_step * RandomNodes::step;
    run.position_step = position_step * RandomNodes::step;
    begin(nodes, run);
    stored.assign(node_count, 0.0);
    for (int step = 0; step < law.steps && !wrong; ++step) {
      draw(nodes);
      run.time += run.position_step;
      const std::int32_t code = run.evaluate();
      ASSERT_TRUE(code == ILAW_OK || (law.unsolvable && code == ILAW_BAD_NODES)) << run.report.reason;
      judge_all(nodes, run);
    }
  }
};

TEST_P(Work, IsNeverPositive) {
  const auto enough = static_cast<std::size_t>(draws);
  for (unsigned seed = 1; done < enough && !wrong && !HasFatalFailure(); ++seed)
    for (const std::uint32_t form : forms)
      for (std::uint32_t dimension = 1; dimension <= 3 && !wrong; ++dimension) {
        follow(form, dimension, seed);
        EXPECT_FALSE(wrong) << *wrong << ", seed " << seed << ", " << name_of_form(form) << ", " << dimension
                            << "D";
      }
  if (law.bonded) {
    EXPECT_GT(held, done / 50);
  } else {
    EXPECT_GT(pushed, done / 10);
  }
  if (law.rubs) {
    EXPECT_GT(slid, done / 50);
  }
  if (law.breaks) {
    EXPECT_GT(broke, done / 50);
  }
}

INSTANTIATE_TEST_SUITE_P(Laws, Work, ::testing::ValuesIn(cases),
                         [](const auto& drawn) { return std::string(drawn.param.name); });

// A node on a spring along the plane, pressed with a constant force, from the smallest steps to the largest:
// E = m v^2/2 + k u_n u_{n+1}/2 falls in every step, by what friction reports.
TEST(FrictionOnASpring, TakesEnergyUpToTheCriticalStep) {
  const double mass = 2.0, stiffness = 9.0, pressure = 5.0;
  for (const double part : {0.01, 0.5, 0.9, 0.99, 0.999, 1.0})
    for (const double friction : {0.0, 1e-3, 0.3, inf_value}) {
      if (part == 1.0 && friction == 0.0) continue;  // without friction the motion itself grows with rounding
      const double h = 2.0 * part / std::sqrt(stiffness / mass);
      NodeRun node("coulomb", {{{"friction", friction}}, {}}, h);
      node.h[0] = 1.0 / mass;
      Vector u{0.0, 1.0, -0.5};
      const auto energy = [&] {
        double sum = 0.0;
        for (std::size_t c = 1; c < 3; ++c)
          sum += 0.5 * mass * node.v[c] * node.v[c] + 0.5 * stiffness * u[c] * (u[c] + h * node.v[c]);
        return sum;
      };
      node.v = node.v_previous = {0.0, 0.3, 0.7};
      const double first = energy();
      double largest = first, dissipated = 0.0;
      for (int k = 0; k < 20000; ++k) {
        for (std::size_t c = 0; c < 3; ++c) u[c] += h * node.v[c];
        Vector free = node.v;
        free[0] -= h * pressure / mass;
        for (std::size_t c = 1; c < 3; ++c) free[c] -= h * stiffness / mass * u[c];
        ASSERT_EQ(node.step(free), ILAW_OK) << "friction " << friction << ", k " << k;
        ASSERT_EQ(node.v[0], 0.0) << "friction " << friction << ", k " << k;
        largest = std::max(largest, energy());
        dissipated += node.energy[ILAW_ENERGY_FRICTION];
      }
      EXPECT_LE(largest - first, 1e-10 * std::abs(first)) << "part " << part << ", mu " << friction;
      EXPECT_NEAR(first - energy(), dissipated, 1e-9 * std::abs(first))
          << "part " << part << ", mu " << friction;
    }
}

}  // namespace
}  // namespace ilaw::testing
