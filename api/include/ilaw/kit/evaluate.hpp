// evaluate.hpp - a batch from end to end: checks its arrays, walks it block by block, reports refused nodes.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/instance.hpp>
#include <ilaw/kit/kernel.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

// A batch read up to the size its writer knew; absent members are zero.
inline ilaw_batch known_batch(const ilaw_batch& given) {
  ilaw_batch batch{};
  const std::uint32_t size =
      given.struct_size < sizeof(batch) ? given.struct_size : std::uint32_t{sizeof(batch)};
  std::memcpy(&batch, &given, size);
  return batch;
}

// What is wrong with the arrays that evaluate or initialise needs; null when nothing is.
template <class Law>
const char* missing_input(const instance<Law>& made, const ilaw_batch& b, std::uint32_t needed) {
  if ((needed & ILAW_INPUT_GAP) && !b.gap.values) return "gap is null";
  if ((needed & ILAW_INPUT_V_PREVIOUS) && !b.v_previous.values) return "v_previous is null";
  if ((needed & ILAW_INPUT_AREA) && !b.area.values) return "area is null";
  if ((needed & ILAW_INPUT_NORMAL) && !b.normal.values) return "normal is null";
  if ((needed & ILAW_INPUT_TANGENT) && !b.tangent.values) return "tangent is null";
  if (made.per_node_count > 0 && !b.per_node_parameters) return "per_node_parameters is null";
  for (std::uint32_t k = 0; k < made.per_node_count; ++k)
    if (!b.per_node_parameters[k].values) return "values of a per-node parameter are null";
  if (made.state_size > 0 && !b.state_out.values) return "state_out is null";
  return nullptr;
}

inline const char* wrong_scalars(const ilaw_batch& b) {
  if (b.node_count < 0) return "node_count is negative";
  if (b.index_base != 0 && b.index_base != 1) return "index_base is neither 0 nor 1";
  if (!finite(b.time)) return "time is not finite";
  return nullptr;
}

template <class Law>
const char* wrong_batch(const instance<Law>& made, const ilaw_batch& b) {
  if (const char* wrong = wrong_scalars(b)) return wrong;
  if (!(b.velocity_step > 0.0) || !finite(b.velocity_step)) return "velocity_step is not a finite number > 0";
  if (!(b.position_step > 0.0) || !finite(b.position_step)) return "position_step is not a finite number > 0";
  if (b.node_count == 0) return nullptr;
  if (!b.v_free.values) return "v_free is null";
  if (!b.delassus.values) return "delassus is null";
  if (!b.impulse.values) return "impulse is null";
  if (made.state_size > 0 && !b.state_in.values) return "state_in is null";
  return missing_input(made, b, made.inputs() | (b.energy.values ? made.energy_inputs() : 0U));
}

inline std::int32_t refuse(ilaw_report* report, const char* reason) {
  if (report)
    fill_sized(report,
               {.struct_size = 0, .reserved = 0, .bad_count = 0, .first_bad_node = -1, .reason = reason});
  return ILAW_INVALID_ARGUMENT;
}

// Whether the vectors that a kernel may read and write in place are (3,n) arrays.
template <class Law>
bool all_interleaved(const instance<Law>& made, const ilaw_batch& b) {
  const auto is_interleaved = [](const auto& a) { return a.node_stride == 3 && a.component_stride == 1; };
  return made.dimension == 3 && !b.index && is_interleaved(b.v_free) && is_interleaved(b.impulse) &&
         (made.frame == ILAW_FRAME_LOCAL || is_interleaved(b.normal));
}

// Columns of a block that are copies: where the host's arrays are not consecutive, or are turned to the local
// frame.
template <class Law>
struct block_room {
  static constexpr int states = state_doubles<Law>;
  column v_free[3], v_previous[3], delassus[6], gap, gap_offset, area, normal[3], tangent[3];
  column impulse[3], velocity[3], energy[ILAW_ENERGY_COUNT], status, refused;
  column state_in[states + 1], state_out[states + 1];
  column first_tangent[3], second_tangent[3];
};

// Entry of the host's state that holds double k of struct state; -1: a component beyond the dimension.
template <class Law>
int state_entry(int k, int dimension) {
  int entry = 0, position = 0;
  if constexpr (has_state<Law>)
    for (const state_variable& v : Law::state_variables) {
      const bool is_vector = v.kind == ILAW_STATE_VECTOR;
      if (k < position + (is_vector ? 3 : 1)) return k - position < dimension ? entry + (k - position) : -1;
      position += is_vector ? 3 : 1;
      entry += is_vector ? dimension : 1;
    }
  return -1;
}

template <class Law, class Layout>
class batch_walk {
 public:
  static constexpr int states = state_doubles<Law>;
  static constexpr bool in_place = std::is_same_v<Layout, interleaved>;

  batch_walk(const instance<Law>& made, const ilaw_batch& batch, block_room<Law>& room)
      : made_(made), batch_(batch), room_(room), dimension_(static_cast<int>(made.dimension)) {}

  // Fills the columns of the block that starts at position first.
  void open(std::int64_t first) {
    const std::int64_t left = batch_.node_count - first;
    nodes_ = {batch_.index, first, batch_.index_base,
              static_cast<int>(left < block_size ? left : block_size)};
    block_.count = nodes_.count;
    block_.time = batch_.time;
    block_.velocity_step = batch_.velocity_step;
    block_.position_step = batch_.position_step;
    gather_inputs();
    if (made_.frame == ILAW_FRAME_GLOBAL) gather_frame();
    if (made_.frame == ILAW_FRAME_GLOBAL && dimension_ == 2) pad_turned_delassus();
    open_state();
    aim_outputs();
  }

  // Gives the nodes of a block their range and frame, for initialise.
  void open_initial(std::int64_t first) {
    const std::int64_t left = batch_.node_count - first;
    nodes_ = {batch_.index, first, batch_.index_base,
              static_cast<int>(left < block_size ? left : block_size)};
    block_.area = optional(batch_.area, made_.inputs() & ILAW_INPUT_AREA, room_.area);
    if (made_.carries_frame) gather_frame();
  }

  // Writes the first state of node i; says why not if it cannot: then the state is zero.
  const char* initialise(const Law& law, int i) {
    const std::int64_t node = nodes_.node(i);
    for (std::int64_t c = 0; c < static_cast<std::int64_t>(made_.state_size); ++c)
      at(batch_.state_out, node, c) = 0.0;
    const double area = block_.area[i];
    if (!finite(area) || area < 0.0) return "the area is not a finite number >= 0";
    if (made_.carries_frame && !unit(columns::get(block_.axes, i))) return "the normal is not a unit vector";
    kit::node<scalar_delassus, state_t<Law>> fresh{};
    fresh.time = batch_.time;
    fresh.area = area;
    if constexpr (requires { law.initialise(fresh); }) law.initialise(fresh);
    if (detail::state_defect<Law>(fresh.state) != 0.0) return "the state overflows";
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
    if (!in_place) scatter_vector(batch_.impulse, dimension_, nodes_, block_.impulse);
    if (batch_.velocity.values) scatter_vector(batch_.velocity, dimension_, nodes_, block_.velocity);
    if (batch_.energy.values)
      for (int k = 0; k < ILAW_ENERGY_COUNT; ++k) scatter(batch_.energy, k, nodes_, block_.energy[k]);
    if (batch_.status)
      for (int i = 0; i < nodes_.count; ++i)
        batch_.status[nodes_.node(i) * batch_.status_stride] = static_cast<std::uint8_t>(block_.status[i]);
    for (int k = 0; k < states; ++k)
      if (const int entry = state_entry<Law>(k, dimension_); entry >= 0)
        scatter(batch_.state_out, entry, nodes_, block_.state_out[k]);
  }

  // The frame of an accepted step becomes the frame to carry on from.
  void keep_frames() {
    if (!made_.carries_frame) return;
    for (int i = 0; i < nodes_.count; ++i)
      if (block_.refused[i] == 0.0) keep_frame(i);
  }

  bool any_refused() const {
    std::uint64_t bits = 0;  // an integer reduction vectorises; refused is 0.0 or 1.0
    for (int i = 0; i < nodes_.count; ++i) bits |= std::bit_cast<std::uint64_t>(block_.refused[i]);
    return bits != 0;
  }

 private:
  static const double& at(const ilaw_input& a, std::int64_t node, std::int64_t c) {
    return a.values[node * a.node_stride + c * a.component_stride];
  }
  static double& at(const ilaw_output& a, std::int64_t node, std::int64_t c) {
    return a.values[node * a.node_stride + c * a.component_stride];
  }

  void keep_frame(int i) {
    const axis n = columns::get(block_.axes, i), t = columns::get(block_.axes + 3, i);
    const double entries[6] = {n.x, n.y, n.z, t.x, t.y, t.z};
    for (int k = 0; k < 6; ++k) at(batch_.state_out, nodes_.node(i), made_.frame_offset() + k) = entries[k];
  }

  const double* optional(const ilaw_input& input, bool read, column& room) {
    return read && input.values ? gather(input, 0, nodes_, room.values) : zeros.values;
  }

  // Vectors that may stay interleaved where the layout says so.
  void gather_in_layout(const ilaw_input& input, column* room, const double** components) {
    if constexpr (in_place) {
      components[0] = input.values + 3 * nodes_.first;
      prefetch_next(components[0], 3 * nodes_.count);
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
      gather_vector(batch_.v_previous, dimension_, nodes_, room_.v_previous, block_.v_previous);
    else
      for (const double*& component : block_.v_previous) component = zeros.values;
    block_.gap = optional(batch_.gap, reads & ILAW_INPUT_GAP, room_.gap);
    block_.gap_offset = optional(batch_.gap_offset, reads & ILAW_INPUT_GAP, room_.gap_offset);
    block_.area = optional(batch_.area, reads & ILAW_INPUT_AREA, room_.area);
    gather_delassus();
  }

  // Missing dimensions are padded so that H stays positive definite; see delassus orders in ilaw.h.
  void gather_delassus() {
    const double** h = block_.delassus;
    const auto component = [this](int c) {
      return gather(batch_.delassus, c, nodes_, room_.delassus[c].values);
    };
    if (made_.delassus_form == ILAW_DELASSUS_SCALAR) {
      h[0] = component(0);
      for (int e = 1; e < 6; ++e) h[e] = e < 3 ? h[0] : zeros.values;
      return;
    }
    for (int e = 0; e < 3; ++e) h[e] = e < dimension_ ? component(e) : h[0];
    for (int e = 3; e < 6; ++e) h[e] = zeros.values;
    if (dimension_ == 2) h[2] = h[1];  // or it would pass for anisotropic
    if (made_.delassus_form != ILAW_DELASSUS_FULL) return;
    if (dimension_ == 2) h[3] = component(2);
    for (int e = 3; dimension_ == 3 && e < 6; ++e) h[e] = component(e);
  }

  // In two dimensions the second tangent is given the entry of the first, lest H pass for anisotropic.
  void pad_turned_delassus() {
    if (made_.delassus_form == ILAW_DELASSUS_SCALAR) return;
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
    if (made_.tangent_given && dimension_ == 3)
      gather_vector(batch_.tangent, dimension_, nodes_, room_.tangent, block_.axes + 3);
    for (int i = 0; i < nodes_.count; ++i) set_tangents(i);
  }

  void set_tangents(int i) {
    const axis n = columns::get(block_.axes, i), t1 = first_tangent(i), t2 = cross(n, t1);
    const double first[] = {t1.x, t1.y, t1.z}, second[] = {t2.x, t2.y, t2.z};
    for (int c = 0; c < 3; ++c) {
      if (block_.axes[3 + c] == room_.first_tangent[c].values) room_.first_tangent[c].values[i] = first[c];
      room_.second_tangent[c].values[i] = second[c];
    }
  }

  axis first_tangent(int i) const {
    const axis n = columns::get(block_.axes, i);
    if (dimension_ < 3) return plane_tangent(dimension_, n);
    if (made_.tangent_given) return columns::get(block_.axes + 3, i);
    return made_.carries_frame && batch_.state_in.values ? carried_tangent(i) : any_tangent(n);
  }

  axis carried_tangent(int i) const {
    const ilaw_input& s = batch_.state_in;
    const double* in = s.values + nodes_.node(i) * s.node_stride + made_.frame_offset() * s.component_stride;
    const std::int64_t c = s.component_stride;
    return transported_tangent({in[0], in[c], in[2 * c]}, {in[3 * c], in[4 * c], in[5 * c]},
                               columns::get(block_.axes, i));
  }

  void open_state() {
    if (batch_.state_in.values) {
      for (int k = 0; k < states; ++k) {
        const int entry = state_entry<Law>(k, dimension_);
        block_.state_in[k] =
            entry >= 0 ? gather(batch_.state_in, entry, nodes_, room_.state_in[k].values) : zeros.values;
      }
      copy_unnamed_state();
    } else {
      for (int k = 0; k < states; ++k) block_.state_in[k] = zeros.values;
    }
    const ilaw_output& out = batch_.state_out;
    block_.history_values = nullptr;
    if (!has_memory<Law>) return;
    block_.history_values = out.values + made_.memory_offset() * out.component_stride +
                            (batch_.index ? 0 : nodes_.first * out.node_stride);
    block_.history_node_stride = out.node_stride;
    block_.history_component_stride = out.component_stride;
    block_.history_index = batch_.index ? batch_.index + nodes_.first : nullptr;
    block_.history_index_base = batch_.index_base;
  }

  // Memory and frame are worked on in state_out, which therefore starts as state_in.
  void copy_unnamed_state() {
    if (batch_.state_in.values == batch_.state_out.values) return;
    const auto size = static_cast<std::int64_t>(made_.state_size);
    for (std::int64_t c = made_.memory_offset(); c < size; ++c)
      for (int i = 0; i < nodes_.count; ++i)
        at(batch_.state_out, nodes_.node(i), c) = at(batch_.state_in, nodes_.node(i), c);
  }

  void aim_outputs() {
    for (int c = 0; c < 3; ++c) {
      block_.impulse[c] = in_place ? batch_.impulse.values + 3 * nodes_.first
                                   : aim(batch_.impulse, c, c < dimension_, room_.impulse[c]);
      block_.velocity[c] = aim(batch_.velocity, c, c < dimension_, room_.velocity[c]);
    }
    for (int k = 0; k < ILAW_ENERGY_COUNT; ++k)
      block_.energy[k] = aim(batch_.energy, k, true, room_.energy[k]);
    block_.status = room_.status.values;
    block_.refused = room_.refused.values;
    for (int k = 0; k < states; ++k) {
      const int entry = state_entry<Law>(k, dimension_);
      block_.state_out[k] = aim(batch_.state_out, entry, entry >= 0, room_.state_out[k]);
    }
  }

  double* aim(const ilaw_output& output, int component, bool exists, column& room) {
    return exists && output.values ? target(output, component, nodes_, room.values) : room.values;
  }

  const instance<Law>& made_;
  const ilaw_batch& batch_;
  block_room<Law>& room_;
  int dimension_;
  node_range nodes_{};
  node_block<Law> block_;
};

// What a walk found.
struct tally {
  std::int64_t bad_count = 0, first_bad_node = -1;
  const char* reason = nullptr;

  void add(std::int64_t node, const char* why) {
    if (bad_count++ > 0) return;
    first_bad_node = node;
    reason = why;
  }
};

// Why a node was refused, from the same checks as step_node, in their order.
template <class Law, class Delassus, class Frame, class Layout, scope Scope>
const char* refusal_reason(const Law& law, const node_block<Law>& b, int i) {
  const auto n = load_node<Law, Delassus, Frame, Layout, Scope>(b, i);
  if (defect(Frame::template at<Layout>(b.axes, i).unit_defect()) != 0.0)
    return "the normal is not a unit vector";
  if (defect(n.v_free) != 0.0) return "v_free is not finite";
  if (n.delassus.positive_defect() != 0.0) return "H is not finite and positive definite";
  if (defect(n.gap) != 0.0) return "the gap is not finite";
  if (defect(n.v_previous) != 0.0) return "v_previous is not finite";
  if (!finite(n.area) || n.area < 0.0) return "the area is not a finite number >= 0";
  if (detail::state_defect<Law>(n.state) != 0.0) return "the state is not finite";
  const double refused = step_node<Law, Delassus, Frame, Layout, Scope>(law, b, i).result.refused;
  if (refused == anisotropic_delassus)
    return "the law needs an H that is isotropic in the tangent plane and does not couple it to the normal";
  if (refused == no_solution) return "the law's equations have no solution for this H";
  return "the impulse or the state overflows";
}

// The parameters of one node, where some are given per node; says what is wrong with them, null where nothing
// is. Then law stays as it was: no step need stand what no parameter may be.
template <class Law>
const char* at_node(const instance<Law>& made, const ilaw_batch& batch, std::int64_t node, Law& law) {
  Law own = law;
  for (std::uint32_t k = 0; k < made.per_node_count; ++k) {
    const ilaw_input& given = batch.per_node_parameters[k];
    const double value = given.values[node * given.node_stride];
    if (!in_range(*made.per_node[k], value)) return "a per-node parameter is out of range";
    own.*made.per_node_members[k] = value;
  }
  if constexpr (requires { own.conflict(); })
    if (const char* conflict = made.per_node_count > 0 ? own.conflict() : nullptr) return conflict;
  law = own;
  return nullptr;
}

// The whole of a batch; Varying: with parameters per node, one node at a time.
template <class Law, class Delassus, class Frame, class Layout, scope Scope, bool Varying>
struct evaluate_walk {
  static tally run(const instance<Law>& made, const Law& law, const ilaw_batch& batch) {
    block_room<Law> room;
    batch_walk<Law, Layout> walk(made, batch, room);
    tally found;
    for (std::int64_t first = 0; first < batch.node_count; first += block_size) {
      walk.open(first);
      run_nodes(made, law, batch, walk);
      const bool refused = walk.any_refused();
      if (refused) explain(made, law, batch, walk, found);
      walk.close();
      walk.keep_frames();
    }
    return found;
  }

 private:
  static void run_nodes(const instance<Law>& made, const Law& law, const ilaw_batch& batch,
                        batch_walk<Law, Layout>& walk) {
    if constexpr (Varying)
      run_varying(made, law, batch, walk);
    else
      in_its_form(law, [&walk](const auto& form) {
        run_block<Law, Delassus, Frame, Layout, Scope>(form, walk.block());
      });
  }

  // Flattened: passing nodes by memory from function to function costs more than a plain step.
  [[gnu::noinline, gnu::flatten]] static void run_varying(const instance<Law>& made, const Law& law,
                                                          const ilaw_batch& batch,
                                                          batch_walk<Law, Layout>& walk) {
    for (int i = 0; i < walk.nodes().count; ++i) {
      Law own = law;
      const char* wrong = at_node(made, batch, walk.nodes().node(i), own);
      run_node<Law, Delassus, Frame, Layout, Scope>(own, walk.block(), i, !wrong);
    }
  }

  [[gnu::noinline, gnu::cold]] static void explain(const instance<Law>& made, const Law& law,
                                                   const ilaw_batch& batch, batch_walk<Law, Layout>& walk,
                                                   tally& found) {
    for (int i = 0; i < walk.nodes().count; ++i) {
      if (walk.block().refused[i] == 0.0) continue;
      Law own = law;
      const char* wrong = at_node(made, batch, walk.nodes().node(i), own);
      found.add(walk.nodes().node(i),
                wrong ? wrong : refusal_reason<Law, Delassus, Frame, Layout, Scope>(own, walk.block(), i));
    }
  }
};

template <class Law, class Delassus, class Frame, class Layout>
tally walk_laid_out(const instance<Law>& made, const Law& law, const ilaw_batch& batch) {
  if (batch.velocity.values || batch.energy.values || batch.status)
    return evaluate_walk<Law, Delassus, Frame, Layout, scope::outputs, false>::run(made, law, batch);
  if constexpr ((Law::card.inputs & reads_v_previous) != 0)
    if (made.inputs() & ILAW_INPUT_V_PREVIOUS)
      return evaluate_walk<Law, Delassus, Frame, Layout, scope::with_previous, false>::run(made, law, batch);
  return evaluate_walk<Law, Delassus, Frame, Layout, scope::impulse, false>::run(made, law, batch);
}

template <class Law, class Delassus, class Frame>
tally walk_as(const instance<Law>& made, const ilaw_batch& batch) {
  const Law law = made.at(batch.time);
  if (made.per_node_count > 0)
    return evaluate_walk<Law, Delassus, Frame, columns, scope::outputs, true>::run(made, law, batch);
  if constexpr (std::is_same_v<Delassus, scalar_delassus> && !std::is_same_v<Frame, stored_frame>)
    if (all_interleaved(made, batch))
      return walk_laid_out<Law, Delassus, Frame, interleaved>(made, law, batch);
  return walk_laid_out<Law, Delassus, Frame, columns>(made, law, batch);
}

// A diagonal H turned out of its axes is full.
template <class Law>
tally walk_turned(const instance<Law>& made, const ilaw_batch& batch) {
  if (made.delassus_form != ILAW_DELASSUS_SCALAR)
    return walk_as<Law, full_delassus, stored_frame>(made, batch);
  if constexpr (needs_no_tangents<Law>())
    if (!made.stores_frame()) return walk_as<Law, scalar_delassus, normal_frame>(made, batch);
  return walk_as<Law, scalar_delassus, stored_frame>(made, batch);
}

template <class Law>
tally walk_local(const instance<Law>& made, const ilaw_batch& batch) {
  if (made.delassus_form == ILAW_DELASSUS_SCALAR)
    return walk_as<Law, scalar_delassus, local_frame>(made, batch);
  return made.delassus_form == ILAW_DELASSUS_DIAGONAL
             ? walk_as<Law, diagonal_delassus, local_frame>(made, batch)
             : walk_as<Law, full_delassus, local_frame>(made, batch);
}

// An ilaw_kit_walk: a checked batch from end to end, compiled for this level.
template <class Law>
void walk_batch(const void* opaque, const ilaw_batch& batch, void* found) {
  const auto& made = *static_cast<const instance<Law>*>(opaque);
  *static_cast<tally*>(found) =
      made.frame == ILAW_FRAME_GLOBAL ? walk_turned(made, batch) : walk_local(made, batch);
}

inline std::int32_t give_report(ilaw_report* report, const tally& found) {
  if (report)
    fill_sized(report, {.struct_size = 0,
                        .reserved = 0,
                        .bad_count = found.bad_count,
                        .first_bad_node = found.first_bad_node,
                        .reason = found.reason});
  return found.bad_count > 0 ? ILAW_BAD_NODES : ILAW_OK;
}

template <class Law>
std::int32_t evaluate(const ilaw_instance* opaque, const ilaw_batch* given, ilaw_report* report) {
  if (!opaque || !given) return refuse(report, "instance or batch is null");
  const instance<Law>& made = of<Law>(opaque);
  const ilaw_batch batch = known_batch(*given);
  if (const char* wrong = wrong_batch(made, batch)) return refuse(report, wrong);
  tally found;
  (made.walk ? made.walk : walk_batch<Law>)(&made, batch, &found);
  return give_report(report, found);
}

// First state of the nodes of a batch.
template <class Law>
tally initialise_nodes(const instance<Law>& made, const ilaw_batch& batch) {
  const Law law = made.at(batch.time);
  block_room<Law> room;
  batch_walk<Law, columns> walk(made, batch, room);
  tally found;
  for (std::int64_t first = 0; first < batch.node_count; first += block_size) {
    walk.open_initial(first);
    for (int i = 0; i < walk.nodes().count; ++i) {
      Law own = law;
      const char* wrong = at_node(made, batch, walk.nodes().node(i), own);
      if (!wrong) wrong = walk.initialise(own, i);
      if (wrong) found.add(walk.nodes().node(i), wrong);
    }
  }
  return found;
}

template <class Law>
std::int32_t initialise(const ilaw_instance* opaque, const ilaw_batch* given, ilaw_report* report) {
  if (!opaque || !given) return refuse(report, "instance or batch is null");
  const instance<Law>& made = of<Law>(opaque);
  ilaw_batch batch = known_batch(*given);
  const char* wrong = wrong_scalars(batch);
  const std::uint32_t reads = made.inputs() & (ILAW_INPUT_AREA | ILAW_INPUT_NORMAL | ILAW_INPUT_TANGENT);
  if (!wrong && batch.node_count > 0) wrong = missing_input(made, batch, reads);
  if (wrong) return refuse(report, wrong);
  if (made.state_size == 0) return give_report(report, {});
  return give_report(report, initialise_nodes(made, batch));
}

}  // namespace ilaw::kit
