// SPDX-License-Identifier: BSD-3-Clause
#include "scene/arguments.hpp"

#include "scene/json_text.hpp"

#include <cmath>

namespace ilaw::host {
namespace {

using nlohmann::json;

// JSON has no infinity: "inf" stands for it.
bool is_infinity(const json& value) { return value.is_string() && value.get<std::string>() == "inf"; }

double read_number(const json& value, const std::string& pointer) {
  if (is_infinity(value)) return INFINITY;
  if (!value.is_number()) throw mistake(pointer, value.dump(), "a number or \"inf\"");
  return value.get<double>();
}

void read_varying(const json& value, const std::string& name, std::size_t node_count, Arguments& arguments,
                  const std::string& pointer) {
  if (value.size() != 1 || !(value.contains("table") || value.contains("per_node")))
    throw mistake(
        pointer, value.dump(),
        R"(a number, "inf", a choice, {"table": [[time, value], ...]} or {"per_node": [value, ...]})");
  const std::string key = value.begin().key();
  const json& rows = value[key];
  const std::string where = pointer + "/" + key;
  if (!rows.is_array()) throw mistake(where, rows.dump(), "an array");
  if (rows.empty()) throw mistake(where, "[]", "at least one entry");
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (key == "per_node") {
      arguments.per_node[name].push_back(read_number(rows[k], at(where, k)));
      continue;
    }
    if (!rows[k].is_array() || rows[k].size() != 2)
      throw mistake(at(where, k), rows[k].dump(), "[time, value]");
    for (std::size_t i = 0; i < 2; ++i)
      arguments.tables[name].push_back(read_number(rows[k][i], at(at(where, k), i)));
  }
  if (key == "per_node" && rows.size() != node_count)
    throw mistake(where, std::to_string(rows.size()) + " values",
                  std::to_string(node_count) + ", one per node of the interface");
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

}  // namespace ilaw::host
