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

}  // namespace
}  // namespace ilaw::host::testing::driven
