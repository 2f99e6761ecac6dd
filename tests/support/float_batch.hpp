// float_batch.hpp - a batch of floats beside one of doubles.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/float.h>

namespace ilaw::testing {

// With all that is the same in both: nodes, times, states and statuses. Arrays of floats are absent.
inline ilaw_float_batch float_batch_like(const ilaw_batch& of) {
  ilaw_float_batch made{};
  made.struct_size = sizeof made;
  made.index_base = of.index_base;
  made.node_count = of.node_count;
  made.index = of.index;
  made.index64 = of.index64;
  made.time = of.time;
  made.velocity_step = of.velocity_step;
  made.position_step = of.position_step;
  made.state_in = of.state_in;
  made.state_out = of.state_out;
  made.status = of.status;
  made.status_stride = of.status_stride;
  return made;
}

}  // namespace ilaw::testing
