// Planes that tilt: gap, normal and velocity of the surface belong together.
#include "host_runner.hpp"

#include <Eigen/Geometry>

#include <functional>

namespace ilaw::host::testing::tilt {
namespace {

constexpr double fall = 10.0, rate = 0.2;

// The start gives it the velocity of the plane, an impact of its own. A point at the distance s from the axis
// of a plane that tilts at a constant rate.
json on_plane(int dimension, double s, double friction, double dt) {
  const bool flat = dimension == 2;
  json scene = {{"model", {{"type", "points"}, {"dimension", dimension}}},
                {"time", {{"dt", dt}, {"end", 3.0}}}};
  scene["model"]["points"] = {{{"mass", 2},
                               {"position", flat ? json{1 + s, 0.5} : json{1 + s, 0.5, 3}},
                               {"velocity", flat ? json{0, 0} : json{0, 0, 0}}}};
  scene["loads"] = {{{"type", "gravity"}, {"acceleration", flat ? json{0, -fall} : json{0, -fall, 0}}}};
  json tilt = {{"angles", {{0, 0}, {10, 10 * rate}}}};
  if (!flat) tilt["axis"] = {0, 0, 3};
  scene["interfaces"] = {{{"name", "plane"},
                          {"law", "coulomb"},
                          {"nodes", "all"},
                          {"parameters", {{"friction", friction}, {"restitution", 0}}},
                          {"obstacle",
                           {{"type", "plane"},
                            {"point", flat ? json{1, 0.5} : json{1, 0.5, -2}},
                            {"normal", flat ? json{0, 3} : json{0, 3, 0}},
                            {"tilt", tilt}}}}};
  return scene;
}

// The time at which a friction is not enough any more.
double time_of(const std::function<double(double)>& missing) {
  double low = 0.0, high = 3.0;
  while (high - low > 1e-14) (missing(0.5 * (low + high)) < 0.0 ? low : high) = 0.5 * (low + high);
  return low;
}

// On the axis a body slides as soon as tan(angle) is the friction. At a distance s it needs w^2 s towards the
// axis, which the slope helps to give: g sin(angle) - w^2 s = friction g cos(angle).
TEST(Tilt, SlidesWhereTheAngleIsThatOfFriction) {
  for (const int dimension : {2, 3})
    for (const double s : {0.0, 0.8})
      for (const double friction : {0.2, 0.4})
        for (const double dt : {0.01, 0.0073, 0.0031}) {
          Scene scene = scene_of(on_plane(dimension, s, friction, dt).dump());
          Integrator integrator = integrator_of(scene);
          const double expected = time_of([&](double time) {
            return fall * std::sin(rate * time) - rate * rate * s - friction * fall * std::cos(rate * time);
          });
          EXPECT_TRUE(s > 0.0 || std::abs(std::tan(rate * expected) - friction) < 1e-12);
          const auto slid = [&] {
            const double angle = rate * integrator.time();
            return (s + integrator.displacement()[0]) * std::cos(angle) +
                   integrator.displacement()[1] * std::sin(angle) - s;
          };
          while (integrator.steps() < scene.steps && std::abs(slid()) < 1e-10) integrator.step();
          EXPECT_LT(slid(), 0.0);  // downhill
          EXPECT_GT(integrator.time(), expected - 1.01 * dt) << dimension << "D, s " << s << ", " << friction;
          EXPECT_LT(integrator.time(), expected + 2.01 * dt) << dimension << "D, s " << s << ", " << friction;
        }
}

// A plane that swings up to a point far from its axis finds it, with and without the filter, to the same
// bits.
TEST(Tilt, IsNotMissedByTheFilter) {
  std::vector<Dofs> found;
  for (const bool skip : {true, false}) {
    json source = on_plane(2, 30.0, 0.3, 0.001);
    source["model"]["points"][0]["position"] = {31, 2.0};
    source["model"]["points"][0]["velocity"] = {0, 0};
    source["loads"] = json::array();
    source["interfaces"][0]["skip"] = skip;
    source["interfaces"][0]["obstacle"]["tilt"]["angles"] = {{"rows", {{0.2, 0}, {0.4, 0.2}}},
                                                             {"smooth", true}};
    source["time"]["end"] = 0.5;
    auto [scene, integrator] = simulation_of(source);
    while (integrator.steps() < scene.steps) {
      integrator.step();
      ASSERT_GT(scene.interfaces[0]->gap_at(0, integrator.displacement(), integrator.time()), -1e-3);
    }
    EXPECT_GT(integrator.displacement()[1], 1.0);
    found.push_back(integrator.displacement());
  }
  EXPECT_EQ(found[0], found[1]);
}

// A bond that remembers where it is along the surface keeps hold while the plane tilts by a quarter turn.
TEST(Tilt, MemoryTurnsWithThePlane) {
  for (const int dimension : {2, 3}) {
    json source = on_plane(dimension, 0.3, 0.3, 0.002);
    source["interfaces"][0]["law"] = "cohesive";
    source["interfaces"][0]["parameters"] = {{"strength", 1e3}, {"toughness", 10.0}, {"stiffness", 1e6}};
    source["interfaces"][0]["obstacle"]["tilt"]["angles"] = {{0, 0}, {3, 1.5}};
    source["model"]["points"][0]["velocity"] = dimension == 2 ? json{0, 0.15} : json{0, 0.15, 0};
    auto [scene, integrator] = run_to_end(source);
    const double angle = 1.5 * integrator.time() / 3.0;
    EXPECT_NEAR(integrator.displacement()[0], 0.3 * (std::cos(angle) - 1.0), 1e-3);
    EXPECT_NEAR(integrator.displacement()[1], 0.3 * std::sin(angle), 1e-3);
  }
}

}  // namespace
}  // namespace ilaw::host::testing::tilt
