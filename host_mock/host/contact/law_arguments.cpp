// SPDX-License-Identifier: BSD-3-Clause
#include "contact/law_arguments.hpp"

#include "base/words.hpp"

#include <algorithm>

namespace ilaw::host {
namespace {

bool has_field(const ilaw_law& law, const std::string& name) {
  constexpr ilaw_parameter_flags field = ILAW_FLAG_FIELD | ILAW_FLAG_ALLOWS_PER_NODE;
  for (std::uint32_t k = 0; k < law.parameter_count; ++k)
    if (name == law.parameters[k]->name) return (law.parameters[k]->flags & field) == field;
  return false;
}

// Fields that the law takes become values per node.
Arguments with_fields(Arguments given, const ilaw_law* law) {
  for (const auto& [name, values] : given.fields)
    if (law && has_field(*law, name) && !given.gives(name)) given.per_node[name] = values;
  return given;
}

// node_index: the values of this node stand for those per node.
ilaw::parameters parameters_of(const Arguments& given, std::optional<std::size_t> node_index) {
  ilaw::parameters made;
  for (const auto& [name, value] : given.numbers) made.number(name, value);
  for (const auto& [name, text] : given.texts) made.text(name, text);
  for (const auto& [name, table] : given.tables) made.table(name, table.axes, table.values);
  for (const auto& [name, values] : given.per_node)
    node_index ? made.number(name, values[*node_index]) : made.per_node(name);
  return made;
}

std::size_t node_count(const Arguments& given) {
  return given.per_node.empty() ? 0 : given.per_node.begin()->second.size();
}

bool is_like_the_node_before(const Arguments& given, std::size_t node_index) {
  return node_index > 0 && std::ranges::all_of(given.per_node, [node_index](const auto& one) {
           return one.second[node_index] == one.second[node_index - 1];
         });
}

// The parameter that a law's message names first, or empty: laws put names in quotes.
std::string named_in(const std::string& message, const Arguments& given) {
  std::string named;
  std::size_t first = std::string::npos;
  const auto look = [&](const auto& parameters) {
    for (const auto& [name, value] : parameters)
      if (const std::size_t at = message.find("'" + name + "'"); at < first) first = at, named = name;
  };
  look(given.numbers), look(given.texts), look(given.tables), look(given.per_node);
  return named;
}

std::string pointer_to(const std::string& named, const Arguments& given,
                       std::optional<std::size_t> node_index) {
  if (named.empty()) return "";
  if (given.per_node.contains(named))
    return "/" + named + "/per_node" + (node_index ? "/" + std::to_string(*node_index) : "");
  return "/" + named + (given.tables.contains(named) ? "/table" : "");
}

// The parameter that was meant by a name that the law does not have.
std::string meant_by(const std::string& given, const ilaw_law* law) {
  std::vector<std::string> names;
  for (std::uint32_t k = 0; law && k < law->parameter_count; ++k)
    names.emplace_back(law->parameters[k]->name);
  return std::find(names.begin(), names.end(), given) == names.end() ? suggestion(given, names) : "";
}

// Straight through the law: the loader, which checks every instance, has seen one.
void try_create(const ilaw_law& law, const ilaw_setup& setup) {
  char message[1024] = "";
  ilaw_instance* made = nullptr;
  const std::int32_t code = law.create(law.id, &setup, &made, message, sizeof message);
  if (code != ILAW_OK) throw ilaw::error(code, message);
  law.destroy(made);
}

}  // namespace

ilaw::interface create_law(const std::string& law, const Arguments& from_scene, ilaw_setup setup,
                           const ilaw::library& library) {
  const Arguments given = with_fields(from_scene, library.law(law));
  ilaw::parameters parameters = parameters_of(given, {});
  parameters.give(setup);
  std::vector<const ilaw_argument*> order(setup.arguments, setup.arguments + setup.argument_count);
  if (given.is_reversed) std::reverse(order.begin(), order.end());
  setup.arguments = order.data();
  std::optional<std::size_t> node_index;
  try {
    ilaw::interface created(library, law, setup);
    // Values per node reach the law with the first batch only. Whether it allows those of a node
    // together is found now, by an instance for that node alone.
    for (node_index = 0; *node_index < node_count(given); ++*node_index) {
      if (is_like_the_node_before(given, *node_index)) continue;
      ilaw::parameters of_node = parameters_of(given, node_index);
      of_node.give(setup);
      try_create(created.law(), setup);
    }
    return created;
  } catch (const ilaw::error& refusal) {
    if (refusal.code() != ILAW_INVALID_PARAMETER) throw;
    const std::string named = named_in(refusal.what(), given);
    const std::string text = refusal.what() + (named.empty() ? "" : meant_by(named, library.law(law)));
    throw ParameterError({refusal.code(), text}, pointer_to(named, given, node_index), node_index);
  }
}

ilaw::interface create_law(const std::string& law, const Arguments& given, const Vector& tangent,
                           const ilaw::library& library, int dimension, std::uint32_t delassus_form) {
  ilaw_setup setup{};
  setup.struct_size = sizeof setup;
  setup.dimension = static_cast<std::uint32_t>(dimension);
  setup.delassus_form = delassus_form;
  setup.frame = ILAW_FRAME_GLOBAL;
  setup.numbers = ILAW_NUMBERS_DOUBLE;
  setup.has_tangent = tangent.size() > 0 ? 1 : 0;
  return create_law(law, given, setup, library);
}

}  // namespace ilaw::host
