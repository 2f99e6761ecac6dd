// Obstacles against closed forms of their distances; prescribed motion and damping.
#include "model/obstacle.hpp"

#include "host_runner.hpp"
#include "model/points.hpp"
#include "surface/counterpart.hpp"

#include <memory>
#include <numeric>

namespace ilaw::host::testing {
namespace {

using Eigen::Vector3d;

Motion still() { return Motion(Vector(Vector3d::Zero())); }

Vector3d random_vector(std::mt19937_64& random) {
  std::uniform_real_distribution<double> draw(-2.0, 2.0);
  return Vector3d::NullaryExpr([&] { return draw(random); });
}

// ---- shapes ---------------------------------------------------------------------------------------------

// The gaps of many nodes at once are found another way, by one component where the normal is along an axis.
TEST(Plane, GivesManyNodesTheGapsOfEachToTheBit) {
  std::mt19937_64 random(7);
  const std::vector<PointMass> points(9, {1.0, 1.0, random_vector(random), Vector::Zero(3), Vector()});
  const Points model(3, points);
  std::vector<int> nodes(points.size());
  std::iota(nodes.begin(), nodes.end(), 0);
  for (const Vector3d& normal : {Vector3d(1, 0, 0), Vector3d(0, -3, 0), Vector3d(0, 0, 1), Vector3d(0, 0, -1),
                                 Vector3d(1, 0, -2), Vector3d(0, 1, 1), Vector3d(1, 2, 3)}) {
    const Motion motion(Vector(random_vector(random)));
    const RigidCounterpart plane(model, nodes,
                                 std::make_unique<Plane>(random_vector(random), normal, motion));
    const Dofs u = Dofs::Random(27);
    std::vector<double> gaps(nodes.size());
    plane.gap_bounds(0, 9, u, 0.3, gaps.data());
    for (const int node : nodes)
      EXPECT_EQ(gaps[static_cast<std::size_t>(node)], plane.contact_point(node, u, 0.3).gap)
          << normal.transpose() << ", node " << node;
  }
}

// Where no direction is better than another, the normal is still a unit vector, off the axis of a cylinder.
TEST(RoundObstacle, HasANormalAtItsCenter) {
  const Round sphere(Vector3d(1, 2, 3), {}, 2.0, still());
  EXPECT_EQ(sphere.at(Vector3d(1, 2, 3), 0.0).gap, -2.0);
  EXPECT_EQ(sphere.at(Vector3d(1, 2, 3), 0.0).normal.norm(), 1.0);
  for (const Vector3d& axis : {Vector3d(1, 0, 0), Vector3d(0, 3, 0), Vector3d(1, 1, 0)}) {
    const Round cylinder(Vector3d::Zero(), axis, 1.0, still());
    const RigidSurface surface = cylinder.at(Vector3d::Zero(), 0.0);
    EXPECT_EQ(surface.gap, -1.0);
    EXPECT_NEAR(surface.normal.norm(), 1.0, 1e-15);
    EXPECT_NEAR(surface.normal.dot(axis), 0.0, 1e-15);
  }
}

// Gaps by the formulas of the shapes, whatever the length of a normal or an axis; the normal is a unit vector
// along which the gap grows as the way does.
TEST(Obstacle, HasTheGapOfItsShapeAlongItsNormal) {
  std::mt19937_64 random(5);
  for (int draw = 0; draw < 10000; ++draw) {
    const Vector3d point = random_vector(random), direction = random_vector(random),
                   x = random_vector(random);
    const Vector3d arm = x - point, along = direction.normalized();
    const Plane plane(point, direction, still());
    const Round sphere(point, {}, 0.7, still());
    const Round cylinder(point, direction, 0.7, still());
    for (const auto& [obstacle, gap] : std::initializer_list<std::pair<const Obstacle*, double>>{
             {&plane, arm.dot(along)},
             {&sphere, arm.norm() - 0.7},
             {&cylinder, (arm - arm.dot(along) * along).norm() - 0.7}}) {
      const RigidSurface surface = obstacle->at(x, 0.0);
      ASSERT_NEAR(surface.gap, gap, 1e-14) << draw;
      ASSERT_NEAR(surface.normal.norm(), 1.0, 1e-15) << draw;
      ASSERT_NEAR(obstacle->at(x + 0.3 * surface.normal, 0.0).gap, gap + 0.3, 1e-14) << draw;
    }
  }
}

// ---- motion ---------------------------------------------------------------------------------------------

// An obstacle that moved by d sees a point at x as it saw that at x - d; its velocity is the mean over a
// step.
TEST(MovingObstacle, IsTheOneAtRestDisplaced) {
  const Motion steady(Vector(Vector3d(1, -2, 0.5)));
  const Motion path(Table({0.0, 1.0, 3.0}, {Vector3d(0, 0, 0), Vector3d(2, 0, 0), Vector3d(2, 4, 0)}));
  EXPECT_EQ(Vector3d(steady.displacement(2.0)), Vector3d(2, -4, 1));
  EXPECT_EQ(Vector3d(path.displacement(0.5)), Vector3d(1, 0, 0));
  EXPECT_EQ(Vector3d(path.displacement(2.0)), Vector3d(2, 2, 0));
  EXPECT_EQ(Vector3d(path.displacement(9.0)), Vector3d(2, 4, 0));  // it stays at the end
  EXPECT_EQ(Vector3d(path.velocity(0.5, 2.0)), Vector3d(1, 2, 0) / 1.5);
  std::mt19937_64 random(6);
  for (const Motion& motion : {steady, path})
    for (int draw = 0; draw < 1000; ++draw) {
      const Vector3d center = random_vector(random), x = random_vector(random);
      const double time = 0.003 * draw;
      const Round moving(center, {}, 0.5, motion), resting(center, {}, 0.5, still());
      EXPECT_EQ(moving.at(x, time).gap, resting.at(x - motion.displacement(time), 0.0).gap)
          << "draw " << draw;
      EXPECT_EQ(Vector3d(moving.velocity(0.1, 0.2)), Vector3d(motion.velocity(0.1, 0.2))) << "draw " << draw;
    }
}

}  // namespace
}  // namespace ilaw::host::testing
