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
    const edge e = edge_at(k);
    if (k == newest)
      return checked(e.sum(read(own, middle_sum), read(own, current), read(own, oldest_bucket),
                           read(own, oldest_slope)));
    const turned t = turn(own, k, k - newest);
    const vector middle = t.middle, oldest = t.oldest;
    return checked(e.sum(middle, {}, oldest, limited_difference(oldest, vector(t.next))));
  }

  // Takes the step's own impulse in. The history is one that before() did not refuse.
  void add(const history& own, vector impulse) const {
    if (duration_ == 0.0 || is_zero(impulse)) return;
    if (duration_ == infinity) return write(own, 0, read(own, 0) + impulse);
    if (!has_grid_) return;
    if (own[0] == stamp_ && begin_ >= now_) return write(own, current, read(own, current) + impulse);
    const double k = newest_with_step(own[0]), turns = turns_since(own[0]);
    add_in(own, impulse, k, turns, turns > 0.0 ? turn(own, k, turns) : turned{});
  }

  // An empty window is one without a newest bucket; what else its history holds does not count.
  void clear(const history& own) const {
    if (duration_ == infinity) write(own, 0, {});
    if (duration_ > 0.0 && duration_ < infinity) own[0] = empty;
  }

  bool forgets() const { return duration_ == 0.0; }

 protected:
  friend class window;
  static bool is_zero(vector a) { return a.n == 0.0 && a.t1 == 0.0 && a.t2 == 0.0; }
  static reading checked(vector sum) { return {sum, defect(sum) == 0.0 ? not_refused : impossible_state}; }

  // The newest bucket once a step is taken in, and by how many it then lies behind the one before; more than
  // B where that was empty, or nothing of it counts.
  double newest_with_step(double stamp) const {
    return stamp == empty ? now_ : larger(now_, bucket_of(stamp));
  }
  double turns_since(double stamp) const {
    return stamp == empty ? buckets_ + 1.0
                          : smaller(newest_with_step(stamp) - bucket_of(stamp), buckets_ + 1.0);
  }

  // Bucket k becomes the newest, or is it still; t: what turn() makes of the others, without the impulse.
  void add_in(const history& own, vector impulse, double k, double turns, const turned& t) const {
    if (own.stride == 1)
      add_where(neighbours<double>{own.values}, impulse, k, turns, t);
    else
      add_where(own, impulse, k, turns, t);
  }
  template <class History>
  [[gnu::noinline]] void add_where(const History& own, vector impulse, double k, double turns,
                                   const turned& t) const {
    vector middle = turns > 0.0 ? t.middle : read(own, middle_sum);
    if (turns > 0.0) open(own, k, turns, t.oldest);
    spread(own, impulse, k, middle);
    write(own, middle_sum, middle);
    const double oldest = k - buckets_;
    write(own, oldest_slope,
          limited_difference(read(own, oldest_bucket), read(own, index_of(oldest + 1.0, k))));
    own[0] = stamp_of(k);
  }
  // Closes the newest bucket and opens those up to k, of which it is so many away.
  template <class History>
  void open(const History& own, double k, double turns, vector oldest) const {
    const vector last = read(own, current);
    std::int64_t place = place_of(k - 1.0);
    double j = 1.0;
    for (; j < turns && j < buckets_; j += 1.0, place = previous(place)) write(own, at(place), {});
    if (turns < buckets_) write(own, at(place), last);
    write(own, oldest_bucket, oldest);
    write(own, current, {});
  }
  // Over the buckets that the step covers, as far as tau reaches; the last takes what is left, so that the
  // whole arrives. The step may end before bucket k.
  template <class History>
  void spread(const History& own, vector impulse, double k, vector& middle) const {
    const shares s = k == now_ ? shares_ : shares_at(k);
    vector left = impulse;
    for (double j = s.first; j < now_; j += 1.0) {
      const vector part = (j == s.first ? s.of_first : s.of_others) * impulse;
      left = left - part;
      put_in(own, part, j, k, middle);
    }
    put_in(own, s.is_whole ? left : s.of_last * impulse, now_, k, middle);
  }
  template <class History>
  void put_in(const History& own, vector part, double j, double k, vector& middle) const {
    const std::int64_t index = index_of(j, k);
    write(own, index, read(own, index) + part);
    if (index >= first_bucket) middle = middle + part;
  }
};

class window {
 public:
  using reading = window_in_step::reading;

  // Doubles of history that a duration and a number of buckets B need, whatever the time step.
  static std::int64_t doubles(double duration, double buckets) {
    if (duration == 0.0) return 0;
    if (duration == infinity) return 3;
    return window_in_step::first_bucket + 3 * (static_cast<std::int64_t>(buckets) - 1);
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
