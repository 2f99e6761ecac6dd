// The frame that the kit carries in a state. That memory follows it in any law is for `ilaw check`
// (frame-turned, history-carried).
#include "kit_probe.hpp"

#include "support/small_batch.hpp"

namespace ilaw::testing {
namespace {

// Rotation by an angle about a coordinate axis.
Matrix turn(std::size_t about, double angle) {
  Matrix q{};
  const std::size_t i = (about + 1) % 3, j = (about + 2) % 3;
  q[about][about] = 1.0;
  q[i][i] = q[j][j] = std::cos(angle);
  q[i][j] = -std::sin(angle);
  q[j][i] = std::sin(angle);
  return q;
}

// The memory of a law is carried by the shortest rotation from one normal to the next, by any angle up to
// the half turn, and by the half turn about the remembered tangent where the normal has become its opposite.
TEST(Frame, MemoryFollowsTheNormalByAnyAngle) {
  const ilaw::interface law = make_probe(ILAW_FRAME_GLOBAL);
  const std::size_t s = law.info().state_size;
  const Matrix start = product(turn(0, 0.4), turn(2, 1.1));
  const Vector n = times(start, {1, 0, 0}), across = times(start, {0, 1, 0}), along = times(start, {0, 0, 1});
  const double pi = std::acos(-1.0);
  std::vector<double> angles = {pi, pi - 1e-3, pi - 1e-5, pi - 2e-6, 1e-9, 0.0};
  for (int degrees = 1; degrees < 180; ++degrees) angles.push_back(degrees * pi / 180.0);
  for (const double angle : angles) {
    // The rotation about `along`: n to n cos + across sin.
    Vector turned;
    for (std::size_t c = 0; c < 3; ++c)
      turned[c] = angle == pi ? -n[c] : std::cos(angle) * n[c] + std::sin(angle) * across[c];
    SmallBatch node(1, {}, s);
    // The frame is at the end of the state, as (normal, tangent).
    const auto tangent = [&] { return Vector{node.state[s - 3], node.state[s - 2], node.state[s - 1]}; };
    node.b.normal = ilaw::input(n.data(), 0, 1);
    ASSERT_EQ(law.initialise(node.b), ILAW_OK) << "angle " << angle;
    const Vector t1 = tangent();
    node.b.normal = ilaw::input(turned.data(), 0, 1);
    ASSERT_EQ(law.evaluate(node.b), ILAW_OK) << "angle " << angle;
    const Vector t2 = tangent();
    // Opposite normals: the tangent stays. Else the part along the axis stays, and that across it turns.
    Vector expected = t1;
    for (std::size_t c = 0; angle != pi && c < 3; ++c)
      expected[c] = dot(t1, along) * along[c] +
                    dot(t1, across) * (std::cos(angle) * across[c] - std::sin(angle) * n[c]);
    // The axis is known to an ulp of n over the sine of the angle.
    const double tolerance = 1e-15 + 4e-16 / std::max(pi - angle, 1e-1 * (angle == pi ? 1.0 : 0.0) + 1e-9);
    EXPECT_THAT(t2, VectorNear(expected, tolerance)) << "angle " << angle;
    EXPECT_NEAR(dot(t2, turned), 0.0, 1e-15) << "angle " << angle;
  }
}

}  // namespace
}  // namespace ilaw::testing
