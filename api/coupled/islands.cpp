// SPDX-License-Identifier: BSD-3-Clause
#include "islands.hpp"

#include <numeric>

namespace ilaw::coupled {
namespace {

// Calls visit with each movable body of a contact.
template <class Visit>
void for_movable(const Block& block, std::size_t lane, const Bodies& bodies, Visit&& visit) {
  for (int e = 0; e < block.layout->ends; ++e)
    if (const std::int32_t body = block.end(e, lane); bodies.is_movable(body)) visit(body);
}

// The last movable body of a contact, or else the wall's index.
std::int32_t a_movable(const Block& block, std::size_t lane, const Bodies& bodies) {
  std::int32_t found = bodies.wall();
  for_movable(block, lane, bodies, [&](std::int32_t body) { found = body; });
  return found;
}

}  // namespace

std::int32_t Islands::root(std::int32_t body) {
  const auto at = [&](std::int32_t b) -> std::int32_t& { return joined_to_[static_cast<std::size_t>(b)]; };
  while (at(body) != body) body = at(body) = at(at(body));
  return body;
}

void Islands::find(const Blocks& blocks, const Problem& problem) {
  label(blocks, problem);
  sort(blocks);
}

std::span<const Lane> Islands::lanes(std::int32_t island) const {
  const auto i = static_cast<std::size_t>(island);
  return {lanes_.data() + first_[i], first_[i + 1] - first_[i]};
}

void Islands::join(const Blocks& blocks, const Problem& problem) {
  joined_to_.resize(static_cast<std::size_t>(problem.bodies.count()) + 1);
  std::iota(joined_to_.begin(), joined_to_.end(), 0);
  for (const Block& block : blocks.list())
    for (std::size_t q = 0; q < block.count && !block.asleep; ++q) {
      const std::int32_t one = a_movable(block, q, problem.bodies);
      for_movable(block, q, problem.bodies, [&](std::int32_t body) {
        const std::int32_t from = root(body), to = root(one);
        joined_to_[static_cast<std::size_t>(from)] = to;
      });
    }
}

void Islands::label(const Blocks& blocks, const Problem& problem) {
  join(blocks, problem);
  label_of_root_.assign(joined_to_.size(), -1);
  labels_.clear();
  first_.assign(1, 0);
  for (const Block& block : blocks.list())
    for (std::size_t q = 0; q < block.count; ++q) {
      if (block.asleep) {
        labels_.push_back(-1);
        continue;
      }
      std::int32_t& label =
          label_of_root_[static_cast<std::size_t>(root(a_movable(block, q, problem.bodies)))];
      if (label < 0) {
        label = count();
        first_.push_back(0);
      }
      ++first_[static_cast<std::size_t>(label) + 1];
      labels_.push_back(label);
    }
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
}

void Islands::sort(const Blocks& blocks) {
  next_.assign(first_.begin(), first_.end());
  lanes_.resize(first_.back());
  std::size_t k = 0;
  for (std::size_t b = 0; b < blocks.list().size(); ++b)
    for (std::size_t q = 0; q < blocks.list()[b].count; ++q, ++k)
      if (labels_[k] >= 0)
        lanes_[next_[static_cast<std::size_t>(labels_[k])]++] = {static_cast<std::int32_t>(b),
                                                                 static_cast<std::int32_t>(q)};
}

}  // namespace ilaw::coupled
