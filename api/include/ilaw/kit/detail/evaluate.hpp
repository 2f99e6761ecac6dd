// evaluate.hpp - a batch from end to end: checks its arrays, walks it block by block, reports refused nodes.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/batch_walk.hpp>
#include <ilaw/kit/detail/interleaving.hpp>
#include <ilaw/kit/detail/node_parameters.hpp>
#include <ilaw/kit/detail/refusal.hpp>
#include <ilaw/kit/detail/stable_step.hpp>
#include <ilaw/kit/detail/wrong_batch.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

inline std::int32_t refuse(ilaw_report* report, const char* reason,
                           std::int32_t code = ILAW_INVALID_ARGUMENT) {
  if (report)
    sized::write(report, {.struct_size = 0,
                          .reserved = 0,
                          .bad_count = 0,
                          .first_bad_node = -1,
                          .reason = reason,
                          .stable_velocity_step = infinity});
  return code;
}

// What a walk found.
struct tally {
  std::int64_t bad_count = 0, first_bad_node = -1, one_by_one = 0;
  const char* reason = nullptr;
  double stable_velocity_step = infinity;

  void add(std::int64_t node, const char* why) {
    if (bad_count++ > 0) return;
    first_bad_node = node;
    reason = why;
  }
};

// The whole of a batch; Varying: with parameters per node.
template <class Law, class Delassus, class Frame, class Layout, scope Scope, bool Varying>
struct evaluate_walk {
  // In long blocks where nothing of what lies in memory is copied, and no more is asked than hosts most often
  // do: each length is a walk more to compile.
  static tally run(const instance<Law>& made, const Law& law, const ilaw_kit_batch& batch) {
    const arrays_ahead<Law, Layout> ahead(made, batch, is_asked_first<Delassus, Frame>(law));
    if constexpr (!Varying && Scope < scope::outputs && !std::is_same_v<Frame, stored_frame>)
      if (!ahead.get() && !are_rows_in_memory(batch)) return run_in<block_size>(made, law, batch, nullptr);
    return run_in<short_block>(made, law, batch, ahead.get());
  }

 private:
  // Rows of doubles that no cache holds: measured, they take 0.75 to 1.0 of their time in short blocks, and
  // columns 1.05.
  static bool are_rows_in_memory(const ilaw_kit_batch& batch) {
    constexpr std::int64_t fewest_nodes = 131072;
    return is_in_place<Layout> && !is_of_floats<Layout> && batch.node_count >= fewest_nodes;
  }
  template <int Length>
  static tally run_in(const instance<Law>& made, const Law& law, const ilaw_kit_batch& batch,
                      const streams* ahead) {
    block_room<Law, Length> room;
    batch_walk<Law, Layout, Length> walk(made, batch, room, ahead);
    using parameters_of_nodes = std::conditional_t<Varying, node_parameters<Law>, same_parameters>;
    [[maybe_unused]] parameters_of_nodes parameters(made, law, batch);
    tally found;
    for (std::int64_t first = 0; first < batch.node_count; first += Length) {
      walk.open(first);
      if constexpr (Varying)
        found.one_by_one += run_varying(parameters.of(walk.nodes()), walk.block());
      else
        found.one_by_one += run_form(law, walk.block());
      limit_step(made, law, batch, walk, found);
      const bool refused = walk.any_refused();
      if (refused) explain(made, law, batch, walk, found);
      walk.close();
      walk.keep_frames();
    }
    return found;
  }

  // The smallest stable step of the block's good nodes, for laws that limit it.
  template <class Walk>
  static void limit_step(const instance<Law>& made, const Law& law, const ilaw_kit_batch& batch, Walk& walk,
                         tally& found) {
    if constexpr (limits_step<Law> && !Varying) {
      in_its_form(law, [&walk, &found]<class Form>(const Form& form) {
        if constexpr (is_run<Law, Form, Layout, Scope>() && !always_stable<Form>)
          found.stable_velocity_step =
              smaller(found.stable_velocity_step,
                      least_stable_step<Law, Delassus, Frame, Layout, Scope>(form, walk.block()));
      });
    } else if constexpr (limits_step<Law>) {
      for (int i = 0; i < walk.nodes().count; ++i) {
        if (walk.block().refused[i] != 0.0) continue;
        Law own = law;
        at_node(made, batch, walk.nodes().node(i), own);
        const auto node = load_node<Law, Delassus, Frame, Layout, Scope>(walk.block(), i);
        found.stable_velocity_step = smaller(found.stable_velocity_step, own.stable_velocity_step(node));
      }
    }
  }

  static int run_varying(const law_per_node<Law>& laws, const node_block<Law>& block) {
    if constexpr (requires { typename Law::form_of_nodes; })
      if (laws.have_form_of_nodes(block.count))
        return run_block<Law, Delassus, Frame, Layout, Scope>(laws.in_form_of_nodes(), block);
    return run_block<Law, Delassus, Frame, Layout, Scope>(laws, block);
  }

  static int run_form(const Law& law, const node_block<Law>& block) {
    int one_by_one = 0;
    in_its_form(law, [&block, &one_by_one]<class Form>(const Form& form) {
      if constexpr (is_run<Law, Form, Layout, Scope>())
        one_by_one = run_block<Law, Delassus, Frame, Layout, Scope>(one_law<Form>{form}, block);
    });
    return one_by_one;
  }

  template <class Walk>
  [[gnu::noinline, gnu::cold]] static void explain(const instance<Law>& made, const Law& law,
                                                   const ilaw_kit_batch& batch, Walk& walk, tally& found) {
    for (int i = 0; i < walk.nodes().count; ++i) {
      if (walk.block().refused[i] == 0.0) continue;
      Law own = law;
      const char* wrong = at_node(made, batch, walk.nodes().node(i), own);
      found.add(walk.nodes().node(i), wrong ? wrong
                                            : refusal_reason<Law, Delassus, Frame, Layout, reading<Scope>>(
                                                  own, {own, walk.block(), i}, i, made.has_tangent));
    }
  }
};

// With or without the velocity before the step, as the parameters ask for it.
template <class Law, class Delassus, class Frame, class Layout>
tally walk_for_impulse(const instance<Law>& made, const Law& law, const ilaw_kit_batch& batch) {
  if constexpr (reads_previous<Law>)
    if (always_reads_previous<Law> || (made.inputs() & ILAW_INPUT_V_PREVIOUS))
      return evaluate_walk<Law, Delassus, Frame, Layout, scope::with_previous, false>::run(made, law, batch);
  if constexpr (!always_reads_previous<Law>)
    return evaluate_walk<Law, Delassus, Frame, Layout, scope::impulse, false>::run(made, law, batch);
  return {};
}

template <class Law, class Delassus, class Frame>
tally walk_in_columns(const instance<Law>& made, const Law& law, const ilaw_kit_batch& batch) {
  const bool asks_motion = batch.velocity.values || batch.status;
  if (batch.energy.values || (asks_motion && !always_reads_previous<Law>))
    return evaluate_walk<Law, Delassus, Frame, columns, scope::outputs, false>::run(made, law, batch);
  if constexpr (always_reads_previous<Law>)
    if (asks_motion)
      return evaluate_walk<Law, Delassus, Frame, columns, scope::motion, false>::run(made, law, batch);
  return walk_for_impulse<Law, Delassus, Frame, columns>(made, law, batch);
}

// What the card serves; create refuses the rest, and no loop is compiled for it.
template <class Law>
constexpr bool serves(std::uint32_t forms) {
  return (Law::card.delassus_forms & forms) != 0;
}
template <class Law>
inline constexpr bool has_varying_parameters = [] {
  for (const ilaw_parameter& p : description<Law>::parameters)
    if (p.flags & ILAW_PARAMETER_ALLOWS_PER_NODE) return true;
  return false;
}();

// With parameters per node. Without what is not asked for where it would be much of the work.
template <class Law, class Delassus, class Frame>
tally walk_varying(const instance<Law>& made, const Law& law, const ilaw_kit_batch& batch) {
  if constexpr (std::is_same_v<Delassus, transverse_delassus> && !std::is_same_v<Frame, stored_frame> &&
                always_reads_previous<Law>) {
    if (!batch.energy.values && !batch.velocity.values && !batch.status)
      return evaluate_walk<Law, Delassus, Frame, columns, scope::with_previous, true>::run(made, law, batch);
    if (!batch.energy.values)
      return evaluate_walk<Law, Delassus, Frame, columns, scope::motion, true>::run(made, law, batch);
  }
  return evaluate_walk<Law, Delassus, Frame, columns, scope::outputs, true>::run(made, law, batch);
}

template <class Law, class Delassus, class Frame, class Layout>
tally walk_in_place(const instance<Law>& made, const Law& law, const ilaw_kit_batch& batch) {
  if constexpr (always_reads_previous<Law>)
    if (batch.velocity.values)
      return evaluate_walk<Law, Delassus, Frame, Layout, scope::motion, false>::run(made, law, batch);
  return walk_for_impulse<Law, Delassus, Frame, Layout>(made, law, batch);
}

template <class Law, class Delassus, class Frame>
tally walk_as(const instance<Law>& made, const ilaw_kit_batch& batch) {
  const Law law = made.at(batch.time);
  if constexpr (has_varying_parameters<Law>)
    if (made.per_node_count > 0) return walk_varying<Law, Delassus, Frame>(made, law, batch);
  if constexpr (may_interleave<Law, Delassus, Frame>)
    if (asks_little<Law>(batch) && stand_in<interleaved>(made, batch)) {
      if constexpr (may_have_state_rows<Law, Delassus>)
        if (state_stands_in_rows(made, batch))
          return walk_in_place<Law, Delassus, Frame, interleaved_with_state>(made, law, batch);
      return walk_in_place<Law, Delassus, Frame, interleaved>(made, law, batch);
    }
  if constexpr (may_stay_floats<Law, Delassus, Frame>)
    if (asks_little<Law>(batch) && are_scalars_in_columns(batch) && has_form_of_floats(law)) {
      if (stand_in<rows_of_float>(made, batch))
        return walk_in_place<Law, Delassus, Frame, rows_of_float>(made, law, batch);
      if (stand_in<columns_of_float>(made, batch))
        return walk_in_place<Law, Delassus, Frame, columns_of_float>(made, law, batch);
    }
  return walk_in_columns<Law, Delassus, Frame>(made, law, batch);
}

// A diagonal H turned out of its axes is full.
template <class Law>
tally walk_turned(const instance<Law>& made, const ilaw_kit_batch& batch) {
  if constexpr (serves<Law>(ILAW_DELASSUS_FULL))
    if (!made.is_transverse()) return walk_as<Law, full_delassus, stored_frame>(made, batch);
  if constexpr (serves<Law>(ILAW_DELASSUS_SCALAR | ILAW_DELASSUS_TRANSVERSE)) {
    if constexpr (needs_no_tangents<Law>() && in_space<Law>)
      if (!made.stores_frame()) return walk_as<Law, transverse_delassus, normal_frame>(made, batch);
    return walk_as<Law, transverse_delassus, stored_frame>(made, batch);
  }
  return {};
}

template <class Law>
tally walk_local(const instance<Law>& made, const ilaw_kit_batch& batch) {
  if constexpr (serves<Law>(ILAW_DELASSUS_SCALAR | ILAW_DELASSUS_TRANSVERSE))
    if (made.is_transverse()) return walk_as<Law, transverse_delassus, local_frame>(made, batch);
  if constexpr (serves<Law>(ILAW_DELASSUS_DIAGONAL))
    if (made.delassus_form == ILAW_DELASSUS_DIAGONAL)
      return walk_as<Law, diagonal_delassus, local_frame>(made, batch);
  if constexpr (serves<Law>(ILAW_DELASSUS_FULL)) return walk_as<Law, full_delassus, local_frame>(made, batch);
  return {};
}

// An ilaw_kit_walk: a checked batch from end to end, compiled for this level.
// Not inlined: nothing of it may be computed before the floating-point environment is set.
template <class Law>
[[gnu::noinline]] void walk_batch(const void* opaque, const ilaw_kit_batch& batch, void* found) {
  const auto& made = *static_cast<const instance<Law>*>(opaque);
  *static_cast<tally*>(found) =
      made.frame == ILAW_FRAME_GLOBAL ? walk_turned(made, batch) : walk_local(made, batch);
}

inline std::int32_t give_report(ilaw_report* report, const tally& found) {
  if (report)
    sized::write(report, {.struct_size = 0,
                          .reserved = 0,
                          .bad_count = found.bad_count,
                          .first_bad_node = found.first_bad_node,
                          .reason = found.reason,
                          .stable_velocity_step = found.stable_velocity_step});
  return found.bad_count > 0 ? ILAW_BAD_NODES : ILAW_OK;
}

// Whether an array has the number type of the instance, or is absent.
inline bool is_of(bool floats, const void* values, const void* in_floats) {
  return !(floats ? values : in_floats);
}

// Why the arrays of a batch are not of the number type of the instance; null where they are.
template <class Law>
const char* wrong_numbers(const instance<Law>& made, const ilaw_batch& b) {
  const bool floats = made.numbers == ILAW_NUMBERS_FLOAT;
  bool good = true;
  for (const ilaw_input* a :
       {&b.v_free, &b.delassus, &b.gap, &b.gap_offset, &b.v_previous, &b.area, &b.normal, &b.tangent})
    good &= is_of(floats, a->values, a->floats);
  for (const ilaw_output* a : {&b.impulse, &b.velocity, &b.energy})
    good &= is_of(floats, a->values, a->floats);
  for (std::uint32_t k = 0; b.per_node_parameters && k < made.per_node_count; ++k)
    good &= is_of(floats, b.per_node_parameters[k].values, b.per_node_parameters[k].floats);
  if (!good)
    return floats ? "an array has doubles; expected floats alone, as in the setup"
                  : "an array has floats; expected doubles alone, as in the setup";
  return b.state_in.floats || b.state_out.floats ? "the state has floats; expected doubles" : nullptr;
}

template <class Law>
ilaw_kit_batch known(const instance<Law>& made, const ilaw_batch& b) {
  return {.index_base = b.index_base,
          .flags = made.numbers == ILAW_NUMBERS_FLOAT ? arrays_of_float : 0,
          .node_count = b.node_count,
          .index = b.index,
          .index64 = b.index64,
          .time = b.time,
          .velocity_step = b.velocity_step,
          .position_step = b.position_step,
          .v_free = in_kit(b.v_free),
          .delassus = in_kit(b.delassus),
          .gap = in_kit(b.gap),
          .gap_offset = in_kit(b.gap_offset),
          .v_previous = in_kit(b.v_previous),
          .area = in_kit(b.area),
          .normal = in_kit(b.normal),
          .tangent = in_kit(b.tangent),
          .per_node_parameters = b.per_node_parameters,
          .state_in = in_kit(b.state_in),
          .state_out = in_kit(b.state_out),
          .impulse = in_kit(b.impulse),
          .velocity = in_kit(b.velocity),
          .energy = in_kit(b.energy),
          .status = b.status,
          .status_stride = b.status_stride};
}

// The beginning of evaluate and initialise: hands on the instance and the batch in the kit's form.
template <class Law, class Run>
std::int32_t with_batch(const ilaw_instance* opaque, const ilaw_batch* given, ilaw_report* report, Run run) {
  if (report && !sized::is_complete(report)) return ILAW_INVALID_ARGUMENT;
  if (!opaque || !given) return refuse(report, "instance or batch is null");
  if (!sized::is_complete(given)) return refuse(report, "struct_size of the batch is none of any version");
  const ilaw_batch batch = sized::read(given);
  if (batch.flags != 0) return refuse(report, "flags of the batch are not known", ILAW_UNSUPPORTED);
  if (const char* wrong = wrong_numbers(of<Law>(opaque), batch)) return refuse(report, wrong);
  const float_environment own;
  return run(of<Law>(opaque), known(of<Law>(opaque), batch));
}

// one_by_one: as the profile extension counts them; may be null.
template <class Law>
ilaw_result evaluate_counting(const ilaw_instance* opaque, const ilaw_batch* given, ilaw_report* report,
                              std::int64_t* one_by_one) {
  return with_batch<Law>(opaque, given, report, [&](const instance<Law>& made, const ilaw_kit_batch& batch) {
    if (const char* wrong = wrong_batch(made, batch)) return refuse(report, wrong);
    tally found;
    (made.walk ? made.walk : walk_batch<Law>)(&made, batch, &found);
    if (one_by_one) *one_by_one = found.one_by_one;
    return give_report(report, found);
  });
}

template <class Law>
ilaw_result ILAW_CALL evaluate(const ilaw_instance* opaque, const ilaw_batch* given, ilaw_report* report) {
  return evaluate_counting<Law>(opaque, given, report, nullptr);
}

// First state of the nodes of a batch.
template <class Law>
[[gnu::noinline]] tally initialise_nodes(const instance<Law>& made, const ilaw_kit_batch& batch) {
  const Law law = made.at(batch.time);
  block_room<Law, short_block> room;
  batch_walk<Law, columns, short_block> walk(made, batch, room, nullptr);
  tally found;
  for (std::int64_t first = 0; first < batch.node_count; first += short_block) {
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
const char* wrong_initial(const instance<Law>& made, const ilaw_kit_batch& b) {
  if (const char* wrong = wrong_scalars(b)) return wrong;
  if (b.node_count == 0) return nullptr;
  if (const char* wrong =
          missing_input(made, b, made.inputs() & (ILAW_INPUT_AREA | ILAW_INPUT_NORMAL | ILAW_INPUT_TANGENT)))
    return wrong;
  return colliding_state(made, b);
}

template <class Law>
ilaw_result ILAW_CALL initialise(const ilaw_instance* opaque, const ilaw_batch* given, ilaw_report* report) {
  return with_batch<Law>(opaque, given, report, [&](const instance<Law>& made, const ilaw_kit_batch& batch) {
    if (const char* wrong = wrong_initial(made, batch)) return refuse(report, wrong);
    return give_report(report, made.state_size > 0 ? initialise_nodes(made, batch) : tally{});
  });
}

}  // namespace ilaw::kit::detail
