// Shapes for hosts, by closed forms.
// SPDX-License-Identifier: BSD-3-Clause
#include <ilaw/shapes.hpp>

#include <gtest/gtest.h>

namespace ilaw::shapes {
namespace {

void expect_near(const vector& found, const vector& exact) {
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(found[c], exact[c], 1e-14) << c;
}

TEST(Shapes, GapsAndNormals) {
  const surface flat = plane({5.0, 0.0, 2.0}, {0.6, 0.0, 0.8});
  EXPECT_NEAR(flat.gap, 4.6, 1e-14);
  expect_near(flat.normal, {0.6, 0.0, 0.8});
  const surface ball = sphere({0.0, 3.0, -4.0}, 2.0);
  EXPECT_NEAR(ball.gap, 3.0, 1e-14);
  expect_near(ball.normal, {0.0, 0.6, -0.8});
  const surface pipe = inside(cylinder({7.0, 3.0, -4.0}, {1.0, 0.0, 0.0}, 6.0));
  EXPECT_NEAR(pipe.gap, 1.0, 1e-14);
  expect_near(pipe.normal, {0.0, -0.6, 0.8});
}

TEST(Shapes, NormalIsTheSlopeOfTheGap) {
  const vector axis = {2.0 / 3.0, 1.0 / 3.0, 2.0 / 3.0}, at = {0.3, -1.1, 0.7};
  const double step = 1e-6;
  for (std::size_t c = 0; c < 3; ++c) {
    vector ahead = at, behind = at;
    ahead[c] += step;
    behind[c] -= step;
    const double slope = (cylinder(ahead, axis, 0.5).gap - cylinder(behind, axis, 0.5).gap) / (2 * step);
    EXPECT_NEAR(slope, cylinder(at, axis, 0.5).normal[c], 1e-9);
  }
}

TEST(Shapes, APointOfATurningBodyMovesAroundItsAxis) {
  expect_near(velocity({1.0, 0.0, 0.0}, {0.0, 0.0, 2.0}, {0.0, 3.0, 5.0}), {-5.0, 0.0, 0.0});
}

// The end of a rod: 1/m + l^2 / (4 J) = 4/m across it, 1/m along it.
TEST(Shapes, DelassusOfTheEndOfARod) {
  const double mass = 2.0, length = 0.5, across = 12.0 / (mass * length * length);
  const vector along = {0.6, 0.8, 0.0}, normal = {-0.8, 0.6, 0.0};
  const symmetric inertia = {0.64 * across, 0.36 * across, across, -0.48 * across, 0.0, 0.0};  // its inverse
  const symmetric h = delassus(1.0 / mass, inertia, plus({}, along, 0.5 * length));
  expect_near(times(h, along), plus({}, along, 1.0 / mass));
  expect_near(times(h, normal), plus({}, normal, 4.0 / mass));
  expect_near(times(h, {0.0, 0.0, 1.0}), {0.0, 0.0, 4.0 / mass});
}

// A sphere at its foot: 7/2m along the ground.
TEST(Shapes, DelassusOfASphereAtItsFoot) {
  const double mass = 3.0, radius = 0.2, inverse = 2.5 / (mass * radius * radius);
  const symmetric h = delassus(1.0 / mass, {inverse, inverse, inverse, 0.0, 0.0, 0.0}, {0.0, 0.0, -radius});
  expect_near({h[0], h[1], h[2]}, {3.5 / mass, 3.5 / mass, 1.0 / mass});
  expect_near({h[3], h[4], h[5]}, {});
}

}  // namespace
}  // namespace ilaw::shapes
