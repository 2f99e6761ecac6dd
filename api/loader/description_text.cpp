// SPDX-License-Identifier: BSD-3-Clause
#include "description_text.hpp"

#include "readable.hpp"

#include <ilaw/decimal_text.hpp>

#include <cmath>
#include <initializer_list>
#include <limits>

namespace ilaw::loading {
namespace {

// Names of bits, the lowest first; of kinds, from 0.
using names = std::initializer_list<const char*>;
constexpr names dimension_names = {"", "1", "2", "3"};
constexpr names form_names = {"scalar", "diagonal", "full", "transverse", "transverse_spin"};
constexpr names frame_names = {"local", "global"};
constexpr names number_names = {"double", "float"};
constexpr names input_names = {"gap", "v_previous", "area", "normal", "tangent", "v_smooth"};
constexpr names output_names = {"velocity", "status", "energy"};
constexpr names capability_names = {"adhere", "store_energy", "hold_bonds"};
constexpr names permission_names = {"skip_fresh", "skip_free"};
constexpr names parameter_flag_names = {"required", "excludes_minimum", "allows_infinity", "allows_per_node",
                                        "field",    "needs_spins"};
constexpr names variable_flag_names = {"internal"};
constexpr names parameter_kinds = {"number", "integer", "choice"};
constexpr names state_kinds = {"scalar", "vector", "history", "axis", "tangential"};

void append(std::string& list, const std::string& element) { list += (list.empty() ? "" : ", ") + element; }

std::string bits(std::uint32_t mask, const names& known) {
  std::string list;
  for (std::size_t i = 0; i < known.size(); ++i)
    if ((mask >> i & 1U) != 0 && *known.begin()[i]) append(list, quoted_text(known.begin()[i]));
  return "[" + list + "]";
}

std::string kind(std::uint32_t value, const names& known) {
  return value < known.size() ? quoted_text(known.begin()[value]) : "null";
}

// The largest double stands for "no limit".
std::string limit(double value) {
  const bool unlimited = std::abs(value) == std::numeric_limits<double>::max();
  return number_text(unlimited ? std::copysign(INFINITY, value) : value);
}

std::string texts(const char* const* elements, std::uint32_t count) {
  std::string list;
  for (std::uint32_t i = 0; i < count; ++i) append(list, quoted_text(elements[i]));
  return "[" + list + "]";
}

struct member {
  const char* name;
  std::string value;
};
std::string object(std::initializer_list<member> members) {
  std::string list;
  for (const member& one : members) append(list, quoted_text(one.name) + ": " + one.value);
  return "{" + list + "}";
}

template <class Element>
std::string objects(const Element* const* elements, std::uint32_t count,
                    std::string (*text_of)(const Element&)) {
  std::string list;
  for (std::uint32_t i = 0; i < count; ++i) append(list, text_of(*elements[i]));
  return "[" + list + "]";
}

std::string default_of(const ilaw_parameter& p) {
  if ((p.flags & ILAW_FLAG_REQUIRED) != 0) return "null";
  if (p.kind == ILAW_KIND_CHOICE) return quoted_text(p.choices[static_cast<std::size_t>(p.default_value)]);
  return number_text(p.default_value);
}

std::string parameter(const ilaw_parameter& p) {
  return object({{"name", quoted_text(p.name)},
                 {"symbol", quoted_text(p.symbol)},
                 {"unit", quoted_text(p.unit)},
                 {"doc", quoted_text(p.doc)},
                 {"kind", kind(p.kind, parameter_kinds)},
                 {"minimum", limit(p.minimum)},
                 {"maximum", limit(p.maximum)},
                 {"default", default_of(p)},
                 {"flags", bits(p.flags, parameter_flag_names)},
                 {"choices", texts(p.choices, p.choice_count)},
                 {"axes", texts(p.axes, p.axis_count)}});
}

std::string state_variable(const ilaw_state_variable& v) {
  return object({{"name", quoted_text(v.name)},
                 {"unit", quoted_text(v.unit)},
                 {"doc", quoted_text(v.doc)},
                 {"kind", kind(v.kind, state_kinds)},
                 {"count", std::to_string(v.count)},
                 {"flags", bits(v.flags, variable_flag_names)}});
}

std::string amount(const ilaw_amount& a) {
  return object({{"name", quoted_text(a.name)}, {"unit", quoted_text(a.unit)}, {"doc", quoted_text(a.doc)}});
}

std::string law(const ilaw_law& l) {
  return object({{"id", quoted_text(l.id)},
                 {"title", quoted_text(l.title)},
                 {"doc", quoted_text(l.doc)},
                 {"references", texts(l.references, l.reference_count)},
                 {"dimensions", bits(l.dimensions, dimension_names)},
                 {"delassus_forms", bits(l.delassus_forms, form_names)},
                 {"frames", bits(l.frames, frame_names)},
                 {"numbers", bits(l.numbers, number_names)},
                 {"inputs", bits(l.inputs, input_names)},
                 {"outputs", bits(l.outputs, output_names)},
                 {"capabilities", bits(l.capabilities, capability_names)},
                 {"permissions", bits(l.permissions, permission_names)},
                 {"parameters", objects(l.parameters, l.parameter_count, parameter)},
                 {"state_variables", objects(l.state_variables, l.state_variable_count, state_variable)},
                 {"amounts", objects(l.amounts, l.amount_count, amount)}});
}

}  // namespace

std::string quoted_text(std::string_view text) {
  const bool clean = clean_text(text, true);  // the path of a file may be no UTF-8
  std::string made = "\"";
  for (const char c : text) {
    if (c == '\n' || c == '\t')
      made += c == '\n' ? "\\n" : "\\t";
    else if (c == '"' || c == '\\')
      made += std::string("\\") + c;
    else
      made += clean || (c >= 0x20 && c < 0x7F) ? c : '?';
  }
  return made + "\"";
}

std::string number_text(double value) {
  if (std::isnan(value)) return "null";
  if (std::isinf(value)) return value > 0 ? "\"inf\"" : "\"-inf\"";
  return decimal_text(value).get();
}

std::string description_text(const ilaw_plugin& plugin) {
  const std::string version = std::to_string(plugin.abi_major) + ", " + std::to_string(plugin.abi_minor);
  return object({{"format", quoted_text(description_format)},
                 {"name", quoted_text(plugin.name)},
                 {"version", quoted_text(plugin.version)},
                 {"vendor", quoted_text(plugin.vendor)},
                 {"licence", quoted_text(plugin.licence)},
                 {"abi", "[" + version + "]"},
                 {"laws", objects(plugin.laws, plugin.law_count, law)}});
}

}  // namespace ilaw::loading
