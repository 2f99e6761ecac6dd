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

// A block in plane strain, all nodes held along y: its velocity along x falls as e^-15, at the default step
// and at the critical one.
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

// A floor carries the weight, whatever is damped: alone, with friction, and through a stack of light and
// heavy ones.
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
      "model": {"type": "points", "dimension": 1, "points": [{"mass": 2, "position": [0.02], "velocity": [-1]}]},
      "loads": [{"type": "damping", "name": "air", "rate": 20}, {"type": "damping", "name": "oil", "rate": 7}],
      "interfaces": [{"name": "wall", "law": "contact", "parameters": {"restitution": 0.5}, "nodes": "all",
        "obstacle": {"type": "plane", "point": [0], "normal": [1]}}],
      "output": {"watch": [0], "balance": true, "forces": ["wall", "air", "oil"]}})");
    scene["time"] = {{"dt", h}, {"end", 0.3}};
    const Ran run = ran(scene);
    for (std::size_t k = 1; k < run.history.at("time").size(); ++k) {
      const double force =
          run.history.at("wall.F0")[k] + run.history.at("air.F0")[k] + run.history.at("oil.F0")[k];
      EXPECT_NEAR(2.0 * (run.history.at("n0.v0")[k] - run.history.at("n0.v0")[k - 1]), h * force, 1e-14)
          << "h = " << h;
      if (run.history.at("wall.F0")[k] > 0.0) {
        EXPECT_NEAR(run.history.at("n0.v0")[k], -0.5 * run.history.at("n0.v0")[k - 1], 1e-15) << "h = " << h;
      }
    }
    EXPECT_GT(run.last("n0.v0"), 0.0) << "h = " << h;
    EXPECT_LT(run.summary["energy"]["balance_error"].get<double>(), 1e-14) << "h = " << h;
  }
}

// ---- driven nodes in interfaces -------------------------------------------------------------------------

// Half a block, its plane of symmetry driven along x alone, against the whole one: the same motion and
// energies.
TEST(Driven, HalfABlockMovesAsTheWholeOne) {
  struct Law {
    const char *name, *parameters;
  };
  for (const Law law :
       {Law{"contact", "{}"}, Law{"coulomb", R"({"friction": 0.3})"}, Law{"postit", R"({"friction": 0.2})"},
        Law{"tie", "{}"}, Law{"cohesive", R"({"strength": 3e4, "toughness": 20, "friction": 0.2})"}})
    for (const double cfl : {0.9, 0.999, 0.53}) {
      json whole = json::parse(R"({
        "model": {"type": "blocks", "blocks": [{"name": "b", "size": [2, 0.5, 0.5], "corner": [-1, 0, 0], "elements": [4, 1, 2], "velocity": [0, 0, -1],
          "material": {"type": "linear", "young": 1e7, "poisson": 0.3, "density": 1000}}]},
        "loads": [{"type": "gravity", "acceleration": [0, 0, -10]}, {"type": "damping", "rate": 40}],
        "interfaces": [{"name": "floor", "nodes": "b.z_min", "obstacle": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}}]})");
      whole["interfaces"][0]["law"] = law.name;
      whole["interfaces"][0]["parameters"] = json::parse(law.parameters);
      whole["time"] = {{"cfl", cfl}, {"end", 0.05}};
      json half = whole;
      json& block = half["model"]["blocks"][0];
      block["size"][0] = 1;
      block["corner"][0] = 0;
      block["elements"][0] = 2;
      half["loads"].push_back({{"type", "motion"}, {"nodes", "b.x_min"}, {"axes", {0}}});
      Scene all = scene_of(whole.dump()), part = scene_of(half.dump());
      Integrator one(*all.model, all.loads, all.interfaces, all.dt),
          other(*part.model, part.loads, part.interfaces, all.dt);
      for (std::int64_t k = 0; k < all.steps; ++k) {
        one.step();
        other.step();
      }
      const std::string at = std::string(law.name) + ", cfl " + number(cfl);
      double largest = 0.0, difference = 0.0;
      for (int node = 0; node < part.model->node_count(); ++node)
        for (int same = 0; same < all.model->node_count(); ++same) {
          const Eigen::Index d = 3, i = d * node, j = d * same;
          if ((part.model->position().segment(i, d) - all.model->position().segment(j, d)).norm() > 1e-9)
            continue;
          difference = std::max(
              difference, (other.displacement().segment(i, d) - one.displacement().segment(j, d)).norm());
          largest = std::max(largest, one.displacement().segment(j, d).norm());
        }
      EXPECT_LT(difference, 1e-10 * largest) << at;
      const EnergyReport a = one.energy(), b = other.energy();
      EXPECT_NEAR(2.0 * b.interface_work, a.interface_work, 1e-10 * a.scale) << at;
      EXPECT_NEAR(2.0 * b.by_law[ILAW_ENERGY_FRICTION], a.by_law[ILAW_ENERGY_FRICTION], 1e-10 * a.scale)
          << at;
      EXPECT_LT(b.balance_error, 1e-12) << at;
    }
}

// The shipped half: its floor carries half of what the whole block's carries, and both corners move alike.
// At rest that is the weight.
TEST(Driven, HalfOfTheShippedBlockMovesAsTheWhole) {
  for (const double cfl : {0.7, 0.53, 0.89}) {
    json scene = read_scene_source(scene_files::named("half_model.json"));
    scene["time"]["cfl"] = cfl;
    const Ran run = ran(scene);
    const std::size_t rows = run.history.at("time").size();
    double widest = 0.0;
    for (std::size_t k = 0; k < rows; ++k) {
      for (const char* axis : {"0", "2"}) {
        const double whole = run.history.at(std::string("n8.u") + axis)[k],
                     half = run.history.at(std::string("n229.u") + axis)[k];
        EXPECT_NEAR(half, whole, 1e-12) << axis << " at row " << k << ", cfl " << cfl;
        if (*axis == '0') widest = std::max(widest, whole);
      }
      EXPECT_NEAR(2.0 * run.history.at("floor_2.F2")[k], run.history.at("floor.F2")[k], 1e-9) << k;
    }
    EXPECT_GT(widest, 1e-3) << "the block widens";
    EXPECT_NEAR(run.last("floor.F2"), 1000.0 * 0.2 * 0.1 * 0.1 * 10.0, 1e-2) << cfl;
    EXPECT_LT(run.summary["energy"]["balance_error"].get<double>(), 1e-12) << cfl;
  }
}

// A node that is driven along x meets a facet whose nodes there are, too, but for a part of 1e-9: laws are
// given an H along x that they resolve.
TEST(Driven, NodeMayMeetAFacetThatIsNearlyDriven) {
  Scene scene = scene_of(R"({"model": {"type": "blocks", "blocks": [
      {"name": "a", "size": [1, 1, 1], "elements": [1, 1, 1], "material": {"type": "linear", "young": 1e6, "poisson": 0, "density": 1000}},
      {"name": "b", "corner": [1e-9, 0, 1], "size": [1, 1, 1], "elements": [1, 1, 1],
       "material": {"type": "linear", "young": 1e6, "poisson": 0, "density": 1000}}]},
    "time": {"cfl": 0.9, "end": 1.5},
    "loads": [{"type": "motion", "nodes": "a.x_min", "axes": [0]}, {"type": "motion", "nodes": "b.x_min", "axes": [0]},
      {"type": "motion", "nodes": "a.z_min"}, {"type": "damping", "rate": 60},
      {"type": "gravity", "acceleration": [0, 0, -10]}],
    "interfaces": [{"law": "coulomb", "parameters": {"friction": 0.3}, "nodes": "b.z_min", "against": {"surface": "a.z_max"}}]})");
  Integrator integrator = integrator_of(scene);
  integrator.start();
  while (integrator.steps() < scene.steps) integrator.step();
  const Dofs impulse = integrator.interface_impulse();
  double force = 0.0;
  for (const int node : scene.model->sets().at("b.z_min").nodes) force += impulse[3 * node + 2] / scene.dt;
  EXPECT_NEAR(force, 1000.0 * 10.0, 1e-3);
}

// A slope of 45 degrees that a driven point climbs: the load perpendicular to the drive gives N and F in
// closed form.
TEST(Driven, PointSlidesUpASlope) {
  for (const double h : steps) {
    json scene = json::parse(R"({
      "model": {"type": "points", "dimension": 2, "points": [{"mass": 2, "position": [0, 0]}]},
      "loads": [{"type": "motion", "name": "rod", "nodes": [0], "axes": [0], "velocity": [0.3, 0]},
                {"type": "gravity", "acceleration": [0, -10]}, {"type": "damping", "rate": 30}],
      "interfaces": [{"name": "slope", "law": "coulomb", "parameters": {"friction": 0.2}, "nodes": [0],
        "obstacle": {"type": "plane", "point": [0, 0], "normal": [-1, 1]}}],
      "output": {"forces": ["slope", "rod"], "balance": true}})");
    scene["time"] = {{"dt", h}, {"end", 1}};
    const Ran run = ran(scene);
    // Along y: (N - mu N)/sqrt 2 = m g + rate m v, and along x the rod holds -(N + mu N)/sqrt 2.
    const double lift = 20.0 + 30.0 * 2.0 * 0.3, push = lift * 1.2 / 0.8;
    EXPECT_NEAR(run.last("slope.F1"), lift, 1e-9) << "h = " << h;
    EXPECT_NEAR(run.last("slope.F0"), -push, 1e-9) << "h = " << h;
    EXPECT_NEAR(run.last("rod.F0"), push, 1e-9) << "h = " << h;
    EXPECT_LT(run.summary["energy"]["balance_error"].get<double>(), 1e-13) << "h = " << h;
  }
}

// A law that is rigid and driven along its normal ends the run with a reason.
TEST(Driven, AgainstARigidLawEndsTheRun) {
  json scene = json::parse(R"({
    "model": {"type": "points", "dimension": 2, "points": [{"mass": 2, "position": [0, 0.05]}]},
    "time": {"dt": 0.0037, "end": 0.1},
    "loads": [{"type": "motion", "nodes": [0], "axes": [1], "velocity": [0, -1]}],
    "interfaces": [{"name": "floor", "law": "contact", "nodes": [0],
      "obstacle": {"type": "plane", "point": [0, 0], "normal": [0, 1]}}],
    "output": {"watch": [0]}})");
  const auto folder = fresh_folder();
  const auto run = [&] {
    std::ofstream(folder / "scene.json") << scene.dump();
    return run_program("run " + (folder / "scene.json").string() + " --out " + folder.string());
  };
  const Outcome rigid = run();
  EXPECT_EQ(rigid.code, 1) << rigid.output;
  EXPECT_NE(rigid.output.find(
                "node 0 is driven along axis 1 against 'floor' (law 'contact'), which cannot give way"),
            std::string::npos)
      << rigid.output;
  scene["interfaces"][0]["law"] = "penalty";
  scene["interfaces"][0]["parameters"] = {{"stiffness", 1e6}};
  const Outcome soft = run();
  EXPECT_EQ(soft.code, 0) << soft.output;
  std::filesystem::remove_all(folder);
}

// Nothing is left to solve where nodes on both sides are driven along all axes.
TEST(Driven, AlongAllAxesOnBothSidesIsRefused) {
  json scene = json::parse(R"({
    "model": {"type": "points", "dimension": 2, "points": [{"mass": 2, "position": [0, 0.05]}, {"mass": 2, "position": [0, 0]}]},
    "time": {"dt": 0.0037, "end": 0.1},
    "loads": [{"type": "motion", "nodes": [0], "velocity": [0, -1]}],
    "interfaces": [{"name": "pair", "law": "contact", "nodes": [0], "against": {"nodes": [1], "normal": [0, 1]}}]})");
  EXPECT_EQ(refusal_of_scene(scene), "not refused");
  scene["loads"].push_back({{"type", "motion"}, {"nodes", {1}}});
  EXPECT_EQ(
      refusal_of_scene(scene),
      "/interfaces/0/nodes: found node 0, which a motion drives along all axes, expected a node that is free along "
      "one axis, or that meets one that is");
}

// ---- meshes that do not match ---------------------------------------------------------------------------

// Two equal blocks without lateral strain, 5x5 on 3x3 elements, that meet at full speed: a plane wave runs
// into each. Impulses of the interface over area and step at the nodes of a face, over rho c v.
struct Pressures {
  double least, largest;
};
Pressures pressures_of_a_plane_wave(bool both_sides) {
  json scene = json::parse(R"({"model": {"type": "blocks", "blocks": [
      {"name": "a", "size": [1, 1, 0.5], "elements": [3, 3, 10], "velocity": [0, 0, 1],
       "material": {"type": "linear", "young": 1, "poisson": 0, "density": 1}},
      {"name": "b", "corner": [0, 0, 0.5], "size": [1, 1, 0.5], "elements": [5, 5, 10], "velocity": [0, 0, -1],
       "material": {"type": "linear", "young": 1, "poisson": 0, "density": 1}}]},
    "time": {"dt": 0.04, "end": 0.2},
    "interfaces": [{"law": "contact", "nodes": "b.z_min", "against": {"surface": "a.z_max"}}]})");
  if (both_sides) scene["interfaces"][0]["against"]["both_sides"] = true;
  Scene read = read_scene(scene, "waves.json");
  Integrator integrator = integrator_of(read);
  integrator.start();
  Dofs impulse = integrator.interface_impulse();
  while (integrator.steps() < read.steps) {
    integrator.step();
    impulse += integrator.interface_impulse();
  }
  EXPECT_EQ(integrator.tally().unconverged, 0);
  EXPECT_LE(integrator.energy().balance_error, 1e-12);
  const NodeSet& face = read.model->sets().at("b.z_min");
  Pressures pressures{1e300, 0.0};
  for (std::size_t k = 0; k < face.nodes.size(); ++k) {
    const double pressure = impulse[3 * face.nodes[k] + 2] / face.areas[k];
    pressures.least = std::min(pressures.least, pressure);
    pressures.largest = std::max(pressures.largest, pressure);
  }
  return pressures;
}

// The patch test: nodes that share their facets' impulses by weights alone do not bear a uniform pressure.
TEST(NonMatchingMeshes, BearAUniformPressureFromBothSides) {
  setenv("ILAW_PATH", ILAW_PLUGIN_FOLDER, 1);
  const Pressures both = pressures_of_a_plane_wave(true), one = pressures_of_a_plane_wave(false);
  EXPECT_NEAR(both.least / both.largest, 1.0, 1e-12) << both.largest;
  EXPECT_NEAR(one.least / one.largest, 0.812, 0.001) << "one side alone fails it";
  EXPECT_GT(both.least, 0.0);
}

// A block on another with a different mesh, in contact from both sides, under a pressure that grows until
// 0.2.
Scene pressed_blocks(const json& low, const json& high, double end) {
  setenv("ILAW_PATH", ILAW_PLUGIN_FOLDER, 1);
  json scene = json::parse(R"({"model": {"type": "blocks", "blocks": [
      {"name": "a", "size": [1, 1, 0.5], "material": {"type": "linear", "young": 1e6, "poisson": 0.3, "density": 1000}},
      {"name": "b", "corner": [0, 0, 0.5], "size": [1, 1, 0.5],
       "material": {"type": "linear", "young": 1e6, "poisson": 0.3, "density": 1000}}]},
    "time": {"cfl": 0.9},
    "loads": [{"type": "motion", "nodes": "a.z_min", "axes": [2]}, {"type": "damping", "rate": 60},
      {"type": "pressure", "surface": "b.z_max", "history": {"rows": [[0, 0], [0.2, 1000]], "smooth": true}}],
    "interfaces": [{"law": "contact", "nodes": "b.z_min", "against": {"surface": "a.z_max", "both_sides": true}}]})");
  scene["model"]["blocks"][0]["elements"] = low;
  scene["model"]["blocks"][1]["elements"] = high;
  scene["time"]["end"] = end;
  return read_scene(scene, "pressed.json");
}

// Contacts of both sides are redundant, and their gaps differ by rounding: below that there is no better
// solution, for which iterations would creep. A pressure with lateral strain comes to rest.
TEST(NonMatchingMeshes, AreSolvedToTheRoundingOfTheirGaps) {
  Scene read = pressed_blocks({3, 3, 2}, {5, 5, 2}, 0.8);
  Integrator integrator = integrator_of(read);
  integrator.start();
  while (integrator.steps() < read.steps) integrator.step();
  EXPECT_EQ(integrator.tally().unconverged, 0);
  EXPECT_LT(integrator.tally().sweeps_max, 300) << "iterations crept";
  const Dofs impulse = integrator.interface_impulse();
  const NodeSet& face = read.model->sets().at("b.z_min");
  double sum = 0.0;
  for (const int node : face.nodes) sum += impulse[3 * node + 2];
  EXPECT_NEAR(sum / read.dt, 1000.0, 1.0);  // the loaded face has grown by 2 * 0.3 * 1e-3
  for (std::size_t k = 0; k < face.nodes.size(); ++k)
    EXPECT_NEAR(impulse[3 * face.nodes[k] + 2] / (face.areas[k] * sum), 1.0, 1e-8) << "node " << k;
}

// While a load grows, faces are not quite flat: redundant contacts contradict each other by rounding, and
// iterations alone would creep until one of them opens.
TEST(NonMatchingMeshes, AreSolvedWhileALoadGrows) {
  Scene read = pressed_blocks({6, 6, 3}, {10, 10, 5}, 0.1);
  Integrator integrator = integrator_of(read);
  integrator.start();
  while (integrator.steps() < read.steps) integrator.step();
  EXPECT_EQ(integrator.tally().unconverged, 0);
  EXPECT_LE(integrator.energy().balance_error, 1e-12);
}

// Each side has half of the areas: a bond keeps its strength. The scene may be read again.
TEST(NonMatchingMeshes, ShareAreasBetweenBothSides) {
  setenv("ILAW_PATH", ILAW_PLUGIN_FOLDER, 1);
  json scene = json::parse(R"({"model": {"type": "blocks", "blocks": [
      {"name": "a", "size": [1, 1, 1], "elements": [2, 2, 1], "material": {"type": "linear", "young": 1, "poisson": 0, "density": 1}},
      {"name": "b", "corner": [0, 0, 1], "size": [1, 1, 1], "elements": [3, 3, 1], "material": {"type": "linear", "young": 1, "poisson": 0, "density": 1}}]},
    "time": {"cfl": 0.5, "end": 0.1},
    "interfaces": [{"name": "glue", "law": "contact", "nodes": "b.z_min", "against": {"surface": "a.z_max", "both_sides": true}}]})");
  for (int time = 0; time < 2; ++time) {
    const Scene one = read_scene(scene, "glue.json");
    scene = one.source;
    ASSERT_EQ(one.interfaces.size(), 2U);
    EXPECT_EQ(one.interfaces[1]->name(), "glue, other side");
    for (const auto& interface : one.interfaces) {
      double area = 0.0;
      for (const double part : interface->setup().areas) area += part;
      EXPECT_NEAR(area, 0.5, 1e-15) << interface->name();
    }
  }
}

TEST(NonMatchingMeshes, AskForTwoFaces) {
  json scene = json::parse(R"({"model": {"type": "blocks", "blocks": [
      {"name": "a", "size": [1, 1, 1], "elements": [1, 1, 1], "material": {"type": "linear", "young": 1, "poisson": 0, "density": 1}},
      {"name": "b", "corner": [0, 0, 1], "size": [1, 1, 1], "elements": [1, 1, 1], "material": {"type": "linear", "young": 1, "poisson": 0, "density": 1}}]},
    "time": {"cfl": 0.5, "end": 0.1},
    "interfaces": [{"law": "contact", "nodes": "b.z_min", "against": {"surface": "a.z_max", "both_sides": true}}]})");
  EXPECT_EQ(refusal_of_scene(scene), "not refused");
  scene["interfaces"][0]["nodes"] = {8, 9};
  EXPECT_EQ(refusal_of_scene(scene),
            "/interfaces/0/nodes: found a list, expected a surface, which its other side meets");
}

// The shipped patch test: all nodes bear p times their area from both sides. The loaded face grows by the
// lateral strain, so that p = 1000 (1 + 0.3 p/E)^2.
TEST(NonMatchingMeshes, PassThePatchTestThatIsShipped) {
  setenv("ILAW_PATH", ILAW_PLUGIN_FOLDER, 1);
  double pressure = 1000.0;
  for (int k = 0; k < 20; ++k) pressure = 1000.0 * std::pow(1.0 + 0.3e-6 * pressure, 2);
  for (const double cfl : {0.9, 0.71, 0.999}) {
    json source = read_scene_source(scene_files::named("patch_test.json"));
    source["time"]["cfl"] = cfl;
    Scene scene = read_scene(source, "patch_test.json");
    Integrator integrator = integrator_of(scene);
    integrator.start();
    while (integrator.steps() < scene.steps) integrator.step();
    EXPECT_EQ(integrator.tally().unconverged, 0) << cfl;
    const Dofs impulse = integrator.interface_impulse();
    for (const char* name : {"high.z_min", "low.z_max"}) {
      const NodeSet& face = scene.model->sets().at(name);
      for (std::size_t k = 0; k < face.nodes.size(); ++k)
        EXPECT_NEAR(std::abs(impulse[3 * face.nodes[k] + 2]) / (face.areas[k] * scene.dt * pressure), 1.0,
                    1e-7)
            << name << " " << k << ", cfl " << cfl;
    }
    double least = 1e300, largest = 0.0;
    for (const char* name : {"high_2.z_min", "low_2.z_max"}) {
      const NodeSet& face = scene.model->sets().at(name);
      for (std::size_t k = 0; k < face.nodes.size(); ++k) {
        const double share = std::abs(impulse[3 * face.nodes[k] + 2]) / (face.areas[k] * scene.dt * pressure);
        least = std::min(least, share);
        largest = std::max(largest, share);
      }
    }
    EXPECT_LT(least, 0.9) << "one side alone fails it, cfl " << cfl;
    EXPECT_GT(largest, 1.05) << cfl;
    for (const int node : scene.model->sets().at("high.z_max").nodes)
      EXPECT_NEAR(integrator.displacement()[3 * node + 2], -1e-6 * pressure, 1e-11) << cfl;
  }
}

// An implicit spring keeps its depth: it closes within the distance of a step of the wall, and is compressed
// by no more than the energy of the bar allows, however often it opens.
TEST(ImplicitSpring, ClosesAtItsDepthImpactAfterImpact) {
  constexpr double stiffness = 2000.0, speed = 0.05;
  for (const double cfl : {0.999, 0.7, 0.53}) {
    json scene = json::parse(R"({
      "model": {"type": "bars", "bars": [{"name": "bar", "length": 1, "elements": 20, "young": 1, "density": 1, "velocity": -0.05}]},
      "interfaces": [{"law": "penalty", "nodes": "bar.left", "obstacle": {"type": "plane", "point": [0], "normal": [1]}},
                     {"law": "penalty", "nodes": "bar.right", "obstacle": {"type": "plane", "point": [1], "normal": [-1]}}]})");
    for (json& interface : scene["interfaces"])
      interface["parameters"] = {{"stiffness", stiffness}, {"integration", "implicit"}};
    scene["time"] = {{"cfl", cfl}, {"end", 400}};
    Scene read = scene_of(scene.dump());
    Integrator integrator = integrator_of(read);
    integrator.start();
    double deepest = 0.0, fastest = 0.0;
    while (integrator.steps() < read.steps) {
      integrator.step();
      deepest = std::max({deepest, -integrator.displacement()[0], integrator.displacement()[20]});
      fastest = std::max({fastest, std::abs(integrator.velocity()[0]), std::abs(integrator.velocity()[20])});
    }
    const double compressed = speed / std::sqrt(stiffness);  // k x^2/2 = m v^2/2
    EXPECT_GT(deepest, compressed) << cfl;
    EXPECT_LE(deepest, read.dt * fastest + compressed) << cfl;
  }
}

// With e < 1 a bar that settles on its floor stays at its depth: what restitution takes off the indentation
// is given back while the spring stays closed. Without that a spring of ten elements is 0.3 elements deep.
TEST(ImplicitSpring, StaysAtItsDepthUnderABarThatSettles) {
  constexpr double speed = 0.05, gravity = 0.01, element = 0.05;
  for (const double stiffness : {200.0, 2000.0})
    for (const double restitution : {0.0, 0.5})
      for (const double cfl : {0.98, 0.7, 0.53}) {
        json scene = json::parse(R"({
          "model": {"type": "bars", "bars": [{"name": "bar", "length": 1, "elements": 20, "young": 1, "density": 1, "velocity": -0.05}]},
          "loads": [{"type": "gravity", "acceleration": [-0.01]}],
          "interfaces": [{"law": "penalty", "nodes": "bar.left", "obstacle": {"type": "plane", "point": [0], "normal": [1]}}]})");
        scene["interfaces"][0]["parameters"] = {
            {"stiffness", stiffness}, {"integration", "implicit"}, {"restitution", restitution}};
        scene["time"] = {{"cfl", cfl}, {"end", 40000 * cfl * element}};
        Scene read = scene_of(scene.dump());
        Integrator integrator = integrator_of(read);
        integrator.start();
        double deepest = 0.0, late = 0.0, fastest = 0.0;
        while (integrator.steps() < read.steps) {
          integrator.step();
          const double depth = -integrator.displacement()[0];
          deepest = std::max(deepest, depth);
          fastest = std::max(fastest, std::abs(integrator.velocity()[0]));
          if (2 * integrator.steps() > read.steps) late = std::max(late, depth);
        }
        const std::string at = "k " + std::to_string(stiffness) + ", e " + std::to_string(restitution) +
                               ", cfl " + std::to_string(cfl);
        const double compressed = speed / std::sqrt(stiffness) + gravity / stiffness;
        EXPECT_LE(deepest, read.dt * fastest + compressed) << at;
        EXPECT_LE(late, 0.15 * element) << at;
        EXPECT_LE(integrator.energy().balance_error, 1e-12) << at;
      }
}

// ---- the start ------------------------------------------------------------------------------------------

json resting_point(const std::string& law, const json& parameters, double h) {
  json scene = json::parse(R"({
    "model": {"type": "points", "dimension": 2, "points": [{"mass": 1, "position": [0, 0]}]},
    "loads": [{"type": "gravity", "name": "weight", "acceleration": [0, -10]}],
    "interfaces": [{"name": "floor", "nodes": [0], "obstacle": {"type": "plane", "point": [0, 0], "normal": [0, 1]}}],
    "output": {"watch": [0], "forces": ["floor", "weight"], "events": true}})");
  scene["interfaces"][0]["law"] = law;
  scene["interfaces"][0]["parameters"] = parameters;
  scene["time"] = {{"dt", h}, {"end", 0.2}};
  return scene;
}

// A point at rest on a floor stays where it is, under its weight from time 0 on, whatever the rigid law and
// step.
TEST(Start, LeavesABodyAtRestOnItsFloor) {
  for (const auto& [law, parameters] :
       {std::pair{"contact", json::object()}, std::pair{"coulomb", json{{"friction", 0.3}}},
        std::pair{"tie", json::object()}, std::pair{"postit", json::object()},
        std::pair{"cohesive", json{{"strength", 50}, {"toughness", 10}}}})
    for (const double h : steps) {
      const Ran run = ran(resting_point(law, parameters, h));
      const std::string at = std::string(law) + ", h = " + number(h);
      for (const double u : run.history.at("n0.u1")) EXPECT_NEAR(u, 0.0, 1e-16) << at;
      for (const double force : run.history.at("floor.F1")) EXPECT_NEAR(force, 10.0, 1e-12) << at;
      EXPECT_NEAR(run.summary["forces"]["floor"]["largest"].get<double>(), 10.0, 1e-12) << at;
      // From V_0 = 0 to V_{n+1/2} = 0.
      const double held = run.summary["forces"]["floor"]["impulse"][1].get<double>(),
                   given = run.summary["forces"]["weight"]["impulse"][1].get<double>();
      EXPECT_NEAR(held, 10.0 * (run.last("time") + 0.5 * h), 1e-12) << at;
      EXPECT_NEAR(held + given, 0.0, 1e-12) << at;
      EXPECT_LT(run.summary["energy"]["balance_error"].get<double>(), 1e-12) << at;
      EXPECT_TRUE(run.summary["warnings"].empty()) << at << run.summary["warnings"].dump();
      EXPECT_NE(run.events.find("\n0,0,floor,contact"), std::string::npos) << at << ": " << run.events;
    }
}

// Gaps and overlaps at the start count as touching: points at different heights rest where they are, alone
// and where they share a partner.
TEST(Start, LeavesBodiesThatTouchAcrossTheirInitialGaps) {
  for (const double h : steps)
    for (const bool shares : {false, true}) {
      json scene = resting_point("contact", json::object(), h);
      scene["model"]["points"] = {{{"mass", 1}, {"position", {0, 0.1}}},
                                  {{"mass", 1}, {"position", {1, -0.2}}}};
      scene["interfaces"][0]["nodes"] = {0, 1};
      scene["interfaces"][0]["gap_offset"] = "initial";
      if (shares) {
        json again = scene["interfaces"][0];
        again["name"] = "again";
        scene["interfaces"].push_back(again);
      }
      const Ran run = ran(scene);
      const std::string at = (shares ? "shared, h = " : "h = ") + number(h);
      for (const double u : run.history.at("n0.u1")) EXPECT_NEAR(u, 0.0, 1e-15) << at;
      if (!shares) {
        for (const double gap : run.history.at("n0.gap")) EXPECT_NEAR(gap, 0.0, 1e-15) << at;
      }
      EXPECT_NEAR(run.last("weight.F1"), -20.0, 1e-12) << at;
      if (!shares) {
        EXPECT_NEAR(run.last("floor.F1"), 20.0, 1e-12) << at;
      }
      EXPECT_EQ(run.summary["penetration_max"].get<double>(), 0.0) << at;
      EXPECT_TRUE(run.summary["warnings"].empty()) << at << run.summary["warnings"].dump();
    }
}

// A bond holds below its strength from the start, and breaks above.
TEST(Start, BondHoldsUpToItsStrength) {
  for (const double h : steps)
    for (const double part : {0.9, 0.99, 1.01}) {
      json cohesive = resting_point("cohesive", {{"strength", 10.0 / part}, {"toughness", 1e-4}}, h);
      json tie = resting_point("tie", {{"strength", 10.0 * 0.05 / part}, {"memory", 0.05}}, h);
      for (json* scene : {&cohesive, &tie}) {
        (*scene)["loads"][0]["acceleration"] = {0, 10};
        const Ran run = ran(*scene);
        const std::string at =
            (*scene)["interfaces"][0]["law"].dump() + " at " + number(part) + ", h = " + number(h);
        if (part < 1.0)
          EXPECT_NEAR(run.last("n0.u1"), 0.0, 1e-15) << at;
        else
          EXPECT_GT(run.last("n0.u1"), 1e-3) << at;
      }
    }
}

// Impacts at time 0 from a gap of 0 are exact: the body turns at once, and never enters.
TEST(Start, ImpactsAtAGapOfZeroAreExact) {
  for (const char* activation : {"predictive", "moreau"})
    for (const double e : {0.0, 0.5, 1.0})
      for (const double h : steps) {
        json scene = resting_point("contact", {{"restitution", e}, {"activation", activation}}, h);
        scene["loads"] = json::array();
        scene["output"]["forces"] = {"floor"};
        scene["model"]["points"][0]["velocity"] = {0, -1};
        const Ran run = ran(scene);
        for (std::size_t k = 0; k < run.history.at("time").size(); ++k)
          EXPECT_NEAR(run.history.at("n0.u1")[k], e * run.history.at("time")[k], 1e-15)
              << activation << ", e = " << e << ", h = " << h;
        EXPECT_NEAR(run.summary["energy"]["dissipated_impact"].get<double>(), 0.5 * (1.0 - e * e), 1e-15);
        EXPECT_NEAR(run.summary["forces"]["floor"]["impulse"][1].get<double>(), 1.0 + e, 1e-15);
        EXPECT_LT(run.summary["energy"]["balance_error"].get<double>(), 1e-15);
      }
}

// A floor that moves from time 0 on takes a body along that rides on it, at any restitution: it makes no
// impact.
TEST(Start, MovingFloorCarriesItsBody) {
  for (const double e : {0.0, 1.0})
    for (const double h : steps) {
      json scene = resting_point("contact", {{"restitution", e}}, h);
      scene["model"]["points"][0]["velocity"] = {0, 0.3};
      scene["interfaces"][0]["obstacle"]["velocity"] = {0, 0.3};
      const Ran run = ran(scene);
      for (std::size_t k = 0; k < run.history.at("time").size(); ++k)
        EXPECT_NEAR(run.history.at("n0.u1")[k], 0.3 * run.history.at("time")[k], 1e-15)
            << "e = " << e << ", h = " << h;
      EXPECT_NEAR(run.summary["forces"]["floor"]["largest"].get<double>(), 10.0, 1e-15 / (h * h))
          << "e = " << e << ", h = " << h;
    }
}

// A fault that ends a run does so at time 0, too.
TEST(Start, FailsAsAnyStepDoes) {
  json scene = resting_point("contact", json::object(), 1e-2);
  scene["loads"] = json::parse(R"([{"type": "motion", "nodes": [0], "axes": [1], "velocity": [0, -1]}])");
  scene["output"]["forces"] = {"floor"};
  const auto folder = fresh_folder();
  std::ofstream(folder / "scene.json") << scene.dump();
  const Outcome outcome =
      run_program("run " + (folder / "scene.json").string() + " --out " + folder.string());
  EXPECT_EQ(outcome.code, 1) << outcome.output;
  EXPECT_NE(outcome.output.find("failed after step 0, time 0: node 0 is driven along axis 1 against 'floor'"),
            std::string::npos)
      << outcome.output;
  std::filesystem::remove_all(folder);
}

// ---- the border of a surface ----------------------------------------------------------------------------

// Two equal stacked blocks; the lower one goes aside and back by a part of its width, then all rests again.
json moved_stack(double aside) {
  json scene = json::parse(R"({
    "model": {"type": "blocks", "blocks": [
      {"name": "low", "size": [1, 1, 1], "elements": [4, 4, 2], "material": {"type": "linear", "young": 1e6, "poisson": 0, "density": 1000}},
      {"name": "high", "corner": [0, 0, 1], "size": [1, 1, 1], "elements": [4, 4, 2], "material": {"type": "linear", "young": 1e6, "poisson": 0, "density": 1000}}]},
    "time": {"cfl": 0.7, "end": 1},
    "loads": [{"type": "damping", "rate": 60}, {"type": "gravity", "nodes": "high", "acceleration": [0, 0, -10]},
      {"type": "motion", "nodes": "low.z_min", "axes": [0, 1, 2]},
      {"type": "motion", "nodes": "high.z_max", "axes": [0, 1]}],
    "interfaces": [{"name": "joint", "law": "contact", "nodes": "high.z_min", "against": {"surface": "low.z_max"}}],
    "output": {"every": 5, "watch": ["high.z_min"], "forces": ["joint"]}})");
  scene["loads"][2]["path"] = {{0, 0, 0, 0}, {0.3, aside, 0, 0}, {0.6, 0, 0, 0}};
  return scene;
}

// All nodes stay on the surface, where only rounding or a small motion says that they left it.
TEST(Border, HoldsAStackThatMovesALittle) {
  for (const double aside : {1e-6, 1e-3, 1e-2}) {
    const Ran run = ran(moved_stack(aside));
    double least = 0.0;
    for (const auto& [name, column] : run.history)
      if (name.ends_with(".gap")) least = std::min(least, column.back());
    EXPECT_GT(least, -1e-9 - 0.3 * aside * aside) << aside;
    EXPECT_NEAR(run.last("joint.F2"), 10000.0, 1.0) << aside;
    EXPECT_TRUE(run.summary["warnings"].empty()) << aside << ": " << run.summary["warnings"].dump();
  }
}

// Nodes that go over the border while they touch are told of.
TEST(Border, WarnsOfNodesThatLeaveIt) {
  const Ran run = ran(moved_stack(0.1));
  ASSERT_EQ(run.summary["warnings"].size(), 1U) << run.summary["warnings"].dump();
  EXPECT_NE(run.summary["warnings"][0].get<std::string>().find("went over the border of a surface"),
            std::string::npos);
}

// A block that falls past another with a side clearance of 0.03 edges is not caught.
TEST(Border, DoesNotCatchWhatFallsPast) {
  json scene = moved_stack(0.0);
  scene["model"]["blocks"][1]["corner"] = {1.0075, 0, 1.2};
  scene["model"]["blocks"][1]["velocity"] = {0, 0, -1};
  scene["loads"].erase(3);
  scene["loads"].erase(0);
  scene["time"] = {{"cfl", 0.2}, {"end", 0.4}};
  const Ran run = ran(scene);
  EXPECT_EQ(run.summary["forces"]["joint"]["impulse"][2].get<double>(), 0.0);
}

// The facets touched in the last step are part of a checkpoint: a stack on the border goes on to the same
// bits.
TEST(Border, IsTheSameAfterACheckpoint) {
  json source = moved_stack(1e-2);
  source["time"]["end"] = 0.35;
  Scene whole = scene_of(source.dump()), part = scene_of(source.dump());
  Integrator one = integrator_of(whole);
  while (one.steps() < whole.steps / 2) one.step();
  std::stringstream checkpoint;
  one.save(checkpoint);
  Integrator other = integrator_of(part);
  other.load(checkpoint);
  while (one.steps() < whole.steps) {
    one.step();
    other.step();
  }
  EXPECT_EQ(one.displacement(), other.displacement());
  EXPECT_EQ(one.velocity(), other.velocity());
}

// ---- instability ----------------------------------------------------------------------------------------

// A block far beyond its critical step ends the run with a reason, soon; at the critical one it does not.
TEST(Instability, EndsTheRunWithAReason) {
  const auto folder = fresh_folder();
  const auto run = [&](double part) {
    json scene = json::parse(R"({
      "model": {"type": "blocks", "blocks": [{"name": "b", "size": [1, 1, 1], "corner": [0, 0, 0.01], "elements": [3, 3, 3], "velocity": [0, 0, -1],
        "material": {"type": "linear", "young": 1e6, "poisson": 0.3, "density": 1000}}]},
      "interfaces": [{"law": "contact", "nodes": "b.z_min", "obstacle": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}}]})");
    const Scene read = [&] {
      scene["time"] = {{"cfl", 1}, {"end", 1}};
      return scene_of(scene.dump());
    }();
    scene["time"] = {{"dt", part * read.dt}, {"end", 200 * read.dt}};
    std::ofstream(folder / "scene.json") << scene.dump();
    return run_program("run " + (folder / "scene.json").string() + " --out " + folder.string());
  };
  for (const double part : {1.8, 1.4}) {
    const Outcome outcome = run(part);
    EXPECT_EQ(outcome.code, 1) << part << ": " << outcome.output;
    EXPECT_NE(outcome.output.find("the motion diverged: the kinetic energy is "), std::string::npos)
        << outcome.output;
    EXPECT_NE(outcome.output.find("the critical step is "), std::string::npos) << outcome.output;
  }
  for (const double part : {1.0, 0.999, 0.7}) {
    const Outcome outcome = run(part);
    EXPECT_EQ(outcome.code, 0) << part << ": " << outcome.output;
  }
  std::filesystem::remove_all(folder);
}

// A spring that is too stiff for the step is told of at its first contact, once.
TEST(Instability, OfASpringIsToldAtItsFirstContact) {
  json scene = resting_point("penalty", {{"stiffness", 1e6}}, 1e-2);
  scene["model"]["points"][0]["position"] = {0, 0.05};
  const auto folder = fresh_folder();
  std::ofstream(folder / "scene.json") << scene.dump();
  const Outcome outcome =
      run_program("run " + (folder / "scene.json").string() + " --out " + folder.string());
  EXPECT_NE(outcome.output.find(": the time step is 0.01, where a law is stable up to 0.002 at its nodes"),
            std::string::npos)
      << outcome.output;
  EXPECT_EQ(outcome.output.find("the time step is"), outcome.output.rfind("the time step is"))
      << outcome.output;
  std::filesystem::remove_all(folder);
}

// ---- tables, and what the summary says ------------------------------------------------------------------

// Gravity and damping over time: a point settles on a spring, and is let go.
TEST(History, ScalesGravityAndDamping) {
  for (const double h : steps) {
    json scene = json::parse(R"({
      "model": {"type": "points", "dimension": 1, "points": [{"mass": 2, "position": [0], "stiffness": [200]}]},
      "loads": [{"type": "gravity", "acceleration": [-10], "history": [[0, 0], [0.5, 1], [4, 1], [4.001, 0]]},
                {"type": "damping", "rate": 20, "history": {"rows": [[0, 1], [3.9, 1], [4, 0]], "smooth": true}}],
      "interfaces": [], "output": {"watch": [0]}})");
    scene["time"] = {{"dt", h}, {"end", 6}};
    const Ran run = ran(scene);
    double least = 0.0, most = -1.0;
    for (std::size_t k = 0; k < run.history.at("time").size(); ++k) {
      const double time = run.history.at("time")[k], u = run.history.at("n0.u0")[k];
      if (time > 3.0 && time < 3.99) {
        EXPECT_NEAR(u, -0.1, 1e-8) << "h = " << h;
      }
      if (time < 4.1) continue;
      least = std::min(least, u);
      most = std::max(most, u);
    }
    EXPECT_NEAR(least, -0.1, 2e-3) << "h = " << h;
    EXPECT_NEAR(most, 0.1, 2e-3) << "h = " << h;
  }
}

// A floor carries weight and a varying damping alike.
TEST(History, OfDampingReachesTheLaws) {
  for (const double h : steps) {
    json scene = resting_point("contact", json::object(), h);
    scene["loads"].push_back(
        {{"type", "damping"}, {"rate", 300}, {"history", {{0, 0}, {0.1, 1}, {0.15, 0.3}}}});
    const Ran run = ran(scene);
    for (const double force : run.history.at("floor.F1")) EXPECT_NEAR(force, 10.0, 1e-12) << "h = " << h;
  }
}

TEST(Table, IsSmoothBetweenItsRowsOrASine) {
  const Table smooth({1.0, 3.0}, {Vector::Constant(1, 2.0), Vector::Constant(1, 6.0)}, true);
  EXPECT_EQ(smooth.at(0.0)[0], 2.0);
  EXPECT_EQ(smooth.at(2.0)[0], 4.0);
  EXPECT_EQ(smooth.at(5.0)[0], 6.0);
  for (const double at : {1.0, 3.0}) EXPECT_NEAR(smooth.at(at + 1e-4)[0], smooth.at(at - 1e-4)[0], 1e-11);
  const Table sine(Sine{Vector::Constant(1, 1.0), Vector::Constant(1, 3.0), 0.5, 0.1});
  EXPECT_NEAR(sine.at(0.3)[0], 1.0 + 3.0 * std::sin(0.3 * 3.14159265358979323846 + 0.1), 1e-15);
}

TEST(History, TakesASineAndRefusesOneOfDamping) {
  json scene = resting_point("contact", json::object(), 1e-2);
  scene["loads"].push_back({{"type", "force"},
                            {"name", "shaker"},
                            {"nodes", {0}},
                            {"direction", {1, 0}},
                            {"history", {{"sine", {{"amplitude", 3}, {"frequency", 5}}}}}});
  scene["output"]["forces"].push_back("shaker");
  const Ran run = ran(scene);
  for (std::size_t k = 0; k < run.history.at("time").size(); ++k)
    EXPECT_NEAR(run.history.at("shaker.F0")[k],
                3.0 * std::sin(10.0 * 3.14159265358979323846 * run.history.at("time")[k]), 1e-12);
  scene["loads"].back() = {
      {"type", "damping"}, {"rate", 1}, {"history", {{"sine", {{"amplitude", 3}, {"frequency", 5}}}}}};
  scene["output"]["forces"] = {"floor"};
  EXPECT_EQ(refusal_of_scene(scene), "/loads/1/history: found a sine, expected rows: a rate is not negative");
}

// The summary has the time of the first contact and of the largest force, and the history the mean velocity.
TEST(Summary, HasFirstContactAndTheTimeOfThePeak) {
  json scene = resting_point("contact", json::object(), 1e-3);
  scene["model"]["points"][0]["position"] = {0, 0.05};
  scene["output"]["mean_velocity"] = true;
  const Ran run = ran(scene);
  const double fall = std::sqrt(2 * 0.05 / 10);
  EXPECT_NEAR(run.summary["interfaces"][0]["first_contact"].get<double>(), fall, 2e-3);
  EXPECT_NEAR(run.summary["forces"]["floor"]["largest_at"].get<double>(), fall, 2e-3);
  for (std::size_t k = 1; k < run.history.at("time").size(); ++k)
    EXPECT_EQ(run.history.at("n0.vm1")[k],
              0.5 * (run.history.at("n0.v1")[k - 1] + run.history.at("n0.v1")[k]));
  scene["time"]["end"] = 0.01;
  EXPECT_TRUE(ran(scene).summary["interfaces"][0]["first_contact"].is_null());
}

// At rest the floor carries the weight, friction holds what the plane of symmetry does, and then it is
// shaken.
TEST(SettledStack, RestsOnItsFloorAndIsShaken) {
  for (const double cfl : {0.9, 0.71, 0.999}) {
    json scene = read_scene_source(scene_files::named("settled_stack.json"));
    scene["time"]["cfl"] = cfl;
    const Ran run = ran(scene);
    double largest = 0.0;
    for (std::size_t k = 0; k < run.history.at("time").size(); ++k) {
      const double time = run.history.at("time")[k];
      if (time > 1.0) largest = std::max(largest, run.history.at("floor.F2")[k]);
      if (time < 0.8 || time > 0.9) continue;
      EXPECT_NEAR(run.history.at("floor.F2")[k], 2080.0, 1e-2) << cfl;
      EXPECT_NEAR(run.history.at("joint.F2")[k], 1280.0, 1e-2) << cfl;
      EXPECT_NEAR(run.history.at("floor.F0")[k], -run.history.at("symmetry_plane.F0")[k], 1e-2) << cfl;
    }
    EXPECT_GT(largest, 2080.0 + 400.0) << cfl;
    EXPECT_LT(run.summary["energy"]["balance_error"].get<double>(), 1e-13) << cfl;
  }
}

}  // namespace
}  // namespace ilaw::host::testing
