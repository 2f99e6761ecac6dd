// Stresses of elements against closed forms.
#include "results/fields.hpp"

#include "field_file.hpp"
#include "host_runner.hpp"

#include <Eigen/Geometry>

#include <vtkCellData.h>

namespace ilaw::host::testing::stress_field {
namespace {

// A rod's tension over its section; only along x.
TEST(Stress, OfABarIsItsTension) {
  const Scene scene =
      scene_of(R"({"model": {"type": "bars", "bars": [{"length": 2, "elements": 4, "young": 3e6, "density": 1,
      "section": 0.5}]}, "initial": [{"gradient": [[0.005]]}], "time": {"cfl": 0.5, "end": 1e-3}, "interfaces": []})");
  for (const Eigen::Matrix3d& stress : scene.model->stresses(scene.model->initial_displacement())) {
    EXPECT_NEAR(stress(0, 0), 3e6 * 0.005, 1e-8);
    EXPECT_EQ(stress.cwiseAbs().sum(), stress(0, 0));
  }
}

// In the files: components in ParaView's order, and von Mises' stress of them.
TEST(Stress, StandsInTheFields) {
  const auto folder = fresh_folder();
  auto [scene, integrator] = simulation_of(shipped("block_impact").dump());
  while (integrator.time() < 0.005) integrator.step();
  Fields(scene, folder).write(integrator);
  const auto grid = grid_of(folder / "fields_000000.vtu");
  vtkDataArray &tensor = cells_of(*grid, "stress"), &mises = cells_of(*grid, "von_mises");
  const auto stresses = scene.model->stresses(integrator.displacement());
  double largest = 0.0;
  for (std::size_t k = 0; k < stresses.size(); ++k) {
    const Eigen::Matrix3d& s = stresses[k];
    const auto cell = static_cast<vtkIdType>(k);
    const double expected[] = {s(0, 0), s(1, 1), s(2, 2), s(0, 1), s(1, 2), s(0, 2)};
    for (int c = 0; c < 6; ++c) ASSERT_EQ(tensor.GetComponent(cell, c), expected[c]) << k << ", " << c;
    // von Mises 1913, in components.
    const double squares = std::pow(s(0, 0) - s(1, 1), 2) + std::pow(s(1, 1) - s(2, 2), 2) +
                           std::pow(s(2, 2) - s(0, 0), 2),
                 shears = s(0, 1) * s(0, 1) + s(1, 2) * s(1, 2) + s(0, 2) * s(0, 2);
    ASSERT_NEAR(mises.GetComponent(cell, 0), std::sqrt(0.5 * squares + 3.0 * shears), 1e-6) << "k " << k;
    largest = std::max(largest, mises.GetComponent(cell, 0));
  }
  EXPECT_GT(largest, 1e4);
}

}  // namespace
}  // namespace ilaw::host::testing::stress_field
