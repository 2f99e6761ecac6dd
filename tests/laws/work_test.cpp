// An impulse of contact and friction does no positive work, whatever comes in: v_free and v^- of a stiff body
// near its critical step have nothing to do with each other. The work over a step of central difference is
// r.(v^- + v)/2, exactly; a law that never does any cannot make such a body diverge.
#include "random_nodes.hpp"

#include "support/numbers.hpp"
#include "support/sizes.hpp"

#include <optional>
#include <ostream>
#include <tuple>

namespace ilaw::testing {
namespace {

constexpr int draws = 100000;  // of each case, at most: over all forms of H, dimensions and pairs of steps

struct Case {
  const char* name;
  const char* law;
  Parameters parameters;
  bool rubs = false;             // slips at times
  bool unsolvable = false;       // for some H: such a node is refused
  const char* broken = nullptr;  // state variable to set to 1
};
std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name; }

const std::map<std::string, std::string> predictive{{"activation", "predictive"}};

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
     "damage"}};

// Many nodes with steps of their own.
class Work : public ::testing::TestWithParam<Case> {
 protected:
  struct Result {
    std::size_t pushed = 0, slid = 0;
    std::optional<std::string> wrong;
  };

  // What is wrong with node i; nothing where it keeps its promises.
  std::optional<std::string> judge(const RandomNodes& nodes, const Runner& run, std::size_t i,
                                   Result& result) const {
    const Vector &r = run.r[i], &v = run.v[i], &before = nodes.v_previous[i];
    double work = 0.0, size = 0.0, parts = 0.0;
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
    result.pushed += r[0] > 0.0;
    result.slid += run.status[i] == ILAW_SLIP;
    const std::string values = "work " + std::to_string(work / size) + " of " + std::to_string(size);
    if (r[0] < 0.0) return "pulls";
    if (work > 8 * ulp * size) return "puts energy in: " + values;
    if (std::abs(work + parts) > 16 * ulp * size) return "its parts are not the work: " + values;
    return std::nullopt;
  }
};

TEST_P(Work, IsNeverPositive) {
  const Case& law = GetParam();
  constexpr std::size_t count = 1000;
  const std::pair<double, double> steps[] = {{1.0, 1.0}, {0.7, 1.3}, {3.1, 0.11}};  // velocity, position
  Result result;
  const auto enough = static_cast<std::size_t>(part_of(draws));
  std::size_t done = 0;
  for (unsigned seed = 1; done < enough && !result.wrong; ++seed)
    for (const std::uint32_t form :
         {std::uint32_t{ILAW_DELASSUS_SCALAR}, std::uint32_t{ILAW_DELASSUS_DIAGONAL},
          std::uint32_t{ILAW_DELASSUS_FULL}, std::uint32_t{ILAW_DELASSUS_TRANSVERSE}})
      for (std::uint32_t dimension = 1; dimension <= 3 && !result.wrong; ++dimension) {
        RandomNodes nodes(count, dimension, form, Inertia::any, seed);
        Runner run(law.law, law.parameters, nodes);
        const auto& [velocity_step, position_step] = steps[seed % 3];
        run.velocity_step = velocity_step * RandomNodes::step;
        run.position_step = position_step * RandomNodes::step;
        nodes.draw();
        run.initialise();
        for (std::size_t i = 0; i < count; ++i) {
          for (std::size_t c = 0; c < 3; ++c) {
            if (c >= dimension) nodes.v_free[i][c] = 0.0;
            nodes.v_previous[i][c] = c < dimension ? nodes.uniform() : 0.0;
          }
          nodes.gap[i] = nodes.uniform(-2.0, 0.5) * RandomNodes::step;
          if (law.broken) run.set(law.broken, i, 1.0);
        }
        const std::int32_t code = run.evaluate();
        ASSERT_TRUE(code == ILAW_OK || (law.unsolvable && code == ILAW_BAD_NODES)) << run.report.reason;
        for (std::size_t i = 0; i < count && !result.wrong; ++i) {
          result.wrong = judge(nodes, run, i, result);
          if (result.wrong)
            *result.wrong += ", seed " + std::to_string(seed) + ", node " + std::to_string(i) + ", form " +
                             std::to_string(form) + ", " + std::to_string(dimension) + "D";
        }
        done += count;
      }
  EXPECT_FALSE(result.wrong) << *result.wrong;
  EXPECT_GT(result.pushed, done / 10);
  if (law.rubs) {
    EXPECT_GT(result.slid, done / 50);
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
