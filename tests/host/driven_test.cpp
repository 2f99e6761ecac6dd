// Driven nodes in interfaces, and steps that are too large.
#include "run_result.hpp"

namespace ilaw::host::testing::driven {
namespace {

// Half a block, its plane of symmetry driven along x alone, against the whole one: the same motion and
// energies.
TEST(Driven, HalfABlockMovesAsTheWholeOne) {
  json whole = scene_of_blocks(
      {block("b", {-1, 0, 0}, {2, 0.5, 0.5}, {4, 1, 2}, elastic(1e7, 0.3, 1000))},
      R"([{"name": "floor", "nodes": "b.z_min", "obstacle": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}}])");
  whole["model"]["blocks"][0]["velocity"] = {0, 0, -1};
  whole["loads"] =
      json::parse(R"([{"type": "gravity", "acceleration": [0, 0, -10]}, {"type": "damping", "rate": 40}])");
  for (const auto& [law, parameters] : std::map<const char*, const char*>{
           {"contact", "{}"},
           {"coulomb", R"({"friction": 0.3})"},
           {"postit", R"({"friction": 0.2})"},
           {"tie", "{}"},
           {"cohesive", R"({"strength": 3e4, "toughness": 20, "friction": 0.2})"}})
    for (const double cfl : {0.9, 0.999, 0.53}) {
      GIVEN(law, cfl);
      whole["interfaces"][0]["law"] = law;
      whole["interfaces"][0]["parameters"] = json::parse(parameters);
      whole["time"] = {{"cfl", cfl}, {"end", 0.05}};
      json half = whole;
      half["model"]["blocks"][0].update(
          {{"corner", {0, 0, 0}}, {"size", {1, 0.5, 0.5}}, {"elements", {2, 1, 2}}});
      half["loads"].push_back({{"type", "motion"}, {"nodes", "b.x_min"}, {"axes", {0}}});
      Scene all = scene_of(whole), part = scene_of(half);
      host::Integrator one(*all.model, all.loads, all.interfaces, all.dt),
          other(*part.model, part.loads, part.interfaces, all.dt);
      for (std::int64_t k = 0; k < all.steps; ++k) {
        one.step();
        other.step();
      }
      double largest = 0.0, difference = 0.0;
      for (Eigen::Index i = 0; i < part.model->position().size(); i += 3)
        for (Eigen::Index j = 0; j < all.model->position().size(); j += 3) {
          const Eigen::Vector3d u = one.displacement().segment<3>(j);
          if ((part.model->position().segment<3>(i) - all.model->position().segment<3>(j)).norm() > 1e-9)
            continue;
          difference = std::max(difference, (other.displacement().segment<3>(i) - u).norm());
          largest = std::max(largest, u.norm());
        }
      EXPECT_LT(difference, 1e-10 * largest);
      const EnergyReport a = one.energy(), b = other.energy();
      EXPECT_NEAR(2.0 * b.interface_work, a.interface_work, 1e-10 * a.scale);
      EXPECT_NEAR(2.0 * b.by_law[ILAW_ENERGY_FRICTION], a.by_law[ILAW_ENERGY_FRICTION], 1e-10 * a.scale);
      EXPECT_LT(b.balance_error, 1e-12);
    }
}

// A node that is driven along x meets a facet whose nodes there are, too, but for a part of 1e-9: laws are
// given an H along x that they resolve.
TEST(Driven, NodeMayMeetAFacetThatIsNearlyDriven) {
  json source = scene_of_blocks(
      {block("a", {0, 0, 0}, {1, 1, 1}, {1, 1, 1}, elastic(1e6, 0, 1000)),
       block("b", {1e-9, 0, 1}, {1, 1, 1}, {1, 1, 1}, elastic(1e6, 0, 1000))},
      R"([{"law": "coulomb", "parameters": {"friction": 0.3}, "nodes": "b.z_min", "against": {"surface": "a.z_max"}}])");
  source["time"] = {{"cfl", 0.9}, {"end", 1.5}};
  source["loads"] = json::parse(R"([
      {"type": "motion", "nodes": "a.x_min", "axes": [0]}, {"type": "motion", "nodes": "b.x_min", "axes": [0]},
      {"type": "motion", "nodes": "a.z_min"}, {"type": "damping", "rate": 60},
      {"type": "gravity", "acceleration": [0, 0, -10]}])");
  auto [scene, integrator] = run_to_end(source);
  const Dofs impulse = integrator.interface_impulse();
  double force = 0.0;
  for (const int node : scene.model->sets().at("b.z_min").nodes) force += impulse[3 * node + 2] / scene.dt;
  EXPECT_NEAR(force, 1000.0 * 10.0, 1e-3);
}

// A slope of 45 degrees that a driven point climbs: the load perpendicular to the drive gives N and F in
// closed form.
TEST(Driven, PointSlidesUpASlope) {
  json source = json::parse(R"({
    "model": {"type": "points", "dimension": 2, "points": [{"mass": 2, "position": [0, 0]}]},
    "loads": [{"type": "motion", "name": "rod", "nodes": [0], "axes": [0], "velocity": [0.3, 0]},
              {"type": "gravity", "acceleration": [0, -10]}, {"type": "damping", "rate": 30}],
    "interfaces": [{"name": "slope", "law": "coulomb", "parameters": {"friction": 0.2}, "nodes": [0],
      "obstacle": {"type": "plane", "point": [0, 0], "normal": [-1, 1]}}],
    "output": {"forces": ["slope", "rod"], "balance": true}})");
  for (const double h : coprime_steps) {
    GIVEN(h);
    source["time"] = {{"dt", h}, {"end", 1}};
    const Ran run = ran(source);
    // Along y: (N - mu N)/sqrt 2 = m g + rate m v, and along x the rod holds -(N + mu N)/sqrt 2.
    const double lift = 20.0 + 30.0 * 2.0 * 0.3, push = lift * 1.2 / 0.8;
    EXPECT_NEAR(run.last("slope.F1"), lift, 1e-9);
    EXPECT_NEAR(run.last("slope.F0"), -push, 1e-9);
    EXPECT_NEAR(run.last("rod.F0"), push, 1e-9);
    EXPECT_LT(run.energy("balance_error"), 1e-13);
  }
}

// A law that is rigid and driven along its normal ends the run with a reason.
TEST(Driven, AgainstARigidLawEndsTheRun) {
  const json down = json::parse(R"({"type": "motion", "nodes": [0], "axes": [1], "velocity": [0, -1]})");
  json source = until(
      0.1, 0.0037,
      scene_of_points({point(2, {0, 0.05})}, {named("floor", law_on({0}, ground(2), "contact"))}, {down}));
  EXPECT_THAT(
      run_scene(source),
      Exits(1, HasSubstr(
                   "node 0 is driven along axis 1 against 'floor' (law 'contact'), which cannot give way")));
  source["interfaces"][0]["law"] = "penalty";
  source["interfaces"][0]["parameters"] = {{"stiffness", 1e6}};
  const Outcome soft = run_scene(source);
  EXPECT_EQ(soft.code, 0) << soft.output;
}

// Nothing is left to solve where nodes on both sides are driven along all axes.
TEST(Driven, AlongAllAxesOnBothSidesIsRefused) {
  const json down = json::parse(R"({"type": "motion", "nodes": [0], "velocity": [0, -1]})"),
             pair = law_between({0}, {{"nodes", {1}}, {"normal", {0, 1}}}, "contact");
  json source = until(0.1, 0.0037, scene_of_points({point(2, {0, 0.05}), point(2, {0, 0})}, {pair}, {down}));
  EXPECT_EQ(refusal_of(source), "not refused");
  source["loads"].push_back({{"type", "motion"}, {"nodes", {1}}});
  EXPECT_EQ(
      refusal_of(source),
      "/interfaces/0/nodes: found node 0, which a motion drives along all axes, expected a node that is free along "
      "one axis, or that meets one that is");
}

// ---- instability ----------------------------------------------------------------------------------------

// A spring that is too stiff for the step is told of at its first contact, once.
TEST(Instability, OfASpringIsToldAtItsFirstContact) {
  json source = resting_point("penalty", {{"stiffness", 1e6}}, 1e-2);
  source["model"]["points"][0]["position"] = {0, 0.05};
  const std::string output = run_scene(source).output;
  EXPECT_THAT(output, HasSubstr(": the time step is 0.01, where a law is stable up to 0.002 at its nodes"));
  EXPECT_EQ(output.find("the time step is"), output.rfind("the time step is")) << output;
}

// ---- implicit springs -----------------------------------------------------------------------------------

// With e < 1 a bar that settles on its floor stays at its depth: what restitution takes off the indentation
// is given back while the spring stays closed. Without that a spring of ten elements is 0.3 elements deep.
TEST(ImplicitSpring, StaysAtItsDepthUnderABarThatSettles) {
  constexpr double speed = 0.05, weight = 0.01, element = 0.05;
  json source = scene_of_bars({bar("bar", 0, 1, 20, 1, 1, -speed)},
                              {law_on("bar.left", ground(1), "penalty")}, {gravity({-weight})});
  for (const double stiffness : {200.0, 2000.0})
    for (const double restitution : {0.0, 0.5})
      for (const double cfl : {0.98, 0.7, 0.53}) {
        GIVEN(stiffness, restitution, cfl);
        source["interfaces"][0]["parameters"] = {
            {"stiffness", stiffness}, {"integration", "implicit"}, {"restitution", restitution}};
        source["time"] = {{"cfl", cfl}, {"end", 40000 * cfl * element}};
        auto [scene, integrator] = simulation_of(source);
        double deepest = 0.0, late = 0.0, fastest = 0.0;
        while (integrator.steps() < scene.steps) {
          integrator.step();
          const double depth = -integrator.displacement()[0];
          deepest = std::max(deepest, depth);
          fastest = std::max(fastest, std::abs(integrator.velocity()[0]));
          if (2 * integrator.steps() > scene.steps) late = std::max(late, depth);
        }
        const double compressed = speed / std::sqrt(stiffness) + weight / stiffness;
        EXPECT_LE(deepest, scene.dt * fastest + compressed);
        EXPECT_LE(late, 0.15 * element);
        EXPECT_LE(integrator.energy().balance_error, 1e-12);
      }
}

}  // namespace
}  // namespace ilaw::host::testing::driven
