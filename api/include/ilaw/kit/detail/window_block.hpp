// window_block.hpp - the windows (window.hpp) of the nodes of a block, read and written together in vector
// code: most of them have the same newest bucket. What a node gets is the same as alone, to the last bit.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/gather.hpp>
#include <ilaw/kit/window.hpp>

#include <bit>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// Where the histories of a block's nodes are.
struct histories {
  double* values;
  std::int64_t node_stride, component_stride;
  const std::int64_t* nodes;  // null: consecutive

  double* of(int i) const { return values + (nodes ? nodes[i] : i) * node_stride; }
  history at(int i) const { return {of(i), component_stride}; }
};

// Four numbers of each history, as columns, and back: square by square where they are neighbours, row(i) of
// node i. Both return how many nodes they did.
using four_columns = column[4];
template <class Row>
int turn_rows(int count, Row row, four_columns& c) {
  return for_each_square(count, 4, [&](int first, int from) {
    square::from([&](int j) { return row(first + j) + from; }).turned().put([&](int j) {
      return c[from + j].values + first;
    });
  });
}
template <class Row>
int turn_columns(int count, Row row, const four_columns& c) {
  return for_each_square(count, 4, [&](int first, int from) {
    square::from([&](int j) { return c[from + j].values + first; }).turned().put([&](int j) {
      return row(first + j) + from;
    });
  });
}
// Calls turn with where number k of a node stands.
template <class Turn>
int with_rows(const histories& own, std::int64_t k, Turn turn) {
  if (own.component_stride != 1) return 0;
  double* const first = own.values + k;
  const std::int64_t stride = own.node_stride;
  if (own.nodes) return turn([nodes = own.nodes, first, stride](int i) { return first + nodes[i] * stride; });
  return turn([first, stride](int i) { return first + i * stride; });
}
// From number k on.
inline void read_four(const histories& own, int count, std::int64_t k, four_columns& c) {
  const int done = with_rows(own, k, [&](auto row) { return turn_rows(count, row, c); });
  for (int j = 0; j < 4; ++j)
    for (int i = done; i < count; ++i) c[j].values[i] = own.at(i)[k + j];
}
inline void write_four(const histories& own, int count, std::int64_t k, const four_columns& c) {
  const int done = with_rows(own, k, [&](auto row) { return turn_columns(count, row, c); });
  for (int j = 0; j < 4; ++j)
    for (int i = done; i < count; ++i) own.at(i)[k + j] = c[j].values[i];
}

// What the steps of a block gave: impulses, and 1 or 0 for windows that take them in, and for those that are
// emptied before.
struct given_impulses {
  column impulse[3], adds, clears;
};

class window_block : public window_in_step {
 public:
  explicit window_block(const window_in_step& window) : window_in_step(window) {}

  // The sums before the step, and what of them add() needs again: stamp and sum of the middle buckets, and
  // three buckets, each behind the number that stands before it.
  struct block_reading {
    column sum[3], refused;
    four_columns head, current, oldest, next;
  };
  void before(const histories& own, int count, block_reading& r) const {
    int others[block_size], other_count = 0;
    if (is_on_grid()) {
      const std::int64_t oldest = after(place_);
      read_four(own, count, 0, r.head);
      read_four(own, count, at(place_) - 1, r.current);
      read_four(own, count, at(oldest) - 1, r.oldest);
      read_four(own, count, at(after(oldest)) - 1, r.next);
      if (!are_alike(r, count)) other_count = read_older(others, list_others(others, count, r), own, r);
      sum_parts(count, r, edge_, stamp_);
    } else {
      for (; other_count < count; ++other_count) others[other_count] = other_count;
    }
    for (int k = 0; k < other_count; ++k) {
      const int i = others[k];
      const reading alone = window_in_step::before(const_history(own.at(i)));
      put(alone.sum, i, r.sum);
      r.refused.values[i] = alone.refused;
    }
  }

  // Takes the impulses of a step in. The histories are those that before() read.
  void add(const histories& own, int count, given_impulses& given, block_reading& r) const {
    if (is_on_grid() && begin_ >= now_ && add_to_newest(count, given, r, stamp_))
      write_four(own, count, at(place_) - 1, r.current);
    if (is_on_grid() && buckets_ >= 2.0 && shares_.first >= now_ - 1.0)
      own.component_stride == 1
          ? open_next(
                count, [&own](int i) { return neighbours<double>{own.of(i)}; }, given, r)
          : open_next(
                count, [&own](int i) { return own.at(i); }, given, r);
    for (int i = 0; i < count; ++i)
      if (given.adds.values[i] + given.clears.values[i] != 0.0) add_alone(own.at(i), i, given, r);
  }

 private:
  bool is_on_grid() const { return has_grid_ && is_short_; }

  // Whether the newest bucket of all nodes that have one is that of the step.
  bool are_alike(const block_reading& r, int count) const {
    std::uint64_t different = 0;
    for (int i = 0; i < count; ++i) {
      const double stamp = r.head[0].values[i] == empty ? stamp_ : r.head[0].values[i];
      different |= std::bit_cast<std::uint64_t>(stamp) ^ std::bit_cast<std::uint64_t>(stamp_);
    }
    return different == 0;
  }
  // Nodes whose newest bucket is not that of the step, but those without one.
  int list_others(int* nodes, int count, const block_reading& r) const {
    int found = 0;
    for (int i = 0; i < count; ++i) {
      const double stamp = r.head[0].values[i];
      nodes[found] = i;
      found += ((stamp == stamp_) | (stamp == empty)) ? 0 : 1;
    }
    return found;
  }
  // Mends what was read of nodes whose newest bucket lies further back. Returns how many are left in the
  // list, which are to be read alone.
  int read_older(int* nodes, int node_count, const histories& own, block_reading& r) const {
    const std::int64_t next = after(after(place_));
    int left = 0;
    double stamp = stamp_, turns = 0.0;  // of neighbours often the same
    for (int k = 0; k < node_count; ++k) {
      const int i = nodes[k];
      if (r.head[0].values[i] != stamp) turns = turns_since(stamp = r.head[0].values[i]);
      nodes[left] = i;
      left += turns < 0.0 ? 1 : 0;
      const bool counts = (turns > 0.0) & (turns <= buckets_);
      const auto middle_count = static_cast<std::int64_t>(buckets_ - turns);
      put(counts ? sum_of_middle(own.at(i), next, middle_count) : vector{}, i, r.head + 1);
      if (!counts) put({}, i, r.oldest + 1);
      if (!counts || turns == buckets_) put({}, i, r.next + 1);
    }
    return left;
  }
  vector sum_of_middle(const history& own, std::int64_t place, std::int64_t count) const {
    return own.stride == 1 ? sum_from(neighbours<const double>{own.values}, place, count)
                           : sum_from(const_history(own), place, count);
  }

  static vector vector_at(const column* c, int i) { return {c[0].values[i], c[1].values[i], c[2].values[i]}; }
  static void put(vector a, int i, column* c) {
    c[0].values[i] = a.n;
    c[1].values[i] = a.t1;
    c[2].values[i] = a.t2;
  }
  // The bucket of the step counts where it is open, and where none is, nothing does.
  [[gnu::noinline, gnu::flatten]] static void sum_parts(int count, block_reading& r, edge given,
                                                        double newest) {
#pragma omp simd
    for (int i = 0; i < count; ++i)
      put_sum(r, i, given, r.head[0].values[i] == newest, r.head[0].values[i] == empty,
              vector_at(r.current + 1, i), vector_at(r.oldest + 1, i), vector_at(r.next + 1, i));
  }
  static void put_sum(block_reading& r, int i, edge given, bool is_open, bool is_empty, vector current,
                      vector oldest, vector next) {
    current.n = is_open ? current.n : 0.0;
    current.t1 = is_open ? current.t1 : 0.0;
    current.t2 = is_open ? current.t2 : 0.0;
    vector s = given.sum(vector_at(r.head + 1, i), current, oldest, next);
    s.n = is_empty ? 0.0 : s.n;
    s.t1 = is_empty ? 0.0 : s.t1;
    s.t2 = is_empty ? 0.0 : s.t2;
    put(s, i, r.sum);
    r.refused.values[i] = defect(s) == 0.0 ? not_refused : impossible_state;
  }

  // Of nodes whose newest bucket is that of the step, whatever impulse they add; those are done then. Returns
  // whether there are any.
  [[gnu::noinline, gnu::flatten]] static bool add_to_newest(int count, given_impulses& given,
                                                            block_reading& r, double newest) {
    std::uint64_t done = 0;
#pragma omp simd reduction(| : done)
    for (int i = 0; i < count; ++i) {
      const vector impulse = vector_at(given.impulse, i), current = vector_at(r.current + 1, i);
      const double adds = given.adds.values[i], clears = given.clears.values[i];
      const bool is_there = (impulse.n != 0.0) | (impulse.t1 != 0.0) | (impulse.t2 != 0.0);
      const bool is_added = is_there & (r.head[0].values[i] == newest) & (adds > clears);
      r.current[1].values[i] = is_added ? current.n + impulse.n : current.n;
      r.current[2].values[i] = is_added ? current.t1 + impulse.t1 : current.t1;
      r.current[3].values[i] = is_added ? current.t2 + impulse.t2 : current.t2;
      given.adds.values[i] = (is_added | !is_there) ? 0.0 : adds;
      done |= std::bit_cast<std::uint64_t>(is_added ? 1.0 : 0.0);
    }
    return done != 0;
  }
  // Of nodes whose newest bucket is the one before that of the step, which lies in these two.
  template <class OwnHistory>
  [[gnu::noinline]] void open_next(int count, OwnHistory own_of, given_impulses& given,
                                   const block_reading& r) const {
    const double before = stamp_of(now_ - 1.0), of_first = shares_.first < now_ ? shares_.of_first : 0.0;
    for (int i = 0; i < count; ++i) {
      const vector impulse = vector_at(given.impulse, i);
      if (r.head[0].values[i] != before || given.clears.values[i] != 0.0) continue;
      if (given.adds.values[i] == 0.0 || is_zero(impulse)) continue;
      given.adds.values[i] = 0.0;
      const auto own = own_of(i);
      const vector part = of_first * impulse;
      const std::int64_t last = at(previous(place_));
      if (of_first > 0.0) write(own, last, read(own, last) + part);
      write(own, at(place_), vector{} + (impulse - part));
      write(own, middle_sum, vector_at(r.head + 1, i) + part);
      own[0] = stamp_;
    }
  }
  [[gnu::noinline]] void add_alone(const history& own, int i, const given_impulses& given,
                                   const block_reading& r) const {
    const vector impulse = vector_at(given.impulse, i);
    const bool clears = given.clears.values[i] != 0.0;
    if (clears) clear(own);
    if (given.adds.values[i] == 0.0 || is_zero(impulse)) return;
    const double turns = is_on_grid() && !clears ? turns_since(r.head[0].values[i]) : -1.0;
    if (turns > 0.0 && turns <= buckets_)
      open_and_add(own, impulse, turns, vector_at(r.head + 1, i));
    else
      window_in_step::add(own, impulse);
  }
};

}  // namespace ilaw::kit::detail
