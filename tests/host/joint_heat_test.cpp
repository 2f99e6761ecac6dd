// Joints that conduct, against closed forms at steps that share no factor and at the stable step of
// conduction: steady jumps, fluxes over meshes that do not match, nodes in several contacts.
#include "thermal_scenes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace ilaw::host::testing::joint_heat {
namespace {

using nlohmann::json;

constexpr double warm = 400.0, cold = 280.0;

json joint(double conductance) {
  return {{"law", "conductance"}, {"parameters", {{"conductance", conductance}}}};
}

// A steady flux is the whole difference over the sum of the resistances, and the profile of each column is
// linear.
void expect_steady(const Integrator& integrator, const Model& model, const Bar& below, const Bar& above,
                   double conductance) {
  const double flux = (warm - cold) / (below.length / below.conductivity + 1.0 / conductance +
                                       above.length / above.conductivity);
  for (int node = 0; node < model.node_count(); ++node) {
    const double z = model.position()[3 * node + 2];
    const bool is_below = std::ranges::count(model.sets().at("below").nodes, node) > 0;
    const double expected = is_below ? warm - flux / below.conductivity * z
                                     : cold + flux / above.conductivity * (below.length + above.length - z);
    ASSERT_NEAR(integrator.temperatures()->at(node), expected, 1e-9) << "node " << node;
  }
  EXPECT_LT(integrator.temperatures()->report().balance_error, 1e-11);
}

// Two elements on three, both ways.
TEST(JointHeat, PassesOverMeshesThatDoNotMatch) {
  const Bar below{.length = 0.7, .conductivity = 0.8, .elements = 2}, above{.length = 0.7, .elements = 3};
  for (const double conductance : {1.0, 1e4})
    for (const auto& [lower, upper] : {std::pair{2, 3}, std::pair{3, 2}}) {
      SCOPED_TRACE(std::to_string(conductance) + ", below " + std::to_string(lower));
      json scene = two_columns(below, above, 1e-3, 20.0, joint(conductance));
      scene["model"]["blocks"][0]["size"] = scene["model"]["blocks"][1]["size"] = {1, 1, 0.7};
      scene["model"]["blocks"][0]["elements"] = {lower, lower, 2};
      scene["model"]["blocks"][1]["elements"] = {upper, upper, 3};
      scene["interfaces"][0]["against"]["discretization"] = "dual_mortar";
      scene["loads"].push_back(held("below.z_min", warm));
      scene["loads"].push_back(held("above.z_max", cold));
      scene["time"]["dt"] = 0.95 * scene_of(scene.dump()).model->thermal()->stable_step().step;
      auto [read, integrator] = run_to_end(scene);
      expect_steady(integrator, *read.model, below, above, conductance);
    }
}

// Two capacities, of which one is heated: D(t) = q/(G c) (1 - e^(-G c t)), c = 1/C + 1/C_c, at any step.
TEST(JointHeat, IsExactUnderAConstantHeating) {
  const Bar below{.specific_heat = 2.0, .conductivity = 0.0, .elements = 1},
      above{.conductivity = 0.0, .elements = 1};
  constexpr double conductance = 3.0, heating = 5.0;
  for (const double dt : {0.13, 0.031, 0.0077}) {
    json scene = two_columns(below, above, dt, 2.0, joint(conductance));
    scene["loads"].push_back({{"type", "heat_flux"}, {"nodes", "above.z_min"}, {"history", {{0, heating}}}});
    auto [read, integrator] = run_to_end(scene);
    const double area = 0.25, capacity = 0.125, other = 0.25;  // of a node of each face
    const double rate = conductance * area * (1.0 / capacity + 1.0 / other);
    const double expected =
        heating * area / capacity / rate * -std::expm1(-rate * thermal_time(integrator, dt));
    const Temperatures& at = *integrator.temperatures();
    EXPECT_NEAR(at.at(8) - at.at(4), expected, 1e-11) << dt;
  }
}

// One mass between others: each difference decays as exp(-G t (1/C + n/C)), by second order in the step.
TEST(JointHeat, SharesANodeBySecondOrder) {
  constexpr int others = 3;
  constexpr double conductance = 1.5, capacity = 6.0;
  std::vector<double> steps, errors;
  for (const double dt : {0.21, 0.1, 0.047}) {
    json scene = {{"model", {{"type", "points"}, {"dimension", 1}}}, {"time", {{"dt", dt}, {"end", 2.0}}}};
    scene["interfaces"] = scene["loads"] = json::array();
    for (int k = 0; k <= others; ++k) {
      const json thermal = {{"specific_heat", capacity / 2}, {"initial_temperature", k == 0 ? 400 : 300}};
      scene["model"]["points"].push_back({{"mass", 2}, {"position", {0}}, {"thermal", thermal}});
      scene["loads"].push_back(
          {{"type", "force"}, {"nodes", {k}}, {"direction", {k == 0 ? -others : 1}}, {"history", {{0, 7}}}});
      if (k == 0) continue;
      scene["interfaces"].push_back(joint(conductance));
      scene["interfaces"].back()["nodes"] = {0};
      scene["interfaces"].back()["against"] = {{"nodes", {k}}, {"normal", {1}}};
    }
    auto [read, integrator] = run_to_end(scene);
    const double rate = conductance * (1 + others) / capacity;
    const double expected = 100.0 * std::exp(-rate * thermal_time(integrator, dt));
    steps.push_back(dt);
    errors.push_back(
        std::abs(integrator.temperatures()->at(0) - integrator.temperatures()->at(1) - expected));
  }
  EXPECT_GT(order(steps, errors), 1.9);
}

}  // namespace
}  // namespace ilaw::host::testing::joint_heat
