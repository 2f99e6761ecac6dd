// evaluate.hpp - a batch from end to end: checks its arrays, chooses the loop, reports bad nodes.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/batch_checks.hpp>
#include <ilaw/kit/detail/instance.hpp>
#include <ilaw/kit/detail/solver_kernel.hpp>

#include <string>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// ---- the loop of a batch

// What is asked of a kernel: its loop over a view, or its careful_function.
template <class Number>
struct loop_over {
  using view_type = view<Number>;
  using function = ilaw_kit_loop;
  template <class Kernel>
  static constexpr function of = Kernel::run;
};
template <class Number>
struct careful_over {
  using view_type = view<Number>;
  using function = careful_function;
  template <class Kernel>
  static constexpr function of = Kernel::careful_kernel::run_nodes;
};

template <class Law, class Part, template <class> class Frame, template <class> class Delassus>
typename Part::function loop_of(const instance<Law>& made) {
  using plain = kernel<Law, pack, typename Part::view_type, Frame, Delassus>;
  using solver = solver_kernel<Law, pack, typename Part::view_type, Frame, Delassus>;
  using Wide = law_on_t<Law, pack>;
  using node_type = typename plain::node_type;
  if constexpr (can_ask<Wide, node_type> && !can_choose<Wide, node_type>) {
    return Part::template of<solver>;
  } else {
    if constexpr (can_ask<Wide, node_type>)
      if (made.asks) return Part::template of<solver>;
    static_assert(
        requires(const Wide& law, node_type& n) { law.step(n); },
        "the law has neither step nor ask for nodes of this form of H and frame");
    return Part::template of<plain>;
  }
}

// Laws that leave every node to a solver take so long that asking for the frame at each pack costs little (0
// to 6 %): one loop serves all axes, as the careful one does.
template <class Law>
inline constexpr bool solves_every_node = [] {
  using node_type = typename kernel<Law, pack, view<double>, local_frame, transverse>::node_type;
  using Wide = law_on_t<Law, pack>;
  return serves_transverse<Law> && can_ask<Wide, node_type> && !can_choose<Wide, node_type>;
}();

template <class Law, class Part, template <class> class Delassus>
typename Part::function choose_frame(const instance<Law>& made) {
  if constexpr (!solves_every_node<Law>)
    if (made.frame == ILAW_FRAME_LOCAL) return loop_of<Law, Part, local_frame, Delassus>(made);
  if constexpr (needs_no_tangents<Law> && !std::is_same_v<Delassus<double>, full<double>>)
    if (made.frame == ILAW_FRAME_GLOBAL && made.dimension == 3 && !made.has_tangent)
      return loop_of<Law, Part, normal_frame, Delassus>(made);
  if constexpr (solves_every_node<Law>)
    return loop_of<Law, Part, either_frame, Delassus>(made);
  else
    return loop_of<Law, Part, axes_frame, Delassus>(made);
}
template <class Law, class Part>
typename Part::function choose_loop(const instance<Law>& made) {
  if constexpr (serves_spins<Law>)
    if (made.has_spins()) return choose_frame<Law, Part, transverse_spin>(made);
  if constexpr (serves_transverse<Law>)
    if (made.is_transverse()) return choose_frame<Law, Part, transverse>(made);
  if constexpr (serves_full<Law>) return choose_frame<Law, Part, full>(made);
  return nullptr;
}
// Floats have a loop of their own where a node takes so little that to convert them by blocks would count: in
// the local frame, without solver. Null elsewhere.
template <class Law, class Part>
typename Part::function choose_float_loop([[maybe_unused]] const instance<Law>& made) {
  using plain = kernel<Law, pack, view<float>, local_frame, transverse>;
  using Wide = law_on_t<Law, pack>;
  using node_type = typename plain::node_type;
  constexpr bool is_plain = requires(const Wide& law, node_type& n) { law.step(n); }
  &&(!requires { typename Law::problem; } || (!has_state<Law> && !has_window<Law>));
  if constexpr (serves_transverse<Law> && is_plain)
    if (made.is_transverse() && !made.has_spins() && made.frame == ILAW_FRAME_LOCAL && !made.asks)
      return Part::template of<plain>;
  return nullptr;
}
template <class Law>
careful_function choose_careful(const instance<Law>& made) {
  if (made.numbers == ILAW_NUMBERS_FLOAT)
    if (const auto of_floats = choose_float_loop<Law, careful_over<float>>(made)) return of_floats;
  return choose_loop<Law, careful_over<double>>(made);
}

template <class Law>
scalar_function scalar_fallback() {
  if constexpr (requires { typename Law::problem; }) return open_problems<Law>::solve_scalar;
  return nullptr;
}

template <class Law>
ilaw_kit_loop loop_of_instance(const void* opaque, bool of_floats) {
  const auto& made = *static_cast<const instance<Law>*>(opaque);
  return of_floats ? choose_float_loop<Law, loop_over<float>>(made)
                   : choose_loop<Law, loop_over<double>>(made);
}
template <class Law>
inline constexpr ilaw_kit_part part_of = [] {
  ilaw_kit_part part{loop_of_instance<Law>, nullptr, nullptr, convert<float, double>, convert<double, float>};
  if constexpr (has_window<Law>) part.read = read_windows, part.write = write_windows;
  return part;
}();

// A checked batch from end to end.
// Not inlined: nothing of it may be computed before the floating-point environment is set.
template <class Law>
[[gnu::noinline]] tally walk_batch(const instance<Law>& made, const ilaw_batch& batch) {
  const Law law = made.at(batch.time);
  constexpr int columns = 2 * (state_numbers<Law> + (has_window<Law> || has_state<Law> ? frame_size : 0));
  alignas(64) double state[columns * block_nodes + 1], parameters[parameter_count<Law> * block_nodes];
  if (made.numbers == ILAW_NUMBERS_DOUBLE)
    return batch_walk<double, double>(made, batch, state, parameters).run(made.loop, &law);
  if (made.float_loop)
    return batch_walk<float, float>(made, batch, state, parameters).run(made.float_loop, &law);
  return batch_walk<float, double>(made, batch, state, parameters).run(made.loop, &law);
}

// ---- why a node is bad

// "state variable '...' has a value that the law cannot have written", as static text.
template <class Law, std::size_t V>
struct range_reason {
  static constexpr auto make() {
    constexpr const char *head = "state variable '", *name = Law::state_variables[V].name,
                         *tail = "' has a value that the law cannot have written";
    constexpr auto size = [](const char* s) { return std::char_traits<char>::length(s); };
    std::array<char, size(head) + size(name) + size(tail) + 1> made{};
    std::size_t at = 0;
    for (const char* part : {head, name, tail})
      for (; *part; ++part) made[at++] = *part;
    return made;
  }
  static constexpr auto text = make();
};
template <class Law, std::size_t... K>
const char* text_of_variable(int variable, std::index_sequence<K...>) {
  static constexpr const char* all[] = {range_reason<Law, K>::text.data()..., nullptr};
  return all[variable];
}

// The parameters of one node; says what is wrong with them, null where nothing is.
template <class Law>
const char* wrong_parameters(const instance<Law>& made, const ilaw_batch& batch, std::int64_t node,
                             Law& law) {
  for (std::uint32_t k = 0; k < made.per_node_count; ++k) {
    const ilaw_input& given = batch.per_node_parameters[k];
    const std::int64_t at = node * given.node_stride;
    const double value = made.numbers == ILAW_NUMBERS_FLOAT ? double{given.floats[at]} : given.values[at];
    const int place = made.per_node_parameters[k];
    if (!Law::parameters[place].range().has(value)) return "a per-node parameter is out of range";
    Law::parameters[place].member.set(law, value);
  }
  made.read_node_tables(law, batch.time);
  if constexpr (requires { law.conflict(); })
    if (made.per_node_count > 0) return law.conflict();
  return nullptr;
}

// In the order of reason.
inline constexpr const char* reason_texts[] = {
    nullptr,
    "a per-node parameter is out of range, or several do not go together",
    "the normal is not a unit vector",
    "the tangent is not a unit vector orthogonal to the normal",
    "v_free is not finite",
    "v_smooth is not finite",
    "H is not finite and positive definite",
    "the gap is not finite",
    "v_previous is not finite",
    "spin_free or spin_previous is not finite",
    "the area is not a finite number >= 0",
    "the state was not initialised, or is of another law or version (it holds no frame)",
    "the state is not finite",
    "the law's equations have several solutions for this H and step: a smaller step is needed",
    "the law's equations have no solution for this H",
    "the state is not one that the law can have written",
    "the time lies before what the state remembers",
    "H couples directions, or differs along the tangents, which these parameters do not serve",
    "the law gave an impulse that is not a number",
    "the impulse or the state overflows",
    "the law pulled, which needs can_adhere in its card",
    "the law acted out of reach, which may_skip_fresh of its card excludes"};
static_assert(std::size(reason_texts) == reason_reach + 1);

template <class Law>
const char* reason_text(int code) {
  if constexpr (has_state<Law>)
    if (code >= reason_of_first_variable)
      return text_of_variable<Law>(code - reason_of_first_variable,
                                   std::make_index_sequence<std::size(Law::state_variables)>{});
  return code <= reason_reach ? reason_texts[code] : nullptr;
}

template <class Law>
const char* reason_text(const instance<Law>& made, const ilaw_batch& batch, const tally& found) {
  if (found.reason != reason_parameter) return reason_text<Law>(found.reason);
  Law law = made.at(batch.time);
  return wrong_parameters(made, batch, found.first_bad_node, law);
}

// ---- evaluate and initialise

inline ilaw_result give_report(ilaw_report* report, const tally& found, const char* reason) {
  if (report)
    sized::write(report, {.struct_size = 0,
                          .reserved = 0,
                          .bad_count = found.bad_count,
                          .first_bad_node = found.first_bad_node,
                          .reason = reason,
                          .stable_velocity_step = found.stable_velocity_step});
  return found.bad_count > 0 ? ILAW_BAD_NODES : ILAW_OK;
}
inline ilaw_result refuse(ilaw_report* report, const char* reason, ilaw_result code = ILAW_INVALID_ARGUMENT) {
  give_report(report, {}, reason);
  return code;
}

// The beginning of evaluate and initialise: the instance, the batch, and the environment of laws as long as
// the call lives. Where they are refused there is no batch, but a code.
template <class Law>
class batch_call {
 public:
  batch_call(const ilaw_instance* opaque, const ilaw_batch* given, ilaw_report* report)
      : made(reinterpret_cast<const instance<Law>*>(opaque)) {
    if (report && !sized::is_complete(report)) return;
    if (!opaque || !given)
      refuse(report, "instance or batch is null");
    else if (!sized::is_complete(given))
      refuse(report, "struct_size of the batch is none of any version");
    else
      open(*given, report);
  }

  const instance<Law>* made;
  const ilaw_batch* batch = nullptr;
  ilaw_result code = ILAW_INVALID_ARGUMENT;

 private:
  // Copied only where the host knows less: a copy takes as long as what a law does at one node.
  void open(const ilaw_batch& given, ilaw_report* report) {
    const ilaw_batch* all = &given;
    if (sized::size_of(&given) < sizeof copied_) {
      copied_ = sized::read(&given);
      all = &copied_;
    }
    if (all->flags != 0) [[unlikely]]
      if (const char* wrong = wrong_flags(made->capabilities, *all)) {
        code = refuse(report, wrong, ILAW_UNSUPPORTED);
        return;
      }
    batch = all;
  }

  ilaw_batch copied_;
  float_environment environment_;
};

// by_scalar_fallback: as ilaw/ext/draft/profile.h counts them; may be null.
template <class Law>
ilaw_result ILAW_CALL evaluate_counting(const ilaw_instance* opaque, const ilaw_batch* given,
                                        ilaw_report* report, std::int64_t* by_scalar_fallback) {
  const batch_call<Law> call(opaque, given, report);
  if (!call.batch) return call.code;
  const instance<Law>& made = *call.made;
  const ilaw_batch& batch = *call.batch;
  if (const char* wrong = wrong_batch(made, batch)) return refuse(report, wrong);
  tally found;
  if (batch.node_count > 0) found = walk_batch(made, batch);
  if (by_scalar_fallback) *by_scalar_fallback = found.by_scalar_fallback;
  return give_report(report, found, found.bad_count > 0 ? reason_text(made, batch, found) : nullptr);
}
template <class Law>
ilaw_result ILAW_CALL evaluate(const ilaw_instance* opaque, const ilaw_batch* given, ilaw_report* report) {
  return evaluate_counting<Law>(opaque, given, report, nullptr);
}

// First states, node by node.
template <class Law>
class first_states {
 public:
  first_states(const instance<Law>& made, const ilaw_batch& batch)
      : made_(made), b_(batch), law_(made.at(batch.time)) {}

  // Says why the state of a node cannot be given: then it is zero.
  const char* write(std::int64_t node) const {
    for (std::int64_t c = 0; c < static_cast<std::int64_t>(made_.state_size); ++c) at(node, c) = 0.0;
    Law law = law_;
    if (const char* wrong = wrong_parameters(made_, b_, node, law)) return wrong;
    const double area = made_.inputs & ILAW_INPUT_AREA ? number(b_.area, node, 0) : 0.0;
    if (!is_finite(area) || area < 0.0) return "the area is not a finite number >= 0";
    axes_frame<double> frame{};
    if (made_.carries_frame) {
      frame.n = {number(b_.normal, node, 0), number(b_.normal, node, 1), number(b_.normal, node, 2)};
      if (!is_unit(frame.n)) return "the normal is not a unit vector";
      frame.t1 = any_tangent(frame.n);
    }
    if constexpr (requires(initial_node<Law> & n) { law.initialise(n); }) {
      initial_node<Law> fresh{.time = b_.time, .area = {}, .state = {}};
      if constexpr (reads<Law>(reads_area)) {
        initial_node<Law> with_area{.time = b_.time, .area = area, .state = {}};
        law.initialise(with_area);
        fresh.state = with_area.state;
      } else {
        law.initialise(fresh);
      }
      for (int k = 0; k < made_.states; ++k)
        if (!is_finite(number_in<double>(fresh.state, k))) return "the state overflows";
      for (int k = 0; k < made_.states; ++k)
        if (const int entry = state_entry<Law>(k, static_cast<int>(made_.dimension)); entry >= 0)
          at(node, entry) = number_in<double>(fresh.state, k);
    }
    if (made_.carries_frame) {
      const double entries[frame_size] = {frame.n.x,  frame.n.y,  frame.n.z,
                                          frame.t1.x, frame.t1.y, frame.t1.z};
      for (int k = 0; k < frame_size; ++k) at(node, made_.frame_offset + k) = entries[k];
    }
    return nullptr;
  }

 private:
  double number(const ilaw_input& a, std::int64_t node, std::int64_t c) const {
    const std::int64_t place = node * a.node_stride + c * a.component_stride;
    return made_.numbers == ILAW_NUMBERS_FLOAT ? double{a.floats[place]} : a.values[place];
  }
  double& at(std::int64_t node, std::int64_t c) const {
    return b_.state_out.values[node * b_.state_out.node_stride + c * b_.state_out.component_stride];
  }

  const instance<Law>& made_;
  const ilaw_batch& b_;
  const Law law_;
};

template <class Law>
[[gnu::cold]] ilaw_result ILAW_CALL initialise(const ilaw_instance* opaque, const ilaw_batch* given,
                                               ilaw_report* report) {
  const batch_call<Law> call(opaque, given, report);
  if (!call.batch) return call.code;
  const instance<Law>& made = *call.made;
  const ilaw_batch& batch = *call.batch;
  if (const char* wrong = wrong_initial(made, batch)) return refuse(report, wrong);
  tally found;
  const char* reason = nullptr;
  if (made.state_size > 0) {
    const first_states<Law> states(made, batch);
    for (std::int64_t first = 0; first < batch.node_count; first += block_nodes) {
      const std::int64_t left = batch.node_count - first;
      const node_range nodes(batch, first, left < block_nodes ? left : block_nodes);
      for (std::int64_t i = 0; i < nodes.count; ++i)
        if (const char* wrong = states.write(nodes(i))) {
          if (found.bad_count++ > 0) continue;
          found.first_bad_node = nodes(i);
          reason = wrong;
        }
    }
  }
  return give_report(report, found, reason);
}

}  // namespace ilaw::kit::detail
