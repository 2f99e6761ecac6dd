// instance.hpp - the ABI description of a law, made from its struct at compile time; and what create makes:
// the law with its checked parameters, and how its batches look.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/create.h>
#include <ilaw/kit/detail/dispatch.hpp>
#include <ilaw/kit/detail/kernel.hpp>
#include <ilaw/kit/detail/walk.hpp>
#include <ilaw/kit/law.hpp>
#include <ilaw/sized.hpp>

#include <new>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// ---- description

template <class T, std::size_t N>
constexpr std::array<const T*, N> pointers_to(const std::array<T, N>& elements) {
  std::array<const T*, N> pointers{};
  for (std::size_t i = 0; i < N; ++i) pointers[i] = &elements[i];
  return pointers;
}

constexpr std::uint32_t flag_if(bool condition, std::uint32_t flag) { return condition ? flag : 0U; }

// The parameter of L<pack>, whose members tell what may vary.
template <class Law>
constexpr ilaw_parameter abi_parameter(const parameter<Law>& p) {
  const bool is_choice = p.choices.count > 0, varies = p.member.may_vary(),
             has_tables = varies || p.member.is_grid();
  return {.struct_size = sizeof(ilaw_parameter),
          .kind = static_cast<ilaw_kind>(is_choice ? ILAW_KIND_CHOICE
                                                   : (p.whole ? ILAW_KIND_INTEGER : ILAW_KIND_NUMBER)),
          .name = p.name,
          .symbol = p.symbol,
          .unit = p.unit,
          .doc = p.doc,
          .minimum = is_choice ? 0.0 : p.minimum,
          .maximum = is_choice ? p.choices.count - 1.0 : p.maximum,
          .default_value = p.default_value,
          .flags = flag_if(p.required, ILAW_FLAG_REQUIRED) |
                   flag_if(p.minimum_excluded, ILAW_FLAG_EXCLUDES_MINIMUM) |
                   flag_if(p.infinity_allowed, ILAW_FLAG_ALLOWS_INFINITY) |
                   flag_if(varies, ILAW_FLAG_ALLOWS_PER_NODE) | flag_if(p.is_field, ILAW_FLAG_FIELD) |
                   flag_if(p.needs_spins, ILAW_FLAG_NEEDS_SPINS),
          .choice_count = p.choices.count,
          .choices = p.choices.values,
          .axes = has_tables ? p.axes.values : nullptr,
          .axis_count = has_tables ? p.axes.count : 0U,
          .reserved = 0};
}
template <class Wide>
constexpr auto abi_parameters() {
  std::array<ilaw_parameter, std::size(Wide::parameters)> result{};
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = abi_parameter<Wide>(Wide::parameters[i]);
  return result;
}

// Text: a state_variable or a history_card.
template <class Text>
constexpr ilaw_state_variable abi_state_variable(const Text& v, std::uint32_t kind, std::uint64_t count) {
  return {.struct_size = sizeof(ilaw_state_variable),
          .kind = kind,
          .name = v.name,
          .unit = v.unit,
          .doc = v.doc,
          .count = count,
          .flags = flag_if(v.internal, ILAW_FLAG_INTERNAL),
          .reserved = 0};
}
template <class Law>
inline constexpr std::size_t state_variable_count = [] {
  std::size_t count = has_window<Law> ? 1 : 0;
  if constexpr (has_state<Law>) count += std::size(Law::state_variables);
  return count;
}();
template <class Law>
constexpr auto abi_state_variables(int dimension, std::uint64_t history_size) {
  std::array<ilaw_state_variable, state_variable_count<Law>> result{};
  std::size_t i = 0;
  if constexpr (has_state<Law>)
    for (const auto& v : Law::state_variables)
      result[i++] =
          abi_state_variable(v, v.member.kind(), static_cast<std::uint64_t>(v.member.components(dimension)));
  if constexpr (has_window<Law>)
    result[i] = abi_state_variable(Law::history, ILAW_KIND_HISTORY, history_size);
  return result;
}

template <class Law>
constexpr auto abi_amounts() {
  std::array<ilaw_amount, static_cast<std::size_t>(amount_count<Law>)> result{};
  std::size_t i = 0;
  const auto add = [&](const amount_card& a) {
    result[i++] = {
        .struct_size = sizeof(ilaw_amount), .reserved = 0, .name = a.name, .unit = a.unit, .doc = a.doc};
  };
  if constexpr (has_amounts<Law>)
    for (const amount_card& a : Law::amounts) add(a);
  if constexpr (gives_heat<Law>)
    for (const amount_card& a : heat_amounts) add(a);
  return result;
}

// Wide: L<pack>; Law: L<double>.
template <class Wide, class Law>
struct description {
  static constexpr auto parameters = abi_parameters<Wide>();
  static constexpr auto parameter_pointers = pointers_to(parameters);
  static constexpr auto state_variables = abi_state_variables<Law>(3, 0);
  static constexpr auto state_variable_pointers = pointers_to(state_variables);
  static constexpr auto amounts = abi_amounts<Law>();
  static constexpr auto amount_pointers = pointers_to(amounts);
};

// ---- instance

// The local frame is carried along in the state where a law remembers vectors and the host gives only
// normals.
inline constexpr history_card frame_variables[] = {
    {.name = "frame_normal", .doc = "Normal of the last step.", .internal = true},
    {.name = "frame_tangent", .doc = "First tangent of the last step.", .internal = true}};

static_assert(table::time == ILAW_TIME && table::computed == ILAW_COMPUTED);
inline table table_of(const ilaw_table& given) {
  table t;
  t.axis_count = static_cast<int>(given.axis_count);
  for (int a = 0; a < t.axis_count; ++a) {
    t.source[a] = given.source[a];
    t.named_axis[a] = static_cast<int>(given.place[a]);
    t.count[a] = given.count[a];
    t.points[a] = given.points[a];
  }
  t.values = given.values;
  return t;
}

// Law: L<double>.
template <class Law>
struct instance : instance_base {
  using description_type = description<law_on_t<Law, pack>, Law>;
  static constexpr std::size_t variable_capacity = state_variable_count<Law> + 2;
  static_assert(parameter_count<Law> <= most_parameters && kit::amount_count<Law> <= most_amounts);

  Law law;
  std::uint32_t capabilities, permissions;
  table tables[parameter_count<Law> + 1];  // by parameter
  std::uint32_t table_count = 0;
  const char* per_node_names[parameter_count<Law> + 1];
  ilaw_state_variable variables[variable_capacity];
  const ilaw_state_variable* variable_pointers[variable_capacity];
  std::uint32_t variable_count = 0;

  bool varies() const { return table_count > 0 || per_node_count > 0; }

  // The law as it is at a time: tables read, but those over a field that comes per node. Fields first.
  Law at(double time) const {
    Law now = law;
    if (table_count > 0)
      for (const bool over_time_alone : {true, false})
        for (int k = 0; k < parameter_count<Law>; ++k)
          if (tables[k].axis_count > 0 && !tables[k].per_node &&
              tables[k].is_over_time_alone() == over_time_alone)
            read_table_of(now, k, time);
    return now;
  }
  // And with the fields of a node.
  void read_node_tables(Law& now, double time) const {
    for (int k = 0; k < parameter_count<Law>; ++k)
      if (tables[k].per_node) read_table_of(now, k, time);
  }
  void read_table_of(Law& now, int k, double time) const {
    if (Law::parameters[k].member.is_grid()) return;
    double place[3] = {};
    for (int a = 0; a < tables[k].axis_count; ++a) {
      const int source = tables[k].source[a];
      place[a] = source == table::time ? time : Law::parameters[source].member.get(now);
    }
    Law::parameters[k].member.set(now, tables[k].at(place));
  }

  ~instance() {
    for (const table& t : tables) std::free(t.points[0]);
  }
};

// Makes an instance of what create.h read.
template <class Law>
class instance_builder {
 public:
  instance_builder(instance<Law>& target, const ilaw_law& law, const ilaw_setup& setup, ilaw_message& text)
      : made_(target), abi_(law), setup_(setup), text_(text) {}

  [[gnu::cold]] ilaw_result build() {
    ilaw_arguments given{};
    const ilaw_result read = ilaw_create_read(&abi_, &setup_, &given, &text_);
    if (read != ILAW_OK) ilaw_arguments_free(&given);
    if (read != ILAW_OK) return read;
    take(given);
    if (const ilaw_result code = check_together(); code != ILAW_OK) return code;
    lay_out_state();
    state_needs();
    return ILAW_OK;
  }

 private:
  using description_type = typename instance<Law>::description_type;
  static constexpr auto count = static_cast<std::size_t>(parameter_count<Law>);
  static_assert(parameter_count<Law> <= ILAW_CREATE_MAX);

  void take(const ilaw_arguments& given) {
    made_.dimension = setup_.dimension;
    made_.delassus_form = setup_.delassus_form;
    made_.frame = setup_.frame;
    made_.numbers = setup_.numbers;
    made_.has_tangent = setup_.has_tangent;
    made_.per_node_count = given.per_node_count;
    for (std::uint32_t k = 0; k < given.per_node_count; ++k) {
      made_.per_node_parameters[k] = static_cast<int>(given.per_node[k]);
      made_.per_node_names[k] = given.per_node_names[k];
    }
    for (std::size_t p = 0; p < count; ++p) {
      table& t = made_.tables[p];
      t = table_of(given.table[p]);
      const auto& member = Law::parameters[p].member;
      member.set(made_.law, given.number[p], t);
      if (t.axis_count == 0 || member.is_grid()) continue;
      ++made_.table_count;
      member.set(made_.law, t.values[0]);
      for (int a = 0; a < t.axis_count; ++a)
        for (std::uint32_t k = 0; k < given.per_node_count; ++k)
          t.per_node = t.per_node || made_.per_node_parameters[k] == t.source[a];
      if (t.per_node) made_.node_tables = made_.tables;
    }
  }

  ilaw_result check_together() {
    if constexpr (requires { made_.law.inputs(); })
      if (const std::uint32_t extra = made_.law.inputs() & ~Law::card.inputs)
        return ilaw_refuse(&text_, ILAW_UNSUPPORTED, "reads inputs 0x%x that its card does not name", extra);
    if (const ilaw_result code = check_conflicts(); code != ILAW_OK) return code;
    if constexpr (requires { made_.law.tells_tangents_apart(); })
      if (with_unknowns().tells_tangents_apart() && setup_.frame == ILAW_FRAME_GLOBAL &&
          setup_.dimension == 3 && !setup_.has_tangent)
        return ilaw_refuse(
            &text_, ILAW_UNSUPPORTED,
            "these parameters tell the two tangential axes apart: expected a tangent per node");
    return ILAW_OK;
  }

  // Values that come per node are checked together there. Tables are checked at all their times, which is
  // enough for what is linear or convex in the parameters, and halfway to the next time of any of them, where
  // a segment towards infinity is infinite already.
  ilaw_result check_conflicts() {
    if (made_.per_node_count > 0) return ILAW_OK;
    if (made_.table_count == 0) return check_conflict(made_.law, nullptr);
    bool has_times = false;
    for (const table& t : made_.tables)
      for (int a = 0; a < t.axis_count; ++a)
        for (std::uint64_t j = 0; t.source[a] == table::time && j < t.count[a]; ++j) {
          const double time = t.points[a][j], between = time + 0.5 * (next_time(time) - time);
          has_times = true;
          for (const double instant : {time, between})
            if (const ilaw_result code = check_conflict(made_.at(instant), &instant); code != ILAW_OK)
              return code;
        }
    return has_times ? ILAW_OK : check_conflict(made_.at(0.0), nullptr);
  }

  // The next time of any table after `time`; `time` itself where none follows.
  double next_time(double time) const {
    double next = infinity;
    for (const table& t : made_.tables) next = smaller(next, t.next_time(time));
    return next < infinity ? next : time;
  }

  ilaw_result check_conflict(const Law& law, const double* time) {
    if constexpr (requires { law.conflict(); })
      if (const char* conflict = law.conflict()) {
        ilaw_refuse(&text_, ILAW_INVALID_PARAMETER, "%s", conflict);
        add_values_named_in(conflict, law);
        if (time) {
          ilaw_message_add(&text_, " at time ");
          ilaw_message_add_number(&text_, *time);
        }
        return ILAW_INVALID_PARAMETER;
      }
    return ILAW_OK;
  }

  void add_values_named_in(const char* text, const Law& law) {
    const char* separator = "; found ";
    for (std::size_t i = 0; i < count; ++i) {
      const ilaw_parameter& p = description_type::parameters[i];
      char quoted[80];
      std::snprintf(quoted, sizeof quoted, "'%s'", p.name);
      if (!std::strstr(text, quoted)) continue;
      ilaw_message_add(&text_, "%s%s = ", separator, p.name);
      ilaw_message_add_value(&text_, &p, Law::parameters[i].member.get(law));
      separator = ", ";
    }
  }

  // The law with parameters that vary as NaN, which equals nothing.
  Law with_unknowns() const {
    Law law = made_.law;
    for (std::uint32_t k = 0; k < made_.per_node_count; ++k)
      Law::parameters[made_.per_node_parameters[k]].member.set(law, not_a_number);
    for (std::size_t k = 0; k < count; ++k)
      if (made_.tables[k].axis_count > 0) Law::parameters[k].member.set(law, not_a_number);
    return law;
  }

  void lay_out_state() {
    if constexpr (has_window<Law>) {
      made_.window = made_.law.window();
      made_.history_size = window::doubles(made_.window);
    }
    const auto declared = abi_state_variables<Law>(static_cast<int>(made_.dimension),
                                                   static_cast<std::uint64_t>(made_.history_size));
    for (const ilaw_state_variable& v : declared) append(v);
    made_.carries_frame = made_.frame == ILAW_FRAME_GLOBAL && made_.dimension == 3 && !made_.has_tangent &&
                          (made_.history_size > 0 || has_vector_state<Law>());
    if (made_.carries_frame)
      for (const history_card& v : frame_variables) append(abi_state_variable(v, ILAW_KIND_AXIS, 3));
    made_.states = state_numbers<Law>;
    made_.state_entries = state_entries<Law>[made_.dimension].data();
    made_.frame_offset = static_cast<std::int64_t>(made_.state_size) - (made_.carries_frame ? frame_size : 0);
    made_.history_offset = made_.frame_offset - made_.history_size;
  }

  // Inputs, capabilities and permissions of the instance.
  void state_needs() {
    std::uint32_t mask = Law::card.inputs;
    if constexpr (requires { made_.law.inputs(); })
      if (!made_.varies()) mask = made_.law.inputs();
    if (made_.frame == ILAW_FRAME_GLOBAL) mask |= ILAW_INPUT_NORMAL;
    if (made_.frame == ILAW_FRAME_GLOBAL && made_.has_tangent && made_.dimension == 3)
      mask |= ILAW_INPUT_TANGENT;
    made_.inputs = mask;
    std::uint32_t balance = ILAW_INPUT_V_PREVIOUS;
    if constexpr (gives_heat<Law>)
      if (!(with_unknowns().wear_coefficient == 0.0)) balance |= ILAW_INPUT_AREA;
    made_.balance_inputs = balance & ~mask;
    made_.capabilities = Law::card.capabilities;
    if constexpr (requires { made_.law.capabilities(); })
      if (!made_.varies()) made_.capabilities = made_.law.capabilities();
    made_.permissions = Law::card.permissions;
    if constexpr (requires { made_.law.permissions(); })
      if (!made_.varies()) made_.permissions = made_.law.permissions();
    // A frame follows the normal wherever the node is, unless the law says when its memory rests.
    made_.frame_follows = has_window<Law> && !(made_.permissions & ILAW_MAY_SKIP_FREE);
    if (made_.carries_frame && made_.frame_follows) made_.permissions &= ~std::uint32_t{ILAW_MAY_SKIP_FRESH};
    if constexpr (requires { made_.law.asks(); }) made_.asks = with_unknowns().asks();
    if constexpr (requires { made_.law.asks(true); })
      made_.asks = with_unknowns().asks(made_.is_transverse());
    made_.amount_count = static_cast<std::uint32_t>(amount_count<Law>);
  }

  void append(const ilaw_state_variable& v) {
    if (v.count == 0) return;
    made_.variables[made_.variable_count] = v;
    made_.variable_pointers[made_.variable_count] = &made_.variables[made_.variable_count];
    ++made_.variable_count;
    made_.state_size += v.count;
  }

  instance<Law>& made_;
  const ilaw_law& abi_;
  const ilaw_setup setup_;
  ilaw_message& text_;
};

template <class Law>
careful_function choose_careful(const instance<Law>& made);
template <class Law>
scalar_function scalar_fallback();

// law: its description.
template <class Law>
ilaw_result create(const ilaw_law& law, const char* name, const ilaw_setup* setup, const ilaw_kit_part& part,
                   ilaw_instance** result, ilaw_message& text) {
  *result = nullptr;
  if (!name || std::strcmp(name, Law::card.id) != 0)
    return ilaw_refuse(&text, ILAW_INVALID_ARGUMENT, "create was called for '%s'", name ? name : "null");
  if (!sized::is_complete(setup))
    return ilaw_refuse(&text, ILAW_INVALID_ARGUMENT, "setup is null or its struct_size not from %u to %u",
                       sized::least<ilaw_setup>, sized::most);
  const float_environment own;
  void* memory = std::malloc(sizeof(instance<Law>));
  if (!memory) return ILAW_OUT_OF_MEMORY;
  auto* made = new (memory) instance<Law>{};
  const ilaw_result code = instance_builder<Law>(*made, law, sized::read(setup), text).build();
  if (code == ILAW_OK) {
    made->part = &part;
    made->loop = part.loop(made, false);
    made->float_loop = made->numbers == ILAW_NUMBERS_FLOAT ? part.loop(made, true) : nullptr;
    made->careful = choose_careful(*made);
    made->scalar = scalar_fallback<Law>();
    *result = reinterpret_cast<ilaw_instance*>(made);
  } else {
    made->~instance<Law>();
    std::free(memory);
  }
  return code;
}

template <class Law>
const instance<Law>& of(const ilaw_instance* opaque) {
  return *reinterpret_cast<const instance<Law>*>(opaque);
}

template <class Law>
void destroy(ilaw_instance* opaque) {
  if (!opaque) return;
  reinterpret_cast<instance<Law>*>(opaque)->~instance<Law>();
  std::free(opaque);
}

template <class Law>
ilaw_result info(const ilaw_instance* opaque, ilaw_instance_info* out) {
  if (!opaque || !sized::is_complete(out)) return ILAW_INVALID_ARGUMENT;
  const instance<Law>& made = of<Law>(opaque);
  sized::write(out, {.struct_size = 0,
                     .inputs = made.inputs,
                     .balance_inputs = made.balance_inputs,
                     .state_variable_count = made.variable_count,
                     .state_size = made.state_size,
                     .state_variables = made.variable_pointers,
                     .per_node_parameters = made.per_node_names,
                     .per_node_parameter_count = made.per_node_count,
                     .capabilities = made.capabilities,
                     .state_version = Law::card.state_version,
                     .permissions = made.permissions,
                     .amounts = instance<Law>::description_type::amount_pointers.data(),
                     .amount_count = static_cast<std::uint32_t>(amount_count<Law>),
                     .reserved = 0});
  return ILAW_OK;
}

}  // namespace ilaw::kit::detail
