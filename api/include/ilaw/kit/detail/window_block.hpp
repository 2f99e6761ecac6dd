// window_block.hpp - the windows (window.hpp) of the nodes of a block, read and written together in vector
// code: most of them have the same newest bucket. What a node gets is the same as alone, to the last bit.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/window.hpp>

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

// What the steps of a block gave: impulses, and 1 or 0 for windows that take them in, and for those that are
// emptied before.
struct given_impulses {
  column impulse[3], adds, clears;
};

class window_block : public window_in_step {
 public:
  explicit window_block(const window_in_step& window) : window_in_step(window) {}

  // The sums before the step, and what of them add() needs again: stamps, and of the nodes where the step
  // opens the next bucket, one after another, the sums of the middle buckets and the slopes.
  struct rows {
    alignas(64) double of[block_size][4];
  };
  struct block_reading {
    column sum[3], refused, stamp;
    rows middle, slope;
    int nodes[block_size], opens;  // of those
  };
  void before(const histories& own, int count, block_reading& r) const {
    r.opens = 0;
    if (!is_together(own)) {
      for (int i = 0; i < count; ++i) read_alone(own, i, r);
      return;
    }
    const newest_buckets are = read_stamps(own, count, r.stamp);
    if (are.of_the_step && own.component_stride == 1)
      with_rows(own, [=, this, &r](auto row_of) { sum_rows(count, row_of, edge_, r); });
    else if (are.of_the_step)
      sum_columns(count, own, edge_, r);
    check_sums(count, r, stamp_);
    if (are.others) read_older(own, count, r);
  }

  // Takes the impulses of a step in. The histories are those that before() read.
  void add(const histories& own, int count, given_impulses& given, const block_reading& r) const {
    for (int i = count; i < in_whole_packs(count); ++i) given.adds.values[i] = given.clears.values[i] = 0.0;
    if (is_together(own)) {
      constexpr double none = std::numeric_limits<double>::quiet_NaN();
      column added[4];
      if (choose_added(count, given, r.stamp, added, begin_ >= now_ ? stamp_ : none))
        add_all(own, count, added);
    }
    if (r.opens > 0 && shares_.first >= now_ - 1.0) {
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
    const reading alone = own.component_stride == 1
                              ? window_in_step::before(neighbours<const double>{own.of(i)})
                              : window_in_step::before(const_history(own.at(i)));
    put(alone.sum, i, r.sum);
    r.refused.values[i] = alone.refused;
  }

  // Whether nodes have the bucket of the step, or another one.
  struct newest_buckets {
    bool of_the_step, others;
  };
  newest_buckets read_stamps(const histories& own, int count, column& stamps) const {
    with_rows(own, [=, &stamps](auto row_of) {
      for (int i = 0; i < count; ++i) stamps.values[i] = row_of(i)[0];
    });
    for (int i = count; i < in_whole_packs(count); ++i) stamps.values[i] = empty;
    lane_mask now{}, others{};
    for (int i = 0; i < count; i += register_size) {
      const lanes stamp = lanes_at(stamps.values + i);
      now = now | (stamp == stamp_);
      others = others | ((stamp != stamp_) & (stamp != empty));
    }
    return {any_lane(now), any_lane(others)};
  }

  // As many rows as make a square, to columns from place i on.
  static void separate(const row* from, int i, column* const* to) {
    for (int c = 0; c < row::lines; ++c) {
      square s;
#pragma GCC unroll 4
      for (int k = 0; k < square_size; ++k) s.lines[k] = from[k].line[c];
      s.turned().put([&](int k) { return to[c * square_size + k]->values + i; });
    }
  }

  // The sums of all nodes as if the bucket of the step were open.
  template <class RowOf>
  [[gnu::noinline, gnu::flatten]] static void sum_rows(int count, RowOf row_of, edge given,
                                                       block_reading& r) {
    column unused;
    column* const columns[] = {&unused, r.sum, r.sum + 1, r.sum + 2};
    for (int i = 0; i < count; i += square_size) {
      row sums[square_size];
#pragma GCC unroll 4
      for (int k = 0; k < square_size; ++k) {
        const neighbours<const double> own{row_of(i + k < count ? i + k : count - 1)};
        sums[k] = given.sum(row_at(own, middle_sum), row_at(own, current), row_at(own, oldest_bucket),
                            row_at(own, oldest_slope));
      }
      separate(sums, i, columns);
    }
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
    for (; i + register_size <= count; i += register_size)
      given.sum(at(middle_sum), at(current), at(oldest_bucket), at(oldest_slope)).put(r.sum, i);
    for (; i < count; ++i) {
      const const_history alone = own.at(i);
      put(given.sum(read(alone, middle_sum), read(alone, current), read(alone, oldest_bucket),
                    read(alone, oldest_slope)),
          i, r.sum);
    }
  }
  // Where no bucket is open nothing counts; other nodes are read later.
  [[gnu::noinline, gnu::flatten]] static void check_sums(int count, block_reading& r, double newest) {
    for (int i = 0; i < count; i += register_size) {
      const lane_mask is_of_the_step = lanes_at(r.stamp.values + i) == newest;
      put_sum(select(is_of_the_step, lane_vector::at(r.sum, i), lane_vector{}), i, r.sum, r.refused);
    }
  }
  static void put_sum(const lane_vector& sum, int i, column* sums, column& refused) {
    sum.put(sums, i);
    const lanes zero{};
    put_lanes(zero * sum.n * sum.t1 * sum.t2 == zero ? zero : zero + impossible_state, refused.values + i);
  }

  // Nodes whose newest bucket is not that of the step: together where it is the one before, as most often.
  void read_older(const histories& own, int count, block_reading& r) const {
    const double before = buckets_ > 2.0 ? stamp_of(now_ - 1.0) : std::numeric_limits<double>::quiet_NaN();
    marks one_back, further;
    lane_mask any_further{};
    for (int i = 0; i < count; i += register_size) {
      const lanes stamp = lanes_at(r.stamp.values + i);
      const lane_mask is_before = stamp == before,
                      is_further = (stamp != before) & (stamp != stamp_) & (stamp != empty);
      one_back.put(is_before, i);
      further.put(is_further, i);
      any_further = any_further | is_further;
    }
    if (any_lane(any_further)) {
      int others[block_size];
      const int other_count = further.list(count, others);
      for (int k = 0; k < other_count; ++k) read_alone(own, others[k], r);
    }
    r.opens = one_back.list(count, r.nodes);
    if (r.opens == 0) return;
    turned_columns t;
    if (own.component_stride == 1)
      with_rows(own, [=, this, &r, &t](auto row_of) {
        turn_listed(r, t, [=](int i) { return neighbours<const double>{row_of(i)}; });
      });
    else
      turn_listed(r, t, [&own](int i) { return const_history(own.at(i)); });
    sum_turned(count, r, t, edge_);
  }
  // Behind one that does not count.
  struct turned_columns {
    column middle[4], oldest[4], next[4];
  };
  // Several at once; the last of them again where there are not so many.
  template <class HistoryOf>
  [[gnu::noinline, gnu::flatten]] void turn_listed(block_reading& r, turned_columns& to,
                                                   HistoryOf history_of) const {
    constexpr int ahead = 2 * square_size;
    const std::int64_t place = place_, next = after(place), end = ring_size_;
    const int opens = r.opens, *const nodes = r.nodes;
    column* const middles[] = {to.middle, to.middle + 1, to.middle + 2, to.middle + 3};
    column* const oldests[] = {to.oldest, to.oldest + 1, to.oldest + 2, to.oldest + 3};
    column* const nexts[] = {to.next, to.next + 1, to.next + 2, to.next + 3};
    for (int k = 0; k < opens; k += square_size) {
      decltype(history_of(0)) own[square_size];
      row middle[square_size]{}, oldest[square_size], following[square_size];
#pragma GCC unroll 4
      for (int j = 0; j < square_size; ++j) {
        own[j] = history_of(nodes[k + j < opens ? k + j : opens - 1]);
        if (k + j + ahead < opens) expect_ring(history_of(nodes[k + j + ahead]));
      }
      const auto add = [&](std::int64_t index) {
#pragma GCC unroll 4
        for (int j = 0; j < square_size; ++j) middle[j] = middle[j] + row_at(own[j], index);
      };
      for (std::int64_t q = 0; q < place; ++q) add(at(q));
      for (std::int64_t q = place + 1; q < end; ++q) add(at(q));
      add(current);
#pragma GCC unroll 4
      for (int j = 0; j < square_size; ++j) {
        oldest[j] = row_at(own[j], at(place));
        following[j] = row_at(own[j], at(next));
        middle[j].put(r.middle.of[k + j]);
      }
      separate(middle, k, middles);
      separate(oldest, k, oldests);
      separate(following, k, nexts);
    }
  }
  // Asks for what is summed soon.
  void expect_ring(const neighbours<const double>& own) const {
    constexpr std::int64_t line = 8, most = 64;
    const std::int64_t numbers = 3 * ring_size_ < most ? 3 * ring_size_ : most;
    for (std::int64_t k = 0; k < numbers; k += line) __builtin_prefetch(own.values + first_bucket + k);
  }
  void expect_ring(const const_history& /*in columns*/) const {}
  [[gnu::noinline, gnu::flatten]] static void sum_turned(int count, block_reading& r, turned_columns& t,
                                                         edge given) {
    column some_refused;
    const bool are_all = r.opens == count;
    column* const sums = are_all ? r.sum : t.middle + 1;
    column& refused = are_all ? r.refused : some_refused;
    for (int i = 0; i < r.opens; i += register_size) {
      const lane_vector first = lane_vector::at(t.oldest + 1, i),
                        difference = limited_difference(first, lane_vector::at(t.next + 1, i));
      difference.put(t.next + 1, i);
      put_sum(given.sum(lane_vector::at(t.middle + 1, i), lane_vector{}, first, difference), i, sums,
              refused);
    }
    join(t.next + 1, r.opens, r.slope);
    for (int k = 0; k < r.opens && !are_all; ++k) {
      put(vector_at(sums, k), r.nodes[k], r.sum);
      r.refused.values[r.nodes[k]] = refused.values[k];
    }
  }
  // Three columns, to rows behind one that does not count.
  static void join(column* from, int count, rows& to) {
    double* const columns[] = {from[0].values, from[0].values, from[1].values, from[2].values};
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

  // At nodes whose newest bucket is the one before that of the step, which lies in those two.
  template <class HistoryOf>
  [[gnu::noinline, gnu::flatten]] void open_listed(int count, given_impulses& given, const block_reading& r,
                                                   HistoryOf history_of) const {
    const bool is_cut = shares_.first < now_;
    const double of_first = shares_.of_first, stamp = stamp_;
    const std::int64_t closed = at(place_);
    marks takes;
    for (int i = 0; i < count; i += register_size)
      takes.put(lanes_at(given.adds.values + i) > lanes_at(given.clears.values + i), i);
    int listed[block_size], listed_count = 0;
    for (int k = 0; k < r.opens; ++k) {
      listed[listed_count] = k;
      listed_count -= static_cast<int>(takes.of[r.nodes[k]]);
    }
    rows impulses;
    join(given.impulse, count, impulses);
    for (int l = 0; l < listed_count; ++l) {
      const int k = listed[l], i = r.nodes[k];
      given.adds.values[i] = 0.0;
      const auto own = history_of(i);
      const row impulse = row::at(impulses.of[i]), middle = row::at(r.middle.of[k]),
                oldest = row_at(own, closed), last = row_at(own, current), part = of_first * impulse;
      put_row(own, closed, is_cut ? last + part : last);
      put_head(own, stamp, row{} + (is_cut ? impulse - part : impulse), is_cut ? middle + part : middle,
               oldest, row::at(r.slope.of[k]));
    }
  }
  [[gnu::noinline]] void add_alone(const history& own, int i, const given_impulses& given) const {
    if (given.clears.values[i] != 0.0) clear(own);
    if (given.adds.values[i] != 0.0) window_in_step::add(own, vector_at(given.impulse, i));
  }
};

}  // namespace ilaw::kit::detail
