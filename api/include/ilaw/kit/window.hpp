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
#include <ilaw/kit/detail/window_grid.hpp>
#include <ilaw/kit/node.hpp>

#include <concepts>
#include <cstdint>

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

// Sums are compared with limits up to this part of the limit: an e/w of 1e6 leaves some 1e-10 of rounding, as
// does a clock that adds up its steps.
inline constexpr double window_slack = 1e-9;

// A window in one step. What is the same at all nodes is worked out once.
class window_in_step : detail::window_grid {
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

  // The same for the nodes of a block, whose histories own(i) gives, and what of it add() needs again. What
  // was written in the newest bucket or before it is summed in vector code.
  struct block_reading {
    detail::column sum[3], refused, stamp, middle[3];
  };
  template <class OwnHistory>
  void before(int count, OwnHistory own, block_reading& r) const {
    const auto in_row = [&own](int i) { return neighbours<const double>{own(i).values}; };
    if (count > 0 && own(0).stride == 1)
      before_in(count, in_row, r);
    else
      before_in(count, own, r);
  }

 private:
  template <class OwnHistory>
  void before_in(int count, OwnHistory own, block_reading& r) const {
    parts p;
    int others[detail::block_size], other_count = 0;
    if (has_grid_ && is_short_) {
      const std::int64_t latest = at(place_), oldest = at(after(place_)), next = at(after(after(place_)));
      for (int i = 0; i < count; ++i) {
        const auto h = own(i);
        r.stamp.values[i] = h[0];
        put(read(h, middle_sum), i, r.middle);
        put(read(h, latest), i, p.current);
        put(read(h, oldest), i, p.oldest);
        put(read(h, next), i, p.next);
        others[other_count] = i;
        other_count += h[0] == stamp_ ? 0 : 1;
      }
      other_count = read_older(others, other_count, own, r, p);
      sum_parts(count, r, p, edge_);
    } else {
      for (; other_count < count; ++other_count) others[other_count] = other_count;
    }
    for (int k = 0; k < other_count; ++k) {
      const int i = others[k];
      const reading alone = before(own(i));
      r.stamp.values[i] = empty;
      put(alone.sum, i, r.sum);
      r.refused.values[i] = alone.refused;
    }
  }

 public:
  // Tells add() what before() read of node i, whose turn it is.
  void recall(const block_reading& r, int i) {
    read_ = &r;
    node_ = i;
  }

  // Takes the step's own impulse in. The history is one that before() did not refuse.
  void add(const history& own, vector impulse) const {
    if (duration_ == 0.0 || (impulse.n == 0.0 && impulse.t1 == 0.0 && impulse.t2 == 0.0)) return;
    if (has_grid_ && own[0] == stamp_ && begin_ >= now_)
      write(own, at(place_), read(own, at(place_)) + impulse);
    else if (const double turns = has_grid_ ? turns_since(own[0]) : -1.0; turns > 0.0)
      own.stride == 1 ? open_and_add(neighbours<double>{own.values}, impulse, turns)
                      : open_and_add(own, impulse, turns);
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
  static reading checked(vector sum) { return {sum, defect(sum) == 0.0 ? not_refused : impossible_state}; }

  // By how many buckets the newest one lies before that of this step, up to B, for which the rest of a
  // history counts; B + 1 where it is empty, -1 where it is something else.
  double turns_since(double stamp) const {
    if (stamp == empty) return buckets_ + 1.0;
    const double turns = now_ - bucket_of(stamp);
    const bool counts = (turns >= 0.0) & (turns <= buckets_);  // false for NaN
    return counts && floor_of(turns) == turns ? turns : -1.0;
  }

  // What is read of the nodes of a block beside their middle sums, as columns.
  struct parts {
    detail::column current[3], oldest[3], next[3];
  };
  // Mends what was read of nodes whose newest bucket lies further back. Returns how many are left in the
  // list, which are to be read alone.
  template <class OwnHistory>
  int read_older(int* nodes, int node_count, OwnHistory own, block_reading& r, parts& p) const {
    const std::int64_t next = after(after(place_));
    int left = 0;
    for (int k = 0; k < node_count; ++k) {
      const int i = nodes[k];
      const double turns = turns_since(r.stamp.values[i]);
      nodes[left] = i;
      left += turns < 0.0 ? 1 : 0;
      const bool counts = (turns > 0.0) & (turns <= buckets_);
      const auto middle_count = static_cast<std::int64_t>(buckets_ - turns);
      put(counts ? sum_from(own(i), next, middle_count) : vector{}, i, r.middle);
      put({}, i, p.current);
      if (!counts) put({}, i, p.oldest);
      if (!counts || turns == buckets_) put({}, i, p.next);
    }
    return left;
  }
  static vector vector_at(const detail::column (&c)[3], int i) {
    return {c[0].values[i], c[1].values[i], c[2].values[i]};
  }
  static void put(vector a, int i, detail::column (&c)[3]) {
    c[0].values[i] = a.n;
    c[1].values[i] = a.t1;
    c[2].values[i] = a.t2;
  }
  // The parts are not const: GCC 12 thinks of a block without nodes, and warns that they are not initialised.
  [[gnu::noinline, gnu::flatten]] static void sum_parts(int count, block_reading& r, parts& p, edge given) {
#pragma omp simd
    for (int i = 0; i < count; ++i)
      put_sum(r, i, given, vector_at(p.current, i), vector_at(p.oldest, i), vector_at(p.next, i));
  }
  static void put_sum(block_reading& r, int i, edge given, vector current, vector oldest, vector next) {
    const vector s = given.sum(vector_at(r.middle, i), current, oldest, next);
    put(s, i, r.sum);
    r.refused.values[i] = defect(s) == 0.0 ? not_refused : impossible_state;
  }

  template <class History>
  vector opened_middle(const History& own, double turns) const {
    if (turns > buckets_) return {};
    return sum_from(own, after(after(place_)), static_cast<std::int64_t>(buckets_ - turns));
  }

  // Where the newest bucket lies `turns` before that of the step, which is opened with those between.
  template <class History>
  [[gnu::noinline]] void open_and_add(const History& own, vector impulse, double turns) const {
    const bool is_known = read_ && own[0] == read_->stamp.values[node_] && turns <= buckets_;
    const auto opened = static_cast<std::int64_t>(turns), oldest = after(place_);
    vector middle = is_known ? vector_at(read_->middle, node_) : opened_middle(own, turns);
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

  const block_reading* read_ = nullptr;
  int node_ = 0;
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
