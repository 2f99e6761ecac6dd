// SPDX-License-Identifier: BSD-3-Clause
#include "islands.hpp"

#include <algorithm>
#include <numeric>

namespace ilaw::coupled {

std::int32_t Islands::root(std::int32_t body) {
  const auto at = [&](std::int32_t b) -> std::int32_t& { return joined_to_[static_cast<std::size_t>(b)]; };
  while (at(body) != body) body = at(body) = at(at(body));
  return body;
}

void Islands::find(const Blocks& blocks, const Problem& problem) {
  const auto bodies = static_cast<std::size_t>(problem.bodies.count()) + 1;
  joined_to_.resize(bodies);
  std::iota(joined_to_.begin(), joined_to_.end(), 0);
  const auto for_each_contact = [&](const auto& visit) {
    for (const Block& block : blocks.list())
      for (std::size_t q = 0; q < block.count; ++q) visit(block, q);
  };
  // A movable body of the contact, or else the wall's index.
  const auto first_movable = [&](const Block& block, std::size_t q) {
    const int ends = problem.layouts[static_cast<std::size_t>(block.group)].ends;
    for (int e = 0; e < ends; ++e)
      if (const std::int32_t b = block.ends[static_cast<std::size_t>(e) * block.stride + q];
          problem.bodies.is_movable(b))
        return b;
    return problem.bodies.wall();
  };
  for_each_contact([&](const Block& block, std::size_t q) {
    if (block.asleep) return;
    const std::int32_t first = first_movable(block, q);
    const int ends = problem.layouts[static_cast<std::size_t>(block.group)].ends;
    for (int e = 0; e < ends; ++e)
      if (const std::int32_t b = block.ends[static_cast<std::size_t>(e) * block.stride + q];
          problem.bodies.is_movable(b)) {
        const std::int32_t other = root(first);
        joined_to_[static_cast<std::size_t>(root(b))] = other;
      }
  });
  label_of_root_.assign(bodies, -1);
  labels_.clear();
  residuals_.clear();
  count_ = 0;
  for_each_contact([&](const Block& block, std::size_t q) {
    if (block.asleep) return labels_.push_back(-1);
    std::int32_t& label = label_of_root_[static_cast<std::size_t>(root(first_movable(block, q)))];
    if (label < 0) {
      label = count_++;
      residuals_.push_back(0.0);
    }
    labels_.push_back(label);
  });
}

}  // namespace ilaw::coupled
