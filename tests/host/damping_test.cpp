// Bodies that are damped, and loads over time, against closed forms.
#include "run_result.hpp"

#include <Eigen/Geometry>

namespace ilaw::host::testing::damping {
namespace {

TEST(Table, IsSmoothBetweenItsRowsOrASine) {
  const Table smooth({1.0, 3.0}, {Vector::Constant(1, 2.0), Vector::Constant(1, 6.0)}, true);
  EXPECT_EQ(smooth.at(0.0)[0], 2.0);
  EXPECT_EQ(smooth.at(2.0)[0], 4.0);
  EXPECT_EQ(smooth.at(5.0)[0], 6.0);
  for (const double at : {1.0, 3.0}) EXPECT_NEAR(smooth.at(at + 1e-4)[0], smooth.at(at - 1e-4)[0], 1e-11);
  const Table sine(Sine{Vector::Constant(1, 1.0), Vector::Constant(1, 3.0), 0.5, 0.1});
  EXPECT_NEAR(sine.at(0.3)[0], 1.0 + 3.0 * std::sin(0.3 * M_PI + 0.1), 1e-15);
}

// A body that has turned, and turns, keeps its volume.
TEST(BulkViscosity, LetsABodyTurn) {
  json source = until_at_cfl(
      1.0, 0.5,
      scene_of_blocks({block("b", {0, 0, 0}, {1, 1, 1}, {2, 1, 1},
                             {{"type", "neo_hookean"}, {"young", 1}, {"poisson", 0.3}, {"density", 1}})},
                      "[]"));
  source["loads"] = {{{"type", "bulk_viscosity"}}};
  const Scene scene = scene_of(source);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  const Eigen::Vector3d spin(0.3, -2, 0.7);
  const Dofs& x = scene.model->position();
  Dofs u(x.size()), v(x.size()), impulse = Dofs::Zero(x.size());
  for (Eigen::Index k = 0; k < x.size(); k += 3) {
    u.segment<3>(k) = turn * x.segment<3>(k) - x.segment<3>(k);
    v.segment<3>(k) = spin.cross(turn * x.segment<3>(k));
  }
  Dofs after = v;
  scene.loads[0]->correct({0.0, 1.0}, {u, v}, after, impulse);
  EXPECT_LT(impulse.cwiseAbs().maxCoeff(), 1e-14);
}

}  // namespace
}  // namespace ilaw::host::testing::damping
