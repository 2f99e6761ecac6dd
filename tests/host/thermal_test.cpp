// Nodes with a temperature: conduction, contact that conducts, heat of friction, and the balance of heat,
// against closed forms at steps that share no factor and at the stable step of conduction.
#include "mesh_writer.hpp"
#include "run_result.hpp"
#include "thermal_scenes.hpp"

#include "contact/contact_heat.hpp"

#include <nlohmann/json.hpp>

#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <sstream>
#include <vector>

namespace ilaw::host::testing::thermal {
namespace {

// ---- conduction -----------------------------------------------------------------------------------------

// Carslaw, Jaeger 1959, section 2.9: the surface of a half space under a constant flux is at 2 q sqrt(t/(pi k
// rho c)).
TEST(Thermal, HeatsAHalfSpaceBySecondOrder) {
  constexpr double flux = 3.0, end = 0.02;
  std::vector<double> sizes, errors;
  for (const int elements : {10, 17, 31}) {
    const Bar bar{.specific_heat = 2.0, .conductivity = 1.4, .elements = elements};
    const double dt = bar.stable_step();
    json scene = scene_with({column(bar, "bar", 0)}, dt, end);
    scene["loads"] = {{{"type", "heat_flux"}, {"nodes", "bar.z_max"}, {"history", {{0, flux}}}}};
    auto [read, integrator] = run_to_end(scene);
    const double expected =
        2 * flux * std::sqrt(thermal_time(integrator, dt) / std::numbers::pi) / bar.effusivity();
    sizes.push_back(bar.size());
    errors.push_back(std::abs(integrator.temperatures()->at(read.model->node_count() - 1) - 300 - expected));
  }
  EXPECT_GT(order(sizes, errors), 1.8);
  EXPECT_LT(errors.back(), 2e-3 * 0.3);
}

// Held on one side, held or with a flux on the other, in elements that are no boxes.
TEST(Thermal, ConductsALinearProfileThroughAMesh) {
  const json flux = {{"type", "heat_flux"}, {"nodes", "body.x_max"}, {"history", {{0, 0.3 * -120}}}};
  for (const auto& [tetrahedra, end] : {std::pair{false, held("body.x_max", 280)},
                                        {false, flux},
                                        {true, held("body.x_max", 280)},
                                        {true, flux}}) {
    const auto folder = fresh_folder();
    std::ofstream(folder / "body.vtu")
        << box_mesh({3, 2, 2}, {1, 0.6, 0.6}, tetrahedra, [](Eigen::Vector3d x) {
             x[0] += 0.2 * x[0] * (1 - x[0]) * std::sin(4 * x[1] + 3 * x[2]);
             return x;
           }).vtu();
    json scene = {{"model", {{"type", "solids"}}}, {"interfaces", json::array()}};
    json body = column({.conductivity = 0.3}, "body", 0);
    for (const char* key : {"corner", "size", "elements"}) body.erase(key);
    body["file"] = (folder / "body.vtu").string();
    scene["model"]["meshes"] = {body};
    scene["loads"] = {held("body.x_min", 400), end};
    scene["time"] = {{"dt", 1e-4}, {"end", 200}};
    const double stable = scene_of(scene.dump()).model->thermal()->stable_step().step;
    for (const double fraction : step_fractions) {
      scene["time"]["dt"] = fraction * stable;
      auto [read, integrator] = run_to_end(scene);
      for (int node = 0; node < read.model->node_count(); ++node)
        EXPECT_NEAR(integrator.temperatures()->at(node), 400 - 120 * read.model->position()[3 * node], 1e-9);
    }
    std::filesystem::remove_all(folder);
  }
}

// ---- contact that conducts ------------------------------------------------------------------------------

// Carslaw, Jaeger 1959, section 2.14: the surfaces of two half spaces that touch are at the mean of their
// temperatures, weighed by their effusivities. On meshes of size d the error falls as exp(-4 a t/d^2): a
// lumped half space takes heat by e sqrt(s) sqrt(1 + s d^2/(4a)), so the ratio of two of them is analytic
// about s = 0.
TEST(Thermal, HoldsTheTemperatureOfTwoHalfSpaces) {
  std::vector<double> errors;
  for (const int elements : {6, 11, 20}) {
    const Bar below{.specific_heat = 2.0, .conductivity = 1.2, .temperature = 400, .elements = elements};
    const Bar above{.specific_heat = 1.0, .conductivity = 0.5, .temperature = 300, .elements = elements};
    const double dt = std::min(below.stable_step(), above.stable_step());
    const json law = {{"law", "conductance"}, {"parameters", {{"conductance", 1e12}}}};
    auto [read, integrator] = run_to_end(two_columns(below, above, dt, 0.05, law));
    const double expected =
        (below.effusivity() * 400 + above.effusivity() * 300) / (below.effusivity() + above.effusivity());
    errors.push_back(std::abs(integrator.temperatures()->at(read.interfaces[0]->nodes()[0]) - expected));
    EXPECT_LT(integrator.temperatures()->report().balance_error, 1e-12);
  }
  EXPECT_LT(errors[1], 0.01 * errors[0]);
  EXPECT_LT(errors[2], 1e-9);
}

// A node within a facet sees the temperature sum of w_i T_i and the capacity 1/(sum of w_i^2/C_i), here of
// equal nodes, each of which takes w_i of the heat.
TEST(Thermal, ExchangesHeatWithinAFacet) {
  const Bar facet{.temperature = 400, .elements = 1}, bar{.specific_heat = 3, .temperature = 300};
  const json law = {{"law", "conductance"}, {"parameters", {{"conductance", 0.4}}}};
  for (const auto& [x, y] : {std::pair{0.5, 0.5}, std::pair{0.3, 0.6}})
    for (const double dt : {0.013, 0.0031, 0.00071}) {
      json scene = two_columns(facet, bar, dt, 0.5, law);
      for (json& block : scene["model"]["blocks"]) block["thermal"]["conductivity"] = 0;
      scene["model"]["blocks"][1]["corner"] = {x, y, 1};
      scene["initial"] = json::array();
      scene["loads"] = {{{"type", "motion"}, {"nodes", "below"}},
                        {{"type", "motion"}, {"nodes", "above"}, {"axes", {0, 1}}},
                        {{"type", "gravity"}, {"acceleration", {0, 0, -0.01}}}};
      scene["interfaces"][0]["nodes"] = {8};
      auto [read, integrator] = run_to_end(scene);
      const Dofs& capacity = read.model->thermal()->capacity();
      const std::array weights{(1 - x) * (1 - y), x * (1 - y), (1 - x) * y, x * y};
      double yielding = 0.0;  // 1/C of the facet
      for (const double weight : weights) yielding += weight * weight / capacity[4];
      const double both = 1 / capacity[8] + yielding,
                   conductance = 0.4 * read.interfaces[0]->setup().areas[0];
      const double heat = 100 * -std::expm1(-conductance * both * thermal_time(integrator, dt)) / both;
      EXPECT_NEAR(integrator.temperatures()->at(8), 300 + heat / capacity[8], 1e-10);
      for (int k = 0; k < 4; ++k)
        EXPECT_NEAR(integrator.temperatures()->at(4 + k),
                    400 - weights[static_cast<std::size_t>(k)] * heat / capacity[4], 1e-10);
      EXPECT_LT(integrator.temperatures()->report().balance_error, 1e-13);
    }
}

// What a law reads: the mean of each side by its weights, and the capacity that heat meets if it is divided
// as the impulse is. The own side is that of a mortar, of two nodes.
TEST(ContactHeat, GivesTheLawTheMeanOfEachSide) {
  const std::vector<double> temperature{300, 340, 400, 500}, capacity{2, 3, 5, 7};
  ilaw_instance_info info{};
  info.per_node_parameters = ContactHeat::field_names.data();
  info.per_node_parameter_count = ContactHeat::field_names.size();
  ContactHeat heat(info, std::nullopt);
  heat.read(temperature.data(), capacity.data());
  ContactPoint point;
  point.own_weight = 0.7;
  point.own_partners = 1;
  point.partners = {{1, -0.3}, {2, 0.9}, {3, 0.1}};
  ContactArrays contacts(3, info, 1, true);
  contacts.parameters.assign(ContactHeat::field_names.size(), {0.0});
  heat.give(0, 0, point, contacts);
  const std::array expected{0.7 * 300 + 0.3 * 340, 0.9 * 400 + 0.1 * 500, 1 / (0.49 / 2 + 0.09 / 3),
                            1 / (0.81 / 5 + 0.01 / 7)};
  for (std::size_t k = 0; k < expected.size(); ++k)
    EXPECT_NEAR(contacts.parameters[k][0], expected[k], 1e-12 * expected[k]) << ContactHeat::field_names[k];
}

// Conduction and contact at their limits together: no node leaves the range of the start. With both at once,
// T + C^-1 h (q - K T) + C^-1 Q(T), a disturbance grows by 1.6 per step.
TEST(Thermal, IsStableWithAnyConductance) {
  const Bar below{.temperature = 400, .elements = 3}, above{.temperature = 300, .elements = 4};
  for (const double conductance : {1.0, 1e2, 1e12})
    for (const double fraction : step_fractions) {
      const double dt = fraction * above.stable_step();
      const json law = {{"law", "conductance"}, {"parameters", {{"conductance", conductance}}}};
      auto [read, integrator] = simulation_of(two_columns(below, above, dt, 200 * dt, law));
      for (int n = 0; n < 200; ++n) {
        integrator.step();
        const HeatReport heat = integrator.temperatures()->report();
        ASSERT_GT(heat.lowest, 300 - 1e-9) << conductance << " " << fraction << " step " << n;
        ASSERT_LT(heat.highest, 400 + 1e-9);
      }
    }
}

// Nodes of both meshes are in several contacts each, as nodes and in facets.
TEST(Thermal, IsStableWhereBothSidesAct) {
  const Bar below{.temperature = 400, .elements = 3}, above{.temperature = 300, .elements = 4};
  for (const double fraction : step_fractions) {
    const double dt = fraction * std::min(below.stable_step(), above.stable_step());
    const json law = {{"law", "conductance"}, {"parameters", {{"conductance", 1e12}}}};
    json scene = two_columns(below, above, dt, 50 * dt, law);
    scene["interfaces"][0]["against"]["both_sides"] = true;
    scene["model"]["blocks"][0]["elements"] = {2, 2, below.elements};
    scene["model"]["blocks"][1]["elements"] = {3, 3, above.elements};
    for (json& block : scene["model"]["blocks"]) block["thermal"]["conductivity"] = 0;
    auto [read, integrator] = simulation_of(scene);
    for (int n = 0; n < 50; ++n) {
      integrator.step();
      const HeatReport heat = integrator.temperatures()->report();
      ASSERT_GT(heat.lowest, 300 - 1e-9) << fraction << " step " << n;
      ASSERT_LT(heat.highest, 400 + 1e-9) << fraction << " step " << n;
      ASSERT_LT(heat.balance_error, 1e-12);
    }
  }
}

// ---- heat of friction -----------------------------------------------------------------------------------

json sliding_point(double dt, double partition) {
  json scene = {{"model", {{"type", "points"}, {"dimension", 2}}}, {"time", {{"dt", dt}, {"end", 2.0}}}};
  scene["model"]["points"] = {{{"mass", 2},
                               {"position", {0, 0}},
                               {"velocity", {4, 0}},
                               {"thermal", {{"specific_heat", 5}, {"initial_temperature", 290}}}}};
  scene["loads"] = {{{"type", "gravity"}, {"acceleration", {0, -10}}}};
  scene["interfaces"] = {{{"law", "coulomb"},
                          {"nodes", "all"},
                          {"parameters", {{"friction", 0.3}, {"heat_partition", partition}}},
                          {"obstacle", {{"type", "plane"}, {"point", {0, 0}}, {"normal", {0, 1}}}}}};
  return scene;
}

// A block in 3D that slides over another: the law's shares reach both, and conduction spreads them.
TEST(Thermal, SharesFrictionBetweenTwoBlocks) {
  const Bar below{.conductivity = 0.4, .temperature = 0.0, .elements = 2},
      above{.conductivity = 0.7, .temperature = 0.0, .elements = 3};
  for (const double fraction : step_fractions) {
    const json law = {{"law", "coulomb"}, {"parameters", {{"friction", 0.4}, {"heat_partition", 0.3}}}};
    json scene = two_columns(below, above, fraction * above.stable_step(), 1.0, law);
    scene["loads"].push_back({{"type", "force"},
                              {"nodes", "above"},
                              {"direction", {1, 0, 0}},
                              {"total", true},
                              {"history", {{0, 0}, {0.01, 3e-4}, {0.4, 3e-4}, {0.41, 0}}}});
    auto [read, integrator] = run_to_end(scene);
    double share = 0.0;
    for (const int node : read.model->sets().at("above").nodes)
      share += read.model->thermal()->capacity()[node] * integrator.temperatures()->at(node);
    const HeatReport heat = integrator.temperatures()->report();
    ASSERT_GT(heat.friction, 0.0);
    EXPECT_NEAR(heat.friction / integrator.energy().by_law[ILAW_ENERGY_FRICTION], 1.0, 1e-12);
    EXPECT_NEAR(heat.stored / heat.friction, 1.0, 1e-12);
    EXPECT_NEAR(share / heat.friction, 0.3, 1e-12);
    EXPECT_LT(heat.balance_error, 1e-12);
    EXPECT_LT(integrator.energy().balance_error, 1e-12);
  }
}

// ---- the host -------------------------------------------------------------------------------------------

// A failed run reports its last complete step.
TEST(Thermal, TakesBackAStepThatOverflows) {
  const Bar bar{.specific_heat = 0.01, .conductivity = 1e-6};
  json scene = scene_with({column(bar, "bar", 0)}, 0.01, 1.0);
  scene["loads"] = {
      {{"type", "heat_flux"}, {"nodes", "bar.z_max"}, {"history", {{0, 1}, {0.045, 1}, {0.05, 1e308}}}}};
  auto [read, integrator] = simulation_of(scene);
  HeatReport before;
  EXPECT_THROW(
      for (int n = 0; n < 100; ++n) {
        before = integrator.temperatures()->report();
        integrator.step();
      },
      Diverged);
  integrator.take_back_step();
  const HeatReport after = integrator.temperatures()->report();
  EXPECT_EQ(after.stored, before.stored);
  EXPECT_EQ(after.supplied, before.supplied);
  EXPECT_EQ(after.highest, before.highest);
}

TEST(Thermal, WritesTemperaturesToFields) {
  const auto folder = fresh_folder();
  json scene = sliding_point(0.01, 0.25);
  scene["output"] = {{"fields", 100}};
  std::ofstream(folder / "scene.json") << scene.dump();
  const Outcome outcome =
      run_program("run " + (folder / "scene.json").string() + " --out " + folder.string());
  EXPECT_EQ(outcome.code, 0) << outcome.output;
  EXPECT_NE(text_of(folder / "fields_000001.vtu").find("Name=\"temperature\""), std::string::npos);
  std::filesystem::remove_all(folder);
}

// The block of docs/results/tyre_block.md.
TEST(Thermal, HeatsTheShippedTyreBlock) {
  json scene = read_scene_source(scene_files::named("tyre_block.json"));
  std::vector<double> rises;
  for (const double cfl : {0.9, 0.57, 0.31}) {
    scene["time"]["cfl"] = cfl;
    auto [read, integrator] = run_to_end(scene);
    const HeatReport heat = integrator.temperatures()->report();
    EXPECT_NEAR(heat.friction / integrator.energy().by_law[ILAW_ENERGY_FRICTION], 1.0, 1e-12);
    EXPECT_NEAR(heat.obstacles / heat.friction, 0.66, 1e-12);
    EXPECT_LT(heat.balance_error, 1e-11);
    EXPECT_LT(integrator.energy().balance_error, 1e-11);
    // The surface of a half space under the mean flux; friction changes by a few percent as it heats.
    const double flux = heat.stored / 4e-4 / integrator.time();
    double rise = 0.0;
    for (const int node : read.interfaces[0]->nodes())
      rise += 0.25 * (integrator.temperatures()->at(node) - 293.0);
    EXPECT_NEAR(rise / (2 * flux * std::sqrt(integrator.time() / (std::numbers::pi * 0.25 * 1150 * 1800))),
                1.0, 0.05);
    rises.push_back(rise);
  }
  EXPECT_NEAR(rises[0] / rises[2], 1.0, 0.01);
  EXPECT_NEAR(rises[1] / rises[2], 1.0, 0.01);
}

}  // namespace
}  // namespace ilaw::host::testing::thermal
