// window.hpp - the sum of a node's impulses over the last tau, from a bounded number of buckets and for any
// time steps.
//
// The impulse of a step is spread evenly over the step's interval [e - h, e], which ends half a position step
// after the configuration: the intervals of successive steps touch, also when the step varies. Buckets of
// width w = tau/B stand on a fixed grid in absolute time, b_j over [j w, (j + 1) w). With k = floor(e/w) and
// theta = (k + 1) - e/w, the part of the oldest bucket that tau still covers, the sum is
//   S = r + b_k + (b_{k-1} + ... + b_{k-B+1}) + theta b_{k-B} + theta (1 - theta)/2 sigma,
// its last term by a force that is linear in the oldest bucket: sigma = b_{k-B+1} - b_{k-B}, limited to twice
// b_{k-B} so that no force changes its sign within a bucket (van Leer 1979, in normal and tangential part).
// The own impulse counts whole: where h >= tau, S = r.
//
// Error, for a force F that is smooth over the two oldest buckets: for F = x^2/2 over buckets [0, 1] and
// [1, 2], b = 1/6 and sigma = 1, and with u = 1 - theta the sum of the oldest is off by u (1 - u) (2 - u)/6,
// at most 1/(9 sqrt 3). Hence |S - integral of F| <= w^3 |F''|/(9 sqrt 3), and constant and linear forces are
// exact. Where the slope is limited, or not known since the step began less than a bucket after the oldest
// (h > tau - 2 w), |S - integral| <= w^2 |F'|/8 (linear interpolation of the integral). A step that the edge
// of a bucket cuts adds up to h^2 |F'|/8. Where F jumps by J within the oldest bucket: w J/4. A shock is
// exact until tau - w after it, and fades over the width of its bucket.
//
// No sum runs on: that of the middle buckets is formed anew whenever k turns, so nothing drifts. Of time the
// state holds the number of the newest bucket alone. A step without impulse leaves it as it is, bit for bit.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/window_grid.hpp>
#include <ilaw/kit/node.hpp>

#include <concepts>
#include <cstdint>

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

// Sums are compared with limits up to this part of the limit: an e/w of 1e6 leaves some 1e-10 of rounding, as
// does a clock that adds up its steps.
inline constexpr double window_slack = 1e-9;

// A window in one step. What is the same at all nodes is worked out once.
class window_in_step : protected detail::window_grid {
 public:
  using window_grid::window_grid;

  // The sum of the impulses before the step, within tau of its end; or why there is none.
  struct reading {
    vector sum;
    double refused = not_refused;
  };
  template <class History>
  reading before(const History& own) const {
    if (duration_ == 0.0) return {};
    if (duration_ == infinity) return checked(read(own, 0));
    const double stamp = own[0];
    if (!is_stamp(stamp)) return {{}, impossible_state};
    if (stamp == empty || !has_grid_) return {};
    const double newest = bucket_of(stamp), k = larger(now_, newest);
    // A host whose position step is not the next one may fall back by a part of its last step.
    if (now_ < newest - 1.0) return {{}, time_before_history};
    if (!is_short_ || k - newest > buckets_) return {};
    const std::int64_t latest = place_of(k), oldest = after(latest);
    const vector middle = k == newest ? read(own, middle_sum) : sum_between(own, k, newest);
    const vector current = k == newest ? read(own, at(latest)) : vector{};
    const vector next = k - buckets_ + 1.0 <= newest ? read(own, at(after(oldest))) : vector{};
    return checked(edge_at(k).sum(middle, current, read(own, at(oldest)), next));
  }

  // Takes the step's own impulse in. The history is one that before() did not refuse.
  void add(const history& own, vector impulse) const {
    if (duration_ == 0.0 || is_zero(impulse)) return;
    if (has_grid_ && own[0] == stamp_ && begin_ >= now_)
      write(own, at(place_), read(own, at(place_)) + impulse);
    else if (const double turns = has_grid_ ? turns_since(own[0]) : -1.0; turns > 0.0)
      open_and_add(own, impulse, turns, opened_middle(own, turns));
    else
      add_elsewhere(own, impulse);
  }

  // An empty window is one without a newest bucket; what else its history holds does not count.
  void clear(const history& own) const {
    if (duration_ == infinity) write(own, 0, {});
    if (duration_ > 0.0 && duration_ < infinity) own[0] = empty;
  }

  bool forgets() const { return duration_ == 0.0; }

 protected:
  // The history: number of the newest bucket, sum of the middle ones, and a ring of B + 1 buckets.
  friend class window;
  static bool is_zero(vector a) { return a.n == 0.0 && a.t1 == 0.0 && a.t2 == 0.0; }
  static reading checked(vector sum) { return {sum, defect(sum) == 0.0 ? not_refused : impossible_state}; }

  // By how many buckets the newest one lies before that of this step, up to B, for which the rest of a
  // history counts; B + 1 where it is empty, -1 where it is something else.
  double turns_since(double stamp) const {
    if (stamp == empty) return buckets_ + 1.0;
    const double turns = now_ - bucket_of(stamp);
    const bool counts = (turns >= 0.0) & (turns <= buckets_);  // false for NaN
    return counts && floor_of(turns) == turns ? turns : -1.0;
  }

  template <class History>
  vector opened_middle(const History& own, double turns) const {
    if (turns > buckets_) return {};
    return sum_from(own, after(after(place_)), static_cast<std::int64_t>(buckets_ - turns));
  }

  // Where the newest bucket lies `turns` before that of the step, which is opened with those between; middle
  // is the sum of the middle buckets then, without the impulse.
  void open_and_add(const history& own, vector impulse, double turns, vector middle) const {
    if (own.stride == 1)
      open_in(neighbours<double>{own.values}, impulse, turns, middle);
    else
      open_in(own, impulse, turns, middle);
  }
  template <class History>
  [[gnu::noinline]] void open_in(const History& own, vector impulse, double turns, vector middle) const {
    const auto opened = static_cast<std::int64_t>(turns), oldest = after(place_);
    for (std::int64_t j = 0, place = place_; j < opened; ++j, place = previous(place))
      write(own, at(place), {});
    vector left = impulse;
    std::int64_t place = place_ - static_cast<std::int64_t>(now_ - shares_.first);
    place = place < 0 ? place + ring_size() : place;
    for (double j = shares_.first; j < now_; j += 1.0, place = after(place)) {
      const vector part = (j == shares_.first ? shares_.of_first : shares_.of_others) * impulse;
      left = left - part;
      write(own, at(place), read(own, at(place)) + part);
      if (place != oldest) middle = middle + part;
    }
    const vector last = shares_.is_whole ? left : shares_.of_last * impulse;
    write(own, at(place_), read(own, at(place_)) + last);
    write(own, middle_sum, middle);
    own[0] = stamp_;
  }
  // Where the step lies in other buckets than the newest, or in several.
  [[gnu::noinline]] void add_elsewhere(const history& own, vector impulse) const {
    if (duration_ == infinity) return write(own, 0, read(own, 0) + impulse);
    if (!has_grid_) return;
    const double newest = own[0] == empty ? now_ - buckets_ - 1.0 : bucket_of(own[0]);
    const double k = larger(now_, newest);
    clear_between(own, newest, k);
    spread(own, impulse, k);
    write(own, middle_sum, sum_between(own, k, k));
    own[0] = stamp_of(k);
  }

  // Opens the buckets after newest up to k.
  void clear_between(const history& own, double newest, double k) const {
    const double first = larger(newest + 1.0, k - buckets_);
    std::int64_t place = place_of(first);
    for (double j = first; j <= k; j += 1.0, place = after(place)) write(own, at(place), {});
  }

  // Over the buckets that the step covers, as far as tau reaches; the last takes what is left, so that the
  // whole arrives. The step may end before bucket k.
  void spread(const history& own, vector impulse, double k) const {
    const bool is_whole = begin_ >= k - buckets_;
    const double first = is_whole ? floor_of(begin_) : k - buckets_;
    vector left = impulse;
    std::int64_t place = place_of(first);
    for (double j = first; j <= now_; j += 1.0, place = after(place)) {
      const double overlap = smaller(j + 1.0, end_) - larger(j, begin_);
      const vector part = is_whole && j == now_ ? left : (overlap / (end_ - begin_)) * impulse;
      left = left - part;
      write(own, at(place), read(own, at(place)) + part);
    }
  }
};

class window {
 public:
  using reading = window_in_step::reading;

  // Doubles of history that a duration and a number of buckets B need, whatever the time step.
  static std::int64_t doubles(double duration, double buckets) {
    if (duration == 0.0) return 0;
    if (duration == infinity) return 3;
    return window_in_step::first_bucket + 3 * (static_cast<std::int64_t>(buckets) + 1);
  }

  window(double duration, double buckets) : duration_(duration), buckets_(buckets) {}

  window_in_step in(step_interval step) const { return {duration_, buckets_, step}; }

  template <class History>
  reading before(const History& own, step_interval step) const {
    return in(step).before(own);
  }
  void add(const history& own, step_interval step, vector impulse) const { in(step).add(own, impulse); }

 private:
  double duration_, buckets_;
};

// Whether a law's history is a window: the kit reads it ahead of the steps of a block, as node.earlier, and
// takes in what they gave. So the steps themselves run in vector code.
template <class Law>
concept has_window = requires(const Law& law, step_interval step) {
  { law.window_in(step) } -> std::same_as<window_in_step>;
};

}  // namespace ilaw::kit
