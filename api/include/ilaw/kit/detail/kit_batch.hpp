// kit_batch.hpp - a checked batch as the loops see it: one pointer per array, to doubles or floats as the
// instance says.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/ilaw.h>

#include <cstdint>

struct ilaw_kit_input {
  const double* values;  // floats, where ilaw_kit_batch.flags says so
  std::int64_t node_stride;
  std::int64_t component_stride;
};
struct ilaw_kit_output {
  double* values;
  std::int64_t node_stride;
  std::int64_t component_stride;
};
struct ilaw_kit_batch {
  std::int32_t index_base;
  std::uint64_t flags;
  std::int64_t node_count;
  const std::int32_t* index;
  const std::int64_t* index64;
  double time, velocity_step, position_step;
  ilaw_kit_input v_free, delassus, gap, gap_offset, v_previous, area, normal, tangent;
  const ilaw_input* per_node_parameters;
  ilaw_kit_input state_in;
  ilaw_kit_output state_out, impulse, velocity, energy;
  std::uint8_t* status;
  std::int64_t status_stride;
};
