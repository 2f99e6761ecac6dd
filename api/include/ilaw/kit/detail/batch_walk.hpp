// batch_walk.hpp - blocks of a batch as columns: in place where the host's arrays allow it, else copies that
// are turned to the local frame and back.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/ahead.hpp>
#include <ilaw/kit/detail/kernel.hpp>
#include <ilaw/kit/detail/tangent_columns.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// Length: of its blocks, at most.
template <class Law, class Layout, int Length>
class batch_walk {
  using column = column_to<Length>;

 public:
  static constexpr int states = state_doubles<Law>;
  static constexpr bool in_place = is_in_place<Layout>, of_floats = is_of_floats<Layout>;

  batch_walk(const instance<Law>& made, const ilaw_kit_batch& batch, block_room<Law, Length>& room,
             const streams* ahead)
      : made_(made),
        batch_(batch),
        room_(room),
        dimension_(static_cast<int>(made.dimension)),
        ahead_(ahead) {}

  // Fills the columns of the block that starts at position first.
  void open(std::int64_t first) {
    nodes_ = range(first);
    block_.count = nodes_.count;
    block_.next = first + Length;
    block_.ahead = block_.next < batch_.node_count ? ahead_ : nullptr;
    block_.time = batch_.time;
    block_.velocity_step = batch_.velocity_step;
    block_.position_step = batch_.position_step;
    for (const double*& sum : block_.earlier) sum = zeros.values;
    block_.earlier_refused = zeros.values;
    block_.impulse_guard = holds_floats(batch_) ? 0x1p898 : 4.0;
    block_.in_full = &in_full_;
    gather_inputs();
    if (made_.frame == ILAW_FRAME_GLOBAL) gather_frame();
    if (made_.frame == ILAW_FRAME_GLOBAL && dimension_ == 2) pad_turned_delassus();
    open_state();
    aim_outputs();
  }

  // Gives the nodes of a block their range and frame, for initialise.
  void open_initial(std::int64_t first) {
    nodes_ = range(first);
    is_initial_ = true;
    block_.area = optional(batch_.area, made_.inputs() & ILAW_INPUT_AREA, room_.area);
    if (made_.carries_frame) gather_frame();
  }

  // Writes the first state of node i; says why not if it cannot: then the state is zero.
  const char* initialise(const Law& law, int i) {
    const std::int64_t node = nodes_.node(i);
    for (std::int64_t c = 0; c < static_cast<std::int64_t>(made_.state_size); ++c)
      at(batch_.state_out, node, c) = 0.0;
    const double area = block_.area[i];
    if (!is_finite(area) || area < 0.0) return "the area is not a finite number >= 0";
    if (made_.carries_frame && !unit(columns::get(block_.axes, i))) return "the normal is not a unit vector";
    initial_node<state_t<Law>, Law::card.inputs> fresh{
        .time = batch_.time, .area = area_of<Law, Layout>(block_.area, i), .state = {}};
    if constexpr (initialises<Law>) law.initialise(fresh);
    if (state_defect<Law>(fresh.state) != 0.0) return "the state overflows";
    if constexpr (has_state<Law>) {
      const auto doubles = std::bit_cast<std::array<double, states>>(fresh.state);
      for (int k = 0; k < states; ++k)
        if (const int entry = state_entry<Law>(k, dimension_); entry >= 0)
          at(batch_.state_out, node, entry) = doubles[k];
    }
    if (made_.carries_frame) keep_frame(i);
    return nullptr;
  }

  node_block<Law>& block() { return block_; }
  const node_range& nodes() const { return nodes_; }

  // Writes what the block computed to the host's arrays. Outputs that are absent are left out.
  void close() {
    if (!in_place) scatter_components(batch_.impulse, dimension_, nodes_, block_.impulse);
    if (!in_place && batch_.velocity.values)
      scatter_components(batch_.velocity, dimension_, nodes_, block_.velocity);
    if (batch_.energy.values) scatter_components(batch_.energy, ILAW_ENERGY_COUNT, nodes_, block_.energy);
    if (batch_.status) write_status();
    if (has_state_rows<Layout>) return;
    double* entries[states + 1] = {};
    for (int k = 0; k < states; ++k)
      if (const int entry = state_entry<Law>(k, dimension_); entry >= 0) entries[entry] = block_.state_out[k];
    scatter_doubles(batch_.state_out, state_entries<Law>(dimension_), nodes_, entries);
  }

  // The frame of an accepted step becomes the frame to carry on from.
  void keep_frames() {
    if (!made_.carries_frame) return;
    const bool history_moves = has_history<Law> && !(made_.capabilities() & can_rest);
    column moves;
    for (int i = 0; i < nodes_.count; ++i)
      moves.values[i] = block_.refused[i] == 0.0 && (history_moves || block_.stirs[i] != 0.0) ? 1.0 : 0.0;
    if (!nodes_.listed() && batch_.state_out.node_stride == 1) return keep_frames_in_columns(moves);
    for (int i = 0; i < nodes_.count; ++i)
      if (moves.values[i] != 0.0) keep_frame(i);
  }

  bool any_refused() const { return any_one(block_.refused, nodes_.count); }

 private:
  node_range range(std::int64_t first) const {
    const std::int64_t left = batch_.node_count - first;
    return {batch_.index,
            batch_.index64,
            first,
            batch_.index_base,
            static_cast<int>(left < Length ? left : Length),
            holds_floats(batch_)};
  }
  // Where component c of the block's first node stands in an array of the layout's numbers.
  template <class Array>
  auto where(const Array& a, int c) const {
    const auto first = Layout::in(a.values) + nodes_.first * a.node_stride + c * a.component_stride;
    return reinterpret_cast<decltype(a.values)>(first);
  }
  // What is read where an array is absent.
  static const double* none() {
    static constexpr typename Layout::number absent[Length] = {};
    return reinterpret_cast<const double*>(absent);
  }
  static const double& at(const ilaw_kit_input& a, std::int64_t node, std::int64_t c) {
    return a.values[node * a.node_stride + c * a.component_stride];
  }
  static double& at(const ilaw_kit_output& a, std::int64_t node, std::int64_t c) {
    return a.values[node * a.node_stride + c * a.component_stride];
  }

  void write_status() const {
    const double* s = block_.status;
    std::uint8_t* status = batch_.status + nodes_.first;
    if (nodes_.listed() || batch_.status_stride != 1) {
      for (int i = 0; i < nodes_.count; ++i)
        batch_.status[nodes_.node(i) * batch_.status_stride] = static_cast<std::uint8_t>(s[i]);
      return;
    }
#pragma omp simd
    for (int i = 0; i < nodes_.count; ++i) status[i] = static_cast<std::uint8_t>(static_cast<int>(s[i]));
  }

  void keep_frame(int i) {
    const axis n = columns::get(block_.axes, i), t = columns::get(block_.axes + 3, i);
    const double entries[6] = {n.x, n.y, n.z, t.x, t.y, t.z};
    for (int k = 0; k < 6; ++k) at(batch_.state_out, nodes_.node(i), made_.frame_offset() + k) = entries[k];
  }

  void keep_frames_in_columns(const column& moves) {
    for (int k = 0; k < 6; ++k) {
      double* const frame = &at(batch_.state_out, nodes_.first, made_.frame_offset() + k);
      const double* const now = block_.axes[k];
#pragma omp simd
      for (int i = 0; i < nodes_.count; ++i) frame[i] = moves.values[i] != 0.0 ? now[i] : frame[i];
    }
  }

  const double* optional(const ilaw_kit_input& input, bool read, column& room) {
    if (!read || !input.values) return none();
    return of_floats ? where(input, 0) : gather(input, nodes_, room.values);
  }

  // Vectors that may stay interleaved where the layout says so.
  void gather_in_layout(const ilaw_kit_input& input, column* room, const double** components) {
    if constexpr (in_place) {
      for (int c = 0; c < 3; ++c) components[c] = where(input, c);
    } else {
      gather_vector(input, dimension_, nodes_, room, components);
    }
  }

  void gather_inputs() {
    const std::uint32_t reads = made_.inputs();
    const bool previous =
        batch_.v_previous.values && ((reads & ILAW_INPUT_V_PREVIOUS) || batch_.energy.values);
    gather_in_layout(batch_.v_free, room_.v_free, block_.v_free);
    if (previous)
      gather_in_layout(batch_.v_previous, room_.v_previous, block_.v_previous);
    else
      for (const double*& component : block_.v_previous) component = zeros.values;
    for (int c = 0; c < 3; ++c) block_.v_previous_of_energy[c] = block_.v_previous[c];
    if (previous && reads_previous<Law> && !(reads & ILAW_INPUT_V_PREVIOUS)) keep_from_motion();
    block_.gap = optional(batch_.gap, reads & ILAW_INPUT_GAP, room_.gap);
    block_.gap_offset = optional(batch_.gap_offset, reads & ILAW_INPUT_GAP, room_.gap_offset);
    block_.area = optional(batch_.area, reads & ILAW_INPUT_AREA, room_.area);
    gather_delassus();
  }

  // Where parameters make a law read no v_previous it is there for energies alone, a number always, turned or
  // not: what a law says of them may need it, its motion may not.
  void keep_from_motion() {
    constexpr double guard = 4.0;
    double* const room[] = {room_.finite_previous[0].values, room_.finite_previous[1].values,
                            room_.finite_previous[2].values};
    for (int i = 0; i < nodes_.count; ++i) {
      const axis v = columns::get(block_.v_previous, i);
      const bool good = defect(guard * v.x) + defect(guard * v.y) + defect(guard * v.z) == 0.0;
      columns::put(room, i, {good ? v.x : 0.0, good ? v.y : 0.0, good ? v.z : 0.0});
    }
    for (int c = 0; c < 3; ++c) block_.v_previous[c] = room_.finite_previous[c].values;
  }

  // Missing dimensions are padded so that H stays positive definite; see delassus orders in ilaw.h.
  void gather_delassus() {
    const int numbers = delassus_numbers(made_.delassus_form, dimension_);
    const double* given[6] = {};
    if constexpr (of_floats)
      for (int k = 0; k < numbers; ++k) given[k] = where(batch_.delassus, k);
    else
      gather_components(batch_.delassus, numbers, nodes_, room_.delassus, given);
    const double** h = block_.delassus;
    if (made_.is_transverse()) {  // two columns are read; a scalar is both
      h[0] = given[0];
      h[1] = given[numbers - 1];
      return;
    }
    for (int e = 0; e < 3; ++e) h[e] = given[e < dimension_ ? e : 0];
    for (int e = 3; e < 6; ++e) h[e] = zeros.values;
    if (dimension_ == 2) h[2] = h[1];  // or it would pass for anisotropic
    if (made_.delassus_form != ILAW_DELASSUS_FULL) return;
    if (dimension_ == 2) h[3] = given[2];
    for (int e = 3; dimension_ == 3 && e < 6; ++e) h[e] = given[e];
  }

  // In two dimensions the second tangent is given the entry of the first, lest H pass for anisotropic.
  void pad_turned_delassus() {
    if (made_.is_transverse()) return;
    const double* const* h = block_.delassus;
    double* padded = room_.delassus[4].values;
    for (int i = 0; i < nodes_.count; ++i) {
      const axis t = plane_tangent(2, columns::get(block_.axes, i));
      padded[i] = t.x * t.x * h[0][i] + t.y * t.y * h[1][i] + 2.0 * t.x * t.y * h[3][i];
    }
    block_.delassus[2] = padded;
  }

  // Columns of the axes. Frames that follow from the normal alone are left to the kernel in three dimensions.
  void gather_frame() {
    gather_in_layout(batch_.normal, room_.normal, block_.axes);
    if (!made_.stores_frame()) return;
    for (int c = 0; c < 3; ++c) {
      block_.axes[3 + c] = room_.first_tangent[c].values;
      block_.axes[6 + c] = room_.second_tangent[c].values;
    }
    const tangent_columns tangents(room_.first_tangent, room_.second_tangent);
    const bool in_space = dimension_ == 3;
    if (in_space && made_.has_tangent) {
      gather_vector(batch_.tangent, dimension_, nodes_, room_.tangent, block_.axes + 3);
      tangents.keep(nodes_.count, block_.axes, block_.axes + 3);
    } else if (in_space && made_.carries_frame && !is_initial_) {
      ilaw_kit_input frames = batch_.state_in;
      frames.values += made_.frame_offset() * frames.component_stride;
      const double* before[6];
      gather_doubles(frames, 6, nodes_, room_.frame_before, before);
      tangents.transport(nodes_.count, block_.axes, before);
    } else if (in_space) {
      tangents.choose(nodes_.count, block_.axes);
    } else {
      for (int i = 0; i < nodes_.count; ++i)
        tangents.put(i, columns::get(block_.axes, i), plane_tangent(dimension_, columns::get(block_.axes, i)),
                     true);
    }
  }

  void open_state() {
    if (has_state_rows<Layout>) {
      block_.state_in[0] = where(batch_.state_in, 0);
    } else if (batch_.state_in.values) {
      const double* entries[states + 1];
      gather_doubles(batch_.state_in, state_entries<Law>(dimension_), nodes_, room_.state_in, entries);
      for (int k = 0; k < states; ++k) {
        const int entry = state_entry<Law>(k, dimension_);
        block_.state_in[k] = entry >= 0 ? entries[entry] : zeros.values;
      }
      copy_unnamed_state();
    } else {
      for (int k = 0; k < states; ++k) block_.state_in[k] = zeros.values;
    }
    const ilaw_kit_output& out = batch_.state_out;
    block_.history_values = nullptr;
    if (!has_history<Law>) return;
    block_.history_values = out.values + made_.history_offset() * out.component_stride +
                            (nodes_.listed() ? 0 : nodes_.first * out.node_stride);
    block_.history_node_stride = out.node_stride;
    block_.history_component_stride = out.component_stride;
    block_.history_nodes = nodes_.listed() ? room_.nodes : nullptr;
    for (int i = 0; nodes_.listed() && i < nodes_.count; ++i) room_.nodes[i] = nodes_.node(i);
  }

  // History and frame are worked on in state_out, which therefore starts as state_in.
  void copy_unnamed_state() {
    if (batch_.state_in.values == batch_.state_out.values) return;
    const auto first = static_cast<std::int64_t>(made_.history_offset()),
               size = static_cast<std::int64_t>(made_.state_size);
    if (batch_.state_in.component_stride == 1 && batch_.state_out.component_stride == 1) {
      const auto bytes = static_cast<std::size_t>(size - first) * sizeof(double);
      for (int i = 0; bytes > 0 && i < nodes_.count; ++i)
        __builtin_memcpy(&at(batch_.state_out, nodes_.node(i), first),
                         &at(batch_.state_in, nodes_.node(i), first), bytes);
      return;
    }
    for (std::int64_t c = first; c < size; ++c)
      for (int i = 0; i < nodes_.count; ++i)
        at(batch_.state_out, nodes_.node(i), c) = at(batch_.state_in, nodes_.node(i), c);
  }

  void aim_outputs() {
    aim_vector(batch_.impulse, block_.impulse, room_.impulse);
    aim_vector(batch_.velocity, block_.velocity, room_.velocity);
    for (int k = 0; k < ILAW_ENERGY_COUNT; ++k)
      block_.energy[k] = aim(batch_.energy, k, true, room_.energy[k]);
    block_.status = room_.status.values;
    block_.refused = room_.refused.values;
    block_.stirs = room_.stirs.values;
    if (has_state_rows<Layout>) {
      block_.state_out[0] = where(batch_.state_out, 0);
      return;
    }
    for (int k = 0; k < states; ++k) {
      const int entry = state_entry<Law>(k, dimension_);
      block_.state_out[k] = aim(batch_.state_out, entry, entry >= 0, room_.state_out[k]);
    }
  }

  void aim_vector(const ilaw_kit_output& output, double** components, column* room) {
    for (int c = 0; c < 3; ++c)
      components[c] = in_place && output.values ? where(output, c) : aim(output, c, c < dimension_, room[c]);
  }
  double* aim(const ilaw_kit_output& output, int component, bool exists, column& room) {
    return exists && output.values ? target(output, component, nodes_, room.values) : room.values;
  }

  const instance<Law>& made_;
  const ilaw_kit_batch& batch_;
  block_room<Law, Length>& room_;
  int dimension_;
  const streams* ahead_;
  bool is_initial_ = false;
  full_blocks in_full_;
  node_range nodes_{};
  node_block<Law> block_;
};

}  // namespace ilaw::kit::detail
