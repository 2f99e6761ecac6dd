// SPDX-License-Identifier: BSD-3-Clause
#include "arguments.hpp"

#include "validation.hpp"

#include <cmath>
#include <deque>

namespace ilaw::host {
namespace {

using nlohmann::json;

std::string at(const std::string& pointer, std::size_t index) {
  return pointer + "/" + std::to_string(index);
}

// JSON has no infinity: "inf" stands for it.
bool is_infinity(const json& value) { return value.is_string() && value.get<std::string>() == "inf"; }

double read_number(const json& value, const std::string& pointer) {
  if (is_infinity(value)) return INFINITY;
  if (!value.is_number())
    throw SceneError(pointer, "found " + value.dump() + ", expected a number or \"inf\"");
  return value.get<double>();
}

void read_varying(const json& value, const std::string& name, std::size_t node_count, Arguments& arguments,
                  const std::string& pointer) {
  if (value.size() != 1 || !(value.contains("table") || value.contains("per_node")))
    throw SceneError(pointer, "found " + value.dump() + ", expected a number, \"inf\", a choice, " +
                                  "{\"table\": [[time, value], ...]} or {\"per_node\": [value, ...]}");
  const std::string key = value.begin().key();
  const json& rows = value[key];
  const std::string where = pointer + "/" + key;
  if (!rows.is_array()) throw SceneError(where, "found " + rows.dump() + ", expected an array");
  if (rows.empty()) throw SceneError(where, "found [], expected at least one entry");
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (key == "per_node") {
      arguments.per_node[name].push_back(read_number(rows[k], at(where, k)));
      continue;
    }
    if (!rows[k].is_array() || rows[k].size() != 2)
      throw SceneError(at(where, k), "found " + rows[k].dump() + ", expected [time, value]");
    for (std::size_t i = 0; i < 2; ++i)
      arguments.tables[name].push_back(read_number(rows[k][i], at(at(where, k), i)));
  }
  if (key == "per_node" && rows.size() != node_count)
    throw SceneError(where, "found " + std::to_string(rows.size()) + " values, expected " +
                                std::to_string(node_count) + ", one per node of the interface");
}

// The arguments of create, with the pointers that it wants; deque keeps addresses while growing.
class ArgumentList {
 public:
  explicit ArgumentList(const Arguments& given) {
    for (const auto& [name, value] : given.numbers) add(ILAW_VALUE_NUMBER, name).number = value;
    for (const auto& [name, text] : given.texts) add(ILAW_VALUE_TEXT, name).text = text.c_str();
    for (const auto& [name, pairs] : given.tables) {
      ilaw_argument& argument = add(ILAW_VALUE_TABLE, name);
      argument.values = pairs.data();
      argument.count = pairs.size() / 2;
    }
    for (const auto& [name, values] : given.per_node)
      per_node_.emplace_back(&add(ILAW_VALUE_PER_NODE, name), &values);
    for (const ilaw_argument& argument : arguments_) pointers_.push_back(&argument);
  }

  const std::vector<const ilaw_argument*>& pointers() const { return pointers_; }
  std::size_t node_count() const { return per_node_.empty() ? 0 : per_node_.front().second->size(); }

  // From now on the values of one node stand for those per node. Returns whether this changed any.
  bool take_node(std::size_t place) {
    bool changed = false;
    for (const auto& [argument, values] : per_node_) {
      changed |= argument->kind != ILAW_VALUE_NUMBER || argument->number != (*values)[place];
      argument->kind = ILAW_VALUE_NUMBER;
      argument->number = (*values)[place];
    }
    return changed;
  }

  // Of the parameter that a law's message names first: laws put names in quotes.
  std::string pointer_from(const std::string& message, std::optional<std::size_t> place) const {
    const ilaw_argument* named = nullptr;
    std::size_t first = std::string::npos;
    for (const ilaw_argument& argument : arguments_)
      if (const std::size_t at = message.find("'" + std::string(argument.name) + "'"); at < first) {
        first = at;
        named = &argument;
      }
    if (!named) return "";
    std::string pointer = "/" + std::string(named->name);
    for (const auto& [argument, values] : per_node_)
      if (argument == named) pointer += "/per_node" + (place ? "/" + std::to_string(*place) : "");
    return named->kind == ILAW_VALUE_TABLE ? pointer + "/table" : pointer;
  }

 private:
  ilaw_argument& add(std::uint32_t kind, const std::string& name) {
    ilaw_argument& argument = arguments_.emplace_back();
    argument = {};
    argument.struct_size = sizeof argument;
    argument.kind = kind;
    argument.name = name.c_str();
    return argument;
  }

  std::deque<ilaw_argument> arguments_;
  std::vector<std::pair<ilaw_argument*, const std::vector<double>*>> per_node_;
  std::vector<const ilaw_argument*> pointers_;
};

// Straight through the law: the loader, which checks every instance, has seen one.
void try_create(const ilaw_law& law, const ilaw_setup& setup) {
  char message[1024];
  ilaw_instance* made = nullptr;
  const std::int32_t code = law.create(&setup, &made, message, sizeof message);
  if (code != ILAW_OK) throw ilaw::error(code, message);
  law.destroy(made);
}

}  // namespace

Arguments read_arguments(const json& parameters, std::size_t node_count, const std::string& pointer) {
  Arguments arguments;
  for (const auto& [name, value] : parameters.items()) {
    if (value.is_object())
      read_varying(value, name, node_count, arguments, pointer + "/" + name);
    else if (value.is_string() && !is_infinity(value))
      arguments.texts[name] = value.get<std::string>();
    else
      arguments.numbers[name] = read_number(value, pointer + "/" + name);
  }
  return arguments;
}

ilaw::interface create_law(const std::string& law, const Arguments& given, const Vector& tangent,
                           const ilaw::library& library, int dimension) {
  ArgumentList arguments(given);
  ilaw_setup setup{};
  setup.struct_size = sizeof setup;
  setup.dimension = static_cast<std::uint32_t>(dimension);
  setup.delassus_form = ILAW_DELASSUS_SCALAR;
  setup.frame = ILAW_FRAME_GLOBAL;
  setup.tangent_given = tangent.size() > 0 ? 1 : 0;
  setup.arguments = arguments.pointers().data();
  setup.argument_count = static_cast<std::uint32_t>(arguments.pointers().size());
  std::optional<std::size_t> place;
  try {
    ilaw::interface created(library, law, setup);
    // Values per node reach the law with the first batch only. Whether it allows those of a node together is
    // found now, by an instance for that node alone; neighbours are often alike.
    for (place = 0; *place < arguments.node_count(); ++*place)
      if (arguments.take_node(*place)) try_create(created.law(), setup);
    return created;
  } catch (const ilaw::error& refusal) {
    if (refusal.code() != ILAW_INVALID_PARAMETER) throw;
    throw ParameterError(refusal, arguments.pointer_from(refusal.what(), place), place);
  }
}

}  // namespace ilaw::host
