// motion.hpp - axes that move with a surface, in which a motion of points and surface as one rigid body is
// none.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vector.hpp"

#include <array>
#include <cstddef>
#include <vector>

namespace ilaw::search {

// Any axes do; these have their origin at one node, and turn with the directions to two others, far apart.
class Axes {
 public:
  Axes(const std::vector<Vec>& nodes, bool is_plane);

  void follow(const std::vector<Vec>& nodes);
  Vec seen(Vec p) const {
    const Vec from = p - origin_;
    return {dot(from, axes_[0]), dot(from, axes_[1]), dot(from, axes_[2])};
  }

 private:
  bool is_plane_;
  std::array<std::size_t, 3> nodes_{};
  Vec origin_{};
  std::array<Vec, 3> axes_{};
};

}  // namespace ilaw::search
