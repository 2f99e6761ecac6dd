// SPDX-License-Identifier: BSD-3-Clause
#include "projection.hpp"

#include <algorithm>
#include <cmath>

namespace ilaw::search {
namespace {

using Weights = std::array<double, 4>;

// A place on a bilinear patch: xi and eta in [-1, 1].
struct Place {
  double xi, eta;
};

Weights shape_functions(Place at) {
  const double a = 0.5 * (1.0 - at.xi), b = 0.5 * (1.0 + at.xi), c = 0.5 * (1.0 - at.eta),
               d = 0.5 * (1.0 + at.eta);
  return {a * c, b * c, b * d, a * d};
}
Vec along_xi(const Corners& x, Place at) {
  return 0.25 * ((1.0 - at.eta) * (x[1] - x[0]) + (1.0 + at.eta) * (x[2] - x[3]));
}
Vec along_eta(const Corners& x, Place at) {
  return 0.25 * ((1.0 - at.xi) * (x[3] - x[0]) + (1.0 + at.xi) * (x[2] - x[1]));
}
Vec point_of(const Corners& x, const Weights& n) {
  return n[0] * x[0] + n[1] * x[1] + n[2] * x[2] + n[3] * x[3];
}

// The closest point of an edge from a to b, as a part of the edge from a on.
double along_edge(Vec p, Vec a, Vec b) { return std::clamp(dot(p - a, b - a) / square(b - a), 0.0, 1.0); }

Projection project_on_segment(Vec p, const Corners& x) {
  const double t = along_edge(p, x[0], x[1]);
  const Vec point = (1.0 - t) * x[0] + t * x[1], way = x[1] - x[0];
  return {{1.0 - t, t, 0.0, 0.0},
          point,
          unit(Vec{way.y, -way.x, 0.0}),
          norm(p - point),
          {t == 0.0, t == 1.0, false, false}};
}

// Inside the triangle, or the closest point of an edge. The edge from corner 2 to corner 3 has no length.
Projection project_on_triangle(Vec p, const Corners& x) {
  const Vec area = cross(x[1] - x[0], x[2] - x[0]);
  const auto part = [&](Vec a, Vec b) { return dot(cross(a - p, b - p), area) / square(area); };
  Weights weights{part(x[1], x[2]), part(x[2], x[0]), part(x[0], x[1]), 0.0};
  std::array<bool, 4> is_at{};
  if (*std::min_element(weights.begin(), weights.begin() + 3) <= 0.0) {
    double least = infinity;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      const double t = along_edge(p, x[k], x[next]);
      const double apart = square(p - (1.0 - t) * x[k] - t * x[next]);
      if (!(apart < least)) continue;
      least = apart;
      weights = {};
      weights[k] = 1.0 - t;
      weights[next] = t;
    }
    is_at = {weights[2] == 0.0, weights[0] == 0.0, false, weights[1] == 0.0};
  }
  const Vec point = weights[0] * x[0] + weights[1] * x[1] + weights[2] * x[2];
  return {weights, point, unit(area), norm(p - point), is_at};
}

// A Gauss-Newton step for the closest point; a coordinate that leaves the patch is kept at its edge.
Place next_place(Vec p, const Corners& x, Place at) {
  const Vec t1 = along_xi(x, at), t2 = along_eta(x, at), rest = p - point_of(x, shape_functions(at));
  const double m11 = dot(t1, t1), m12 = dot(t1, t2), m22 = dot(t2, t2), r1 = dot(t1, rest),
               r2 = dot(t2, rest);
  const double scale = 1.0 / (m11 * m22 - m12 * m12);
  Place step{(m22 * scale) * r1 + (-m12 * scale) * r2, (-m12 * scale) * r1 + (m11 * scale) * r2};
  const Place free{at.xi + step.xi, at.eta + step.eta};
  if (std::fabs(free.xi) > 1.0) {
    const double way = std::copysign(1.0, free.xi) - at.xi;
    step = {way, (r2 - m12 * way) / m22};
  } else if (std::fabs(free.eta) > 1.0) {
    const double way = std::copysign(1.0, free.eta) - at.eta;
    step = {(r1 - m12 * way) / m11, way};
  }
  return {std::clamp(at.xi + step.xi, -1.0, 1.0), std::clamp(at.eta + step.eta, -1.0, 1.0)};
}

// On a parallelogram one step finds the place.
Projection project_on_patch(Vec p, const Corners& x) {
  constexpr int most_steps = 12;
  constexpr double rounding = 1e-14;
  Place at{0.0, 0.0};
  for (int step = 0; step < most_steps; ++step) {
    const Place next = next_place(p, x, at);
    const double moved = std::max(std::fabs(next.xi - at.xi), std::fabs(next.eta - at.eta));
    at = next;
    if (!(moved > rounding)) break;
  }
  const Weights weights = shape_functions(at);
  const Vec point = point_of(x, weights);
  return {weights,
          point,
          unit(cross(along_xi(x, at), along_eta(x, at))),
          norm(p - point),
          {at.eta == -1.0, at.xi == 1.0, at.eta == 1.0, at.xi == -1.0}};
}

}  // namespace

Projection project(Vec p, const Corners& corners, Shape shape) {
  if (shape == Shape::quadrilateral) return project_on_patch(p, corners);
  return shape == Shape::triangle ? project_on_triangle(p, corners) : project_on_segment(p, corners);
}

}  // namespace ilaw::search
