// window.hpp - the sum of a node's impulses over the last tau, from a bounded number of buckets and for any
// time steps.
//
// The impulse of a step is spread evenly over the step's interval [e - h, e], which ends half a position step
// after the configuration: the intervals of successive steps touch, also when the step varies. Buckets of
// width w = tau/B stand on a fixed grid in absolute time, b_j over [j w, (j + 1) w). With k = floor(e/w) and
// theta = (k + 1) - e/w, the part of the oldest bucket that tau still covers, the sum is
//   S = r + b_k + (b_{k-1} + ... + b_{k-B+1}) + theta b_{k-B} + theta (1 - theta)/2 sigma,
// its last term from a force that is linear in the oldest bucket: sigma = b_{k-B+1} - b_{k-B}, limited to
// twice b_{k-B} so that no force changes its sign within a bucket (van Leer 1979, in normal and tangential
// part). The step's own impulse counts in full: where h >= tau, S = r.
//
// Error, for a force F that is smooth over the two oldest buckets: for F = x^2/2 over buckets [0, 1] and [1,
// 2], b = 1/6 and sigma = 1, and with u = 1 - theta the sum of the oldest is off by u (1 - u) (2 - u)/6, at
// most 1/(9 sqrt 3). Hence |S - integral of F| <= w^3 |F''|/(9 sqrt 3), and constant and linear forces are
// exact. Where the slope is limited, or unknown since the step began less than a bucket after the oldest (h >
// tau - 2 w), |S - integral| <= w^2 |F'|/8 (linear interpolation of the integral). A step that the edge of a
// bucket cuts adds up to h^2 |F'|/8. Where F jumps by J within the oldest bucket: w J/4. A shock is exact
// until tau - w after it, and fades over the width of its bucket.
//
// No running sum is kept: that of the middle buckets is formed anew whenever k changes, so nothing drifts.
// The only time in the state is the number of the newest bucket. A step without impulse leaves the state as
// it is, bit for bit.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/load_store.hpp>
#include <ilaw/kit/node.hpp>
#include <ilaw/kit/vector.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL {
namespace detail {

// Number k of the node in lane i stands at first[k * stride + i]; V = double: of one node.
template <class V>
struct window_columns {
  using number = V;
  double* first;
  std::int64_t stride;

  ILAW_KIT_INLINE V number_at(std::int64_t k) const { return load<V>(first + k * stride); }
  ILAW_KIT_INLINE vector<V> vector_at(std::int64_t k) const {
    return {number_at(k), number_at(k + 1), number_at(k + 2)};
  }
  // A linear function of vectors, the same in all lanes. It is given vectors as it likes to read them.
  struct values {
    const window_columns& own;
    ILAW_KIT_INLINE vector<V> operator()(std::int64_t k) const { return own.vector_at(k); }
    ILAW_KIT_INLINE vector<V> zero() const { return {}; }
  };
  template <class F>
  ILAW_KIT_INLINE vector<V> linear(F f) const {
    return f(values{*this});
  }

  ILAW_KIT_INLINE void put_number(mask_of<V> where, std::int64_t k, V x) const {
    store(select(where, x, number_at(k)), first + k * stride);
  }
  ILAW_KIT_INLINE void put(mask_of<V> where, std::int64_t k, vector<V> a) const {
    put_number(where, k, a.n);
    put_number(where, k + 1, a.t1);
    put_number(where, k + 2, a.t2);
  }
  ILAW_KIT_INLINE void add(mask_of<V> where, std::int64_t k, vector<V> a) const {
    put(where, k, vector_at(k) + a);
  }
};

// The windows of the nodes in the lanes of a pack begin anywhere; stride: between the numbers of a node.
struct window_rows {
  using number = pack;
  using mask = mask_of<pack>;
  double* first[register_lanes];
  std::int64_t stride;

  // A vector behind one number that does not count, which stands before it in memory.
  using row = double __attribute__((vector_size(32)));
  struct values {
    const double* first;
    std::int64_t stride;

    ILAW_KIT_INLINE row operator()(std::int64_t k) const {
      row r;
      if (stride == 1 && k > 0) {
        __builtin_memcpy(&r, first + k - 1, sizeof r);
      } else {
        const double* const at = first + k * stride;
        r = row{0.0, at[0], at[stride], at[2 * stride]};
      }
      return r;
    }
    ILAW_KIT_INLINE row zero() const { return row{}; }
  };

  template <int... K>
  ILAW_KIT_INLINE pack number_at(std::int64_t k, std::integer_sequence<int, K...>) const {
    return pack::each([&](int) ILAW_KIT_LAMBDA { return one{first[K][k * stride]...}; });
  }
  ILAW_KIT_INLINE pack number_at(std::int64_t k) const { return number_at(k, each_lane); }
  template <class F>
  ILAW_KIT_INLINE vector<pack> linear(F f) const {
    row rows[register_lanes];
#pragma GCC unroll 8
    for (int lane = 0; lane < register_lanes; ++lane) rows[lane] = f(values{first[lane], stride});
    return to_lanes(rows, each_lane);
  }
  ILAW_KIT_INLINE vector<pack> vector_at(std::int64_t k) const {
    return linear([&](const values& value) ILAW_KIT_LAMBDA { return value(k); });
  }
  ILAW_KIT_INLINE void put_number(mask where, std::int64_t k, double x) const {
    const unsigned lanes = mask_bits(where);
    for (int lane = 0; lane < register_lanes; ++lane)
      if (lanes >> lane & 1) first[lane][k * stride] = x;
  }
  ILAW_KIT_INLINE void put(mask where, std::int64_t k, vector<pack> a) const {
    const unsigned lanes = mask_bits(where);
    row rows[register_lanes];
    to_rows(a, 0.0, rows);
#pragma GCC unroll 8
    for (int lane = 0; lane < register_lanes; ++lane)
      if (lanes >> lane & 1) {
        double* const at = first[lane] + k * stride;
        at[0] = rows[lane][1];
        at[stride] = rows[lane][2];
        at[2 * stride] = rows[lane][3];
      }
  }
  // To the number before a vector -0 is added, which changes none: it is a finite one where a node adds.
  ILAW_KIT_INLINE void add(mask where, std::int64_t k, vector<pack> a) const {
    if (stride != 1) return put(where, k, vector_at(k) + a);
    const unsigned lanes = mask_bits(where);
    row rows[register_lanes];
    to_rows(a, -0.0, rows);
#pragma GCC unroll 8
    for (int lane = 0; lane < register_lanes; ++lane)
      if (lanes >> lane & 1) {
        const row sum = values{first[lane], 1}(k) + rows[lane];
        __builtin_memcpy(first[lane] + k - 1, &sum, sizeof sum);
      }
  }

 private:
  // Four rows fill four registers, half a row or several each, and come out as columns; and back.
  template <int... K, class One = one>
  ILAW_KIT_INLINE static vector<pack> to_lanes(const row (&rows)[register_lanes],
                                               std::integer_sequence<int, K...>) {
    One in[4];
#pragma GCC unroll 4
    for (int c = 0; c < 4; ++c) {
      if constexpr (register_lanes == 8)
        in[c] = __builtin_shufflevector(rows[2 * c], rows[2 * c + 1], K...);
      else if constexpr (register_lanes == 4)
        in[c] = rows[c];
      else
        in[c] = One{rows[c / 2][c % 2 * 2], rows[c / 2][c % 2 * 2 + 1]};
    }
    One out[4];
    to_columns(in, out);
    const auto wide = [](one v)
                          ILAW_KIT_LAMBDA { return pack::each([&](int) ILAW_KIT_LAMBDA { return v; }); };
    return {wide(out[1]), wide(out[2]), wide(out[3])};
  }
  template <class One = one>
  ILAW_KIT_INLINE static void to_rows(vector<pack> a, double before, row (&rows)[register_lanes]) {
    const One in[4] = {before - one{}, a.n.v[0], a.t1.v[0], a.t2.v[0]};
    One out[4];
    detail::to_rows(in, out);
#pragma GCC unroll 8
    for (int lane = 0; lane < register_lanes; ++lane) {
      if constexpr (register_lanes == 8)
        rows[lane] = lane % 2 == 0 ? __builtin_shufflevector(out[lane / 2], out[lane / 2], 0, 1, 2, 3)
                                   : __builtin_shufflevector(out[lane / 2], out[lane / 2], 4, 5, 6, 7);
      else if constexpr (register_lanes == 4)
        rows[lane] = out[lane];
      else
        rows[lane] = row{out[2 * lane][0], out[2 * lane][1], out[2 * lane + 1][0], out[2 * lane + 1][1]};
    }
  }
};

}  // namespace detail

// ---- windows

// Sums are compared with limits up to this part of the limit: an e/w of 1e6 leaves some 1e-10 of rounding, as
// does a clock that adds up its steps.
inline constexpr double window_slack = 1e-9;

// A law's window() gives it: the duration tau and the number of buckets B.
struct window_size {
  double duration, buckets;
};

template <class Law>
constexpr parameter<Law> memory_parameter(double Law::*member) {
  return {.member = member,
          .name = "memory",
          .symbol = "tau_Y",
          .unit = "s",
          .doc = "Duration over which impulses are summed; 0: the step's own impulse alone.",
          .infinity_allowed = true};
}
template <class Law>
constexpr parameter<Law> buckets_parameter(double Law::*member) {
  return {.member = member,
          .name = "buckets",
          .symbol = "B",
          .doc = "Buckets of the window, which is of third order in their width memory/B.",
          .default_value = 16.0,
          .minimum = 1.0,
          .maximum = 4096.0,
          .whole = true};
}
inline constexpr history_card window_variable{
    .name = "window", .unit = "N.s", .doc = "Impulses of the last memory.", .internal = true};

// The windows of some nodes in one step, on V: lanes whose newest bucket is the same are worked on together.
// Own: where the windows stand.
class window {
 public:
  // Doubles of history, whatever the time step.
  static constexpr std::int64_t doubles(window_size size) {
    if (size.duration == 0.0) return 0;
    if (size.duration == infinity) return 3;
    return first_bucket + 3 * (static_cast<std::int64_t>(size.buckets) - 1);
  }

  window(window_size size, step_interval step)
      : duration_(size.duration),
        buckets_(size.buckets),
        end_(step.end * (size.buckets / size.duration)),
        begin_(end_ - step.length * (size.buckets / size.duration)),
        now_(on_grid(end_) ? floor_of(end_) : 0.0),
        has_grid_(duration_ > 0.0 && duration_ < infinity && on_grid(end_)),
        is_short_(step.length < duration_),
        counts_(has_grid_ && is_short_),
        stamp_(stamp_of(now_)),
        ring_size_(static_cast<std::int64_t>(buckets_) - 1),
        edge_(edge_at(now_)),
        shares_(has_grid_ ? shares_at(now_) : shares{}) {}

  // The sums of the impulses before the step, within tau of its end. Returns the code of a refusal.
  template <class Own>
  ILAW_KIT_INLINE auto read(const Own& own, vector<typename Own::number>& sum) const {
    using V = typename Own::number;
    V refused = 0.0;
    if (duration_ == infinity) {
      sum = own.vector_at(0);
    } else {
      const V stamp = own.number_at(0);
      const mask_of<V> open = (stamp == stamp_) & counts_;
      sum = {};
      if (any(open)) sum = zero_unless(open, open_sum(own, edge_));
      const mask_of<V> others = !(open | (stamp == empty));
      if (any(others)) [[unlikely]] {
        vector<V> all = sum;
        refused = read_others(own, others, stamp, all);
        sum = all;
      }
    }
    return select(residual(sum, V(0.0)) == 0.0, refused, code_of<V>(refusal::impossible_state));
  }

  // Empties the windows of some nodes, and then takes in the impulse at some. The history is one that read()
  // did not refuse.
  template <class Own, class V = typename Own::number>
  ILAW_KIT_INLINE void write(const Own& own, mask_of<V> clears, mask_of<V> adds, vector<V> impulse) const {
    mask_of<V> left = adds & ((impulse.n != 0.0) | (impulse.t1 != 0.0) | (impulse.t2 != 0.0));
    if (duration_ == infinity) {
      if (any(clears | left))
        own.put(clears | left, 0, zero_unless(!clears, own.vector_at(0)) + zero_unless(left, impulse));
      return;
    }
    if (any(clears)) own.put_number(clears, 0, empty);  // of an empty window no other number counts
    left = left & has_grid_;
    if (begin_ >= now_) {  // the step lies in one bucket
      const mask_of<V> open = left & (own.number_at(0) == stamp_);
      if (any(open)) own.add(open, current, impulse);
      left = left & !open;
    }
    if (any(left)) [[unlikely]]
      write_others(own, left, impulse);
  }

 private:
  // The numbers that every step needs stand in front: the number of the newest bucket, which is open, its
  // sum, that of the middle ones, the oldest bucket and the slope in it. Behind are the middle buckets, as a
  // ring.
  static constexpr std::int64_t current = 1, middle_sum = 4, oldest_bucket = 7, oldest_slope = 10,
                                first_bucket = 13;
  // Numbers of buckets that a double and a cast hold with room to spare. A grid finer than that is finer than
  // the clock: no step lies within tau of another.
  static constexpr double largest_number = 0x1p51;

  // The newest bucket is kept as a number other than zero, so that zeros are an empty window.
  static constexpr double empty = 0.0;
  static double stamp_of(double bucket) { return bucket >= 0.0 ? bucket + 1.0 : bucket; }
  static double bucket_of(double stamp) { return stamp > 0.0 ? stamp - 1.0 : stamp; }
  static bool on_grid(double x) { return absolute(x) < largest_number; }
  template <class V>
  static V code_of(refusal reason) {
    return static_cast<double>(reason);
  }
  template <class V>
  static double first_of(mask_of<V> lanes, V x) {
    return detail::lane_of(x, __builtin_ctz(detail::mask_bits(lanes)));
  }
  static double first_of(bool, double x) { return x; }

  // Places in the ring: bucket j stands at j modulo B - 1, so that the bucket that closes takes the place of
  // the one that becomes the oldest.
  std::int64_t place_of(double bucket) const {
    const double size = buckets_ - 1.0;
    if (size < 1.0) return 0;
    const double place = bucket - floor_of(bucket * (1.0 / size)) * size;  // the quotient may be one off
    return static_cast<std::int64_t>(place < 0.0 ? place + size : (place < size ? place : place - size));
  }
  static std::int64_t at(std::int64_t place) { return first_bucket + 3 * place; }

  // The part of the oldest bucket that tau still covers, and its correction by the slope.
  struct edge {
    double part, slope;

    // The sum of vectors in lanes, or of one that fills a register.
    template <class Vector>
    ILAW_KIT_INLINE Vector sum(Vector middle, Vector newest, Vector oldest, Vector difference) const {
      return (middle + newest) + (part * oldest + slope * difference);
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

  template <class V>
  static vector<V> limited_difference(vector<V> bucket, vector<V> next) {
    const vector<V> difference = next - bucket;
    const V most = 2.0 * absolute(bucket.n);
    const V scale = power_scale_of(larger(larger(absolute(bucket.t1), absolute(bucket.t2)),
                                          larger(absolute(difference.t1), absolute(difference.t2))))
                        .down;
    const V a1 = scale * bucket.t1, a2 = scale * bucket.t2, b1 = scale * difference.t1,
            b2 = scale * difference.t2;
    const V allowed = 4.0 * (a1 * a1 + a2 * a2), found = b1 * b1 + b2 * b2;
    const mask_of<V> is_steep = found > allowed;
    const V factor = square_root(select(is_steep, allowed, V(1.0)) / select(is_steep, found, V(1.0)));
    return {smaller(larger(difference.n, -most), most), factor * difference.t1, factor * difference.t2};
  }

  // Where the newest bucket stays open.
  template <class Own>
  ILAW_KIT_INLINE static auto open_sum(const Own& own, edge e) {
    return own.linear([&](auto value) ILAW_KIT_LAMBDA {
      return e.sum(value(middle_sum), value(current), value(oldest_bucket), value(oldest_slope));
    });
  }
  // Where the newest bucket is another than that of the step.
  template <class Own, class V>
  [[gnu::noinline]] V read_others(const Own& own, mask_of<V> left, V stamp, vector<V>& sum) const {
    const mask_of<V> is_stamp = (absolute(stamp) <= largest_number) & is_whole(stamp);
    V refused = select(is_stamp, V(0.0), code_of<V>(refusal::impossible_state));
    left = left & is_stamp & has_grid_;
    while (any(left)) {
      const double number = first_of(left, stamp), newest = bucket_of(number);
      const mask_of<V> same = left & (stamp == number);
      left = left & !same;
      // A host whose position step is not the next one may fall back by a part of its last step.
      if (now_ < newest - 1.0) refused = select(same, code_of<V>(refusal::time_before_history), refused);
      const double k = larger(now_, newest);
      if (now_ < newest - 1.0 || !is_short_ || k - newest > buckets_) continue;
      const edge e = k == now_ ? edge_ : edge_at(k);
      if (k == newest) {
        sum = select(same, open_sum(own, e), sum);
      } else {
        const front<V> f = front_at(own, k, k - newest);
        sum = select(same, e.sum(f.middle, f.newest, f.oldest, limited_difference(f.oldest, f.next)), sum);
      }
    }
    return refused;
  }
  template <class Own, class V>
  [[gnu::noinline]] void write_others(const Own& own, mask_of<V> left, vector<V> impulse) const {
    const V stamp = own.number_at(0);
    while (any(left)) {
      const double newest = first_of(left, stamp);
      const mask_of<V> same = left & (stamp == newest);
      left = left & !same;
      const double k = newest == empty ? now_ : larger(now_, bucket_of(newest));
      const double turns = newest == empty ? buckets_ + 1.0 : smaller(k - bucket_of(newest), buckets_ + 1.0);
      take_in(own, same, impulse, k, turns);
    }
  }

  // The buckets that a step changes: the newest, k; the sum of the middle ones; the oldest, k - B, and the
  // one after it; and the one that closes.
  template <class V>
  struct front {
    vector<V> newest, middle, oldest, next, closing;
  };
  template <class Own>
  auto front_at(const Own& own, double k, double turns) const {
    using V = typename Own::number;
    front<V> f;
    if (turns > buckets_) return f;
    const std::int64_t place = place_of(k - 1.0),
                       next = place + 1 < ring_size_ ? place + 1 : 0;  // k - B, the next one
    if (turns == 0.0) {
      f.newest = own.vector_at(current);
      f.middle = own.vector_at(middle_sum);
      f.oldest = own.vector_at(oldest_bucket);
      f.next = ring_size_ > 0 ? own.vector_at(at(next)) : f.newest;
      return f;
    }
    f.closing = own.vector_at(current);
    if (turns == buckets_) {
      f.oldest = f.closing;
      return f;
    }
    // In the order in which they stand, whichever is the first of them.
    const std::int64_t count = ring_size_ - static_cast<std::int64_t>(turns);
    const std::int64_t beyond = next + count - ring_size_, last = beyond > 0 ? ring_size_ : next + count;
    f.middle = own.linear([&](auto value) ILAW_KIT_LAMBDA {
      auto sum = value.zero();
      for (std::int64_t q = 0; q < beyond; ++q) sum = sum + value(at(q));
      for (std::int64_t q = next; q < last; ++q) sum = sum + value(at(q));
      return sum + value(current);
    });
    f.oldest = own.vector_at(at(place));
    f.next = count > 0 ? own.vector_at(at(next)) : f.closing;
    return f;
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

  // Bucket k becomes the newest, or is it still, and the impulse is spread over the buckets that the step
  // covers; the last takes what is left, so that the whole arrives. The step may end before bucket k.
  template <class Own, class V>
  void take_in(const Own& own, mask_of<V> where, vector<V> impulse, double k, double turns) const {
    front<V> f = front_at(own, k, turns);
    const double before = k - turns, closing = turns < buckets_ ? before : k;  // k: none
    for (double j = larger(before, k - buckets_) + 1.0; j < k; j += 1.0)
      own.put(where, at(place_of(j)), vector<V>{});
    const shares s = k == now_ ? shares_ : shares_at(k);
    vector<V> left = impulse;
    for (double j = s.first; j <= now_; j += 1.0) {
      const bool is_rest = j == now_ && s.is_whole;
      const double share = j == now_ ? s.of_last : (j == s.first ? s.of_first : s.of_others);
      const vector<V> part = is_rest ? left : share * impulse;
      left = left - part;
      put_in(own, where, f, part, j, k, closing);
    }
    if (closing < k) own.put(where, at(place_of(closing)), f.closing);
    own.put(where, current, f.newest);
    own.put(where, middle_sum, f.middle);
    own.put(where, oldest_bucket, f.oldest);
    own.put(where, oldest_slope, limited_difference(f.oldest, ring_size_ > 0 ? f.next : f.newest));
    own.put_number(where, 0, stamp_of(k));
  }
  template <class Own, class V>
  void put_in(const Own& own, mask_of<V> where, front<V>& f, vector<V> part, double j, double k,
              double closing) const {
    if (j == k) {
      f.newest = f.newest + part;
    } else if (j == k - buckets_) {
      f.oldest = f.oldest + part;
    } else {
      f.middle = f.middle + part;
      if (j == k - buckets_ + 1.0) f.next = f.next + part;
      if (j == closing)
        f.closing = f.closing + part;
      else
        own.put(where, at(place_of(j)), own.vector_at(at(place_of(j))) + part);
    }
  }

  double duration_, buckets_, end_, begin_, now_;
  bool has_grid_, is_short_, counts_;  // counts: what lies before the step
  double stamp_;                       // of bucket now_
  std::int64_t ring_size_;
  edge edge_;
  shares shares_;
};

}  // namespace ilaw::kit
