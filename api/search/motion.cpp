// SPDX-License-Identifier: BSD-3-Clause
#include "motion.hpp"

namespace ilaw::search {
namespace {

template <class Measure>
std::size_t farthest(const std::vector<Vec>& nodes, Measure measure) {
  std::size_t best = 0;
  double most = 0.0;
  for (std::size_t k = 0; k < nodes.size(); ++k)
    if (const double size = measure(nodes[k]); size > most) {
      most = size;
      best = k;
    }
  return best;
}

}  // namespace

Axes::Axes(const std::vector<Vec>& nodes, bool is_plane) : is_plane_(is_plane) {
  const Vec a = nodes[0];
  nodes_[1] = farthest(nodes, [&](Vec p) { return square(p - a); });
  const Vec way = nodes[nodes_[1]] - a;
  nodes_[2] = farthest(nodes, [&](Vec p) { return square(cross(way, p - a)); });
  follow(nodes);
}

void Axes::follow(const std::vector<Vec>& nodes) {
  origin_ = nodes[nodes_[0]];
  axes_ = {Vec{1.0, 0.0, 0.0}, Vec{0.0, 1.0, 0.0}, Vec{0.0, 0.0, 1.0}};
  const Vec first = nodes[nodes_[1]] - origin_;
  const Vec normal = is_plane_ ? axes_[2] : cross(first, nodes[nodes_[2]] - origin_);
  const double a = square(first), b = square(normal);
  if (!(a > 0.0 && b > 0.0 && a < infinity && b < infinity)) return;  // nodes on a line, or lost
  axes_[0] = first / std::sqrt(a);
  axes_[2] = normal / std::sqrt(b);
  axes_[1] = cross(axes_[2], axes_[0]);
}

}  // namespace ilaw::search
