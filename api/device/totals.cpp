// The kernels of totals.hpp, compiled for devices alone.
// SPDX-License-Identifier: BSD-3-Clause
#include "totals.hpp"

using namespace ilaw::device;

extern "C" __attribute__((global)) void ilaw_total_findings(FindingArgument a) {
  const std::int64_t lane = ilaw::kit::detail::thread_number();
  if (lane >= finding_lanes) return;
  FindingParts found{0, -1, __builtin_inf()};
  for (std::int64_t k = lane; k < a.count; k += finding_lanes) {
    if (a.reasons[k] != 0) {
      if (found.bad_count++ == 0) found.first_bad = k;
      continue;
    }
    if (a.stable_steps[k] < found.stable_step) found.stable_step = a.stable_steps[k];
  }
  a.parts[lane] = found;
}

extern "C" __attribute__((global)) void ilaw_total_sums(SumArgument a) {
  const std::int64_t lane = ilaw::kit::detail::thread_number();
  if (lane >= a.lanes) return;
  double sums[sum_components] = {};
  for (std::int64_t k = lane; k < a.count; k += a.lanes) {
    std::int64_t node = k;
    if (a.index64)
      node = a.index64[k] - a.index_base;
    else if (a.index)
      node = a.index[k] - a.index_base;
    for (int c = 0; c < sum_components; ++c) {
      const std::int64_t place = node * a.node_stride + c * a.component_stride;
      sums[c] += a.floats ? static_cast<double>(a.floats[place]) : a.values[place];
    }
  }
  for (int c = 0; c < sum_components; ++c) a.parts[sum_components * lane + c] = sums[c];
}
