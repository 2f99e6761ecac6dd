// SPDX-License-Identifier: BSD-3-Clause
#include "contact/law_setup.hpp"

#include "base/words.hpp"

#include <algorithm>
#include <deque>

namespace ilaw::host {
namespace {

// The arguments of create, with the pointers that it wants; deque keeps addresses while growing.
class ArgumentList {
 public:
  ArgumentList(const Arguments& given, const ilaw_law* law) {
    for (const auto& [name, value] : given.numbers) add(ILAW_VALUE_NUMBER, name).number = value;
    for (const auto& [name, text] : given.texts) add(ILAW_VALUE_TEXT, name).text = text.c_str();
    for (const auto& [name, table] : given.tables) add_table(name, table);
    for (const auto& [name, values] : given.per_node)
      per_node_.emplace_back(&add(ILAW_VALUE_PER_NODE, name), &values);
    for (const auto& [name, values] : given.fields)
      if (has_field(law, name) && !given.gives(name))
        per_node_.emplace_back(&add(ILAW_VALUE_PER_NODE, name), &values);
    for (const ilaw_argument& argument : arguments_) pointers_.push_back(&argument);
  }

  const std::vector<const ilaw_argument*>& pointers() const { return pointers_; }
  std::size_t node_count() const { return per_node_.empty() ? 0 : per_node_.front().second->size(); }

  // From now on the values of one node stand for those per node. Returns whether this changed any.
  bool take_node(std::size_t node_index) {
    bool changed = false;
    for (const auto& [argument, values] : per_node_) {
      changed |= argument->kind != ILAW_VALUE_NUMBER || argument->number != (*values)[node_index];
      argument->kind = ILAW_VALUE_NUMBER;
      argument->number = (*values)[node_index];
    }
    return changed;
  }

  // The parameter that a law's message names first, or null: laws put names in quotes.
  const ilaw_argument* named_in(const std::string& message) const {
    const ilaw_argument* named = nullptr;
    std::size_t first = std::string::npos;
    for (const ilaw_argument& argument : arguments_)
      if (const std::size_t at = message.find("'" + std::string(argument.name) + "'"); at < first) {
        first = at;
        named = &argument;
      }
    return named;
  }

  std::string pointer_to(const ilaw_argument* named, std::optional<std::size_t> node_index) const {
    if (!named) return "";
    std::string pointer = "/" + std::string(named->name);
    for (const auto& [argument, values] : per_node_)
      if (argument == named) pointer += "/per_node" + (node_index ? "/" + std::to_string(*node_index) : "");
    return named->kind == ILAW_VALUE_TABLE ? pointer + "/table" : pointer;
  }

 private:
  static bool has_field(const ilaw_law* law, const std::string& name) {
    constexpr ilaw_parameter_flags field = ILAW_PARAMETER_IS_FIELD | ILAW_PARAMETER_ALLOWS_PER_NODE;
    for (std::uint32_t k = 0; law && k < law->parameter_count; ++k)
      if (name == law->parameters[k]->name) return (law->parameters[k]->flags & field) == field;
    return false;
  }

  ilaw_argument& add(std::uint32_t kind, const std::string& name) {
    ilaw_argument& argument = arguments_.emplace_back();
    argument = {};
    argument.struct_size = sizeof argument;
    argument.kind = kind;
    argument.name = name.c_str();
    return argument;
  }

  void add_table(const std::string& name, const ArgumentTable& table) {
    std::vector<const ilaw_axis*>& pointers = axis_pointers_.emplace_back();
    for (const ArgumentTable::Axis& axis : table.axes) {
      axes_.push_back({sizeof(ilaw_axis), 0, axis.name.c_str(), axis.points.data(), axis.points.size()});
      pointers.push_back(&axes_.back());
    }
    ilaw_argument& argument = add(ILAW_VALUE_TABLE, name);
    argument.values = table.values.data();
    argument.axes = pointers.data();
    argument.axis_count = static_cast<std::uint32_t>(pointers.size());
  }

  std::deque<ilaw_axis> axes_;
  std::deque<std::vector<const ilaw_axis*>> axis_pointers_;
  std::deque<ilaw_argument> arguments_;
  std::vector<std::pair<ilaw_argument*, const std::vector<double>*>> per_node_;
  std::vector<const ilaw_argument*> pointers_;
};

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

ilaw::interface create_law(const std::string& law, const Arguments& given, ilaw_setup setup,
                           const ilaw::library& library) {
  ArgumentList arguments(given, library.law(law));
  setup.arguments = arguments.pointers().data();
  setup.argument_count = static_cast<std::uint32_t>(arguments.pointers().size());
  std::optional<std::size_t> node_index;
  try {
    ilaw::interface created(library, law, setup);
    // Values per node reach the law with the first batch only. Whether it allows those of a node
    // together is found now, by an instance for that node alone; neighbours are often alike.
    for (node_index = 0; *node_index < arguments.node_count(); ++*node_index)
      if (arguments.take_node(*node_index)) try_create(created.law(), setup);
    return created;
  } catch (const ilaw::error& refusal) {
    if (refusal.code() != ILAW_INVALID_PARAMETER) throw;
    const ilaw_argument* named = arguments.named_in(refusal.what());
    const std::string text = refusal.what() + (named ? meant_by(named->name, library.law(law)) : "");
    throw ParameterError({refusal.code(), text}, arguments.pointer_to(named, node_index), node_index);
  }
}

ilaw::interface create_law(const std::string& law, const Arguments& given, const Vector& tangent,
                           const ilaw::library& library, int dimension) {
  ilaw_setup setup{};
  setup.struct_size = sizeof setup;
  setup.dimension = static_cast<std::uint32_t>(dimension);
  setup.delassus_form = ILAW_DELASSUS_SCALAR;
  setup.frame = ILAW_FRAME_GLOBAL;
  setup.numbers = ILAW_NUMBERS_DOUBLE;
  setup.has_tangent = tangent.size() > 0 ? 1 : 0;
  return create_law(law, given, setup, library);
}

}  // namespace ilaw::host
