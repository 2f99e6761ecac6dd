// instance.hpp - what create makes: the law with its checked parameters, and how its batches look.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/dispatch.hpp>
#include <ilaw/kit/detail/float_environment.hpp>
#include <ilaw/kit/detail/parameters.hpp>
#include <ilaw/sized.hpp>

#include <new>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// The local frame is carried along in the state where a law remembers vectors and the host gives only
// normals.
inline constexpr history_card frame_variables[] = {
    {.name = "frame_normal", .doc = "Normal of the last step.", .internal = true},
    {.name = "frame_tangent", .doc = "First tangent of the last step.", .internal = true}};

// Whether kernels may work from the normal alone: no tangent named, and no vector remembered, which would
// need tangents to be written in.
template <class Law>
constexpr bool needs_no_tangents() {
  return !Law::card.names_tangents && !has_history<Law> && !has_vector_state<Law>();
}

template <class Law>
struct instance {
  static constexpr std::size_t parameter_count = detail::parameter_count<Law>;
  static constexpr std::size_t variable_room = detail::state_variable_count<Law> + 2;

  Law law;
  std::uint32_t dimension, delassus_form, frame, numbers, has_tangent;
  ilaw_kit_walk walk = nullptr;  // null: this level's own
  std::int64_t history_size = 0;
  bool carries_frame = false;
  time_table tables[parameter_count + 1];
  std::uint32_t table_count = 0;
  const ilaw_parameter* per_node[parameter_count + 1];
  double Law::*per_node_members[parameter_count + 1];
  const char* per_node_names[parameter_count + 1];
  double Law::*table_members[parameter_count + 1];
  std::uint32_t per_node_count = 0;
  ilaw_state_variable variables[variable_room];
  const ilaw_state_variable* variable_pointers[variable_room];
  std::uint32_t variable_count = 0;
  std::uint64_t state_size = 0;

  // Where the named state, the history and the frame start in the state of a node.
  std::int64_t history_offset() const {
    return static_cast<std::int64_t>(state_size) - history_size - frame_size();
  }
  std::int64_t frame_size() const { return carries_frame ? 6 : 0; }
  std::int64_t frame_offset() const { return static_cast<std::int64_t>(state_size) - frame_size(); }

  // Whether H is transverse, which it is in any axes, or scalar, which is transverse with one value.
  bool is_transverse() const {
    return delassus_form == ILAW_DELASSUS_SCALAR || delassus_form == ILAW_DELASSUS_TRANSVERSE;
  }

  // Whether kernels read all axes from columns, rather than the normal alone.
  bool stores_frame() const {
    return !needs_no_tangents<Law>() || dimension < 3 || has_tangent || carries_frame || !is_transverse();
  }

  std::uint32_t inputs() const {
    std::uint32_t mask = Law::card.inputs;
    if constexpr (requires { law.inputs(); })
      if (table_count == 0 && per_node_count == 0) mask = law.inputs();
    mask &= ~std::uint32_t{ILAW_INPUT_NORMAL | ILAW_INPUT_TANGENT};
    if (frame == ILAW_FRAME_GLOBAL) mask |= ILAW_INPUT_NORMAL;
    if (frame == ILAW_FRAME_GLOBAL && has_tangent && dimension == 3) mask |= ILAW_INPUT_TANGENT;
    return mask;
  }
  std::uint32_t energy_inputs() const { return ILAW_INPUT_V_PREVIOUS & ~inputs(); }

  std::uint32_t capabilities() const {
    const bool vary = table_count > 0 || per_node_count > 0;
    std::uint32_t mask = Law::card.capabilities;
    if constexpr (requires { law.capabilities(); })
      if (!vary) mask = law.capabilities();
    if constexpr (requires { Law::rests_by_parameters; })
      if (vary) mask &= ~can_rest;  // a promise, unlike the others
    // A frame follows the normal wherever the node is, unless the law says when its memory rests.
    const bool frame_moves = carries_frame && has_history<Law> && !(mask & can_rest);
    return frame_moves ? mask | acts_at_distance : mask;
  }

  // The law as it is at a time: tables read.
  Law at(double time) const {
    Law now = law;
    for (std::uint32_t k = 0; k < table_count; ++k) now.*table_members[k] = tables[k].at(time);
    return now;
  }

  ~instance() {
    for (std::uint32_t k = 0; k < table_count; ++k) std::free(tables[k].pairs);
  }
};

template <class Law>
class instance_builder {
 public:
  instance_builder(instance<Law>& target, const ilaw_setup& setup, message& text)
      : made_(target), setup_(setup), text_(text) {}

  std::int32_t build() {
    for (auto step : {&instance_builder::check_setup, &instance_builder::read_arguments,
                      &instance_builder::require_arguments, &instance_builder::check_together,
                      &instance_builder::lay_out_state})
      if (const std::int32_t code = (this->*step)(); code != ILAW_OK) return code;
    return ILAW_OK;
  }

 private:
  static constexpr const char* id = Law::card.id;
  static constexpr std::size_t parameter_count = instance<Law>::parameter_count;

  std::int32_t check_setup() {
    const law_card& card = Law::card;
    if (setup_.dimension < 1 || setup_.dimension > 3 || !(card.dimensions & (1U << setup_.dimension))) {
      text_.add("law '%s': dimension %u is not served: expected", id, setup_.dimension);
      for (unsigned d = 1; d <= 3; ++d)
        if (card.dimensions & (1U << d)) text_.add(" %u", d);
      return ILAW_UNSUPPORTED;
    }
    const std::uint32_t form = setup_.delassus_form;
    if ((form != ILAW_DELASSUS_SCALAR && form != ILAW_DELASSUS_DIAGONAL && form != ILAW_DELASSUS_FULL &&
         form != ILAW_DELASSUS_TRANSVERSE) ||
        !(card.delassus_forms & form)) {
      text_.add("law '%s': form %u of H is not served: expected one of%s%s%s%s", id, form,
                card.delassus_forms & ILAW_DELASSUS_SCALAR ? " 1 (scalar)" : "",
                card.delassus_forms & ILAW_DELASSUS_DIAGONAL ? " 2 (diagonal)" : "",
                card.delassus_forms & ILAW_DELASSUS_FULL ? " 4 (full)" : "",
                card.delassus_forms & ILAW_DELASSUS_TRANSVERSE ? " 8 (transverse)" : "");
      return ILAW_UNSUPPORTED;
    }
    if (setup_.frame != ILAW_FRAME_LOCAL && setup_.frame != ILAW_FRAME_GLOBAL) {
      text_.add("law '%s': frame %u is not served: expected 1 (local) or 2 (global)", id, setup_.frame);
      return ILAW_UNSUPPORTED;
    }
    if (setup_.numbers != ILAW_NUMBERS_DOUBLE && setup_.numbers != ILAW_NUMBERS_FLOAT) {
      text_.add("law '%s': number type %u is not served: expected 1 (double) or 2 (float)", id,
                setup_.numbers);
      return ILAW_UNSUPPORTED;
    }
    if (setup_.flags != 0) {
      text_.add("law '%s': flags 0x%llx are not known: expected 0", id,
                static_cast<unsigned long long>(setup_.flags));
      return ILAW_UNSUPPORTED;
    }
    if (setup_.has_tangent > 1) {
      text_.add("law '%s': has_tangent %u is unknown: expected 0 or 1", id, setup_.has_tangent);
      return ILAW_INVALID_ARGUMENT;
    }
    made_.dimension = setup_.dimension;
    made_.delassus_form = setup_.delassus_form;
    made_.frame = setup_.frame;
    made_.numbers = setup_.numbers;
    made_.has_tangent = setup_.has_tangent;
    return ILAW_OK;
  }

  std::int32_t read_arguments() {
    for (std::size_t i = 0; i < parameter_count; ++i)
      made_.law.*Law::parameters[i].member = Law::parameters[i].default_value;
    if (setup_.argument_count > 0 && !setup_.arguments) {
      text_.add("law '%s': arguments is null, expected %u pointers", id, setup_.argument_count);
      return ILAW_INVALID_ARGUMENT;
    }
    for (std::uint32_t k = 0; k < setup_.argument_count; ++k) {
      const ilaw_argument* given = setup_.arguments[k];
      const ilaw_argument a = sized::is_complete(given) ? sized::read(given) : ilaw_argument{};
      if (!a.name) {
        text_.add("law '%s': argument %u is null, has no name or a struct_size not from %u to %u", id, k,
                  sized::least<ilaw_argument>, sized::most);
        return ILAW_INVALID_ARGUMENT;
      }
      if (const std::int32_t code = read_argument(a); code != ILAW_OK) return code;
    }
    return ILAW_OK;
  }

  std::int32_t read_argument(const ilaw_argument& a) {
    std::size_t i = 0;
    while (i < parameter_count && std::strcmp(Law::parameters[i].name, a.name) != 0) ++i;
    if (i == parameter_count) {
      text_.add("law '%s': unknown parameter '%s': expected one of ", id, a.name);
      for (std::size_t k = 0; k < parameter_count; ++k)
        text_.add("%s%s", k ? ", " : "", Law::parameters[k].name);
      return ILAW_INVALID_PARAMETER;
    }
    if (given_[i]) {
      text_.add("law '%s': parameter '%s' is given twice", id, a.name);
      return ILAW_INVALID_PARAMETER;
    }
    given_[i] = true;
    const ilaw_parameter& p = description<Law>::parameters[i];
    double Law::*member = Law::parameters[i].member;
    if (p.kind == ILAW_PARAMETER_CHOICE) return read_choice(id, p, a, made_.law.*member, text_);
    if (a.kind == ILAW_VALUE_TABLE && p.axis_count > 0) return keep_table(p, member, a);
    if (a.kind == ILAW_VALUE_PER_NODE && (p.flags & ILAW_PARAMETER_ALLOWS_PER_NODE))
      return keep_per_node(p, member);
    return read_number(id, p, a, made_.law.*member, text_);
  }

  std::int32_t keep_table(const ilaw_parameter& p, double Law::*member, const ilaw_argument& a) {
    if (const std::int32_t code = check_table(id, p, a, text_); code != ILAW_OK) return code;
    const ilaw_axis axis = sized::read(a.axes[0]);
    auto* pairs = static_cast<double*>(std::malloc(2 * axis.count * sizeof(double)));
    if (!pairs) {
      text_.add("law '%s': no memory for the table of parameter '%s'", id, p.name);
      return ILAW_OUT_OF_MEMORY;
    }
    for (std::uint64_t k = 0; k < axis.count; ++k) {
      pairs[2 * k] = axis.points[k];
      pairs[2 * k + 1] = a.values[k];
    }
    made_.table_members[made_.table_count] = member;
    made_.tables[made_.table_count++] = {&p, pairs, axis.count};
    made_.law.*member = pairs[1];
    return ILAW_OK;
  }

  std::int32_t keep_per_node(const ilaw_parameter& p, double Law::*member) {
    made_.per_node[made_.per_node_count] = &p;
    made_.per_node_members[made_.per_node_count] = member;
    made_.per_node_names[made_.per_node_count++] = p.name;
    return ILAW_OK;
  }

  std::int32_t require_arguments() {
    for (std::size_t i = 0; i < parameter_count; ++i)
      if (Law::parameters[i].required && !given_[i]) {
        const ilaw_parameter& p = description<Law>::parameters[i];
        text_.add("law '%s': parameter '%s' is missing: expected ", id, p.name);
        if (p.kind == ILAW_PARAMETER_CHOICE) {
          text_.add("one of ");
          add_choices(text_, p);
        } else {
          text_.add("a number in ");
          add_range(text_, p);
        }
        return ILAW_INVALID_PARAMETER;
      }
    return ILAW_OK;
  }

  std::int32_t check_together() {
    if constexpr (requires { made_.law.inputs(); })
      if (const std::uint32_t extra = made_.law.inputs() & ~Law::card.inputs) {
        text_.add("law '%s': reads inputs 0x%x that its card does not name", id, extra);
        return ILAW_UNSUPPORTED;
      }
    if (const std::int32_t code = check_conflicts(); code != ILAW_OK) return code;
    if constexpr (requires { made_.law.tells_tangents_apart(); })
      if (with_unknowns().tells_tangents_apart() && setup_.frame == ILAW_FRAME_GLOBAL &&
          setup_.dimension == 3 && !setup_.has_tangent) {
        text_.add(
            "law '%s': these parameters tell the two tangential axes apart: expected a tangent per node", id);
        return ILAW_UNSUPPORTED;
      }
    return ILAW_OK;
  }

  // Values that come per node are checked together there. Tables are checked at all their times, which is
  // enough for what is linear or convex in the parameters, and halfway to the next time of any of them, where
  // a segment towards infinity is infinite already.
  std::int32_t check_conflicts() {
    if (made_.per_node_count > 0) return ILAW_OK;
    if (made_.table_count == 0) return check_conflict(made_.law, nullptr);
    for (std::uint32_t k = 0; k < made_.table_count; ++k)
      for (std::uint64_t j = 0; j < made_.tables[k].count; ++j) {
        const double time = made_.tables[k].pairs[2 * j], between = time + 0.5 * (next_time(time) - time);
        for (const double instant : {time, between})
          if (const std::int32_t code = check_conflict(made_.at(instant), &instant); code != ILAW_OK)
            return code;
      }
    return ILAW_OK;
  }

  // Of any table; the same where none follows.
  double next_time(double time) const {
    double next = infinity;
    for (std::uint32_t k = 0; k < made_.table_count; ++k)
      next = smaller(next, made_.tables[k].next_time(time));
    return next < infinity ? next : time;
  }

  std::int32_t check_conflict(const Law& law, const double* time) {
    if constexpr (requires { law.conflict(); })
      if (const char* conflict = law.conflict()) {
        text_.add("law '%s': %s", id, conflict);
        add_values_named_in(conflict, law);
        if (time) {
          text_.add(" at time ");
          add_number(text_, *time);
        }
        return ILAW_INVALID_PARAMETER;
      }
    return ILAW_OK;
  }

  void add_values_named_in(const char* text, const Law& law) {
    const char* separator = "; found ";
    for (std::size_t i = 0; i < parameter_count; ++i) {
      const ilaw_parameter& p = description<Law>::parameters[i];
      char quoted[80];
      std::snprintf(quoted, sizeof quoted, "'%s'", p.name);
      if (!std::strstr(text, quoted)) continue;
      text_.add("%s%s = ", separator, p.name);
      add_value(text_, p, law.*Law::parameters[i].member);
      separator = ", ";
    }
  }

  // The law with parameters that vary as NaN, which equals nothing.
  Law with_unknowns() const {
    Law law = made_.law;
    for (std::uint32_t k = 0; k < made_.per_node_count; ++k)
      law.*made_.per_node_members[k] = std::numeric_limits<double>::quiet_NaN();
    for (std::uint32_t k = 0; k < made_.table_count; ++k)
      law.*made_.table_members[k] = std::numeric_limits<double>::quiet_NaN();
    return law;
  }

  std::int32_t lay_out_state() {
    if constexpr (has_history<Law>) made_.history_size = made_.law.history_size();
    const auto declared = abi_state_variables<Law>(static_cast<int>(made_.dimension), made_.history_size);
    for (const ilaw_state_variable& v : declared) append(v);
    made_.carries_frame = made_.frame == ILAW_FRAME_GLOBAL && made_.dimension == 3 && !made_.has_tangent &&
                          (made_.history_size > 0 || has_vector_state<Law>());
    if (made_.carries_frame)
      for (const history_card& v : frame_variables) append(abi_state_variable(v, ILAW_STATE_AXIS, 3));
    return ILAW_OK;
  }

  void append(const ilaw_state_variable& v) {
    if (v.count == 0) return;
    made_.variables[made_.variable_count] = v;
    made_.variable_pointers[made_.variable_count] = &made_.variables[made_.variable_count];
    ++made_.variable_count;
    made_.state_size += v.count;
  }

  instance<Law>& made_;
  const ilaw_setup setup_;
  message& text_;
  bool given_[parameter_count + 1] = {};
};

template <class Law>
const instance<Law>& of(const ilaw_instance* opaque) {
  return *reinterpret_cast<const instance<Law>*>(opaque);
}

template <class Law>
ilaw_result create(const char* id, const ilaw_setup* setup, ilaw_instance** result, char* text,
                   std::size_t text_size) {
  message said(text, text_size);
  if (!result) return ILAW_INVALID_ARGUMENT;
  *result = nullptr;
  if (!sized::is_complete(setup)) {
    said.add("law '%s': setup is null or its struct_size not from %u to %u", Law::card.id,
             sized::least<ilaw_setup>, sized::most);
    return ILAW_INVALID_ARGUMENT;
  }
  if (!id || std::strcmp(id, Law::card.id) != 0) {
    said.add("no law '%s' here: expected '%s'", id ? id : "(null)", Law::card.id);
    return ILAW_INVALID_ARGUMENT;
  }
  const float_environment own;
  void* room = std::malloc(sizeof(instance<Law>));
  if (!room) return ILAW_OUT_OF_MEMORY;
  auto* made = new (room) instance<Law>{};
  const std::int32_t code = instance_builder<Law>(*made, sized::read(setup), said).build();
  if (code == ILAW_OK) {
    *result = reinterpret_cast<ilaw_instance*>(made);
  } else {
    made->~instance<Law>();
    std::free(room);
  }
  return code;
}

template <class Law>
void ILAW_CALL destroy(ilaw_instance* opaque) {
  if (!opaque) return;
  reinterpret_cast<instance<Law>*>(opaque)->~instance<Law>();
  std::free(opaque);
}

template <class Law>
ilaw_result ILAW_CALL info(const ilaw_instance* opaque, ilaw_instance_info* out) {
  if (!opaque || !sized::is_complete(out)) return ILAW_INVALID_ARGUMENT;
  const instance<Law>& made = of<Law>(opaque);
  sized::write(out, {.struct_size = 0,
                     .inputs = made.inputs(),
                     .balance_inputs = made.energy_inputs(),
                     .state_variable_count = made.variable_count,
                     .state_size = made.state_size,
                     .state_variables = made.variable_pointers,
                     .per_node_parameters = made.per_node_names,
                     .per_node_parameter_count = made.per_node_count,
                     .capabilities = abi_capabilities(made.capabilities()),
                     .state_version = Law::card.state_version,
                     .permissions = abi_permissions(made.capabilities()),
                     .amounts = nullptr,
                     .amount_count = 0,
                     .reserved = 0});
  return ILAW_OK;
}

}  // namespace ilaw::kit::detail
