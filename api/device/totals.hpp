// totals.hpp - sums and findings over the nodes of a batch: what the kernels of totals.cpp are given and
// leave. Each of a fixed number of lanes goes over every lanes-th node; their results are joined in a tree.
// So the order depends on the number of nodes alone, not on the device.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace ilaw::device {

inline constexpr std::int64_t finding_lanes = 8192, sum_lanes = 65536, last_sum_lanes = 256;
inline constexpr int sum_components = 4;

struct FindingParts {
  std::int64_t bad_count, first_bad;  // a position in the batch; -1: none
  double stable_step;
};
struct FindingArgument {
  std::int64_t count;
  const std::uint8_t* reasons;
  const double* stable_steps;
  FindingParts* parts;  // finding_lanes
};

struct SumArgument {
  std::int64_t count, lanes;
  const std::int32_t* index;
  const std::int64_t* index64;
  std::int64_t index_base;
  const double* values;  // or floats
  const float* floats;
  std::int64_t node_stride, component_stride;
  double* parts;  // sum_components for each lane
};

}  // namespace ilaw::device
