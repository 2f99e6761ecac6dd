// Runs that start from static equilibrium, against closed forms.
#include "run_result.hpp"

#include <chrono>
#include <csignal>
#include <numeric>
#include <thread>

namespace ilaw::host::testing::prestress {
namespace {

constexpr double young = 1e6, density = 1000.0, acceleration = 10.0, height = 0.5, side = 0.1;
constexpr double weight = density * acceleration * height * side * side;

// A column on a floor, under its weight.
json column(double cfl) {
  json source = scene_of_blocks(
      {block("b", {0, 0, 0}, {side, side, height}, {1, 1, 6}, elastic(young, 0, density))},
      R"([{"name": "floor", "law": "coulomb", "parameters": {"friction": 0.3}, "nodes": "b.z_min",
           "obstacle": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}}])");
  source["prestress"] = {{"tolerance", 1e-8}};
  source["time"] = {{"cfl", cfl}, {"end", 0.2}};
  source["loads"] = json::parse(R"([{"type": "gravity", "acceleration": [0, 0, -10]}])");
  source["output"] =
      json::parse(R"({"watch": [{"near": [0, 0, 0.5]}], "forces": ["floor"], "balance": true})");
  return source;
}

double sum_of(const Dofs& impulse, int axis) {
  double sum = 0.0;
  for (Eigen::Index k = axis; k < impulse.size(); k += 3) sum += impulse[k];
  return sum;
}

// The top sinks by rho g L^2/(2 E); the floor carries the weight from the first half step on, and all stays
// at rest.
TEST(Prestress, ColumnStandsOnItsWeight) {
  for (const double cfl : {0.9, 0.613, 0.287}) {
    Scene scene = scene_of(column(cfl).dump());
    Integrator integrator = integrator_of(scene);
    integrator.start();
    const double sunk = -density * acceleration * height * height / (2.0 * young);
    const auto top = [&] { return integrator.displacement()[integrator.displacement().size() - 1]; };
    EXPECT_NEAR(top(), sunk, 1e-6 * std::abs(sunk)) << cfl;
    EXPECT_EQ(integrator.steps(), 0);
    EXPECT_NEAR(sum_of(integrator.interface_impulse(), 2), 0.5 * scene.dt * weight,
                1e-7 * 0.5 * scene.dt * weight);
    EXPECT_LE(integrator.prestressed()->residual, 1e-8);
    EXPECT_EQ(integrator.energy().external_work, 0.0);
    while (integrator.steps() < scene.steps) {
      integrator.step();
      ASSERT_NEAR(top(), sunk, 1e-5 * std::abs(sunk)) << cfl;
      ASSERT_NEAR(sum_of(integrator.interface_impulse(), 2), scene.dt * weight, 1e-4 * scene.dt * weight);
    }
    const EnergyReport energy = integrator.energy();
    EXPECT_LT(energy.balance_error, 1e-12);
    // Stored by a stress that grows linearly from the top: A rho^2 g^2 L^3/(6 E), but for the element's part.
    const double stored =
        side * side * std::pow(density * acceleration, 2) * std::pow(height, 3) / (6.0 * young);
    EXPECT_NEAR(energy.potential, stored * (1.0 - 0.25 / 36.0), 1e-3 * stored);
  }
}

// A bar, a cube and a stack of three blocks, each of height 1 on a floor under its weight.
std::vector<json> standing_bodies() {
  json of_bar = scene_of_bars({bar("b", 0, 1, 40, young, density)}, {law_on("b.left", ground(1), "contact")},
                              {gravity({-10})});
  const json material = elastic(young, 0, density), friction = {{"friction", 0.3}};
  json of_cube = scene_of_blocks({block("b", {0, 0, 0}, {1, 1, 1}, {4, 4, 4}, material)},
                                 {law_on("b.z_min", ground(3), "coulomb", friction)});
  std::vector<json> blocks, joints{law_on("b0.z_min", ground(3), "coulomb", friction)};
  for (int k = 0; k < 3; ++k) {
    const std::string name = "b" + std::to_string(k);
    blocks.push_back(block(name.c_str(), {0, 0, k / 3.0}, {1, 1, 1 / 3.0}, {2, 2, 2}, material));
    if (k > 0)
      joints.push_back(law_between(name + ".z_min", {{"surface", "b" + std::to_string(k - 1) + ".z_max"}},
                                   "coulomb", friction));
  }
  json of_stack = scene_of_blocks(blocks, joints);
  for (json* scene : {&of_cube, &of_stack}) (*scene)["loads"] = {gravity({0, 0, -10})};
  return {of_bar, of_cube, of_stack};
}

// The step of the run has no part in it. At a height z bodies sink by rho g (z - z^2/2)/E.
TEST(Prestress, TakesFewStepsWhateverTheRun) {
  for (const json& body : standing_bodies()) {
    std::set<std::int64_t> steps;
    for (const double cfl : {0.999, 0.5, 0.03}) {
      GIVEN(body["model"]["type"], body["interfaces"].size(), cfl);
      json source = until_at_cfl(1.0, cfl, body);
      source["prestress"] = json::object();
      auto [scene, integrator] = simulation_of(source);
      integrator.start();
      const int d = scene.model->dimension();
      for (int node = 0; node < scene.model->node_count(); ++node) {
        const double z = scene.model->position(node)[d - 1];
        EXPECT_NEAR(integrator.displacement()[d * node + d - 1],
                    -density * acceleration * (z - 0.5 * z * z) / young, 1e-7);
      }
      steps.insert(integrator.prestressed()->steps);
    }
    EXPECT_EQ(steps.size(), 1U);
    EXPECT_LE(*steps.begin(), 400);
  }
}

// It ends at its next step, too, without results but a summary that says so.
TEST(Prestress, EndsAtAnInterrupt) {
  const auto folder = fresh_folder();
  json source = column(0.9);
  source["prestress"] = {{"tolerance", 1e-300}, {"steps", 1000000000}};
  const pid_t child =
      start_program({"run", written(source, folder), "--out", folder.string()}, folder / "messages");
  for (int k = 0; k < 5000 && !fs::exists(folder / "history.csv.partial"); ++k)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  kill(child, SIGTERM);
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 1);
  EXPECT_TRUE(json_of(folder / "summary.json")["interrupted"]);
  EXPECT_THAT(text_of(folder / "messages"), HasSubstr("interrupted at step 0 of "));
}

// A load that comes later does work from the equilibrium on, and the balance closes.
TEST(Prestress, BalanceBeginsAtTheEquilibrium) {
  json source = column(0.8);
  source["loads"].push_back({{"type", "force"},
                             {"nodes", "b.z_max"},
                             {"total", true},
                             {"direction", {0, 0, -1}},
                             {"history", {{0.01, 0}, {0.011, 30}}}});
  const Ran run = ran(source);
  EXPECT_EQ(run["time"].front() > 0.0, true);
  EXPECT_LT(run.energy("balance_error"), 1e-12);
  EXPECT_GT(run.energy("kinetic"), 1e-6);
  EXPECT_LT(run["balance.external_work"][2], 1e-9);
  EXPECT_GT(run.last("balance.external_work"), 1e-4);
  EXPECT_LE(run.energy("reaction_work"), 1e-9);
  EXPECT_GT(run.summary["prestress"]["steps"].get<int>(), 10);
}

// A penalty does not put in later what it stores in the equilibrium.
TEST(Prestress, StoredEnergyOfInterfacesIsNotPutIn) {
  json source = column(0.8);
  const double stiffness = 2e4;
  source["interfaces"][0]["law"] = "penalty";
  source["interfaces"][0]["parameters"] = {{"stiffness", stiffness}, {"friction", 0}};
  const Ran run = ran(source);
  EXPECT_EQ(run.summary["warnings"], json::array());
  // Four springs of the corners share the weight.
  EXPECT_NEAR(run.energy("stored"), weight * weight / (2.0 * 4.0 * stiffness), 1e-5);
  EXPECT_LT(std::abs(run.energy("reaction_work")), 1e-6);
}

// A ramp takes obstacles and motions through the times before 0.
TEST(Prestress, RampMovesWhatMoves) {
  const double stretch = 1e-3, length = 2.0;
  for (const double dt : {1e-2, 7.3e-3, 3.1e-3}) {
    const json source = {
        {"model",
         {{"type", "bars"},
          {"bars", {{{"name", "b"}, {"length", length}, {"elements", 10}, {"young", 3}, {"density", 1}}}}}},
        {"prestress", {{"ramp", 0.5}, {"tolerance", 1e-9}}},
        {"time", {{"dt", dt}, {"end", 1}}},
        {"loads",
         {{{"type", "motion"}, {"nodes", "b.left"}},
          {{"type", "motion"}, {"nodes", "b.right"}, {"path", {{-0.5, 0}, {0, stretch}}}}}},
        {"interfaces", json::array()}};
    auto [scene, integrator] = simulation_of(source);
    integrator.start();
    for (int node = 0; node <= 10; ++node)
      EXPECT_NEAR(integrator.displacement()[node], stretch * node / 10, 1e-8 * stretch) << dt;
    while (integrator.steps() < scene.steps) integrator.step();
    EXPECT_NEAR(integrator.displacement()[5], 0.5 * stretch, 1e-7 * stretch);
    EXPECT_NEAR(scene.model->stresses(integrator.displacement())[4](0, 0), 3.0 * stretch / length, 1e-9);
  }
}

TEST(Prestress, EndsTheRunWhereItIsNotFound) {
  json source = column(0.9);
  source["prestress"] = {{"steps", 20}};
  EXPECT_THAT(run_scene(source),
              Exits(1, AllOf(HasSubstr("no static equilibrium after 21 steps of 'prestress': residual 0."),
                             HasSubstr(", expected at most 1e-06"))));
}

// The shipped seal is squeezed before the run: its lid presses with A E e/(1 - nu^2) from the start, and with
// nu/(1 - nu) of the fluid's force at the end.
TEST(Prestress, SealPressesFromTheStart) {
  const double nu = 0.45, squeezed = 1e-4 * 5e6 * 0.1 / (1.0 - nu * nu), pushed = 0.9 * 2e6 * 1e-4;
  for (const double cfl : {0.7, 0.53, 0.41}) {
    json source = shipped("prestressed_seal");
    source["time"]["cfl"] = cfl;
    source["output"]["every"] = 1;
    const Ran run = ran(source);
    EXPECT_NEAR(run["lid.F2"].front(), -squeezed, 1e-4 * squeezed) << cfl;
    EXPECT_NEAR(run["n23.u2"].front(), -0.001, 1e-12) << cfl;
    EXPECT_NEAR(run.mean_after(0.01, "lid.F2"), -squeezed - nu / (1.0 - nu) * pushed, 1e-3 * squeezed) << cfl;
    EXPECT_EQ(run.summary["warnings"], json::array());
  }
}

}  // namespace
}  // namespace ilaw::host::testing::prestress
