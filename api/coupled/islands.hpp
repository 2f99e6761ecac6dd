// islands.hpp - contacts in groups that no movable body joins: each can be solved for itself.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sweep.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace ilaw::coupled {

class Islands {
 public:
  // Labels alone, and with the contacts of each island.
  void label(const Blocks& blocks, const Problem& problem);
  void find(const Blocks& blocks, const Problem& problem);
  std::int32_t count() const { return static_cast<std::int32_t>(first_.size()) - 1; }
  // Contacts of an island that are not asleep, in the order of blocks.
  std::span<const Lane> lanes(std::int32_t island) const;
  // Island of each contact, in the order of blocks; -1 where asleep.
  const std::vector<std::int32_t>& labels() const { return labels_; }

 private:
  std::int32_t root(std::int32_t body);
  void join(const Blocks& blocks, const Problem& problem);
  void sort(const Blocks& blocks);

  std::vector<std::int32_t> labels_, joined_to_, label_of_root_;
  std::vector<std::size_t> first_{0}, next_;  // of each island in lanes_
  std::vector<Lane> lanes_;
};

}  // namespace ilaw::coupled
