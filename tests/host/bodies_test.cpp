// Bodies that are held, damped, loaded from the start and stacked, against closed forms.
#include "run_result.hpp"

#include <nlohmann/json.hpp>

#include <cmath>
#include <string>
#include <vector>

namespace ilaw::host::testing {
namespace {

using nlohmann::json;

// Three steps without a common factor.
constexpr double steps[] = {1e-2, 3.7e-3, 1.3e-3};

// ---- damping --------------------------------------------------------------------------------------------

// A point that is driven along y keeps the damping along x, as a free one beside it.
TEST(Damping, ActsAlongTheFreeAxesOfADrivenNode) {
  for (const double h : steps) {
    json scene = json::parse(R"({
      "model": {"type": "points", "dimension": 2, "points": [{"mass": 3, "position": [0, 0], "velocity": [2, 0]},
                                                             {"mass": 3, "position": [1, 0], "velocity": [2, 0]}]},
      "loads": [{"type": "damping", "rate": 30},
                {"type": "motion", "nodes": [0], "axes": [1], "path": [[0, 0, 0], [0.2, 0, 0.1]]}],
      "interfaces": []})");
    scene["time"] = {{"dt", h}, {"end", 0.5}};
    Scene read = scene_of(scene.dump());
    Integrator integrator = integrator_of(read);
    while (integrator.steps() < read.steps) integrator.step();
    const double a = 15.0 * h, kept = 2.0 * (1.0 - 0.5 * a) / (1.0 + 0.5 * a) *
                                      std::pow((1.0 - a) / (1.0 + a), static_cast<double>(read.steps));
    EXPECT_NEAR(integrator.velocity()[2], kept, 1e-14) << "h = " << h;
    EXPECT_EQ(integrator.velocity()[0], integrator.velocity()[2]) << "h = " << h;
    EXPECT_EQ(integrator.velocity()[1], 0.0) << "h = " << h;
    EXPECT_NEAR(integrator.displacement()[1], 0.1, 1e-15) << "h = " << h;
    EXPECT_LT(integrator.energy().balance_error, 1e-14) << "h = " << h;
  }
}

// A block in plane strain, all nodes held along y: its velocity along x falls as e^-15, at the default step and
// at the critical one.
TEST(Damping, SlowsABlockInPlaneStrain) {
  for (const double cfl : {0.9, 0.999, 0.53}) {
    json scene = json::parse(R"({
      "model": {"type": "blocks", "blocks": [{"name": "b", "size": [1, 0.2, 1], "elements": [4, 1, 4], "velocity": [1, 0, 0],
        "material": {"type": "linear", "young": 1e6, "poisson": 0.3, "density": 1000}}]},
      "loads": [{"type": "damping", "rate": 30}, {"type": "motion", "nodes": "all", "axes": [1]}],
      "interfaces": []})");
    scene["time"] = {{"cfl", cfl}, {"end", 0.5}};
    Scene read = scene_of(scene.dump());
    Integrator integrator = integrator_of(read);
    while (integrator.steps() < read.steps) integrator.step();
    const double end = static_cast<double>(read.steps) * read.dt;
    EXPECT_NEAR(integrator.velocity()[0] / std::exp(-30.0 * end), 1.0, 0.1) << "cfl " << cfl;
  }
}

// A floor carries the weight, whatever is damped: alone, with friction, and through a stack of light and heavy ones.
TEST(Damping, LeavesTheWeightToTheFloor) {
  for (const double h : steps)
    for (const double rate : {20.0, 200.0}) {
      json scene = json::parse(R"({
        "model": {"type": "points", "dimension": 2, "points": [{"mass": 1, "position": [0, 0]}, {"mass": 20, "position": [0, 0]},
                                                               {"mass": 5, "position": [0, 0]}]},
        "loads": [{"type": "gravity", "acceleration": [0, -10]}, {"type": "damping", "nodes": "all"},
                  {"type": "force", "nodes": [0], "direction": [1, 0], "history": [[0, 60]]},
                  {"type": "damping", "name": "more", "nodes": [1], "rate": 50}],
        "interfaces": [{"name": "floor", "law": "coulomb", "parameters": {"friction": 0.2}, "nodes": [0],
            "obstacle": {"type": "plane", "point": [0, 0], "normal": [0, 1]}},
          {"name": "middle", "law": "coulomb", "parameters": {"friction": 0.2}, "nodes": [1], "against": {"nodes": [0], "normal": [0, 1]}},
          {"name": "top", "law": "contact", "nodes": [2], "against": {"nodes": [1], "normal": [0, 1]}}],
        "output": {"forces": ["floor", "middle", "top", "more"]}})");
      scene["time"] = {{"dt", h}, {"end", 3}};
      scene["loads"][1]["rate"] = rate;
      const Ran run = ran(scene);
      const std::string at = "h = " + number(h) + ", rate " + number(rate);
      EXPECT_NEAR(run.last("floor.F1"), 260.0, 1e-9) << at;
      EXPECT_NEAR(run.last("floor.F0"), -52.0, 1e-9) << at;
      EXPECT_NEAR(run.last("middle.F1"), 250.0, 1e-9) << at;
      EXPECT_NEAR(run.last("top.F1"), 50.0, 1e-9) << at;
      EXPECT_NEAR(run.last("more.F1"), 0.0, 1e-9) << at;
      EXPECT_LT(run.summary["energy"]["balance_error"].get<double>(), 1e-13) << at;
      EXPECT_LT(run.summary["energy"]["reaction_work"].get<double>(), 1e-12) << at;
    }
}

// Forces of all loads and the floor add up to the change of momentum, where dampers take part of a reaction.
TEST(Damping, TakesItsPartOfAnImpact) {
  for (const double h : steps) {
    json scene = json::parse(R"({
      "model": {"type": "points", "dimension": 1, "points": [{"mass": 2, "position": [0.1], "velocity": [-1]}]},
      "loads": [{"type": "damping", "name": "air", "rate": 20}, {"type": "damping", "name": "oil", "rate": 7}],
      "interfaces": [{"name": "wall", "law": "contact", "parameters": {"restitution": 0.5}, "nodes": "all",
        "obstacle": {"type": "plane", "point": [0], "normal": [1]}}],
      "output": {"watch": [0], "balance": true, "forces": ["wall", "air", "oil"]}})");
    scene["time"] = {{"dt", h}, {"end", 0.3}};
    const Ran run = ran(scene);
    const double first = run.history.at("n0.v0")[0];
    for (std::size_t k = 1; k < run.history.at("time").size(); ++k) {
      const double force = run.history.at("wall.F0")[k] + run.history.at("air.F0")[k] + run.history.at("oil.F0")[k];
      EXPECT_NEAR(2.0 * (run.history.at("n0.v0")[k] - run.history.at("n0.v0")[k - 1]), h * force, 1e-14) << "h = " << h;
      if (run.history.at("wall.F0")[k] > 0.0)
        EXPECT_NEAR(run.history.at("n0.v0")[k], -0.5 * run.history.at("n0.v0")[k - 1], 1e-15) << "h = " << h;
    }
    EXPECT_LT(first, 0.0);
    EXPECT_GT(run.last("n0.v0"), 0.0) << "h = " << h;
    EXPECT_LT(run.summary["energy"]["balance_error"].get<double>(), 1e-14) << "h = " << h;
  }
}

}  // namespace
}  // namespace ilaw::host::testing
