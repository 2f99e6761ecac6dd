// window_block.hpp - the windows (window.hpp) of the nodes of a block, read and written together in vector
// code: most of them have the same newest bucket. What a node gets is the same as alone, to the last bit.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/gather.hpp>
#include <ilaw/kit/window.hpp>

#include <bit>
#include <limits>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// Where the histories of a block's nodes are.
struct histories {
  double* values;
  std::int64_t node_stride, component_stride;
  const std::int64_t* nodes;  // null: consecutive

  double* of(int i) const { return values + (nodes ? nodes[i] : i) * node_stride; }
  history at(int i) const { return {of(i), component_stride}; }
};

// Calls turn with where the history of a node stands.
template <class Turn>
void with_rows(const histories& own, Turn turn) {
  double* const first = own.values;
  const std::int64_t stride = own.node_stride;
  if (own.nodes)
    turn([nodes = own.nodes, first, stride](int i) { return first + nodes[i] * stride; });
  else
    turn([first, stride](int i) { return first + i * stride; });
}

// Three numbers of as many nodes as a register holds. A pack (pack.hpp) is two, which these short loops would
// pass through memory.
struct lane_vector {
  lanes n, t1, t2;

  static lane_vector at(const column* c, int i) {
    return {lanes_at(c[0].values + i), lanes_at(c[1].values + i), lanes_at(c[2].values + i)};
  }
  void put(column* c, int i) const {
    put_lanes(n, c[0].values + i);
    put_lanes(t1, c[1].values + i);
    put_lanes(t2, c[2].values + i);
  }
  friend lane_vector operator+(const lane_vector& a, const lane_vector& b) {
    return {a.n + b.n, a.t1 + b.t1, a.t2 + b.t2};
  }
  friend lane_vector operator-(const lane_vector& a, const lane_vector& b) {
    return {a.n - b.n, a.t1 - b.t1, a.t2 - b.t2};
  }
  friend lane_vector operator*(double s, const lane_vector& a) { return {s * a.n, s * a.t1, s * a.t2}; }
  friend lane_vector select(lane_mask m, const lane_vector& a, const lane_vector& b) {
    return {m ? a.n : b.n, m ? a.t1 : b.t1, m ? a.t2 : b.t2};
  }
  lane_mask is_there() const { return (n != 0.0) | (t1 != 0.0) | (t2 != 0.0); }
};

// What the steps of a block gave: impulses, and 1 or 0 for windows that take them in, and for those that are
// emptied before.
struct given_impulses {
  column impulse[3], adds, clears;
};

class window_block : public window_in_step {
 public:
  explicit window_block(const window_in_step& window) : window_in_step(window) {}

  // The sums before the step, and what of them add() needs again: stamps, and the windows that are turned
  // where the step opens a bucket, one after another.
  struct rows {
    alignas(64) double of[block_size][4];
  };
  struct block_reading {
    column sum[3], refused, stamp;
    column turns;
    rows middle, oldest, slope;
    int nodes[block_size], opens;  // of those
  };
  void before(const histories& own, int count, block_reading& r) const {
    r.opens = 0;
    if (!is_together(own)) {
      for (int i = 0; i < count; ++i) read_alone(own, i, r);
      return;
    }
    if (own.component_stride == 1)
      with_rows(own, [=, this, &r](auto row_of) { sum_rows(count, row_of, edge_, r); });
    else
      sum_columns(count, own, edge_, r);
    for (int i = count; i < block_size; ++i) r.stamp.values[i] = empty;
    if (!check_sums(count, r, stamp_)) read_older(own, count, r);
  }

  // Takes the impulses of a step in. The histories are those that before() read.
  void add(const histories& own, int count, given_impulses& given, block_reading& r) const {
    for (int i = count; i < block_size; ++i) given.adds.values[i] = given.clears.values[i] = 0.0;
    if (is_together(own)) {
      constexpr double none = std::numeric_limits<double>::quiet_NaN();
      column added[4];
      if (choose_added(count, given, r.stamp, added, begin_ >= now_ ? stamp_ : none))
        add_all(own, count, added);
    }
    if (r.opens > 0 && buckets_ > 2.0 && shares_.first >= now_ - 1.0) {
      if (own.component_stride == 1)
        with_rows(own, [=, this, &given, &r](auto row_of) {
          open_listed(count, given, r, [=](int i) { return neighbours<double>{row_of(i)}; });
        });
      else
        open_listed(count, given, r, [&own](int i) { return own.at(i); });
    }
    if (!are_left(count, given)) return;
    for (int i = 0; i < count; ++i)
      if (given.adds.values[i] + given.clears.values[i] != 0.0) add_alone(own.at(i), i, given);
  }

 private:
  // Whether the numbers of a node stand side by side, or those of the nodes.
  bool is_together(const histories& own) const {
    const bool in_columns = own.node_stride == 1 && !own.nodes;
    return has_grid_ && is_short_ && (own.component_stride == 1 || in_columns);
  }

  void read_alone(const histories& own, int i, block_reading& r) const {
    const reading alone = window_in_step::before(const_history(own.at(i)));
    put(alone.sum, i, r.sum);
    r.refused.values[i] = alone.refused;
  }

  // The sums of all nodes as if the bucket of the step were open, each behind its stamp.
  template <class RowOf>
  [[gnu::noinline, gnu::flatten]] static void sum_rows(int count, RowOf row_of, edge given,
                                                       block_reading& r) {
    rows sums;
    for (int i = 0; i < count; ++i) {
      const neighbours<const double> own{row_of(i)};
      row sum = given.sum(row_at(own, middle_sum), row_at(own, current), row_at(own, oldest_bucket),
                          row_at(own, oldest_slope));
      sum.line[0][0] = own[0];
      sum.put(sums.of[i]);
    }
    column* const columns[] = {&r.stamp, r.sum, r.sum + 1, r.sum + 2};
    separate_rows(sums.of[0], 4, 4, count, [&columns](int k) { return columns[k]->values; });
  }
  [[gnu::noinline, gnu::flatten]] static void sum_columns(int count, const histories& own, edge given,
                                                          block_reading& r) {
    const double* const first = own.values;
    const std::int64_t stride = own.component_stride;
    int i = 0;
    const auto at = [&](std::int64_t k) -> lane_vector {
      const double* const v = first + k * stride + i;
      return {lanes_at(v), lanes_at(v + stride), lanes_at(v + 2 * stride)};
    };
    for (; i + register_size <= count; i += register_size) {
      put_lanes(lanes_at(first + i), r.stamp.values + i);
      given.sum(at(middle_sum), at(current), at(oldest_bucket), at(oldest_slope)).put(r.sum, i);
    }
    for (; i < count; ++i) {
      const const_history alone = own.at(i);
      r.stamp.values[i] = alone[0];
      put(given.sum(read(alone, middle_sum), read(alone, current), read(alone, oldest_bucket),
                    read(alone, oldest_slope)),
          i, r.sum);
    }
  }
  // Where no bucket is open nothing counts. Returns whether all others have the bucket of the step.
  [[gnu::noinline, gnu::flatten]] static bool check_sums(int count, block_reading& r, double newest) {
    lane_mask others{};
    for (int i = 0; i < count; i += register_size) {
      const lanes stamp = lanes_at(r.stamp.values + i);
      const lane_mask is_empty = stamp == empty;
      put_sum(select(is_empty, lane_vector{}, lane_vector::at(r.sum, i)), i, r.sum, r.refused);
      others = others | ((stamp != newest) & ~is_empty);
    }
    return !any_lane(others);
  }
  static void put_sum(const lane_vector& sum, int i, column* sums, column& refused) {
    sum.put(sums, i);
    const lanes zero{};
    put_lanes(zero * sum.n * sum.t1 * sum.t2 == zero ? zero : zero + impossible_state, refused.values + i);
  }

  // Nodes whose newest bucket is not that of the step.
  void read_older(const histories& own, int count, block_reading& r) const {
    int others[block_size], other_count = 0;
    for (int i = 0; i < count; ++i) {
      const double stamp = r.stamp.values[i];
      others[other_count] = i;
      other_count += (stamp != stamp_) & (stamp != empty) ? 1 : 0;
    }
    if (own.component_stride == 1)
      with_rows(own, [=, this, &r](auto row_of) {
        turn_listed(others, other_count, r, [=](int i) { return neighbours<const double>{row_of(i)}; });
      });
    else
      turn_listed(others, other_count, r, [&own](int i) { return const_history(own.at(i)); });
    for (int k = 0; r.opens < other_count && k < other_count; ++k)
      if (turns_ahead(r.stamp.values[others[k]]) < 0.0) read_alone(own, others[k], r);
    column sum[3], refused;
    sum_turned(r, edge_, sum, refused);
    for (int k = 0; k < r.opens; ++k) {
      put(vector_at(sum, k), r.nodes[k], r.sum);
      r.refused.values[r.nodes[k]] = refused.values[k];
    }
  }
  // Most of them are one bucket back.
  template <class HistoryOf>
  [[gnu::noinline]] void turn_listed(const int* nodes, int count, block_reading& r,
                                     HistoryOf history_of) const {
    const window_block window = *this;  // a copy, so that no store can alias it
    const double before = stamp_of(now_ - 1.0);
    constexpr int ahead = 8;
    int opens = 0;
    for (int k = 0; k < count; ++k) {
      const int i = nodes[k];
      if (k + ahead < count) window.expect_ring(history_of(nodes[k + ahead]));
      const double stamp = r.stamp.values[i], turns = stamp == before ? 1.0 : turns_ahead(stamp);
      if (turns < 0.0) continue;
      const auto own = history_of(i);
      const turned t = turns == 1.0 ? window.turn_at(own, window.place_, 1.0) : turn_further(own, turns);
      r.nodes[opens] = i;
      r.turns.values[opens] = turns;
      t.middle.put(r.middle.of[opens]);
      t.oldest.put(r.oldest.of[opens]);
      t.next.put(r.slope.of[opens++]);
    }
    r.opens = opens;
  }
  template <class History>
  [[gnu::noinline]] turned turn_further(const History& own, double turns) const {
    return turn_at(own, place_, turns);
  }
  // Asks for what is summed soon.
  void expect_ring(const neighbours<const double>& own) const {
    constexpr std::int64_t line = 8, most = 64;
    const std::int64_t numbers = 3 * ring_size_ < most ? 3 * ring_size_ : most;
    for (std::int64_t k = 0; k < numbers; k += line) __builtin_prefetch(own.values + first_bucket + k);
  }
  void expect_ring(const const_history& /*in columns*/) const {}
  // -1: the newest bucket is none that lies before that of the step.
  double turns_ahead(double stamp) const {
    return is_stamp(stamp) && bucket_of(stamp) < now_ ? turns_since(stamp) : -1.0;
  }
  [[gnu::noinline, gnu::flatten]] static void sum_turned(block_reading& r, edge given, column* sum,
                                                         column& refused) {
    column middle[4], oldest[4], slope[4];
    const auto separate = [&r](const rows& from, column* to) {
      separate_rows(from.of[0], 4, 4, r.opens, [to](int k) { return to[k].values; });
    };
    separate(r.middle, middle);
    separate(r.oldest, oldest);
    separate(r.slope, slope);
    for (int i = 0; i < r.opens; i += register_size) {
      const lane_vector first = lane_vector::at(oldest + 1, i),
                        difference = limited_difference(first, lane_vector::at(slope + 1, i));
      difference.put(slope + 1, i);
      put_sum(given.sum(lane_vector::at(middle + 1, i), lane_vector{}, first, difference), i, sum, refused);
    }
    join(slope[0], slope + 1, r.opens, r.slope);
  }
  static void join(column& front, column* from, int count, rows& to) {
    double* const columns[] = {front.values, from[0].values, from[1].values, from[2].values};
    join_rows(columns, 4, count, to.of[0], 4);
  }

  static vector vector_at(const column* c, int i) { return {c[0].values[i], c[1].values[i], c[2].values[i]}; }
  static void put(vector a, int i, column* c) {
    c[0].values[i] = a.n;
    c[1].values[i] = a.t1;
    c[2].values[i] = a.t2;
  }

  // What nodes whose newest bucket is that of the step add to it, behind nothing for the stamp; those are
  // done then. Nothing is -0, which changes no number. Returns whether there are any.
  [[gnu::noinline, gnu::flatten]] static bool choose_added(int count, given_impulses& given,
                                                           const column& stamps, column* added,
                                                           double newest) {
    lane_mask done{};
    const lanes zero{}, nothing = -zero;
    for (int i = 0; i < count; i += register_size) {
      const lane_vector impulse = lane_vector::at(given.impulse, i);
      const lanes adds = lanes_at(given.adds.values + i);
      const lane_mask is_added =
          (lanes_at(stamps.values + i) == newest) & (adds > lanes_at(given.clears.values + i));
      put_lanes(nothing, added[0].values + i);
      select(is_added, impulse, lane_vector{nothing, nothing, nothing}).put(added + 1, i);
      put_lanes(impulse.is_there() & ~is_added ? adds : zero, given.adds.values + i);
      done = done | is_added;
    }
    return any_lane(done);
  }
  static void add_all(const histories& own, int count, const column* added) {
    if (own.component_stride == 1)
      return with_rows(own, [=](auto row_of) { add_rows(count, row_of, added); });
    for (std::int64_t k = current; k < middle_sum; ++k) {
      double* const sums = own.values + k * own.component_stride;
#pragma omp simd
      for (int i = 0; i < count; ++i) sums[i] += added[k].values[i];
    }
  }
  template <class RowOf>
  static void add_rows(int count, RowOf row_of, const column* added) {
    int i = for_each_square(count, 4, [&](int first, int k) {
      const square s = square::from([&](int j) { return added[k + j].values + first; }).turned();
#pragma GCC unroll 4
      for (int j = 0; j < square_size; ++j) {
        square::line sum;
        __builtin_memcpy(&sum, row_of(first + j) + k, sizeof sum);
        sum += s.lines[j];
        __builtin_memcpy(row_of(first + j) + k, &sum, sizeof sum);
      }
    });
    for (; i < count; ++i)
      for (int k = 1; k < 4; ++k) row_of(i)[k] += added[k].values[i];
  }
  static bool are_left(int count, const given_impulses& given) {
    lane_mask left{};
    for (int i = 0; i < count; i += register_size)
      left = left | (lanes_at(given.adds.values + i) + lanes_at(given.clears.values + i) != lanes{});
    return any_lane(left);
  }

  // At nodes whose newest bucket lies before that of the step, which lies in this one and that before.
  template <class HistoryOf>
  [[gnu::noinline]] void open_listed(int count, given_impulses& given, const block_reading& r,
                                     HistoryOf history_of) const {
    const bool is_cut = shares_.first < now_;
    const double of_first = shares_.of_first, stamp = stamp_;
    const std::int64_t closed = at(place_);
    column none{};
    rows impulses;
    join(none, given.impulse, count, impulses);
    for (int k = 0; k < r.opens; ++k) {
      const int i = r.nodes[k];
      if (given.adds.values[i] == 0.0 || given.clears.values[i] != 0.0) continue;
      given.adds.values[i] = 0.0;
      const auto own = history_of(i);
      const row impulse = row::at(impulses.of[i]), middle = row::at(r.middle.of[k]),
                oldest = row::at(r.oldest.of[k]);
      if (const double turns = r.turns.values[k]; turns != 1.0) {
        add_where(own, impulse, now_, turns, {middle, oldest, {}});
        continue;
      }
      const row part = of_first * impulse, last = row_at(own, current);
      own[0] = stamp;
      put_row(own, current, row{} + (is_cut ? impulse - part : impulse));
      put_row(own, middle_sum, is_cut ? middle + part : middle);
      put_row(own, oldest_bucket, oldest);
      put_row(own, oldest_slope, row::at(r.slope.of[k]));
      put_row(own, closed, is_cut ? last + part : last);
    }
  }
  [[gnu::noinline]] void add_alone(const history& own, int i, const given_impulses& given) const {
    if (given.clears.values[i] != 0.0) clear(own);
    if (given.adds.values[i] != 0.0) window_in_step::add(own, vector_at(given.impulse, i));
  }
};

}  // namespace ilaw::kit::detail
