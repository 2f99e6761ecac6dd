// Stresses of elements against closed forms.
#include "results/fields.hpp"

#include "field_file.hpp"
#include "host_runner.hpp"

#include <Eigen/Geometry>

#include <vtkCellData.h>

namespace ilaw::host::testing {
namespace {

// Displacements u = (F - 1) x.
Dofs affine(const Model& model, const Eigen::Matrix3d& F) {
  Dofs u(model.position().size());
  for (Eigen::Index i = 0; i < u.size(); i += 3)
    u.segment<3>(i) = (F - Eigen::Matrix3d::Identity()) * model.position().segment<3>(i);
  return u;
}

Eigen::Matrix3d some_gradient(double size) {
  Eigen::Matrix3d F;
  F << 0.3, -0.1, 0.2, 0.25, -0.35, 0.05, -0.15, 0.3, 0.1;
  return Eigen::Matrix3d::Identity() + size * F;
}

// Hooke's law of the symmetric gradient; Cauchy's stress mu (b - 1) / J + lambda ln J / J (Bonet and Wood
// 2008, eq. 6.29). Where every point has the same F, mean dilatation changes nothing.
TEST(Stress, OfAHomogeneousDeformationIsTheClosedForm) {
  const double mu = 0.5 * 2e6 / 1.3, lambda = 2e6 * 0.3 / (1.3 * 0.4);
  const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
  for (const double size : {1e-3, 0.3, 1.0}) {
    const Eigen::Matrix3d F = some_gradient(size), strain = 0.5 * (F + F.transpose()) - one;
    const double J = F.determinant();
    const Eigen::Matrix3d hooke = 2.0 * mu * strain + lambda * strain.trace() * one,
                          cauchy = (mu * (F * F.transpose() - one) + lambda * std::log(J) * one) / J;
    for (const char* element : {"full", "mean_dilatation"})
      for (const auto& [material, expected] :
           {std::pair{"linear", hooke}, std::pair{"neo_hookean", cauchy}}) {
        const Scene scene = scene_of(block_of(material, element));
        const auto stresses = scene.model->stresses(affine(*scene.model, F));
        ASSERT_EQ(stresses.size(), 6U) << "size " << size;
        for (const Eigen::Matrix3d& stress : stresses)
          EXPECT_LE((stress - expected).norm(), 1e-9 * expected.norm())
              << material << ", " << element << ", size " << size;
      }
  }
}

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
}  // namespace ilaw::host::testing
