// describe.hpp - the ABI description of a law, made from its struct at compile time.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/heat.hpp>
#include <ilaw/kit/state.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

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
  std::size_t count = has_history<Law> ? 1 : 0;
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
  if constexpr (has_history<Law>)
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

}  // namespace ilaw::kit::detail
