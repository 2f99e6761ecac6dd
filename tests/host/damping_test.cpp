// Bodies that are damped, and loads over time, against closed forms.
#include "run_result.hpp"

namespace ilaw::host::testing {
namespace {

// A point that is driven along y keeps the damping along x, as a free one beside it.
TEST(Damping, ActsAlongTheFreeAxesOfADrivenNode) {
  for (const double h : coprime_steps) {
    GIVEN(h);
    json source = json::parse(R"({
      "model": {"type": "points", "dimension": 2, "points": [{"mass": 3, "position": [0, 0], "velocity": [2, 0]},
                                                             {"mass": 3, "position": [1, 0], "velocity": [2, 0]}]},
      "loads": [{"type": "damping", "rate": 30},
                {"type": "motion", "nodes": [0], "axes": [1], "path": [[0, 0, 0], [0.2, 0, 0.1]]}],
      "interfaces": []})");
    source["time"] = {{"dt", h}, {"end", 0.5}};
    auto [scene, integrator] = run_to_end(source);
    const double a = 15.0 * h, kept = 2.0 * (1.0 - 0.5 * a) / (1.0 + 0.5 * a) *
                                      std::pow((1.0 - a) / (1.0 + a), static_cast<double>(scene.steps));
    EXPECT_NEAR(integrator.velocity()[2], kept, 1e-14);
    EXPECT_EQ(integrator.velocity()[0], integrator.velocity()[2]);
    EXPECT_EQ(integrator.velocity()[1], 0.0);
    EXPECT_NEAR(integrator.displacement()[1], 0.1, 1e-15);
    EXPECT_LT(integrator.energy().balance_error, 1e-14);
  }
}

// A block in plane strain, all nodes held along y: its velocity along x falls as e^-15, at the default step
// and at the critical one.
TEST(Damping, SlowsABlockInPlaneStrain) {
  json source =
      scene_of_blocks({block("b", {0, 0, 0}, {1, 0.2, 1}, {4, 1, 4}, elastic(1e6, 0.3, 1000))}, "[]");
  source["model"]["blocks"][0]["velocity"] = {1, 0, 0};
  source["loads"] =
      json::parse(R"([{"type": "damping", "rate": 30}, {"type": "motion", "nodes": "all", "axes": [1]}])");
  for (const double cfl : {0.9, 0.999, 0.53}) {
    source["time"] = {{"cfl", cfl}, {"end", 0.5}};
    auto [scene, integrator] = run_to_end(source);
    const double end = static_cast<double>(scene.steps) * scene.dt;
    EXPECT_NEAR(integrator.velocity()[0] / std::exp(-30.0 * end), 1.0, 0.1) << "cfl " << cfl;
  }
}

// A floor carries the weight, whatever is damped: alone, with friction, and through a stack of light and
// heavy ones.
TEST(Damping, LeavesTheWeightToTheFloor) {
  json source = json::parse(R"({
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
  for (const double h : coprime_steps)
    for (const double rate : {20.0, 200.0}) {
      GIVEN(h, rate);
      source["time"] = {{"dt", h}, {"end", 3}};
      source["loads"][1]["rate"] = rate;
      const Ran run = ran(source);
      EXPECT_NEAR(run.last("floor.F1"), 260.0, 1e-9);
      EXPECT_NEAR(run.last("floor.F0"), -52.0, 1e-9);
      EXPECT_NEAR(run.last("middle.F1"), 250.0, 1e-9);
      EXPECT_NEAR(run.last("top.F1"), 50.0, 1e-9);
      EXPECT_NEAR(run.last("more.F1"), 0.0, 1e-9);
      EXPECT_LT(run.energy("balance_error"), 1e-13);
      EXPECT_LT(run.energy("reaction_work"), CoupledStep::default_tolerance);
    }
}

// Forces of all loads and the floor add up to the change of momentum, where dampers take part of a reaction.
TEST(Damping, TakesItsPartOfAnImpact) {
  json source = json::parse(R"({
    "model": {"type": "points", "dimension": 1, "points": [{"mass": 2, "position": [0.02], "velocity": [-1]}]},
    "loads": [{"type": "damping", "name": "air", "rate": 20}, {"type": "damping", "name": "oil", "rate": 7}],
    "interfaces": [{"name": "wall", "law": "contact", "parameters": {"restitution": 0.5}, "nodes": "all",
      "obstacle": {"type": "plane", "point": [0], "normal": [1]}}],
    "output": {"watch": [0], "balance": true, "forces": ["wall", "air", "oil"]}})");
  for (const double h : coprime_steps) {
    GIVEN(h);
    source["time"] = {{"dt", h}, {"end", 0.3}};
    const Ran run = ran(source);
    const std::vector<double>&v = run["n0.v0"], &wall = run["wall.F0"];
    for (std::size_t k = 1; k < run.rows(); ++k) {
      EXPECT_NEAR(2.0 * (v[k] - v[k - 1]), h * (wall[k] + run["air.F0"][k] + run["oil.F0"][k]), 1e-14);
      EXPECT_TRUE(wall[k] <= 0.0 || std::abs(v[k] + 0.5 * v[k - 1]) < 1e-15) << v[k - 1] << " to " << v[k];
    }
    EXPECT_GT(v.back(), 0.0);
    EXPECT_LT(run.energy("balance_error"), 1e-14);
  }
}

// ---- tables in time -------------------------------------------------------------------------------------

// Gravity and damping over time: a point settles on a spring, and is let go.
TEST(History, ScalesGravityAndDamping) {
  json source = json::parse(R"({
    "model": {"type": "points", "dimension": 1, "points": [{"mass": 2, "position": [0], "stiffness": [200]}]},
    "loads": [{"type": "gravity", "acceleration": [-10], "history": [[0, 0], [0.5, 1], [4, 1], [4.001, 0]]},
              {"type": "damping", "rate": 20, "history": {"rows": [[0, 1], [3.9, 1], [4, 0]], "smooth": true}}],
    "interfaces": [], "output": {"watch": [0]}})");
  for (const double h : coprime_steps) {
    GIVEN(h);
    source["time"] = {{"dt", h}, {"end", 6}};
    const Ran run = ran(source);
    double least = 0.0, most = -1.0;
    for (std::size_t k = 0; k < run.rows(); ++k) {
      const double time = run["time"][k], u = run["n0.u0"][k];
      EXPECT_TRUE(time <= 3.0 || time >= 3.99 || std::abs(u + 0.1) < 1e-8) << u << " at " << time;
      if (time < 4.1) continue;
      least = std::min(least, u);
      most = std::max(most, u);
    }
    EXPECT_NEAR(least, -0.1, 2e-3);
    EXPECT_NEAR(most, 0.1, 2e-3);
  }
}

// A floor carries weight and a varying damping alike.
TEST(History, OfDampingReachesTheLaws) {
  for (const double h : coprime_steps) {
    json source = resting_point("contact", {}, h);
    source["loads"].push_back(
        {{"type", "damping"}, {"rate", 300}, {"history", {{0, 0}, {0.1, 1}, {0.15, 0.3}}}});
    EXPECT_THAT(ran(source)["floor.F1"], Each(DoubleNear(10.0, 1e-12))) << "h = " << h;
  }
}

TEST(Table, IsSmoothBetweenItsRowsOrASine) {
  const Table smooth({1.0, 3.0}, {Vector::Constant(1, 2.0), Vector::Constant(1, 6.0)}, true);
  EXPECT_EQ(smooth.at(0.0)[0], 2.0);
  EXPECT_EQ(smooth.at(2.0)[0], 4.0);
  EXPECT_EQ(smooth.at(5.0)[0], 6.0);
  for (const double at : {1.0, 3.0}) EXPECT_NEAR(smooth.at(at + 1e-4)[0], smooth.at(at - 1e-4)[0], 1e-11);
  const Table sine(Sine{Vector::Constant(1, 1.0), Vector::Constant(1, 3.0), 0.5, 0.1});
  EXPECT_NEAR(sine.at(0.3)[0], 1.0 + 3.0 * std::sin(0.3 * M_PI + 0.1), 1e-15);
}

TEST(History, TakesASineAndRefusesOneOfDamping) {
  json source = resting_point("contact", {}, 1e-2);
  source["loads"].push_back(
      json::parse(R"({"type": "force", "name": "shaker", "nodes": [0], "direction": [1, 0],
                                            "history": {"sine": {"amplitude": 3, "frequency": 5}}})"));
  source["output"]["forces"].push_back("shaker");
  const Ran run = ran(source);
  for (std::size_t k = 0; k < run.rows(); ++k)
    EXPECT_NEAR(run["shaker.F0"][k], 3.0 * std::sin(10.0 * M_PI * run["time"][k]), 1e-12);
  source["loads"].back() =
      json::parse(R"({"type": "damping", "rate": 1, "history": {"sine": {"amplitude": 3, "frequency": 5}}})");
  source["output"]["forces"] = {"floor"};
  EXPECT_EQ(refusal_of(source), "/loads/1/history: found a sine, expected rows: a rate is not negative");
}

}  // namespace
}  // namespace ilaw::host::testing
