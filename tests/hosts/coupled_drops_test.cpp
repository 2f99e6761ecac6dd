// Grains that fall into the groove of two fixed ones, which touch each other: two contacts press against each
// other where friction exceeds the tangent of their angle over the horizontal. A grain at rest there needs
// no force above some weights, and no step may add energy.
// SPDX-License-Identifier: BSD-3-Clause
#include "coupled_scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <tuple>
#include <vector>

namespace {

// Gravity acts against z; the fixed grains lie side by side along x.
using coupled_scene::Scene;
constexpr double size_of_grain = coupled_scene::radius, pull = coupled_scene::g, of_step = coupled_scene::h;

struct Drop {
  Drop(double ratio, double mu, double restitution, double height, double aside)
      : scene(coupled_scene::create("coulomb", ILAW_DELASSUS_FULL,
                                    {{"friction", mu}, {"restitution", restitution}}),
              1),
        fixed(ratio * size_of_grain),
        weight(pull / scene.inverse_mass) {
    const double distance = fixed + size_of_grain, x_of_nearer = fixed - std::fabs(aside) * size_of_grain;
    const double above = std::sqrt(distance * distance - x_of_nearer * x_of_nearer);
    x = {aside * size_of_grain, 0.0, above + height * size_of_grain};
    for (const double side : {-1.0, 1.0}) scene.add(0, -1, 0.0, normal(side));
    scene.initialise();
    place();
  }

  std::vector<double> normal(double side) const {
    const double dx = x[0] - side * fixed, size = std::sqrt(dx * dx + x[2] * x[2]);
    return {dx / size, 0.0, x[2] / size};
  }
  void place() {
    for (std::size_t k = 0; k < 2; ++k) {
      const double side = k == 0 ? -1.0 : 1.0;
      const std::vector<double> n = normal(side);
      scene.gap[k] = std::hypot(x[0] - side * fixed, x[2]) - fixed - size_of_grain;
      for (std::size_t c = 0; c < 3; ++c) {
        scene.normal[3 * k + c] = n[c];
        scene.arm[3 * k + c] = -size_of_grain * n[c];
      }
    }
  }
  void advance(std::uint32_t sweeps) {
    before = scene.largest_velocity();
    said += scene.step(pull, 0.0, sweeps).message != nullptr;
    for (std::size_t c = 0; c < 3; ++c) x[c] += of_step * scene.v[c];
    place();
  }
  // The velocity is that of half a step ago: with the height of then, parabolas have one energy.
  double energy() const { return scene.kinetic() + weight * (x[2] - 0.5 * of_step * scene.v[2]); }
  bool is_slow() const { return std::max(scene.largest_velocity(), before) < 3.0 * pull * of_step; }
  double force() const {
    double most = 0.0;
    for (const double r : scene.impulse) most = std::max(most, std::fabs(r));
    return most / of_step / weight;
  }

  Scene scene;
  double fixed, weight;
  std::array<double, 3> x{};
  double before = 0.0;  // largest velocity before the step
  int said = 0;
};

class CoupledDrops : public ::testing::TestWithParam<std::uint32_t> {};

TEST_P(CoupledDrops, IntoGroovesComeToRestAndGainNoEnergy) {
  int drops = 0, unsolved = 0;
  for (const double ratio : {1.0, 3.0, 10.0, 100.0})
    for (const double mu : {0.1, 0.5, 1.0, 2.0})
      for (const double restitution : {0.0, 0.5, 1.0})
        for (const auto& [height, aside] : std::vector<std::tuple<double, double>>{
                 {1e-9, 0.0}, {1e-3, 0.0}, {0.1, 1e-3}, {0.3, -0.01}, {0.7, 0.05}, {1.0, -0.2}}) {
          Drop drop(ratio, mu, restitution, height, aside);
          const double start = drop.energy();
          double most = start, rest = 0.0;
          const int steps = 1500;
          for (int k = 0; k < steps; ++k) {
            drop.advance(GetParam());
            most = std::max(most, drop.energy());
            if ((restitution == 0.0 || k >= steps - 100) && drop.is_slow())
              rest = std::max(rest, drop.force());
          }
          ++drops;
          unsolved += drop.said > 0;
          const double speed = pull * of_step;  // of a step's fall
          EXPECT_LE(most - start, 0.5 * speed * speed / drop.scene.inverse_mass + 1e-9 * drop.weight)
              << ratio << ", mu " << mu << ", e " << restitution << ", from " << height << ", " << aside;
          EXPECT_LE(rest, 100.0) << ratio << ", mu " << mu << ", e " << restitution << ", from " << height;
        }
  std::printf("grooves: %d drops, %d with unsolved steps\n", drops, unsolved);
  EXPECT_EQ(drops, 288);
}
INSTANTIATE_TEST_SUITE_P(Sweeps, CoupledDrops, ::testing::Values(15U, 1000U));

}  // namespace
