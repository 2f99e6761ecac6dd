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
        ring_size_(static_cast<std::int64_t>(buckets) + 1),
        place_(has_grid_ ? place_of(now_) : 0),
        edge_(edge_at(now_)),
        shares_(has_grid_ ? shares_at(now_) : shares{}),
        stamp_(stamp_of(now_)) {}

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

  // A history whose doubles are neighbours in memory, as those of most hosts are.
  template <class Number>
  struct neighbours {
    Number* values;
    static constexpr std::int64_t stride = 1;
    Number& operator[](std::int64_t k) const { return values[k]; }
  };

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
  template <class History>
  static void write(const History& own, std::int64_t k, vector sum) {
    own[k] = sum.n;
    own[k + 1] = sum.t1;
    own[k + 2] = sum.t2;
  }
  static reading checked(vector sum) { return {sum, defect(sum) == 0.0 ? not_refused : impossible_state}; }

  // Places in the ring: bucket j stands at j modulo B + 1, so that the next bucket to open takes that of the
  // oldest.
  std::int64_t ring_size() const { return ring_size_; }
  std::int64_t place_of(double bucket) const {
    const double size = buckets_ + 1.0;
    const double place = bucket - floor_of(bucket * (1.0 / size)) * size;  // the quotient may be one off
    return static_cast<std::int64_t>(place < 0.0 ? place + size : (place < size ? place : place - size));
  }
  std::int64_t after(std::int64_t place) const { return place + 1 < ring_size() ? place + 1 : 0; }
  std::int64_t previous(std::int64_t place) const { return place > 0 ? place - 1 : ring_size() - 1; }
  static std::int64_t at(std::int64_t place) { return first_bucket + 3 * place; }

  // The sum of the buckets between the oldest and k, of which those after newest are not open yet.
  template <class History>
  vector sum_between(const History& own, double k, double newest) const {
    const double first = (k - buckets_) + 1.0;
    const auto count = static_cast<std::int64_t>(smaller(k - 1.0, newest) - first) + 1;
    return sum_from(own, place_of(first), count);
  }
  // In two runs of neighbours.
  template <class History>
  vector sum_from(const History& own, std::int64_t place, std::int64_t count) const {
    const std::int64_t room = ring_size() - place, before_end = count < room ? count : room;
    return sum_of(own, place, before_end) + sum_of(own, 0, count - before_end);
  }
  // Two sums, of every other bucket, that do not wait for each other; of neighbours in memory in vector code.
  template <class History>
  static vector sum_of(const History& own, std::int64_t place, std::int64_t count) {
    if (own.stride == 1) return sum_of_neighbours(own.values + at(place), count);
    vector even, odd;
    const std::int64_t end = at(place + count);
    std::int64_t k = at(place);
    for (; k + 3 < end; k += 6) {
      even = even + read(own, k);
      odd = odd + read(own, k + 3);
    }
    return k < end ? (even + read(own, k)) + odd : even + odd;
  }
  static vector sum_of_neighbours(const double* values, std::int64_t count) {
    two_doubles a{}, b{}, c{};
    std::int64_t k = 0;
    for (; k + 1 < count; k += 2, values += 6) {
      a += two_at(values);
      b += two_at(values + 2);
      c += two_at(values + 4);
    }
    const vector even{a[0], a[1], b[0]}, odd{b[1], c[0], c[1]};
    return k < count ? (even + vector{values[0], values[1], values[2]}) + odd : even + odd;
  }
  using two_doubles = double __attribute__((vector_size(16)));
  static two_doubles two_at(const double* values) {
    two_doubles both;
    __builtin_memcpy(&both, values, sizeof both);
    return both;
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
  static vector at(const detail::column (&c)[3], int i) {
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
    for (int i = 0; i < count; ++i) put_sum(r, i, given, at(p.current, i), at(p.oldest, i), at(p.next, i));
  }
  static void put_sum(block_reading& r, int i, edge given, vector current, vector oldest, vector next) {
    const vector s = given.sum(at(r.middle, i), current, oldest, next);
    put(s, i, r.sum);
    r.refused.values[i] = defect(s) == 0.0 ? not_refused : impossible_state;
  }

  // How a step is spread over the buckets that it covers, as far as tau reaches: from bucket first, which
  // gets its share, over others that get one each to the newest, which gets what is left where the whole
  // counts, else its share.
  struct shares {
    double first, of_first, of_others, of_last;
    bool is_whole;
  };
  shares shares_at(double k) const {
    const bool is_whole = begin_ >= k - buckets_;
    const double length = end_ - begin_, first = is_whole ? floor_of(begin_) : k - buckets_;
    return {first, (smaller(first + 1.0, end_) - larger(first, begin_)) / length, 1.0 / length,
            (end_ - larger(now_, begin_)) / length, is_whole};
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
    vector middle = is_known ? at(read_->middle, node_) : opened_middle(own, turns);
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

  double duration_, buckets_, per_width_, end_, begin_, now_;
  bool has_grid_, is_short_;
  std::int64_t ring_size_, place_;  // of bucket now_
  edge edge_;
  shares shares_;
  double stamp_;  // of bucket now_
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
