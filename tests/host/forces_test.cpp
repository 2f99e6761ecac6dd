// Resultants and events: sums against momentum, closed forms, and the same whatever the rows.
#include "run_result.hpp"

#include "results/forces.hpp"

namespace ilaw::host::testing::forces {
namespace {

// A bouncing block of rubber, its top moved to and fro along x, damped, pushed and struck.
json shaken_block() {
  return json::parse(R"({
    "model": {"type": "blocks", "blocks": [{"name": "b", "size": [0.1, 0.1, 0.1], "elements": [2, 2, 2],
      "velocity": [0.3, 0, -1], "corner": [0, 0, 0.003],
      "material": {"type": "linear", "young": 1e6, "poisson": 0.3, "density": 1000}}]},
    "time": {"cfl": 0.7, "end": 0.02},
    "loads": [{"type": "motion", "name": "grip", "nodes": "b.z_max", "axes": [0], "path": [[0, 0, 0, 0], [0.01, 1e-3, 0, 0], [0.02, 0, 0, 0]]},
      {"type": "damping", "name": "air", "rate": 20},
      {"type": "gravity", "name": "weight", "acceleration": [0, 0, -10]},
      {"type": "force", "name": "push", "nodes": "b.x_min", "direction": [0, 1, 0], "history": [[0, 0], [0.02, 3]], "total": true},
      {"type": "shock", "name": "blow", "nodes": "b.y_max", "time": 0.0071, "impulse": [0, -0.001, 0.002]}],
    "interfaces": [{"name": "floor", "law": "coulomb", "parameters": {"friction": 0.3}, "nodes": "b.z_min",
      "obstacle": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}}],
    "output": {"watch": [0], "forces": ["floor", "grip", "b.z_max", "air", "weight", "push", "blow"]}})");
}

const std::vector<std::string> parts{"floor", "grip", "air", "weight", "push", "blow"};

// The impulses of all that acts from outside are the change of momentum, whatever the rows: from V_{1/2} on
// in the rows, and from V_0 on in the summary.
TEST(Forces, SumToTheChangeOfMomentumWhateverTheRows) {
  json scene = shaken_block();
  Scene same = scene_of(scene);
  Integrator integrator = integrator_of(same);
  const auto momentum = [&](Eigen::Index axis) {
    double sum = 0.0;
    for (Eigen::Index i = axis; i < integrator.velocity().size(); i += 3)
      sum += same.model->mass()[i] * integrator.velocity()[i];
    return sum;
  };
  const std::array<double, 3> start{momentum(0), momentum(1), momentum(2)};
  while (integrator.steps() < same.steps) integrator.step();
  const Dofs thrown = same.model->mass().cwiseProduct(same.model->initial_velocity());
  std::map<std::string, double> first;
  for (const int every : {1, 7, 20}) {
    scene["output"]["every"] = every;
    const Ran run = ran(scene);
    EXPECT_NEAR(run.last("time"), integrator.time(), 1e-12) << "every " << every;
    for (int axis = 0; axis < 3; ++axis) {
      double sum = 0.0, all = 0.0;
      for (const std::string& name : parts) {
        const std::string column = name + ".F" + std::to_string(axis);
        const double impulse = run.impulse(column);
        sum += impulse;
        all += run.summary["forces"][name]["impulse"][axis].get<double>();
        if (every == 1)
          first[column] = impulse;
        else
          EXPECT_NEAR(impulse, first[column], 1e-13) << column << ", every " << every;
      }
      EXPECT_NEAR(sum, momentum(axis) - start[static_cast<std::size_t>(axis)], 1e-12)
          << "axis " << axis << ", every " << every;
      EXPECT_NEAR(all, momentum(axis) - thrown(Eigen::seqN(axis, thrown.size() / 3, 3)).sum(), 1e-12)
          << "axis " << axis << ", every " << every;
      EXPECT_EQ(run["b.z_max.F" + std::to_string(axis)], run["grip.F" + std::to_string(axis)])
          << "every " << every << ", axis " << axis;
    }
    for (const std::string& name : parts) {
      const auto column = [&](const char* axis) { return run[name + axis]; };
      double largest = 0.0;
      for (std::size_t k = 0; k < column(".F0").size(); ++k)
        largest = std::max(largest, std::hypot(column(".F0")[k], column(".F1")[k], column(".F2")[k]));
      const double told = run.summary["forces"][name]["largest"].get<double>();
      EXPECT_GE(told, largest * (1.0 - 1e-12)) << name << ", every " << every;
      // The grip and the air have more to do at the start.
      if (name == "grip" || name == "air") continue;
      EXPECT_NEAR(told, largest, 1e-12 * largest) << name << ", every " << every;
    }
    EXPECT_GT(std::abs(first["floor.F2"]), 0.5) << "every " << every;
    EXPECT_NEAR(first["blow.F2"], 9 * 0.002, 1e-15) << "every " << every;
  }
}

// A spring and a damper between two thrown masses, and one to a wall: what they do to their own
// nodes is what changes their momentum, and turns them about the wall's end by nothing.
TEST(Forces, OfSpringsAreTheChangeOfMomentumOfTheirNodes) {
  json scene = json::parse(R"({
    "model": {"type": "points", "dimension": 2, "points": [{"mass": 2, "position": [1, 0], "velocity": [0, 0.7]},
      {"mass": 3, "position": [1, 1.5], "velocity": [0.4, -0.2]}, {"mass": 1, "position": [0.5, 0.5], "velocity": [1, 0]}]},
    "springs": [{"name": "strut", "nodes": [0, 2], "to": [1, 0], "stiffness": 5, "damping": 0.8, "length": 1.1},
      {"name": "rope", "nodes": [1], "anchor": [-1, 2], "stiffness": 3, "damping": 0.2}],
    "time": {"end": 1.5}, "interfaces": [],
    "output": {"every": 7, "watch": [0, 1, 2], "forces": ["strut", {"of": "rope", "about": [-1, 2]}]}})");
  for (const double h : {0.013, 0.007, 0.0023}) {
    scene["time"]["dt"] = h;
    const Ran run = ran(scene);
    Scene same = scene_of(scene);
    const Dofs start = integrator_of(same).velocity();
    for (int axis = 0; axis < 2; ++axis) {
      const std::string a = std::to_string(axis);
      const auto gained = [&](int node) {
        return same.model->mass()[2 * node] *
               (run.last("n" + std::to_string(node) + ".v" + a) - start[2 * node + axis]);
      };
      const double strut = run.impulse("strut.F" + a), rope = run.impulse("rope.F" + a);
      EXPECT_NEAR(gained(0) + gained(1) + gained(2), rope, 1e-13) << "axis " << axis << ", h " << h;
      // Springs 0-1 and 2-0 act on 0 and 2 as on their own: of the second, 0 has the opposite.
      EXPECT_NEAR(gained(1), rope - (strut - gained(2)), 1e-13) << "axis " << axis << ", h " << h;
      const auto all = [&](const char* name) {
        return run.summary["forces"][name]["impulse"][static_cast<std::size_t>(axis)].get<double>();
      };
      const auto gained_in_all = [&](int node) {
        return gained(node) + same.model->mass()[2 * node] *
                                  (start[2 * node + axis] - same.model->initial_velocity()[2 * node + axis]);
      };
      EXPECT_NEAR(gained_in_all(1), all("rope") - (all("strut") - gained_in_all(2)), 1e-13)
          << "h " << h << ", axis " << axis;
      EXPECT_GT(std::abs(strut) + std::abs(rope), 0.1) << "h " << h << ", axis " << axis;
    }
    for (const double moment : run["rope.M0"]) ASSERT_NEAR(moment, 0.0, 1e-14) << h;
  }
}

// A run that ends between two rows has told of all its steps.
TEST(Forces, BetweenRowsAreInTheSummary) {
  auto [scene, integrator] = simulation_of(R"({
    "model": {"type": "points", "dimension": 1, "points": [{"mass": 2, "position": [0]}]},
    "time": {"dt": 0.013, "end": 1}, "loads": [{"type": "gravity", "name": "weight", "acceleration": [-10]}],
    "interfaces": [], "output": {"every": 20, "forces": ["weight"]}})");
  Forces forces(scene, integrator);
  const double start = integrator.velocity()[0];
  for (int step = 0; step < 7; ++step) {
    integrator.step();
    forces.add_step(integrator);
  }
  EXPECT_NEAR(forces.summary()["weight"]["impulse"][0].get<double>(), 2 * (integrator.velocity()[0] - start),
              1e-14);
}

}  // namespace
}  // namespace ilaw::host::testing::forces
