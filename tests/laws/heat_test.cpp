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
Parameters worn(Parameters parameters) {
  parameters.numbers["heat_partition"] = partition;
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

}  // namespace
}  // namespace ilaw::testing
