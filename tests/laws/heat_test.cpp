// Heat and wear of every law with friction: shares of what friction dissipates, and Archard's depth.
#include "random_nodes.hpp"

#include <set>

namespace ilaw::testing {
namespace {

constexpr double partition = 0.3, wear_coefficient = 1e-3;

bool wears(const std::string& law) {
  const ilaw::library library(plugin_file(law));
  const ilaw_law& description = *library.law(law);
  return std::any_of(description.amounts, description.amounts + description.amount_count,
                     [](const ilaw_amount* a) { return a->name == std::string("wear"); });
}
Parameters worn(Parameters parameters, double eta = partition) {
  parameters.numbers["heat_partition"] = eta;
  parameters.numbers["wear_coefficient"] = wear_coefficient;
  return parameters;
}

std::vector<LawCase> cases_with_wear() {
  std::vector<LawCase> cases;
  for (const LawCase& one : law_cases("properties"))
    if (wears(one.law)) cases.push_back(one);
  return cases;
}

class HeatOf : public ::testing::TestWithParam<Combination> {};

// heat + counterpart_heat is the friction part of the energy. friction/|r_T| is the mean speed of slip, or
// |v_T^- + v_T|/2 without friction, and the depth k_w p |v_T| h with p = r_N/(h A). A softening
// bond wears less.
TEST_P(HeatOf, IsTheFrictionPartOfTheEnergy) {
  const auto& [law, form, dimension] = GetParam();
  const bool softens = law.law == "cohesive" || law.law == "rccm";
  RandomNodes nodes(500, dimension, form, inertia_of(law), 1);
  Runner run(law.law, worn(law.parameters), nodes);
  run.initialise();
  std::size_t warmed = 0, worn_nodes = 0;
  for (int k = 0; k < 20; ++k) {
    nodes.draw();
    for (std::size_t i = 0; i < nodes.count; ++i) {
      nodes.v_previous[i] = k > 0 ? run.v[i] : nodes.v_free[nodes.count - 1 - i];
      nodes.gap[i] = nodes.uniform(-2.0, 0.5) * RandomNodes::step;
    }
    run.time += run.position_step;
    ASSERT_EQ(run.evaluate(), ILAW_OK) << run.report.reason;
    for (std::size_t i = 0; i < nodes.count; ++i) {
      const bool is_free = run.status[i] == ILAW_FREE;  // what a spring loses as it lets go
      const double friction = is_free ? 0.0 : run.energy[i][ILAW_ENERGY_FRICTION],
                   heat = run.amount("heat", i);
      ASSERT_NEAR(heat, partition * friction, 2 * ulp * friction) << "node " << i;
      ASSERT_NEAR(heat + run.amount("counterpart_heat", i), friction, 2 * ulp * friction) << "node " << i;
      const Vector &r = run.r[i], &v = run.v[i], &before = nodes.v_previous[i];
      const double rubs = std::hypot(r[1], r[2]);
      const double mean = 0.5 * std::hypot(before[1] + v[1], before[2] + v[2]);
      const double depth =
          wear_coefficient * std::max(r[0], 0.0) / nodes.area[i] * (rubs > 0.0 ? friction / rubs : mean);
      if (softens && (run.status[i] == ILAW_BONDED || run.status[i] == ILAW_BROKEN)) {
        const double most = wear_coefficient * std::max(r[0], 0.0) / nodes.area[i] * mean;
        ASSERT_LE(run.amount("wear", i), (1 + 8 * ulp) * most) << "node " << i;
        continue;
      }
      ASSERT_NEAR(run.amount("wear", i), depth, 8 * ulp * depth) << "node " << i;
      warmed += heat > 0.0;
      worn_nodes += depth > 0.0;
    }
  }
  if (softens) return;
  const json& statuses = law.more.at("statuses");
  EXPECT_GT(worn_nodes, nodes.count);
  if (std::find(statuses.begin(), statuses.end(), "slip") != statuses.end()) {
    EXPECT_GT(warmed, nodes.count);
  }
}
INSTANTIATE_TEST_SUITE_P(Laws, HeatOf, ::testing::ValuesIn(combinations_of(cases_with_wear())),
                         name_of_combination);

// ---- closed forms

// A bond that is sheared apart at one speed under pressure. Friction alone is heat, rupture is the energy of
// new surfaces; the broken part d of the area wears by k_w p d |v_T|, an intact bond does not.
TEST(HeatOfBonds, IsFrictionWithoutRupture) {
  constexpr double speed = 0.1, force = 2.0, area = 0.5, mu = 0.4, toughness = 1.5;
  const std::map<std::string, double> soft{{"strength", 1.0}, {"toughness", toughness}, {"friction", mu}};
  const std::vector<LawCase> laws{{"cohesive", "bilinear", {soft, {{"shape", "bilinear"}}}, {}},
                                  {"cohesive", "exponential", {soft, {{"shape", "exponential"}}}, {}},
                                  {"cohesive", "camacho_ortiz", {soft, {{"shape", "camacho_ortiz"}}}, {}},
                                  {"rccm",
                                   "rccm",
                                   {{{"normal_stiffness", 4.0},
                                     {"tangential_stiffness", 4.0},
                                     {"adhesion_energy", 0.5},
                                     {"viscosity", 0.2},
                                     {"friction", mu}},
                                    {}},
                                   {}}};
  for (const LawCase& law : laws)
    for (const double step : {0.11, 0.037, 0.013}) {
      NodeRun node(law.law, worn(law.parameters), step);
      node.area = area;
      node.h[0] = 1e-12;
      node.initialise();
      double work = 0.0, lost = 0.0, rupture = 0.0, heat = 0.0, counterpart_heat = 0.0, depth = 0.0;
      double rubbed = 0.0;  // the sum of d |v_T| h
      const auto broken = [&] {
        return law.law == "rccm" ? 1.0 - node.named("intensity") : node.named("damage");
      };
      const auto pull = [&] {
        const Vector old = node.v;
        const double before = broken();
        ASSERT_EQ(node.step({-step * force * node.h[0], speed, 0.0}), ILAW_OK) << node.report.reason;
        for (std::size_t c = 0; c < 3; ++c) work -= 0.5 * node.r[c] * (old[c] + node.v[c]);
        heat += node.amount("heat");
        counterpart_heat += node.amount("counterpart_heat");
        depth += node.amount("wear");
        rubbed += 0.5 * (before + broken()) * 0.5 * step * (old[1] + node.v[1]);
        lost += node.energy[ILAW_ENERGY_IMPACT];
        rupture += node.energy[ILAW_ENERGY_RUPTURE];
      };
      const double until = law.law == "rccm" ? 0.999 : 1.0;  // that of rccm falls as the square of the slip
      for (int k = 0; broken() < until; ++k) {
        ASSERT_LT(k, 100000);
        pull();
      }
      const double at_rupture = heat + counterpart_heat;
      for (int k = 0; k < 100; ++k) pull();
      const double friction = heat + counterpart_heat, slip = speed * 100 * step;
      const std::string at = law.name + ", step " + std::to_string(step);
      EXPECT_NEAR((friction - at_rupture) / (mu * force * slip), 1.0, law.law == "rccm" ? 1e-3 : 1e-9) << at;
      EXPECT_NEAR(friction / (mu * force * rubbed), 1.0, 1e-9) << at;
      EXPECT_NEAR(heat / friction, partition, 1e-12) << at;
      EXPECT_NEAR(depth / (wear_coefficient * force / area * rubbed), 1.0, 1e-9) << at;
      EXPECT_NEAR((friction + rupture + lost + node.energy[ILAW_ENERGY_STORED]) / work, 1.0, 1e-9) << at;
      if (law.law == "cohesive") {
        EXPECT_NEAR(rupture / (toughness * area), 1.0, 1e-9) << at;
      }
    }
}

// The area is asked for where wear is, and there alone.
TEST(Coulomb, ReadsTheAreaForWearAlone) {
  const auto reads_area = [](double coefficient) {
    const NodeRun node("coulomb", {{{"friction", 0.3}, {"wear_coefficient", coefficient}}, {}});
    EXPECT_FALSE(node.interface.info().inputs & ILAW_INPUT_AREA);
    return (node.interface.info().balance_inputs & ILAW_INPUT_AREA) != 0;
  };
  EXPECT_FALSE(reads_area(0.0));
  EXPECT_TRUE(reads_area(1e-9));
}

}  // namespace
}  // namespace ilaw::testing
