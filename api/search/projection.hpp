// projection.hpp - the closest point of a facet.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vector.hpp"

#include <array>

namespace ilaw::search {

using Corners = std::array<Vec, 4>;

enum class Shape { segment, triangle, quadrilateral };

struct Projection {
  std::array<double, 4> weights;
  Vec point, normal;
  double distance;
  std::array<bool, 4> is_at;  // edges of the facet, from corner k to k + 1; corners of a segment
};

// Corners that a facet does not have are the last one once more.
Projection project(Vec p, const Corners& corners, Shape shape);

}  // namespace ilaw::search
