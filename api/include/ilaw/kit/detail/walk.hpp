// walk.hpp - a batch as views: all of it at once where its arrays are rows or columns, else blocks of nodes,
// of which the other arrays are copied to columns and back, and the windows read before the loop and written
// after it. Once per number types, not per law, and at the baseline, as it moves numbers and computes none:
// windows and conversions of floats are of the instance's level.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/batch_checks.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// ---- copies of blocks

// The nodes of a part of a batch.
inline constexpr int block_nodes = 64;  // at most: their copies stay in the first cache
struct node_range {
  std::int64_t first, count;
  bool listed;
  std::int64_t where[block_nodes];

  node_range(const ilaw_batch& b, std::int64_t start, std::int64_t n)
      : first(start), count(n), listed(b.index || b.index64) {
    if (b.index64)
      for (std::int64_t i = 0; i < n; ++i) where[i] = b.index64[start + i] - b.index_base;
    else if (b.index)
      for (std::int64_t i = 0; i < n; ++i) where[i] = std::int64_t{b.index[start + i]} - b.index_base;
  }
  std::int64_t operator()(std::int64_t i) const { return listed ? where[i] : first + i; }
};

// Between the arrays of a host and the columns of a copy: to the copy where the host's numbers are const.
template <int N, class Host, class Copy>
[[gnu::noinline]] void copy_nodes(Host* values, std::int64_t stride, std::int64_t component,
                                  const node_range& n, Copy* copy) {
  const auto copy_node = [=](std::int64_t node, std::int64_t i) ILAW_KIT_LAMBDA {
    Host* const at = values + node * stride;
#pragma GCC unroll 4
    for (int c = 0; c < N; ++c)
      if constexpr (std::is_const_v<Host>)
        copy[c * block_nodes + i] = static_cast<Copy>(at[c * component]);
      else
        at[c * component] = static_cast<Host>(copy[c * block_nodes + i]);
  };
  if (n.listed)
    for (std::int64_t i = 0; i < n.count; ++i) copy_node(n.where[i], i);
  else
    for (std::int64_t i = 0; i < n.count; ++i) copy_node(n.first + i, i);
}
// Rows of four numbers or more, four nodes by four numbers at a time; the last four may overlap the others.
using four = double __attribute__((vector_size(32)));
ILAW_KIT_INLINE void transpose(four (&m)[4]) {
  const four a = __builtin_shufflevector(m[0], m[1], 0, 4, 2, 6),
             b = __builtin_shufflevector(m[0], m[1], 1, 5, 3, 7),
             c = __builtin_shufflevector(m[2], m[3], 0, 4, 2, 6),
             d = __builtin_shufflevector(m[2], m[3], 1, 5, 3, 7);
  m[0] = __builtin_shufflevector(a, c, 0, 1, 4, 5);
  m[1] = __builtin_shufflevector(b, d, 0, 1, 4, 5);
  m[2] = __builtin_shufflevector(a, c, 2, 3, 6, 7);
  m[3] = __builtin_shufflevector(b, d, 2, 3, 6, 7);
}
template <class Host, class Copy>
[[gnu::noinline]] void copy_rows(Host* values, std::int64_t stride, int count, const node_range& n,
                                 Copy* copy) {
  std::int64_t i = 0;
  for (; i + 4 <= n.count; i += 4)
    for (int c = 0; c < count; c += 4) {
      const int first = c + 4 <= count ? c : count - 4;
      Copy* const columns = copy + first * block_nodes + i;
      four m[4];
      if constexpr (std::is_const_v<Host>) {
#pragma GCC unroll 4
        for (int k = 0; k < 4; ++k) __builtin_memcpy(&m[k], values + n(i + k) * stride + first, sizeof(four));
        transpose(m);
#pragma GCC unroll 4
        for (int k = 0; k < 4; ++k) __builtin_memcpy(columns + k * block_nodes, &m[k], sizeof(four));
      } else {
#pragma GCC unroll 4
        for (int k = 0; k < 4; ++k) __builtin_memcpy(&m[k], columns + k * block_nodes, sizeof(four));
        transpose(m);
#pragma GCC unroll 4
        for (int k = 0; k < 4; ++k) __builtin_memcpy(values + n(i + k) * stride + first, &m[k], sizeof(four));
      }
    }
  for (; i < n.count; ++i)
    for (int c = 0; c < count; ++c)
      if constexpr (std::is_const_v<Host>)
        copy[c * block_nodes + i] = values[n(i) * stride + c];
      else
        values[n(i) * stride + c] = copy[c * block_nodes + i];
}
// Numbers side by side, of floats to doubles and back.
template <class From, class To>
[[gnu::noinline]] void convert(const From* from, To* to, std::int64_t count) {
  std::int64_t k = 0;
  for (; k + register_lanes <= count; k += register_lanes)
    put_one(narrowed<To>(widened(one_at(from + k))), to + k);
  for (; k < count; ++k) to[k] = static_cast<To>(from[k]);
}

// ---- windows of a block

struct window_block {
  alignas(64) double earlier[3][block_nodes], refused[block_nodes];
  alignas(64) double given[3][block_nodes], adds[block_nodes], clears[block_nodes];
};
// Where the windows of a block stand: that of the first node, the strides, and the nodes where they are
// listed.
struct window_place {
  double* first;
  std::int64_t node_stride, component_stride, count;
  const std::int64_t* nodes;

  // Calls work with the windows of each pack of nodes; lanes without a node have that of the last one.
  template <class Work>
  ILAW_KIT_INLINE void for_packs(Work work) const {
    constexpr int lanes = lanes_of<pack>;
    for (std::int64_t i = 0; i < count; i += lanes) {
      if (node_stride == 1 && !nodes && i + lanes <= count) {
        work(i, window_columns<pack>{first + i, component_stride});
      } else {
        window_rows own;
        own.stride = component_stride;
        const std::int64_t last = count - 1 - i;
#pragma GCC unroll 8
        for (int lane = 0; lane < lanes; ++lane) {
          const std::int64_t k = i + (lane < last ? lane : last);
          own.first[lane] = first + (nodes ? nodes[k] : k) * node_stride;
        }
        work(i, own);
      }
    }
  }
};
// Both are ilaw_kit_windows.
[[gnu::noinline, gnu::flatten]] inline void read_windows(const void* window, const void* place, void* all) {
  const auto& w = *static_cast<const kit::window*>(window);
  auto& block = *static_cast<window_block*>(all);
  static_cast<const window_place*>(place)->for_packs([&](std::int64_t i, const auto& own) {
    vector<pack> sum;
    store(w.read(own, sum), block.refused + i);
    store(sum.n, block.earlier[0] + i);
    store(sum.t1, block.earlier[1] + i);
    store(sum.t2, block.earlier[2] + i);
  });
}
[[gnu::noinline, gnu::flatten]] inline void write_windows(const void* window, const void* where, void* all) {
  const auto& w = *static_cast<const kit::window*>(window);
  const auto& place = *static_cast<const window_place*>(where);
  auto& block = *static_cast<window_block*>(all);
  for (std::int64_t i = place.count; i % lanes_of<pack> != 0; ++i) block.adds[i] = block.clears[i] = 0.0;
  place.for_packs([&](std::int64_t i, const auto& own) {
    const vector<pack> impulse{load<pack>(block.given[0] + i), load<pack>(block.given[1] + i),
                               load<pack>(block.given[2] + i)};
    w.write(own, load<pack>(block.clears + i) != 0.0, load<pack>(block.adds + i) != 0.0, impulse);
  });
}

// ---- the walk

// Whether an array of so many components may stay where it is.
template <class Array>
bool stays(const Array& a, int components) {
  return a.node_stride == 1 || (a.node_stride == components && a.component_stride == 1);
}

// What does not depend on the host's numbers: which arrays stay, and the state, whose numbers are doubles.
class walk_base {
 protected:
  // state_scratch: block_nodes for each number of state_in, state_out and twice the frame.
  walk_base(const instance_base& made, const ilaw_batch& batch, double* state_scratch)
      : made_(made),
        b_(batch),
        d_(static_cast<int>(made.dimension)),
        read_(inputs_read(made, batch)),
        state_scratch_(state_scratch) {}

  // ---- which arrays stay

  template <class Array>
  bool stays_or_absent(const Array& a, int components) const {
    return is_absent(made_, a) || stays(a, components);
  }
  template <class Array>
  bool state_stays(const Array& a) const {
    if (made_.states == 0 && !made_.carries_frame) return true;
    for (int k = 0; k < made_.states; ++k)
      if (made_.state_entries[k] < 0) return false;
    if (a.node_stride == 1) return true;
    return made_.state_size == static_cast<std::uint64_t>(made_.states) && a.node_stride == made_.states &&
           a.component_stride == 1;
  }
  bool all_stay() const {
    bool stay = !b_.index && !b_.index64 && (!b_.status || b_.status_stride == 1) &&
                stays(b_.delassus, made_.delassus_numbers()) && state_stays(b_.state_in) &&
                state_stays(b_.state_out);
    const auto check = [&](const array_card& card, const auto& a) {
      stay = stay && (!card.is_in(read_) || stays_or_absent(a, card.count(d_)));
    };
    for_inputs(check, b_);
    for_outputs(check, b_);
    for (std::uint32_t k = 0; k < made_.per_node_count; ++k)
      stay = stay && made_.numbers == ILAW_NUMBERS_DOUBLE && stays(b_.per_node_parameters[k], 1);
    for (std::uint32_t k = 0; b_.amounts && k < made_.amount_count; ++k)
      stay = stay && stays_or_absent(b_.amounts[k], 1);
    return stay;
  }

  // Whether the law's numbers are rows in the host's order.
  template <class Array>
  bool has_rows(const Array& a) const {
    bool are_in_order = made_.states >= 4 && a.component_stride == 1;
    for (int k = 0; k < made_.states; ++k) are_in_order = are_in_order && made_.state_entries[k] == k;
    return are_in_order;
  }

  // ---- state

  struct state_arrays {
    array<const double> in, frame_in;
    array<double> out, frame_out;
  };
  state_arrays open_state(const node_range& n) const {
    state_arrays v;
    if (made_.state_size == 0 && made_.states == 0) return v;
    copy_unnamed(n);
    v.in = place<const double>(b_.state_in, n, state_scratch_);
    if (v.in.at == state_scratch_) copy_state(b_.state_in.values, b_.state_in, n, state_scratch_);
    v.out = place<double>(b_.state_out, n, out_scratch());
    if (!made_.carries_frame) return v;
    v.frame_in = frame_place<const double>(b_.state_in, n, frame_scratch());
    if (v.frame_in.at == frame_scratch()) copy_frame(b_.state_in.values, b_.state_in, n, frame_scratch());
    v.frame_out = frame_place<double>(b_.state_out, n, frame_scratch() + frame_size * block_nodes);
    return v;
  }
  void close_state(const array<double>& state_out, const array<double>& frame_out,
                   const node_range& n) const {
    const double* const frame = frame_scratch() + frame_size * block_nodes;
    if (made_.state_size == 0) return;
    if (state_out.at == out_scratch()) copy_state(b_.state_out.values, b_.state_out, n, state_out.at);
    if (frame_out.at == frame) copy_frame(b_.state_out.values, b_.state_out, n, frame);
  }

 private:
  double* out_scratch() const { return state_scratch_ + made_.states * block_nodes; }
  double* frame_scratch() const { return out_scratch() + made_.states * block_nodes; }
  template <class T, class Array>
  array<T> place(const Array& a, const node_range& n, double* copy) const {
    if (n.listed || !state_stays(a)) return {copy, block_nodes, made_.states, 0};
    return {a.values + n.first * a.node_stride, a.component_stride, made_.states,
            a.node_stride != 1 ? made_.states : 0};
  }
  template <class T, class Array>
  array<T> frame_place(const Array& a, const node_range& n, double* copy) const {
    if (n.listed || a.node_stride != 1) return {copy, block_nodes, frame_size, 0};
    return {a.values + made_.frame_offset * a.component_stride + n.first, a.component_stride, frame_size, 0};
  }
  // Numbers that the host does not have, components beyond the dimension, are zero.
  template <class T, class Array, class Copy>
  void copy_state(T* values, const Array& a, const node_range& n, Copy* copy) const {
    if (has_rows(a)) return copy_rows(values, a.node_stride, made_.states, n, copy);
    for (int k = 0; k < made_.states; ++k, copy += block_nodes)
      if (const int entry = made_.state_entries[k]; entry >= 0)
        copy_nodes<1>(values + entry * a.component_stride, a.node_stride, 0, n, copy);
      else if constexpr (std::is_const_v<T>)
        for (std::int64_t i = 0; i < n.count; ++i) copy[i] = 0.0;
  }
  template <class T, class Array, class Copy>
  void copy_frame(T* values, const Array& a, const node_range& n, Copy* copy) const {
    for (int k = 0; k < frame_size; k += 3)
      copy_nodes<3>(values + (made_.frame_offset + k) * a.component_stride, a.node_stride, a.component_stride,
                    n, copy + k * block_nodes);
  }
  // A window is worked on in state_out, which therefore starts as state_in.
  void copy_unnamed(const node_range& n) const {
    const ilaw_input& in = b_.state_in;
    const ilaw_output& out = b_.state_out;
    if (in.values == out.values || made_.history_size == 0) return;
    for (std::int64_t i = 0; i < n.count; ++i)
      for (std::int64_t c = made_.history_offset; c < made_.history_offset + made_.history_size; ++c)
        out.values[n(i) * out.node_stride + c * out.component_stride] =
            in.values[n(i) * in.node_stride + c * in.component_stride];
  }

 protected:
  const instance_base& made_;
  const ilaw_batch& b_;
  const int d_;
  const std::uint32_t read_;
  double* const state_scratch_;
};

// Host: what the arrays of the batch hold. Number: what the loop reads; another type is converted by blocks,
// rows to rows and columns to columns.
template <class Host, class Number>
class batch_walk : walk_base {
 public:
  // parameter_scratch: block_nodes for each parameter of the law.
  batch_walk(const instance_base& made, const ilaw_batch& batch, double* state_scratch,
             double* parameter_scratch)
      : walk_base(made, batch, state_scratch), parameter_scratch_(parameter_scratch) {}

  [[gnu::noinline]] tally run(ilaw_kit_loop loop, const void* law) {
    tally all;
    if (!converts && made_.window.duration == 0.0 && all_stay()) {
      run_part(node_range(b_, 0, b_.node_count), loop, law, all);
    } else {
      for (std::int64_t first = 0; first < b_.node_count; first += block_nodes) {
        const std::int64_t left = b_.node_count - first;
        run_part(node_range(b_, first, left < block_nodes ? left : block_nodes), loop, law, all);
      }
    }
    return all;
  }

 private:
  static constexpr bool converts = !std::is_same_v<Host, Number>;

  // ---- copies of a block

  template <class T, class Array>
  static void prefetch_block(T* values, const Array& a, const node_range& n) {
    if (n.listed || a.component_stride != 1 || a.node_stride > 8) return;
    for (std::int64_t k = 0; k < block_nodes * a.node_stride; k += 64 / static_cast<int>(sizeof(T)))
      __builtin_prefetch(values + (n.first + block_nodes) * a.node_stride + k);
  }
  // An array of the host's, to its copy or back. One of other numbers that would stay keeps its order.
  template <class T, class Array, class Copy>
  [[gnu::noinline]] void copy_array(T* values, const Array& a, int components, const node_range& n,
                                    Copy* copy) const {
    if constexpr (converts)
      if (!n.listed && stays(a, components)) {
        const bool rows = a.node_stride != 1;
        const std::int64_t count = rows ? n.count * components : n.count;
        for (int c = 0; c < (rows ? 1 : components); ++c, copy += block_nodes) {
          T* const host = values + n.first * a.node_stride + c * a.component_stride;
          for (std::int64_t k = 0; k < count; k += 64 / static_cast<int>(sizeof(T)))
            __builtin_prefetch(host + count + k);
          if constexpr (std::is_const_v<T>)
            made_.part->to_doubles(host, copy, count);
          else
            made_.part->to_floats(copy, host, count);
        }
        return;
      }
    prefetch_block(values, a, n);
    if (components == 3) return copy_nodes<3>(values, a.node_stride, a.component_stride, n, copy);
    for (int c = 0; c < components; ++c)
      copy_nodes<1>(values + c * a.component_stride, a.node_stride, 0, n, copy + c * block_nodes);
  }
  // Where the loop finds an array of the block: at the host's place, or at the copy's.
  template <class Array>
  auto place(const Array& a, int components, const node_range& n, Number* copy) const {
    auto* const values = numbers_in<Host>(a);
    using found =
        array<std::conditional_t<std::is_same_v<decltype(values), Host* const>, Number, const Number>>;
    if (!values) return found{};
    const bool stay = !n.listed && stays(a, components);
    const int rows = stay && a.node_stride != 1 ? components : 0;
    if constexpr (!converts)
      if (stay) return found{values + n.first * a.node_stride, a.component_stride, components, rows};
    return found{copy, block_nodes, components, rows};
  }
  array<const Number> gather(const ilaw_input& a, int components, const node_range& n, Number* copy) const {
    const array<const Number> placed = place(a, components, n, copy);
    if (placed.at == copy && !is_there(a, n)) copy_array(numbers_in<Host>(a), a, components, n, copy);
    return placed;
  }
  // One value for all nodes is the same in every block.
  bool is_there(const ilaw_input& a, const node_range& n) const {
    return a.node_stride == 0 && n.count <= gathered_;
  }
  void scatter(const ilaw_output& a, const array<Number>& placed, const node_range& n,
               const Number* copy) const {
    if (placed.at == copy) copy_array(numbers_in<Host>(a), a, placed.count, n, copy);
  }
  // Parameters are doubles in every loop.
  const double* gather_parameter(const ilaw_input& a, const node_range& n, double* copy) const {
    if constexpr (std::is_same_v<Host, double>)
      if (!n.listed && stays(a, 1)) return a.values + n.first;
    if (!is_there(a, n)) copy_nodes<1>(numbers_in<Host>(a), a.node_stride, 0, n, copy);
    return copy;
  }
  void run_with_windows(view<Number>& v, const node_range& n, ilaw_kit_loop loop, const void* law,
                        tally& found) {
    const window w(made_.window, {b_.time + 0.5 * b_.position_step, b_.velocity_step});
    const ilaw_output& to = b_.state_out;
    const window_place place{
        to.values + made_.history_offset * to.component_stride + (n.listed ? 0 : n.first * to.node_stride),
        to.node_stride, to.component_stride, v.count, n.listed ? n.where : nullptr};
    window_block windows;
    for (int c = 0; c < 3; ++c) {
      v.earlier[c] = windows.earlier[c];
      v.given[c] = windows.given[c];
    }
    v.earlier_refused = windows.refused;
    v.adds = windows.adds;
    v.clears = windows.clears;
    made_.part->read(&w, &place, &windows);
    loop(law, &v, &found);
    made_.part->write(&w, &place, &windows);
  }

  // ---- a part of the batch

  void open_inputs(view<Number>& v, const node_range& n) {
    const auto open = [&](const array_card& card, const ilaw_input& a, auto& to, Number* copy) {
      if (card.is_in(read_)) to = gather(a, card.count(d_), n, copy);
    };
    for_inputs(open, b_, v, s_);
    v.delassus = gather(b_.delassus, made_.delassus_numbers(), n, s_.delassus);
    for (std::uint32_t k = 0; k < made_.per_node_count; ++k)
      v.parameters[made_.per_node_parameters[k]] =
          gather_parameter(b_.per_node_parameters[k], n, parameter_scratch_ + k * block_nodes);
    if (n.count > gathered_) gathered_ = n.count;
  }
  void open_outputs(view<Number>& v, const node_range& n) {
    const auto open = [&](const array_card& card, const ilaw_output& a, auto& to, Number* copy) {
      if (card.is_in(read_)) to = place(a, card.count(d_), n, copy);
    };
    for_outputs(open, b_, v, s_);
    if (b_.status) v.status = status_stays(n) ? b_.status + n.first : s_.status;
    for (std::uint32_t k = 0; b_.amounts && k < made_.amount_count; ++k) {
      v.amounts[k] = place(b_.amounts[k], 1, n, s_.amounts[k]).at;
      v.has_amounts = v.has_amounts || v.amounts[k];
    }
    v.moves = v.velocity.at || v.spin.at || v.energy.at || v.status || v.has_amounts;
    v.has_balance = v.energy.at || v.has_amounts;
  }
  bool status_stays(const node_range& n) const { return !n.listed && b_.status_stride == 1; }
  void run_part(const node_range& n, ilaw_kit_loop loop, const void* law, tally& all) {
    view<Number> v{};
    static_cast<view_options&>(v) = options_of(made_, b_, n.count);
    v.in_memory = std::is_same_v<Host, double> && n.count >= prefetch_from;
    open_inputs(v, n);
    open_outputs(v, n);
    const state_arrays state = open_state(n);
    v.state_in = state.in;
    v.state_out = state.out;
    v.frame_in = state.frame_in;
    v.frame_out = state.frame_out;
    tally found;
    if (made_.window.duration > 0.0)
      run_with_windows(v, n, loop, law, found);
    else
      loop(law, &v, &found);
    add(all, found, n);
    const auto close = [&](const array_card&, const ilaw_output& a, const auto& from, const Number* copy) {
      scatter(a, from, n, copy);
    };
    for_outputs(close, b_, v, s_);
    if (v.status == s_.status)
      for (std::int64_t i = 0; i < n.count; ++i) b_.status[n(i) * b_.status_stride] = s_.status[i];
    for (std::uint32_t k = 0; b_.amounts && k < made_.amount_count; ++k)
      if (v.amounts[k] == s_.amounts[k]) scatter(b_.amounts[k], {v.amounts[k], 0, 1, 0}, n, s_.amounts[k]);
    close_state(v.state_out, v.frame_out, n);
  }
  static void add(tally& all, const tally& found, const node_range& n) {
    all.by_scalar_fallback += found.by_scalar_fallback;
    all.stable_velocity_step = smaller(found.stable_velocity_step, all.stable_velocity_step);
    if (found.bad_count == 0) return;
    if (all.bad_count == 0) {
      all.first_bad_node = n(found.first_bad_node);
      all.reason = found.reason;
    }
    all.bad_count += found.bad_count;
  }

  struct alignas(64) scratch {
    Number v_free[3 * block_nodes], v_smooth[3 * block_nodes], v_previous[3 * block_nodes];
    Number normal[3 * block_nodes], tangent[3 * block_nodes];
    Number spin_free[3 * block_nodes], spin_previous[3 * block_nodes];
    Number delassus[6 * block_nodes], gap[block_nodes], gap_offset[block_nodes], area[block_nodes];
    Number impulse[3 * block_nodes], velocity[3 * block_nodes], energy[ILAW_ENERGY_COUNT * block_nodes];
    Number moment[3 * block_nodes], spin[3 * block_nodes];
    Number amounts[most_amounts][block_nodes];
    std::uint8_t status[block_nodes];
  };

  double* const parameter_scratch_;
  std::int64_t gathered_ = 0;  // nodes of the largest block whose inputs were gathered
  scratch s_;
};

}  // namespace ilaw::kit::detail
