// SPDX-License-Identifier: BSD-3-Clause
#include "description.hpp"

#include "readable.hpp"
#include "refusal.hpp"

#include <cmath>
#include <set>
#include <string_view>

namespace ilaw::loading {
namespace {

// Far more than any library has; a larger count is a broken description.
constexpr std::uint32_t most_entries = 10000;

// Checks with the path to the culprit in every message, e.g. "contact.so: law 'contact': parameter
// 'restitution': ...".
class checker {
 public:
  checker(std::string where, bool newer_minor) : where_(std::move(where)), newer_minor_(newer_minor) {}

  checker inside(const std::string& what) const { return {where_ + ": " + what, newer_minor_}; }

  [[noreturn]] void refuse(const std::string& found_and_expected) const {
    throw refusal(ILAW_BAD_LIBRARY, where_ + ": " + found_and_expected);
  }

  // A struct of at least the size that ABI 1.0 gives it.
  template <class Struct>
  void structure(const Struct* s, const char* what) const {
    if (!s) refuse(std::string(what) + " is null");
    if (!readable(s, sizeof(std::uint32_t)))
      refuse(std::string(what) + " points to memory that cannot be read");
    if (s->struct_size < sizeof(Struct))
      refuse(std::string(what) + " has struct_size " + std::to_string(s->struct_size) +
             ", expected at least " + std::to_string(sizeof(Struct)));
    if (!readable(s, sizeof(Struct))) refuse(std::string(what) + " points to memory that cannot be read");
  }

  void text(const char* t, const char* what) const {
    if (!t) refuse(std::string(what) + " is null, expected a text");
    if (!readable_text(t)) refuse(std::string(what) + " is no readable text of at most 64 KiB");
  }

  void name(const char* n, const char* what) const {
    text(n, what);
    const std::string_view name(n);
    bool good = !name.empty() && name.front() >= 'a' && name.front() <= 'z';
    for (char c : name) good = good && ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_');
    if (!good)
      refuse(std::string(what) + " is '" + std::string(name) +
             "', expected lower-case letters, digits and '_'");
  }

  // An array of count pointers.
  template <class Element>
  void array(const Element* a, std::uint32_t count, const char* what) const {
    if (count > most_entries)
      refuse(std::string(what) + " has " + std::to_string(count) + " entries, expected at most " +
             std::to_string(most_entries));
    if (count == 0) return;
    if (!a) refuse(std::string(what) + " is null, expected " + std::to_string(count) + " entries");
    if (!readable(a, count * sizeof(Element)))
      refuse(std::string(what) + " points to memory that cannot be read");
  }

  // Bits that this host does not know are allowed to newer libraries only.
  void mask(std::uint32_t value, std::uint32_t known, bool may_be_empty, const char* what) const {
    if (value == 0 && !may_be_empty)
      refuse(std::string(what) + " is 0, expected at least one of the bits of " + std::to_string(known));
    if ((value & ~known) != 0 && !newer_minor_)
      refuse(std::string(what) + " is " + std::to_string(value) + ", expected only the bits of " +
             std::to_string(known));
  }

  void kind(std::uint32_t value, std::uint32_t largest, const char* what) const {
    if (value > largest && !newer_minor_)
      refuse(std::string(what) + " is " + std::to_string(value) + ", expected at most " +
             std::to_string(largest));
  }

 private:
  std::string where_;
  bool newer_minor_;
};

std::string quoted(const char* kind, const char* name) { return std::string(kind) + " '" + name + "'"; }

void check_unique(const checker& check, std::set<std::string>& seen, const char* kind, const char* name) {
  if (!seen.insert(name).second) check.refuse(quoted(kind, name) + " is declared twice");
}

bool in_range(const ilaw_parameter& p, double value) {
  if (value == INFINITY) return p.infinity_allowed != 0;
  return value <= p.maximum && (p.minimum_excluded ? value > p.minimum : value >= p.minimum);
}

void check_parameter(const checker& check, const ilaw_parameter& p) {
  check.kind(p.kind, ILAW_PARAMETER_CHOICE, "kind");
  check.text(p.symbol, "symbol");
  check.text(p.unit, "unit");
  check.text(p.doc, "doc");
  check.array(p.choices, p.choice_count, "choices");
  if (p.kind == ILAW_PARAMETER_CHOICE && p.choice_count == 0)
    check.refuse("choice_count is 0, expected at least 1");
  for (std::uint32_t i = 0; i < p.choice_count; ++i) check.text(p.choices[i], "a choice");
  if (!(p.minimum <= p.maximum))
    check.refuse("minimum " + std::to_string(p.minimum) + " is not below maximum " +
                 std::to_string(p.maximum));
  if (!p.required && !in_range(p, p.default_value))
    check.refuse("default " + std::to_string(p.default_value) + " lies outside its own range");
  check.mask(p.may_be, ILAW_MAY_BE_TABLE | ILAW_MAY_BE_PER_NODE, true, "may_be");
}

void check_state_variable(const checker& check, const ilaw_state_variable& v) {
  check.kind(v.kind, ILAW_STATE_TANGENTIAL, "kind");
  check.text(v.unit, "unit");
  check.text(v.doc, "doc");
}

template <class Element>
void check_named(const checker& check, const Element* const* entries, std::uint32_t count, const char* arrays,
                 const char* kind, void (*check_one)(const checker&, const Element&)) {
  check.array(entries, count, arrays);
  std::set<std::string> seen;
  for (std::uint32_t i = 0; i < count; ++i) {
    const checker numbered = check.inside(std::string(kind) + " " + std::to_string(i));
    numbered.structure(entries[i], kind);
    numbered.name(entries[i]->name, "name");
    check_unique(check, seen, kind, entries[i]->name);
    check_one(check.inside(quoted(kind, entries[i]->name)), *entries[i]);
  }
}

void check_functions(const checker& check, const ilaw_law& law) {
  const auto given = [&check](bool set, const char* name) {
    if (!set) check.refuse("function '" + std::string(name) + "' is null, expected a function");
  };
  given(law.create, "create");
  given(law.destroy, "destroy");
  given(law.info, "info");
  given(law.initialise, "initialise");
  given(law.evaluate, "evaluate");
}

void check_law(const checker& check, const ilaw_law& law) {
  check.text(law.title, "title");
  check.text(law.doc, "doc");
  check.mask(law.dimensions, ILAW_DIMENSION_1 | ILAW_DIMENSION_2 | ILAW_DIMENSION_3, false, "dimensions");
  check.mask(law.delassus_forms, 2 * ILAW_DELASSUS_TRANSVERSE - 1, false,
             "delassus_forms");
  check.mask(law.inputs, 2 * ILAW_INPUT_TANGENT - 1, true, "inputs");
  check.mask(law.outputs, 2 * ILAW_OUTPUT_ENERGY - 1, true, "outputs");
  check.mask(law.capabilities, 2 * ILAW_CAN_REST - 1, true, "capabilities");
  check.array(law.references, law.reference_count, "references");
  for (std::uint32_t i = 0; i < law.reference_count; ++i) check.text(law.references[i], "a reference");
  check_named(check, law.parameters, law.parameter_count, "parameters", "parameter", check_parameter);
  check_named(check, law.state_variables, law.state_variable_count, "state_variables", "state variable",
              check_state_variable);
  check_functions(check, law);
}

void check_version(const checker& check, const ilaw_plugin& plugin) {
  if (plugin.abi_major != ILAW_ABI_MAJOR)
    check.refuse("ABI version " + std::to_string(plugin.abi_major) + "." + std::to_string(plugin.abi_minor) +
                 ", expected major version " + std::to_string(ILAW_ABI_MAJOR));
}

}  // namespace

void check_plugin(const std::string& file, const ilaw_plugin* plugin) {
  const checker first(file, false);
  first.structure(plugin, "the description");
  check_version(first, *plugin);
  const checker check(file, plugin->abi_minor > ILAW_ABI_MINOR);
  check.text(plugin->name, "name");
  check.text(plugin->version, "version");
  check.text(plugin->vendor, "vendor");
  check.text(plugin->licence, "licence");
  if (plugin->law_count == 0) check.refuse("law_count is 0, expected at least 1");
  check.array(plugin->laws, plugin->law_count, "laws");
  std::set<std::string> seen;
  for (std::uint32_t i = 0; i < plugin->law_count; ++i) {
    const checker numbered = check.inside("law " + std::to_string(i));
    numbered.structure(plugin->laws[i], "law");
    numbered.name(plugin->laws[i]->id, "id");
    check_unique(check, seen, "law", plugin->laws[i]->id);
    check_law(check.inside(quoted("law", plugin->laws[i]->id)), *plugin->laws[i]);
  }
}

void check_instance_info(const std::string& file, const ilaw_law& law, const ilaw_instance_info& info,
                         std::uint32_t dimension) {
  const checker check = checker(file, true).inside(quoted("law", law.id) + ": instance");
  check_named(check, info.state_variables, info.state_variable_count, "state_variables", "state variable",
              check_state_variable);
  std::uint64_t sum = 0;
  for (std::uint32_t i = 0; i < info.state_variable_count; ++i) {
    const ilaw_state_variable& v = *info.state_variables[i];
    const bool fixed = v.kind != ILAW_STATE_HISTORY;
    const std::uint64_t expected = v.kind == ILAW_STATE_SCALAR ? 1 : dimension;
    if (fixed && v.count != expected)
      check.inside(quoted("state variable", v.name))
          .refuse("count is " + std::to_string(v.count) + ", expected " + std::to_string(expected));
    sum += v.count;
  }
  if (sum != info.state_size)
    check.refuse("state_size is " + std::to_string(info.state_size) + ", expected the sum of the counts, " +
                 std::to_string(sum));
  check.mask(info.capabilities, 2 * ILAW_CAN_REST - 1, true, "capabilities");
  check.array(info.per_node_parameters, info.per_node_parameter_count, "per_node_parameters");
  for (std::uint32_t i = 0; i < info.per_node_parameter_count; ++i)
    check.text(info.per_node_parameters[i], "a per-node parameter");
}

}  // namespace ilaw::loading
