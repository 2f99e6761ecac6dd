// islands.hpp - contacts in groups that no movable body joins: each can be solved for itself.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sweep.hpp"

#include <cstdint>
#include <vector>

namespace ilaw::coupled {

class Islands {
 public:
  // Of the contacts of all blocks; those asleep belong to none (-1).
  void find(const Blocks& blocks, const Problem& problem);
  std::int32_t count() const { return count_; }
  // Island of each contact, in the order of lanes.
  const std::vector<std::int32_t>& labels() const { return labels_; }
  // Largest |H dr| of each island in the last iteration.
  const std::vector<double>& residuals() const { return residuals_; }

 private:
  std::int32_t root(std::int32_t body);

  std::int32_t count_ = 0;
  std::vector<std::int32_t> labels_, joined_to_, label_of_root_;
  std::vector<double> residuals_;
};

}  // namespace ilaw::coupled
