// small_batch.hpp - a batch of a few nodes that are all alike, for tests that say only what is special about
// theirs.
#pragma once

#include <ilaw/ilaw.h>
#include <ilaw/arrays.hpp>

#include <array>
#include <cstdint>
#include <vector>

namespace ilaw::testing {

// Every node has the same velocity before the step and without the law, H = 1, gap 0, area 1, and steps of
// 1 ms, until a test changes a member or points the batch elsewhere.
struct SmallBatch {
  SmallBatch(std::size_t count, const std::array<double, 3>& velocity, std::size_t state_size = 0)
      : v(velocity), r(count), status(count), state(count * state_size) {
    b.struct_size = sizeof b;
    b.node_count = static_cast<std::int64_t>(count);
    b.velocity_step = b.position_step = 1e-3;
    b.v_free = b.v_previous = ilaw::input(v.data(), 0, 1);
    b.delassus = ilaw::input(h.data(), 0, 1);
    b.gap = ilaw::input(&gap, 0, 1);
    b.area = ilaw::input(&area, 0, 1);
    b.state_in = ilaw::input(state.data(), static_cast<std::int64_t>(state_size), 1);
    b.state_out = ilaw::output(state.data(), static_cast<std::int64_t>(state_size), 1);
    b.impulse = ilaw::output(r[0].data(), 3, 1);
    b.status = status.data();
    b.status_stride = 1;
    report.struct_size = sizeof report;
  }
  SmallBatch(const SmallBatch&) = delete;
  SmallBatch& operator=(const SmallBatch&) = delete;

  std::array<double, 3> v;
  std::array<double, 6> h{1.0};
  double gap = 0.0, area = 1.0;
  std::vector<std::array<double, 3>> r;
  std::vector<std::uint8_t> status;
  std::vector<double> state;
  ilaw_batch b{};
  ilaw_report report{};
};

}  // namespace ilaw::testing
