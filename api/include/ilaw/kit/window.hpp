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

#include <ilaw/kit/detail/gather.hpp>
#include <ilaw/kit/node.hpp>

#include <concepts>
#include <cstdint>

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

// Sums are compared with limits up to this part of the limit: an e/w of 1e6 leaves some 1e-10 of rounding, as
// does a clock that adds up its steps.
inline constexpr double window_slack = 1e-9;

// The largest whole number up to x, for |x| < 2^63.
inline double floor_of(double x) {
  const auto cut = static_cast<double>(static_cast<std::int64_t>(x));
  return cut > x ? cut - 1.0 : cut;
}

// The time over which a step's impulse acts: from half step to half step.
struct step_interval {
  double end, length;
};
template <class Node>
step_interval interval_of(const Node& node) {
  return {node.time + 0.5 * node.position_step, node.velocity_step};
}

// A window in one step. What is the same at all nodes is worked out once.
class window_in_step {
 public:
  window_in_step(double duration, double buckets, step_interval step)
      : duration_(duration),
        buckets_(buckets),
        per_width_(buckets / duration),
        end_(step.end * per_width_),
        begin_(end_ - step.length * per_width_),
        now_(on_grid(end_) ? floor_of(end_) : 0.0),
        has_grid_(duration > 0.0 && duration < infinity && on_grid(end_)),
        is_short_(step.length < duration),
        place_(has_grid_ ? place_of(now_) : 0),
        edge_(edge_at(now_)) {}

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

  // The same for the nodes of a block, whose histories own(i) gives. Most were written in the newest bucket
  // as it is now: what is read of them stands at the same places, and is summed in vector code.
  template <class OwnHistory>
  void before(int count, OwnHistory own, detail::column (&sum)[3], detail::column& refused) const {
    parts p;
    const bool may_agree = has_grid_ && is_short_;
    if (may_agree) {
      gather(count, own, p);
      sum_parts(count, p, edge_, sum, refused);
    }
    for (int i = 0; i < count; ++i) {
      if (may_agree && p.stamp.values[i] == stamp_of(now_)) continue;
      const reading alone = before(own(i));
      sum[0].values[i] = alone.sum.n;
      sum[1].values[i] = alone.sum.t1;
      sum[2].values[i] = alone.sum.t2;
      refused.values[i] = alone.refused;
    }
  }

  // Takes the step's own impulse in. The history is one that before() did not refuse.
  void add(const history& own, vector impulse) const {
    if (duration_ == 0.0 || (impulse.n == 0.0 && impulse.t1 == 0.0 && impulse.t2 == 0.0)) return;
    if (has_grid_ && own[0] == stamp_of(now_) && begin_ >= now_)
      write(own, at(place_), read(own, at(place_)) + impulse);
    else
      add_elsewhere(own, impulse);
  }

  // An empty window is one without a newest bucket; what else its history holds does not count.
  void clear(const history& own) const {
    if (duration_ == infinity) write(own, 0, {});
    if (duration_ > 0.0 && duration_ < infinity) own[0] = empty;
  }

  bool forgets() const { return duration_ == 0.0; }

 private:
  // The history: number of the newest bucket, sum of the middle ones, and a ring of B + 1 buckets.
  friend class window;
  static constexpr std::int64_t middle_sum = 1, first_bucket = 4;
  // Numbers of buckets that a double and a cast hold with room to spare. A grid finer than that is finer than
  // the clock: no step lies within tau of another.
  static constexpr double largest_number = 0x1p51;

  // The newest bucket is kept as a number other than zero, so that zeros are an empty window.
  static constexpr double empty = 0.0;
  static double stamp_of(double bucket) { return bucket >= 0.0 ? bucket + 1.0 : bucket; }
  static double bucket_of(double stamp) { return stamp > 0.0 ? stamp - 1.0 : stamp; }
  static bool on_grid(double x) { return absolute(x) < largest_number; }
  static bool is_stamp(double stamp) {
    return absolute(stamp) <= largest_number && floor_of(stamp) == stamp;  // false for NaN
  }

  template <class History>
  static vector read(const History& own, std::int64_t k) {
    return {own[k], own[k + 1], own[k + 2]};
  }
  static void write(const history& own, std::int64_t k, vector sum) {
    own[k] = sum.n;
    own[k + 1] = sum.t1;
    own[k + 2] = sum.t2;
  }
  static reading checked(vector sum) { return {sum, defect(sum) == 0.0 ? not_refused : impossible_state}; }

  // Places in the ring: bucket j stands at j modulo B + 1, so that the next bucket to open takes that of the
  // oldest.
  std::int64_t ring_size() const { return static_cast<std::int64_t>(buckets_) + 1; }
  std::int64_t place_of(double bucket) const {
    const double size = buckets_ + 1.0;
    const double place = bucket - floor_of(bucket * (1.0 / size)) * size;  // the quotient may be one off
    return static_cast<std::int64_t>(place < 0.0 ? place + size : (place < size ? place : place - size));
  }
  std::int64_t after(std::int64_t place) const { return place + 1 < ring_size() ? place + 1 : 0; }
  static std::int64_t at(std::int64_t place) { return first_bucket + 3 * place; }

  // The sum of the buckets between the oldest and k, of which those after newest are not open yet: in two
  // runs of neighbours.
  template <class History>
  vector sum_between(const History& own, double k, double newest) const {
    const double first = (k - buckets_) + 1.0;
    const auto count = static_cast<std::int64_t>(smaller(k - 1.0, newest) - first) + 1;
    const std::int64_t place = place_of(first), room = ring_size() - place;
    const std::int64_t before_end = count < room ? count : room;
    return sum_of(own, place, before_end) + sum_of(own, 0, count - before_end);
  }
  template <class History>
  static vector sum_of(const History& own, std::int64_t place, std::int64_t count) {
    vector even, odd;  // two sums that do not wait for each other
    const std::int64_t end = at(place + count);
    std::int64_t k = at(place);
    for (; k + 3 < end; k += 6) {
      even = even + read(own, k);
      odd = odd + read(own, k + 3);
    }
    return k < end ? (even + read(own, k)) + odd : even + odd;
  }

  // What counts of the oldest bucket: the part that tau still covers, and its correction by the slope.
  struct edge {
    double part, slope;

    vector sum(vector middle, vector current, vector oldest, vector next) const {
      return (middle + current) + (part * oldest + slope * limited_difference(oldest, next));
    }
  };
  // A step may have begun within the oldest bucket or the next, which are then filled up to there.
  edge edge_at(double k) const {
    const double oldest = k - buckets_, filled = smaller(oldest + 1.0, begin_);
    if (filled <= oldest) return {0.0, 0.0};
    const double live = filled - (end_ - buckets_);
    const double part = smaller(1.0, begin_ < oldest + 1.0 ? live / (filled - oldest) : live);
    return {part, begin_ < oldest + 2.0 ? 0.0 : 0.5 * part * (1.0 - part)};
  }
  static vector limited_difference(vector bucket, vector next) {
    const vector difference = next - bucket;
    const double most = 2.0 * absolute(bucket.n);
    const double allowed = 2.0 * bucket.tangential_length(), found = difference.tangential_length();
    const double factor = found > allowed ? allowed / found : 1.0;
    return {smaller(larger(difference.n, -most), most), factor * difference.t1, factor * difference.t2};
  }

  // What is read of the nodes of a block, as columns: the middle sum, the newest bucket and the two oldest.
  struct parts {
    detail::column stamp, middle[3], current[3], oldest[3], next[3];
  };
  template <class OwnHistory>
  void gather(int count, OwnHistory own, parts& p) const {
    const std::int64_t latest = at(place_), oldest = at(after(place_)), next = at(after(after(place_)));
    for (int i = 0; i < count; ++i) {
      const auto h = own(i);
      p.stamp.values[i] = h[0];
      for (int c = 0; c < 3; ++c) {
        p.middle[c].values[i] = h[middle_sum + c];
        p.current[c].values[i] = h[latest + c];
        p.oldest[c].values[i] = h[oldest + c];
        p.next[c].values[i] = h[next + c];
      }
    }
  }
  static vector at(const detail::column (&c)[3], int i) {
    return {c[0].values[i], c[1].values[i], c[2].values[i]};
  }
  // The parts are not const: GCC 12 thinks of a block without nodes, and warns that they are not initialised.
  [[gnu::noinline, gnu::flatten]] static void sum_parts(int count, parts& p, edge given,
                                                        detail::column (&sum)[3], detail::column& refused) {
#pragma omp simd
    for (int i = 0; i < count; ++i)
      put(given.sum(at(p.middle, i), at(p.current, i), at(p.oldest, i), at(p.next, i)), i, sum, refused);
  }
  static void put(vector s, int i, detail::column (&sum)[3], detail::column& refused) {
    sum[0].values[i] = s.n;
    sum[1].values[i] = s.t1;
    sum[2].values[i] = s.t2;
    refused.values[i] = defect(s) == 0.0 ? not_refused : impossible_state;
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

  double duration_, buckets_, per_width_, end_, begin_, now_;
  bool has_grid_, is_short_;
  std::int64_t place_;  // of bucket now_
  edge edge_;
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
// has the law record what they gave. So the steps themselves run in vector code.
template <class Law>
concept has_window = requires(const Law& law, step_interval step) {
  { law.window_in(step) } -> std::same_as<window_in_step>;
};

// What a step gave a law's window to record.
struct stepped_impulse {
  vector impulse;
  double status;
};

}  // namespace ilaw::kit
