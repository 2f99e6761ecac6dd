// window.hpp - the sum of a node's impulses over the last tau, with a bounded number of slots and for any
// time steps.
//
// An impulse of age a counts while a < tau; the step's own has age 0 and always counts. With tau = m h these
// are exactly m impulses, so a constant force F gives F tau.
//
// A slot keeps the sum of the impulses of some consecutive steps, and the times of the first and last of
// them. A new slot is begun when tau/B have passed since the current one began (with every step if tau <= B
// h). No running sum is kept, so nothing drifts: the sum is that of the slots.
//
// B+1 slots never overflow, for constant or varying h: slots begin at least tau/B apart, so at most B of them
// began within the last tau, and at most one that began before still has a live impulse, its successor having
// begun within the last tau. The slot to be overwritten is therefore expired.
//
// Error: none (but rounding) when each slot has one step. Else only the one slot that tau cuts is not known
// exactly; it counts with the part of its duration that is alive, so the error is at most the sum of |r| in
// that slot, whose steps span no more than tau/B. For a force that is constant over the slot the part is
// exact.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/node.hpp>

#include <cstdint>

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

class window {
 public:
  // Slots for a duration and a number of buckets B, if steps are no smaller than smallest_step.
  static std::int64_t slot_count(double duration, double buckets, double smallest_step) {
    if (duration == 0.0) return 0;
    if (duration == infinity) return 1;
    const double steps = __builtin_ceil(duration / smallest_step * (1.0 - rounding));
    return static_cast<std::int64_t>(smaller(buckets, larger(steps, 1.0))) + 1;
  }
  static std::int64_t doubles(std::int64_t slots) { return slots == 0 ? 0 : 1 + slots * slot_doubles; }

  window(double duration, std::int64_t slots) : duration_(duration), slots_(slots) {}

  // The sum of the impulses before the step that ends at time.
  template <class History>
  vector sum(const History& memory, double time, double step) const {
    vector total;
    for (std::int64_t k = 0; k < slots_; ++k) {
      const slot s = read(memory, k);
      const double part = live_part(s, time, step);
      if (part > 0.0) total = total + (part == 1.0 ? s.impulse : part * s.impulse);
    }
    return total;
  }

  // Takes the step's own impulse in.
  void add(const history& memory, double time, double step, vector impulse) const {
    if (slots_ == 0 || (impulse.n == 0.0 && impulse.t1 == 0.0 && impulse.t2 == 0.0)) return;
    auto current = static_cast<std::int64_t>(memory[0]);  // counted from 1; 0: none yet
    if (current == 0 || begins_new(read(memory, current - 1), time, step)) {
      current = current % slots_ + 1;
      memory[0] = static_cast<double>(current);
      write(memory, current - 1, {impulse, time, time});
      return;
    }
    const slot s = read(memory, current - 1);
    write(memory, current - 1, {s.impulse + impulse, s.first, time});
  }

  void clear(const history& memory) const {
    for (std::int64_t k = 0; k < doubles(slots_); ++k) memory[k] = 0.0;
  }

 private:
  static constexpr std::int64_t slot_doubles = 5;
  // Ages are differences of times: what is equal but for rounding is equal.
  static constexpr double rounding = 1e-9;
  static constexpr double age_slack = 1e-6;  // of a step

  // An empty slot has no impulse, and its times do not matter.
  struct slot {
    vector impulse;
    double first, last;
  };
  template <class History>
  static slot read(const History& memory, std::int64_t k) {
    const std::int64_t at = 1 + k * slot_doubles;
    return {{memory[at], memory[at + 1], memory[at + 2]}, memory[at + 3], memory[at + 4]};
  }
  static void write(const history& memory, std::int64_t k, const slot& s) {
    const std::int64_t at = 1 + k * slot_doubles;
    memory[at] = s.impulse.n;
    memory[at + 1] = s.impulse.t1;
    memory[at + 2] = s.impulse.t2;
    memory[at + 3] = s.first;
    memory[at + 4] = s.last;
  }

  bool begins_new(const slot& current, double time, double step) const {
    if (duration_ == infinity) return false;
    const auto buckets = static_cast<double>(slots_ - 1);
    if (duration_ <= buckets * step * (1.0 + rounding)) return true;
    return time - current.first >= duration_ / buckets - age_slack * step;
  }

  double live_part(const slot& s, double time, double step) const {
    if (duration_ == infinity) return 1.0;
    const double limit = duration_ - age_slack * step;
    if (time - s.last >= limit) return 0.0;
    if (time - s.first < limit) return 1.0;
    return smaller(1.0, (s.last - (time - duration_)) / (s.last - s.first + step));
  }

  double duration_;
  std::int64_t slots_;
};

}  // namespace ilaw::kit
