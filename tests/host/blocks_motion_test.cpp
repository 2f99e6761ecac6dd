// Blocks in motion: wave speeds, the critical step, what is conserved, threads.
#include "host_runner.hpp"

#include <Eigen/Eigenvalues>

#include <stdexcept>

namespace ilaw::host::testing::blocks_motion {
namespace {

Scene scene_of(const json& source) { return testing::scene_of(source); }

json material(const char* type, double ratio) {
  return {{"type", type}, {"young", 3.0}, {"poisson", ratio}, {"density", 2.0}};
}

json block(const json& size, const json& elements, const json& of, const char* element = "full") {
  return {{"type", "blocks"},
          {"blocks", json::array({{{"name", "b"},
                                   {"corner", {0.1, 0.0, 0.0}},
                                   {"size", size},
                                   {"elements", elements},
                                   {"material", of},
                                   {"element", element}}})}};
}

// ---- waves ----------------------------------------------------------------------------------------------

// A column of elements that moves along its axis alone is a bar: of Young's modulus E where Poisson's ratio
// is 0, of lambda + 2 mu where it cannot narrow. A shock on its end makes its nodes move as those of the bar.
void expect_a_bar(double ratio, double modulus, json loads) {
  const json time = {{"dt", 0.7 * 0.05 * std::sqrt(2.0 / modulus)}, {"end", 6.0}};
  loads.push_back(shock("b.x_max", 1e-9, {-0.01, 0.0, 0.0}));
  Scene blocks = scene_of({{"model", block({2.0, 0.3, 0.2}, {40, 1, 1}, material("linear", ratio))},
                           {"time", time},
                           {"loads", loads},
                           {"interfaces", json::array()}});
  json source = scene_of_bars({bar("b", 0.1, 2, 40, modulus, 2)}, {}, {shock("b.right", 1e-9, {-0.04})});
  source["model"]["bars"][0]["section"] = 0.06;
  source["time"] = time;
  Scene bars = scene_of(source);
  Integrator block_run = integrator_of(blocks), bar_run = integrator_of(bars);
  while (bar_run.steps() < bars.steps) {
    bar_run.step();
    block_run.step();
    for (int node = 0; node < blocks.model->node_count(); ++node) {
      ASSERT_NEAR(block_run.displacement()[3 * node], bar_run.displacement()[node % 41], 1e-12)
          << "node " << node;
      ASSERT_NEAR(block_run.displacement()[3 * node + 1], 0.0, 1e-12) << "node " << node;
    }
  }
  EXPECT_GT(bar_run.displacement().cwiseAbs().minCoeff(), 0.1);  // the wave passed everywhere
}

TEST(BlockColumn, IsABarOfYoungsModulusWithoutPoissonsRatio) { expect_a_bar(0.0, 3.0, json::array()); }

TEST(BlockColumn, IsABarOfThePWaveModulusWhereItCannotNarrow) {
  const json held = {{"type", "motion"}, {"nodes", "all"}, {"axes", {1, 2}}, {"velocity", {0.0, 0.0, 0.0}}};
  expect_a_bar(0.3, 3.0 * 0.7 / (1.3 * 0.4), json::array({held}));
}

// ---- what is conserved ----------------------------------------------------------------------------------

Eigen::Vector3d momentum(const Scene& scene, const Integrator& integrator) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int node = 0; node < scene.model->node_count(); ++node)
    sum += scene.model->mass()[3 * node] * integrator.velocity().segment<3>(3 * node);
  return sum;
}

// Two shocks make a block fly, spin and ring. Internal forces have no resultant, and a neo-Hookean body's no
// moment about where it is; a linear one's has, once it turns. Forces of elements are sums that cancel, of
// terms of a modulus times (element size) u, each rounded; all nodes stay within 10 of the origin.
void expect_conserved(const char* law, const char* element, double ratio) {
  const double modulus = std::max(3.0, 3.0 / (3.0 * (1.0 - 2.0 * ratio)));
  auto [scene, integrator] = simulation_of(scene_of(
      {{"model", block({1.0, 0.5, 0.4}, {4, 3, 2}, material(law, ratio), element)},
       {"time", {{"cfl", 0.5}, {"end", 20.0}}},
       {"loads",
        {shock("b.x_min", 1e-9, {0.002, -0.002, 0.004}), shock("b.x_max", 1e-9, {-0.001, 0.003, -0.001})}},
       {"interfaces", json::array()}}));
  integrator.step();
  const Eigen::Vector3d start = momentum(scene, integrator), turn = integrator.angular_momentum();
  EXPECT_NEAR((start - 12.0 * Eigen::Vector3d(0.001, 0.001, 0.003)).norm(), 0.0, 1e-15);
  double cancelled = 0.0;
  while (integrator.steps() < scene.steps) {
    integrator.step();
    cancelled += scene.dt * modulus * 0.2 * integrator.displacement().cwiseAbs().sum();
  }
  const double rounding = 1.1e-16 * cancelled;
  EXPECT_LE((momentum(scene, integrator) - start).norm(), rounding);
  if (std::string(law) == "neo_hookean") {
    EXPECT_LE((integrator.angular_momentum() - turn).norm(), 10.0 * rounding);
    EXPECT_LE(integrator.displacement().cwiseAbs().maxCoeff(), 10.0);
  }
  EXPECT_LE(integrator.energy().balance_error, 1e-12 * modulus / 3.0);
}

TEST(FlyingBlock, KeepsItsMomentumAndItsAngularMomentum) {
  for (const char* law : {"linear", "neo_hookean"}) {
    expect_conserved(law, "full", 0.3);
    expect_conserved(law, "mean_dilatation", 0.3);
    expect_conserved(law, "mean_dilatation", 0.499);
  }
}

}  // namespace
}  // namespace ilaw::host::testing::blocks_motion
