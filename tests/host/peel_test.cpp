// The force that peels a tape, which is a string of points, against its closed form.
#include "run_result.hpp"

namespace ilaw::host::testing::peel {
namespace {

constexpr double toughness = 6.0, width = 0.01, edge = 1e-3, stiffness = 10.0;  // the last: E A, in N
constexpr double line_mass = 0.04, air = 10.0, speed = 0.02;
constexpr int bonded = 17, free_edges = 9;

// Glued along x but for its end, which stands off at an angle. The part that comes off in the time of one
// edge adds that edge to the free end: so its tip moves by (cos - 1, sin) times the speed.
json peeled(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  json scene = json::parse(R"({"model": {"type": "points", "dimension": 2, "points": []},
    "loads": [{"type": "damping"}, {"type": "motion", "name": "grip"}],
    "interfaces": [{"name": "glue", "law": "cohesive", "obstacle": {"type": "plane", "point": [0, 0], "normal": [0, 1]}}],
    "output": {"every": 20, "forces": ["grip", "glue"]}})");
  std::vector<int> glued, from, to;
  for (int k = 0; k <= bonded + free_edges; ++k) {
    const double along = edge * std::min(k, bonded), off = edge * std::max(k - bonded, 0);
    scene["model"]["points"].push_back(
        {{"mass", line_mass * edge}, {"position", {along + off * c, off * s}}, {"area", width * edge}});
    if (k <= bonded) glued.push_back(k);
    if (k > 0) from.push_back(k - 1), to.push_back(k);
  }
  scene["springs"] = {{{"nodes", from}, {"to", to}, {"stiffness", stiffness / edge}}};
  scene["loads"][0]["rate"] = air;
  scene["loads"][1]["nodes"] = {bonded + free_edges};
  scene["loads"][1]["velocity"] = {speed * (c - 1.0), speed * s};
  scene["interfaces"][0]["nodes"] = glued;
  scene["interfaces"][0]["parameters"] = {{"toughness", toughness}, {"strength", 2.0 * toughness / 3e-3}};
  return scene;
}

// Where a tape comes off at an angle, |F| - F_x is released per length, F_x along what still holds
// (Rivlin 1944), and F^2/(2 E A) by the tape that is stretched (Kendall 1975): together G b. The
// free end moves at 2 (1 - cos) times the speed squared, against the air.
TEST(PeelForce, IsToughnessTimesWidthOverOneLessTheCosine) {
  const std::vector<std::pair<double, double>> angles_and_steps = {{60, 6e-5}, {90, 4.7e-5}, {120, 3.1e-5}};
  for (const auto& [degrees, h] : angles_and_steps) {
    GIVEN(degrees, h);
    const double angle = degrees * M_PI / 180.0;
    json scene = peeled(angle);
    scene["time"] = {{"dt", h}, {"end", 8.0 * edge / speed}};
    const Ran run = ran(scene);
    const std::vector<double>&time = run["time"], &along = run["grip.F0"], &up = run["grip.F1"];
    double released = 0.0;
    int rows = 0;
    for (std::size_t k = 0; k < time.size(); ++k) {
      if (time[k] <= 4.0 * edge / speed) continue;  // the later half: four edges come off
      const double square = along[k] * along[k] + up[k] * up[k];
      released += std::sqrt(square) - along[k] + square / (2.0 * stiffness);
      ++rows;
    }
    released /= rows;
    const double length = (free_edges + 6.0) * edge;
    const double drag = air * line_mass * length * speed * 2.0 * (1.0 - std::cos(angle));
    EXPECT_NEAR(released, toughness * width + drag, 0.01 * toughness * width);
    // The grip holds what the glue holds, but for the tape's inertia and the air.
    EXPECT_NEAR(run.mean_after(4.0 * edge / speed, "grip.F1"), -run.mean_after(4.0 * edge / speed, "glue.F1"),
                0.02 * toughness * width);
  }
}

}  // namespace
}  // namespace ilaw::host::testing::peel
