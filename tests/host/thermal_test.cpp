// Conduction through meshes from files, and heat of a step that is taken back; motions.json has the closed
// forms.
#include "mesh_writer.hpp"

#include "contact/contact_heat.hpp"

#include <array>
#include <optional>
#include <vector>

namespace ilaw::host::testing::thermal {
namespace {

json thermal_of(double specific_heat, double conductivity) {
  return {{"specific_heat", specific_heat}, {"conductivity", conductivity}, {"initial_temperature", 300}};
}
json held(const char* nodes, double temperature) {
  return {{"type", "temperature"}, {"nodes", nodes}, {"history", {{0, temperature}}}};
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
    json scene = scene_of_blocks({}, "[]");
    scene["model"] = {{"type", "solids"},
                      {"meshes",
                       {{{"name", "body"},
                         {"file", (folder / "body.vtu").string()},
                         {"material", elastic(1, 0, 1)},
                         {"thermal", thermal_of(1.0, 0.3)}}}}};
    scene["loads"] = {held("body.x_min", 400), end};
    scene["time"] = {{"dt", 1e-4}, {"end", 200}};
    const double stable = scene_of(scene.dump()).model->thermal()->stable_step().step;
    for (const double fraction : {1.0, 0.71, 0.43, 0.19}) {
      scene["time"]["dt"] = fraction * stable;
      auto [read, integrator] = run_to_end(scene);
      for (int node = 0; node < read.model->node_count(); ++node)
        EXPECT_NEAR(integrator.temperatures()->at(node), 400 - 120 * read.model->position()[3 * node], 1e-9);
    }
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

// A failed run reports its last complete step.
TEST(Thermal, TakesBackAStepThatOverflows) {
  json bar = block("bar", {0, 0, 0}, {0.2, 0.2, 1}, {1, 1, 5}, elastic(1, 0, 1));
  bar["thermal"] = thermal_of(0.01, 1e-6);
  json scene = until(1.0, 0.01, scene_of_blocks({bar}, "[]"));
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

}  // namespace
}  // namespace ilaw::host::testing::thermal
