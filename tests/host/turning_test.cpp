// Obstacles that turn: the surface that a node meets has a velocity of its own.
#include "host_runner.hpp"

#include <Eigen/Geometry>
#include <complex>

namespace ilaw::host::testing::turning {
namespace {

// A wheel of radius 0.5 about (1, 2), or a sphere or a table there, turning so that its top moves by speed
// along x.
json wheel(const std::string& type, double speed) {
  constexpr double radius = 0.5;
  if (type == "disc")
    return {{"type", "sphere"}, {"center", {1, 2}}, {"radius", radius}, {"rate", -speed / radius}};
  if (type == "table")  // seen from its normal y, at a radius of 0.5 towards z
    return {{"type", "plane"}, {"point", {1, 2.5, -0.5}}, {"normal", {0, 3, 0}}, {"rate", speed / 0.5}};
  json round = {{"type", type}, {"radius", radius}, {"axis", {0, 0, -2}}, {"rate", speed / radius}};
  round[type == "sphere" ? "center" : "point"] = {1, 2, type == "sphere" ? 0 : 7};
  return round;
}

// A point that falls on the top of it.
json dropped(const json& obstacle, int dimension, double friction, double restitution) {
  json scene = {{"model", {{"type", "points"}, {"dimension", dimension}}}, {"time", {{"end", 1.0}}}};
  json position = {1, 2.7}, velocity = {0, -2};
  if (dimension == 3) {
    position.push_back(0);
    velocity.push_back(0);
  }
  scene["model"]["points"] = {{{"mass", 3}, {"position", position}, {"velocity", velocity}}};
  scene["interfaces"] = {
      {{"law", "coulomb"},
       {"nodes", "all"},
       {"obstacle", obstacle},
       {"parameters", {{"friction", friction}, {"restitution", restitution}, {"activation", "moreau"}}}}};
  return scene;
}

void run_to_impact(Integrator& integrator, const Scene& scene) {
  while (integrator.velocity()[1] < 0.0 && integrator.steps() < scene.steps) integrator.step();
}

// An impact at speed w gives mu (1 + e) w along the surface, and no more than the speed of the surface; what
// friction takes is what the wheel has given and the point has not got.
TEST(TurningObstacle, GivesAnImpactItsSpin) {
  constexpr double w = 2.0, mu = 0.3, e = 0.5, kick = mu * (1.0 + e) * w;
  for (const std::string type : {"disc", "cylinder", "sphere", "table"})
    for (const double speed : {0.4, 5.0, -0.7, -3.0})
      for (const double h : {0.01, 0.013, 0.0037}) {
        GIVEN(type, speed, h);
        json source = dropped(wheel(type, speed), type == "disc" ? 2 : 3, mu, e);
        source["time"]["dt"] = h;
        Scene scene = scene_of(source);
        Integrator integrator(scene);
        run_to_impact(integrator, scene);
        const Dofs& v = integrator.velocity();
        // A table moves what it touches along a chord, which leads away from the speed by half the angle.
        const double angle = type == "table" ? speed / 0.5 * h : 0.0,
                     chord = angle != 0.0 ? std::abs(std::sin(0.5 * angle) / h) : std::abs(speed),
                     given = std::min(kick, chord);
        const double expected = std::copysign(given * std::cos(0.5 * angle), speed);
        ASSERT_NEAR(v[0], expected, 1e-14);
        ASSERT_NEAR(v[1], e * w, 1e-14);
        const EnergyReport energy = integrator.energy();
        const double slid = 0.5 * (chord * (1.0 + std::cos(angle)) - given);  // mean over the impact
        ASSERT_NEAR(energy.by_law[ILAW_ENERGY_FRICTION], 3.0 * given * slid, 1e-13);
        ASSERT_NEAR(energy.reaction_work, 0.0, 1e-13);
        ASSERT_LT(energy.balance_error, 1e-14);
      }
}

// A wheel that rolls has no velocity where it touches the ground: what it meets there is not
// dragged along. It touches at a time of 0.5; met s later, its normal is (-4 s, -1) and its
// surface, where it touches, has the velocity (16 s^2, 8 s) as it rolls, (2, 0) as it slides, (4,
// -8 s) as it turns backwards. A node that rises at 1 sticks to the first, and has its velocity. On the
// others it slides: it is pushed by 1 - 8 s along the normal and by 0.3 of that along x, 0.3 - 6.4
// s in all. All to the first order; the second is below 18 s^2.
TEST(TurningObstacle, RollsWithoutSliding) {
  constexpr double forwards = 2.0, radius = 0.5;
  const auto expect_dragged = [&](double rate, double h, double at_once, double slope) {
    json source = dropped({{"type", "sphere"},
                           {"center", {0, 1}},
                           {"radius", radius},
                           {"velocity", {forwards, 0}},
                           {"rate", rate}},
                          2, 0.3, 0.0);
    source["model"]["points"][0]["position"] = {1, 0};
    source["model"]["points"][0]["velocity"] = {0, 1};
    source["time"]["dt"] = h;
    Scene scene = scene_of(source);
    Integrator integrator = integrator_of(scene);
    while (integrator.energy().interface_work == 0.0) integrator.step();
    const double s = integrator.time() - 0.5;
    EXPECT_TRUE(s > -1e-12 && s < h) << "h " << h << ", s " << s;
    EXPECT_NEAR(integrator.velocity()[0], at_once + slope * s, 18.0 * s * s + 1e-13)
        << "h " << h << ", rate " << rate;
  };
  for (const double h : {0.011, 0.013, 0.0037}) {
    expect_dragged(-forwards / radius, h, 0.0, 0.0);  // clockwise, as it rolls along x
    expect_dragged(0.0, h, 0.3, -6.4);
    expect_dragged(forwards / radius, h, 0.3, -6.4);
  }
}

// A mass that a spring of stiffness k = 100 holds to a turntable, where both were at rest to each other. With
// z = x + iy and turned by w = 2, z'' = -k (z - e^(iwt)), so that
//     z = A e^(iwt) + (1 - A) (0.6 e^(10it) + 0.4 e^(-10it)),   A = k/(k - w^2).
// In the axes of space the spring would not turn, and fling it away.
struct Held {
  const char* law;
  double depth;                // of the place at rest under gravity
  double on_plane, on_sphere;  // error over h^2
};
class Turntable : public ::testing::TestWithParam<Held> {};
void follow_turntable(const Held& held, const json& obstacle, double error, const json& other = {}) {
  using namespace std::complex_literals;
  constexpr double a = 100.0 / 96.0;
  for (const double h : {0.003, 0.0013, 0.00037}) {
    json source = json::parse(R"({"model": {"type": "points", "dimension": 3, "points": [
        {"mass": 1, "position": [1, 0, 0], "velocity": [0, 2, 0]}]}, "time": {"end": 10},
        "loads": [{"type": "gravity", "acceleration": [0, 0, -10]}],
        "interfaces": [{"nodes": "all"}]})");
    source["time"]["dt"] = h;
    source["model"]["points"][0]["position"][2] = -held.depth;
    source["interfaces"][0].update(json::parse(held.law));
    source["interfaces"][0]["obstacle"] = obstacle;
    if (!other.is_null()) source["interfaces"].push_back(other);
    auto [scene, integrator] = simulation_of(source);
    while (integrator.steps() < scene.steps) {
      integrator.step();
      const double t = integrator.time();
      const std::complex<double> swings = 0.6 * std::exp(10i * t) + 0.4 * std::exp(-10i * t),
                                 there = a * std::exp(2i * t) + (1.0 - a) * swings;
      const Vector found = scene.model->position() + integrator.displacement();
      ASSERT_LT(std::abs(std::complex<double>(found[0], found[1]) - there), error * h * h)
          << "h " << h << ", time " << t;
    }
  }
}
TEST_P(Turntable, TurnsTheMemoryOfALaw) {
  follow_turntable(GetParam(),
                   json::parse(R"({"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1], "rate": 2})"),
                   GetParam().on_plane);
}
// At its pole it is as flat as that; whether the node has one interface, or two that are solved together.
TEST_P(Turntable, IsThePoleOfALargeSphereToo) {
  const json sphere = json::parse(
      R"({"type": "sphere", "center": [0, 0, -1e6], "radius": 1e6, "axis": [0, 0, 1], "rate": 2})");
  follow_turntable(GetParam(), sphere, GetParam().on_sphere);
  follow_turntable(GetParam(), sphere, GetParam().on_sphere, json::parse(R"({"law": "contact", "nodes": "all",
      "obstacle": {"type": "plane", "point": [0, 0, -1], "normal": [0, 0, 1]}})"));
}
INSTANTIATE_TEST_SUITE_P(
    Laws, Turntable,
    ::testing::Values(
        Held{R"({"law": "cohesive", "parameters": {"strength": "inf", "toughness": 1, "stiffness": 100}})",
             1e-9, 40.0, 50.0},
        Held{R"({"law": "penalty", "parameters": {"stiffness": 1e4, "integration": "implicit",
                 "friction": 1e6, "tangential_stiffness": 100}})",
             1e-3, 40.0, 50.0}));

// A point on a sphere that starts to spin. Alone, and with an interface out of reach, so that contacts are
// solved together: as the start is faster than the bound on speeds, that step is solved more than once.
json on_spinning_sphere(const json& interface, const json& gravity) {
  json scene = json::parse(R"({"model": {"type": "points", "dimension": 3, "points": [
      {"mass": 1, "position": [0.1, 0, 0.79372539331937719]}]}, "time": {"dt": 0.01, "end": 1},
    "loads": [{"type": "gravity"}], "interfaces": [{"nodes": "all", "obstacle": {"type": "sphere",
      "center": [0, 0, 0], "radius": 0.8, "axis": [0, 0, 1], "angles": [[0, 0], [0.2, 0], [1.2, 20]]}}]})");
  scene["loads"][0]["acceleration"] = gravity;
  scene["interfaces"][0].update(interface);
  return scene;
}
// Laws of the tree that remember vectors, with the parameters of their tests, and two stiff bonds.
std::vector<json> laws_that_remember_vectors() {
  std::vector<json> laws = {
      {{"law", "cohesive"}, {"parameters", {{"stiffness", 1e4}, {"strength", 1e3}, {"toughness", 1e3}}}},
      {{"law", "rccm"},
       {"parameters", {{"normal_stiffness", 1e4}, {"tangential_stiffness", 1e4}, {"adhesion_energy", 1e3}}}}};
  for (const auto& folder : fs::directory_iterator(ILAW_SOURCE "/tests/laws"))
    if (std::ifstream file(folder.path() / "cases.json"); file)
      for (const json& entry : json::parse(file).value("frame", json::array()))
        laws.push_back({{"law", folder.path().filename()}, {"parameters", entry["parameters"]}});
  return laws;
}

// From time 0.5 on the second point is driven against a rigid floor, which ends the run.
TEST(TurningObstacle, LeavesNoTraceOfARefusedStep) {
  for (const json& law : laws_that_remember_vectors()) {
    GIVEN(law["law"]);
    json source = on_spinning_sphere(law, {0, -1, -10});
    source["model"]["points"].push_back({{"mass", 1}, {"position", {9, 0, 0.5}}});
    source["interfaces"][0]["nodes"] = {0};
    source["interfaces"].push_back(json::parse(R"({"law": "contact", "nodes": [1],
        "obstacle": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}})"));
    source["loads"].push_back({{"type", "motion"}, {"nodes", {1}}, {"axes", {2}}, {"velocity", {0, 0, -1}}});
    auto [scene, integrator] = simulation_of(source);
    const auto state = [&found = *scene.interfaces[0], &u = integrator.displacement()] {
      return found.state_at(0, u);
    };
    std::vector<double> before = state();
    const auto step_to_the_floor = [&] {
      while (integrator.steps() < scene.steps) {
        before = state();
        integrator.step();
      }
    };
    EXPECT_THROW(step_to_the_floor(), std::runtime_error);
    EXPECT_NEAR(integrator.time(), 0.49, 0.011);  // of the last step that was made, one or two before
    EXPECT_EQ(state(), before);
  }
}

}  // namespace
}  // namespace ilaw::host::testing::turning
