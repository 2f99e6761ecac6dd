// tree.hpp - a tree of bounding boxes over items: halves of the items along the longest side of their box.
// Its form is that of the start; boxes follow the items.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vector.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace ilaw::search {

class Tree {
 public:
  struct Node {
    std::int32_t first, end;  // items, in the order of the tree
    std::int32_t right;       // the second child; the first one is the next node; 0: a leaf
  };

  // Leaves have at most leaf_size items.
  Tree(const std::vector<Vec>& centers, std::size_t leaf_size);

  const Node& operator[](std::size_t node) const { return nodes_[node]; }
  std::size_t size() const { return nodes_.size(); }
  const std::int32_t* items() const { return items_.data(); }
  std::int32_t item(std::int32_t place) const { return items_[static_cast<std::size_t>(place)]; }

  // Bounds of all nodes: box_of(item).
  template <class BoxOf>
  void fit(std::vector<Box>& boxes, BoxOf box_of) const {
    boxes.resize(nodes_.size());
    for (std::size_t n = nodes_.size(); n-- > 0;) {
      Box box;
      if (const Node& node = nodes_[n]; node.right == 0) {
        for (std::int32_t k = node.first; k < node.end; ++k) box.add(box_of(item(k)));
      } else {
        box = boxes[n + 1];
        box.add(boxes[static_cast<std::size_t>(node.right)]);
      }
      boxes[n] = box;
    }
  }

  static constexpr std::size_t most_depth = 64;  // halves of 2^31 items, and some

 private:
  void split(const std::vector<Vec>& centers, std::size_t leaf_size, std::int32_t first, std::int32_t end);

  std::vector<Node> nodes_;
  std::vector<std::int32_t> items_;
};

}  // namespace ilaw::search
