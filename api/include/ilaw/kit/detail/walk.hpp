// walk.hpp - a batch as views: all of it at once where its arrays are rows or columns, else blocks of nodes,
// of which the other arrays are copied. Once per level and number types, not per law.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/batch_checks.hpp>
#include <ilaw/kit/detail/block_copies.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

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
      : made_(made), b_(batch), d_(static_cast<int>(made.dimension)), state_scratch_(state_scratch) {}

  // ---- which arrays stay

  template <class Array>
  bool stays_or_absent(const Array& a, int components) const {
    return is_absent(made_, a) || stays(a, components);
  }
  bool reads_smooth() const { return (made_.inputs & ILAW_INPUT_V_SMOOTH) != 0; }
  bool smooth_stays() const { return !reads_smooth() || stays_or_absent(b_.v_smooth, d_); }
  bool delassus_stays() const {
    if (!made_.is_transverse() && d_ < 3) return false;
    return stays(b_.delassus, made_.delassus_numbers());
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
                stays_or_absent(b_.v_free, d_) && smooth_stays() && stays_or_absent(b_.v_previous, d_) &&
                stays_or_absent(b_.normal, d_) && stays_or_absent(b_.tangent, d_) && delassus_stays() &&
                stays_or_absent(b_.gap, 1) && stays_or_absent(b_.gap_offset, 1) &&
                stays_or_absent(b_.area, 1) && stays_or_absent(b_.impulse, d_) &&
                stays_or_absent(b_.velocity, d_) && stays_or_absent(b_.energy, ILAW_ENERGY_COUNT) &&
                state_stays(b_.state_in) && state_stays(b_.state_out);
    if (made_.has_spins())
      stay = stay && stays(b_.spin_free, 3) && stays_or_absent(b_.spin_previous, 3) && stays(b_.moment, 3) &&
             stays_or_absent(b_.spin, 3);
    for (std::uint32_t k = 0; k < made_.per_node_count; ++k)
      stay = stay && stays(b_.per_node_parameters[k], 1);
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
    double* const in = state_scratch_;
    double* const out = in + made_.states * block_nodes;
    const ilaw_input& from = b_.state_in;
    v.in = {in, block_nodes, made_.states, 0};
    if (!n.listed && state_stays(from)) {
      v.in = {from.values + n.first * from.node_stride, from.component_stride, made_.states,
              from.node_stride != 1 ? made_.states : 0};
    } else if (has_rows(from)) {
      gather_rows(from.values, from.node_stride, made_.states, n, in);
    } else {
      for (int k = 0; k < made_.states; ++k) {
        const int entry = made_.state_entries[k];
        double* const to = in + k * block_nodes;
        if (entry >= 0)
          gather_column(from.values + entry * from.component_stride, from.node_stride, n, to);
        else
          for (std::int64_t i = 0; i < n.count; ++i) to[i] = 0.0;
      }
    }
    const ilaw_output& to = b_.state_out;
    v.out = {out, block_nodes, made_.states, 0};
    if (!n.listed && state_stays(to))
      v.out = {to.values + n.first * to.node_stride, to.component_stride, made_.states,
               to.node_stride != 1 ? made_.states : 0};
    open_frame(v, n, out + made_.states * block_nodes);
    return v;
  }
  void open_frame(state_arrays& v, const node_range& n, double* copy) const {
    if (!made_.carries_frame) return;
    const std::int64_t at = made_.frame_offset;
    const ilaw_input& in = b_.state_in;
    const ilaw_output& out = b_.state_out;
    if (!n.listed && in.node_stride == 1) {
      v.frame_in = {in.values + at * in.component_stride + n.first, in.component_stride, 6, 0};
    } else {
      for (int k = 0; k < 6; ++k)
        gather_column(in.values + (at + k) * in.component_stride, in.node_stride, n, copy + k * block_nodes);
      v.frame_in = {copy, block_nodes, 6, 0};
    }
    if (!n.listed && out.node_stride == 1)
      v.frame_out = {out.values + at * out.component_stride + n.first, out.component_stride, 6, 0};
    else
      v.frame_out = {copy + 6 * block_nodes, block_nodes, 6, 0};
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
  void close_state(const array<double>& state_out, const array<double>& frame_out,
                   const node_range& n) const {
    if (made_.state_size == 0) return;
    const ilaw_output& to = b_.state_out;
    const double* const out = state_scratch_ + made_.states * block_nodes;
    if (state_out.at == out && has_rows(to))
      scatter_rows(to.values, to.node_stride, made_.states, n, out);
    else if (state_out.at == out)
      for (int k = 0; k < made_.states; ++k)
        if (const int entry = made_.state_entries[k]; entry >= 0)
          scatter_column(to.values + entry * to.component_stride, to.node_stride, n, out + k * block_nodes);
    const double* const frame = out + made_.states * block_nodes + 6 * block_nodes;
    if (made_.carries_frame && frame_out.at == frame)
      for (int k = 0; k < 6; k += 3)
        scatter_three(to.values + (made_.frame_offset + k) * to.component_stride, to.node_stride,
                      to.component_stride, n, frame + k * block_nodes);
  }

  const instance_base& made_;
  const ilaw_batch& b_;
  const int d_;
  double* const state_scratch_;
};

// The loop of a law over a view.
template <class Number>
using run_function = void (*)(const void* law, const view<Number>&, tally&);

// Host: what the arrays of the batch hold. Number: what the loop reads; another type is converted by blocks,
// rows to rows and columns to columns.
template <class Host, class Number = Host, bool HasWindow = false>
class batch_walk : walk_base {
 public:
  // parameter_scratch: block_nodes for each parameter of the law.
  batch_walk(const instance_base& made, const ilaw_batch& batch, double* state_scratch,
             Number* parameter_scratch)
      : walk_base(made, batch, state_scratch), parameter_scratch_(parameter_scratch) {}

  [[gnu::noinline]] tally run(run_function<Number> loop, const void* law) {
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

  template <class T>
  static void prefetch_block(const T* values, std::int64_t stride, std::int64_t component,
                             const node_range& n) {
    if (n.listed || component != 1 || stride > 8) return;
    for (std::int64_t k = 0; k < block_nodes * stride; k += 64 / static_cast<int>(sizeof(T)))
      __builtin_prefetch(values + (n.first + block_nodes) * stride + k);
  }
  // The numbers of rows, or one column after the other, of an array that stays: calls convert with where they
  // begin in the host's array and in the copy, and how many follow.
  template <class T, class Array, class Convert>
  static void convert_all(T* values, const Array& a, int components, const node_range& n, Convert convert) {
    const bool rows = a.node_stride != 1;
    const std::int64_t count = rows ? n.count * components : n.count;
    for (int c = 0; c < (rows ? 1 : components); ++c) {
      T* const host = values + c * a.component_stride;
      for (std::int64_t k = 0; k < count; k += 64 / static_cast<int>(sizeof(T)))
        __builtin_prefetch(host + count + k);
      convert(host, std::int64_t{c} * block_nodes, count);
    }
  }

  array<const Number> gather(const ilaw_input& a, int components, const node_range& n, Number* copy) const {
    const Host* const values = numbers_in<Host>(a);
    if (!values) return {};
    const bool stay = !n.listed && stays(a, components);
    const int rows = stay && a.node_stride != 1 ? components : 0;
    if constexpr (!converts)
      if (stay) return {values + n.first * a.node_stride, a.component_stride, components, rows};
    gather_components(values, a, components, n, copy);
    return {copy, block_nodes, components, rows};
  }
  [[gnu::noinline]] static void gather_components(const Host* values, const ilaw_input& a, int components,
                                                  const node_range& n, Number* copy) {
    if constexpr (converts)
      if (!n.listed && stays(a, components))
        return convert_all(values + n.first * a.node_stride, a, components, n,
                           [copy](const Host* from, std::int64_t at, std::int64_t count) {
                             convert(from, copy + at, count);
                           });
    prefetch_block(values, a.node_stride, a.component_stride, n);
    if (components == 3) return gather_three(values, a.node_stride, a.component_stride, n, copy);
    for (int c = 0; c < components; ++c)
      gather_column(values + c * a.component_stride, a.node_stride, n, copy + c * block_nodes);
  }
  const Number* gather_scalar(const ilaw_input& a, const node_range& n, Number* copy) const {
    return gather(a, 1, n, copy).at;
  }
  // Full in the order of three dimensions, padded so that it stays positive definite.
  array<const Number> gather_delassus(const node_range& n) {
    const int numbers = made_.delassus_numbers();
    if (made_.is_transverse() || d_ == 3) return gather(b_.delassus, numbers, n, s_.delassus);
    const Host* const values = numbers_in<Host>(b_.delassus);
    const auto take = [&](int from, int to) {
      gather_column(values + from * b_.delassus.component_stride, b_.delassus.node_stride, n,
                    s_.delassus + to * block_nodes);
    };
    take(0, 0);
    take(d_ > 1 ? 1 : 0, 1);
    take(d_ > 1 ? 1 : 0, 2);  // or it would pass for anisotropic
    for (int k = 3 * block_nodes; k < 6 * block_nodes; ++k) s_.delassus[k] = 0;
    if (numbers == 3) take(2, 3);
    return {s_.delassus, block_nodes, 6, 0};
  }
  array<Number> aim(const ilaw_output& a, int components, const node_range& n, Number* copy) const {
    Host* const values = numbers_in<Host>(a);
    if (!values) return {};
    const bool stay = !n.listed && stays(a, components);
    const int rows = stay && a.node_stride != 1 ? components : 0;
    if constexpr (!converts)
      if (stay) return {values + n.first * a.node_stride, a.component_stride, components, rows};
    return {copy, block_nodes, components, rows};
  }
  void scatter(const ilaw_output& a, const array<Number>& aimed, const node_range& n,
               const Number* copy) const {
    if (aimed.at == copy) scatter_components(numbers_in<Host>(a), a, aimed.count, n, copy);
  }
  [[gnu::noinline]] static void scatter_components(Host* values, const ilaw_output& a, int components,
                                                   const node_range& n, const Number* copy) {
    if constexpr (converts)
      if (!n.listed && stays(a, components))
        return convert_all(
            values + n.first * a.node_stride, a, components, n,
            [copy](Host* to, std::int64_t at, std::int64_t count) { convert(copy + at, to, count); });
    prefetch_block(values, a.node_stride, a.component_stride, n);
    if (components == 3) return scatter_three(values, a.node_stride, a.component_stride, n, copy);
    for (int c = 0; c < components; ++c)
      scatter_column(values + c * a.component_stride, a.node_stride, n, copy + c * block_nodes);
  }

  void run_with_windows(view<Number>& v, const node_range& n, run_function<Number> loop, const void* law,
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
    read_windows(w, place, windows);
    loop(law, v, found);
    write_windows(w, place, windows);
  }

  // ---- a part of the batch

  void open_inputs(view<Number>& v, const node_range& n) {
    v.v_free = gather(b_.v_free, d_, n, s_.v_free);
    if (reads_smooth()) v.v_smooth = gather(b_.v_smooth, d_, n, s_.v_smooth);
    const bool has_balance = wants_balance(made_, b_);
    const std::uint32_t read = made_.inputs | (has_balance ? made_.balance_inputs : 0U);
    if (v.reads_previous || has_balance) v.v_previous = gather(b_.v_previous, d_, n, s_.v_previous);
    if (made_.frame == ILAW_FRAME_GLOBAL) v.normal = gather(b_.normal, d_, n, s_.normal);
    if (made_.inputs & ILAW_INPUT_TANGENT) v.tangent = gather(b_.tangent, d_, n, s_.tangent);
    v.delassus = gather_delassus(n);
    if (made_.has_spins()) {
      v.spin_free = gather(b_.spin_free, 3, n, s_.spin_free);
      if (v.v_previous.at) v.spin_previous = gather(b_.spin_previous, 3, n, s_.spin_previous);
    }
    if (made_.inputs & ILAW_INPUT_GAP) {
      v.gap = gather_scalar(b_.gap, n, s_.gap);
      v.gap_offset = gather_scalar(b_.gap_offset, n, s_.gap_offset);
    }
    if (read & ILAW_INPUT_AREA) v.area = gather_scalar(b_.area, n, s_.area);
    for (std::uint32_t k = 0; k < made_.per_node_count; ++k)
      v.parameters[made_.per_node_parameters[k]] =
          gather_scalar(b_.per_node_parameters[k], n, parameter_scratch_ + k * block_nodes);
  }
  void open_outputs(view<Number>& v, const node_range& n) {
    v.impulse = aim(b_.impulse, d_, n, s_.impulse);
    v.velocity = aim(b_.velocity, d_, n, s_.velocity);
    v.energy = aim(b_.energy, ILAW_ENERGY_COUNT, n, s_.energy);
    if (made_.has_spins()) {
      v.moment = aim(b_.moment, 3, n, s_.moment);
      v.spin = aim(b_.spin, 3, n, s_.spin);
    }
    if (b_.status) v.status = status_stays(n) ? b_.status + n.first : s_.status;
    for (std::uint32_t k = 0; b_.amounts && k < made_.amount_count; ++k) {
      v.amounts[k] = aim(b_.amounts[k], 1, n, s_.amounts[k]).at;
      v.has_amounts = v.has_amounts || v.amounts[k];
    }
    v.moves = v.velocity.at || v.spin.at || v.energy.at || v.status || v.has_amounts;
    v.has_balance = v.energy.at || v.has_amounts;
  }
  bool status_stays(const node_range& n) const { return !n.listed && b_.status_stride == 1; }
  void run_part(const node_range& n, run_function<Number> loop, const void* law, tally& all) {
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
    if constexpr (HasWindow) {
      if (made_.window.duration > 0.0)
        run_with_windows(v, n, loop, law, found);
      else
        loop(law, v, found);
    } else {
      loop(law, v, found);
    }
    add(all, found, n);
    scatter(b_.impulse, v.impulse, n, s_.impulse);
    scatter(b_.velocity, v.velocity, n, s_.velocity);
    if (made_.has_spins()) {
      scatter(b_.moment, v.moment, n, s_.moment);
      scatter(b_.spin, v.spin, n, s_.spin);
    }
    scatter(b_.energy, v.energy, n, s_.energy);
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

  Number* const parameter_scratch_;
  scratch s_;
};

}  // namespace ilaw::kit::detail
