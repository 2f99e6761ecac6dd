// SPDX-License-Identifier: BSD-3-Clause
#include "tree.hpp"

#include <numeric>
#include <utility>

namespace ilaw::search {

Tree::Tree(const std::vector<Vec>& centers, std::size_t leaf_size) : items_(centers.size()) {
  std::iota(items_.begin(), items_.end(), 0);
  if (!items_.empty()) split(centers, leaf_size, 0, static_cast<std::int32_t>(items_.size()));
}

void Tree::split(const std::vector<Vec>& centers, std::size_t leaf_size, std::int32_t first,
                 std::int32_t end) {
  const std::size_t node = nodes_.size();
  nodes_.push_back({first, end, 0});
  if (static_cast<std::size_t>(end - first) <= leaf_size) return;
  Box box;
  for (std::int32_t k = first; k < end; ++k) box.add(centers[static_cast<std::size_t>(item(k))]);
  const Vec side = box.high - box.low;
  const auto along = [&](std::int32_t number) {
    const Vec p = centers[static_cast<std::size_t>(number)];
    if (side.x >= side.y && side.x >= side.z) return p.x;
    return side.y >= side.z ? p.y : p.z;
  };
  const std::int32_t middle = first + (end - first) / 2;
  std::nth_element(
      items_.begin() + first, items_.begin() + middle, items_.begin() + end,
      [&](std::int32_t a, std::int32_t b) { return std::pair(along(a), a) < std::pair(along(b), b); });
  split(centers, leaf_size, first, middle);
  nodes_[node].right = static_cast<std::int32_t>(nodes_.size());
  split(centers, leaf_size, middle, end);
}

}  // namespace ilaw::search
