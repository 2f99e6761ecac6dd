// Pressure on faces of blocks, against the volume that it works on, and bulk viscosity of a body that turns.
#include "host_runner.hpp"

#include <Eigen/Geometry>

namespace ilaw::host::testing::pressure {
namespace {

// The volume of all elements, whose faces are bilinear: det J is of degree two along each axis.
double volume_of(const Model& model, const Dofs& u) {
  const double gauss = 1.0 / std::sqrt(3.0);
  constexpr int corner[8][3] = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1},
                                {-1, -1, 1},  {1, -1, 1},  {1, 1, 1},  {-1, 1, 1}};
  double volume = 0.0;
  for (std::size_t first = 0; first < model.mesh().cells.size(); first += 8)
    for (const auto& point : corner) {
      Eigen::Matrix3d jacobian = Eigen::Matrix3d::Zero();
      for (std::size_t a = 0; a < 8; ++a) {
        const Eigen::Index dof = 3 * model.mesh().cells[first + a];
        const Eigen::Vector3d x = model.position().segment<3>(dof) + u.segment<3>(dof);
        for (int k = 0; k < 3; ++k) {
          double slope = 0.125 * corner[a][k];
          for (int other = 0; other < 3; ++other)
            if (other != k) slope *= 1.0 + corner[a][other] * point[other] * gauss;
          jacobian.col(k) += slope * x;
        }
      }
      volume += jacobian.determinant();
    }
  return volume;
}

Dofs pressure_at(const Scene& scene, const Dofs& u) {
  Dofs force = Dofs::Zero(u.size());
  for (const auto& load : scene.loads) load->add_force(0.0, u, force);
  return force;
}

// On a closed surface, however deformed: -p dV/du, which is linear in each displacement alone. So its
// resultant and its moment vanish.
TEST(Pressure, IsTheDerivativeOfTheVolume) {
  constexpr double p = 0.7;
  json source = until_at_cfl(
      1, 0.5, scene_of_blocks({block("b", {0, 0, 0}, {1, 1.2, 0.9}, {2, 1, 2}, elastic(1, 0.3, 1))}, "[]"));
  for (const char* face : {"x_min", "x_max", "y_min", "y_max", "z_min", "z_max"})
    source["loads"].push_back(
        {{"type", "pressure"}, {"surface", std::string("b.") + face}, {"history", {{0, p}}}});
  const Scene scene = scene_of(source);
  Random random(8);
  for (int round = 0; round < 5; ++round) {
    Dofs u(scene.model->mass().size());
    for (double& component : u) component = random(-0.15, 0.15);
    const Dofs force = pressure_at(scene, u);
    for (Eigen::Index i = 0; i < u.size(); ++i) {
      Dofs more = u, less = u;
      more[i] += 0.5;
      less[i] -= 0.5;
      ASSERT_NEAR(force[i], -p * (volume_of(*scene.model, more) - volume_of(*scene.model, less)), 1e-13)
          << "round " << round << ", dof " << i;
    }
    Eigen::Vector3d sum = Eigen::Vector3d::Zero(), moment = sum;
    for (Eigen::Index i = 0; i < u.size(); i += 3) {
      const Eigen::Vector3d x = scene.model->position().segment<3>(i) + u.segment<3>(i);
      sum += force.segment<3>(i);
      moment += x.cross(force.segment<3>(i));
    }
    EXPECT_LT(sum.norm() + moment.norm(), 1e-13) << "round " << round;
  }
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
  scene.loads[0]->correct({0.0, 1.0, 2.0}, {u, v}, after, impulse);
  EXPECT_LT(impulse.cwiseAbs().maxCoeff(), 1e-14);
}

}  // namespace
}  // namespace ilaw::host::testing::pressure
