// Pressure on faces of blocks, against the volume that it works on; tables in time, bulk viscosity of a body
// that turns, and half a driven block.
#include "host_runner.hpp"

#include <Eigen/Geometry>

namespace ilaw::host::testing::pressure {
namespace {

json rubber_block(const char* material) {
  json scene = json::parse(R"({"model": {"type": "blocks", "blocks": [{"name": "b", "size": [1, 1.2, 0.9],
      "elements": [2, 1, 2], "material": {"young": 1, "poisson": 0.3, "density": 1}}]},
    "time": {"cfl": 0.5, "end": 1}, "interfaces": []})");
  scene["model"]["blocks"][0]["material"]["type"] = material;
  return scene;
}

void press_everywhere(json& scene, double pressure) {
  for (const char* face : {"x_min", "x_max", "y_min", "y_max", "z_min", "z_max"})
    scene["loads"].push_back(
        {{"type", "pressure"}, {"surface", std::string("b.") + face}, {"history", {{0, pressure}}}});
}

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
  json source = rubber_block("linear");
  press_everywhere(source, p);
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

// On one face of a block at rest, its area times p, by tributary area, into the body.
TEST(Pressure, PushesOnTheFaceItIsGivenFor) {
  json source = rubber_block("linear");
  source["sets"]["half"] = {{"box", {{-1, -1, -1}, {0.6, 2, 2}}}, {"of", "b.z_max"}};
  source["loads"] = {{{"type", "pressure"}, {"surface", "half"}, {"history", {{0, 2.0}, {1, 4.0}}}}};
  const Scene scene = scene_of(source);
  const Dofs u = Dofs::Zero(scene.model->mass().size());
  Dofs force = u;
  scene.loads[0]->add_force(0.25, u, force);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < u.size(); i += 3) sum += force.segment<3>(i);
  EXPECT_NEAR(sum[2], -2.5 * 0.5 * 1.2, 1e-15);
  EXPECT_NEAR(sum.head<2>().norm(), 0.0, 1e-15);
}

// The work of a constant pressure is what it takes from the volume, but for the step's second order.
TEST(Pressure, WorksOnTheVolume) {
  constexpr double p = 0.2;
  json source = rubber_block("neo_hookean");
  press_everywhere(source, p);
  source["time"] = {{"end", 2.0}};
  std::vector<double> steps, errors;
  for (const double h : {0.05, 0.035, 0.011}) {
    source["time"]["dt"] = h;
    auto [scene, integrator] = run_to_end(source);
    // Work is booked at half steps: the volume is that half a step on.
    const Dofs u = integrator.displacement() + 0.5 * h * integrator.velocity();
    const double before = volume_of(*scene.model, 0.5 * h * Dofs::Zero(u.size()));
    const double work = p * (before - volume_of(*scene.model, u));
    steps.push_back(h);
    errors.push_back(std::abs(integrator.energy().external_work - work));
    EXPECT_GT(work, 0.02) << "h " << h;
    EXPECT_LT(errors.back(), 0.5 * h * h) << h;
    EXPECT_LT(integrator.energy().balance_error, 1e-12) << "h " << h;
  }
  EXPECT_GT(order(steps, errors), 1.8);
}

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
}  // namespace ilaw::host::testing::pressure
