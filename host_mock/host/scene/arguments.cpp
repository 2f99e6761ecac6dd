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

// An array of at least one entry.
const json& entries(const json& value, const std::string& pointer) {
  if (!value.is_array()) throw mistake(pointer, value.dump(), "an array");
  if (value.empty()) throw mistake(pointer, "[]", "at least one entry");
  return value;
}

// [[time, value], ...]
ArgumentTable read_time_table(const json& rows, const std::string& pointer) {
  ArgumentTable table{{{"time", {}}}, {}};
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (!rows[k].is_array() || rows[k].size() != 2)
      throw mistake(at(pointer, k), rows[k].dump(), "[time, value]");
    table.axes[0].points.push_back(read_number(rows[k][0], at(at(pointer, k), 0)));
    table.values.push_back(read_number(rows[k][1], at(at(pointer, k), 1)));
  }
  return table;
}

// Nested arrays, one level per axis.
void read_grid(const json& value, std::size_t axis, ArgumentTable& table, const std::string& pointer) {
  if (axis == table.axes.size()) {
    table.values.push_back(read_number(value, pointer));
    return;
  }
  const std::size_t count = table.axes[axis].points.size();
  if (entries(value, pointer).size() != count)
    throw mistake(pointer, std::to_string(value.size()) + " entries",
                  std::to_string(count) + ", one per point of axis \"" + table.axes[axis].name + "\"");
  for (std::size_t k = 0; k < count; ++k) read_grid(value[k], axis + 1, table, at(pointer, k));
}

// {"axes": [{"name": ..., "points": [...]}, ...], "values": nested arrays}
ArgumentTable read_grid_table(const json& given, const std::string& pointer) {
  if (given.size() != 2 || !given.contains("axes") || !given.contains("values"))
    throw mistake(pointer, given.dump(), R"({"axes": [{"name": ..., "points": [...]}], "values": [...]})");
  ArgumentTable table;
  const json& axes = entries(given["axes"], pointer + "/axes");
  for (std::size_t a = 0; a < axes.size(); ++a) {
    const std::string where = at(pointer + "/axes", a);
    if (!axes[a].is_object() || axes[a].size() != 2 || !axes[a].contains("name") ||
        !axes[a]["name"].is_string() || !axes[a].contains("points"))
      throw mistake(where, axes[a].dump(), R"({"name": ..., "points": [...]})");
    ilaw::parameters::axis& axis = table.axes.emplace_back();
    axis.name = axes[a]["name"].get<std::string>();
    const json& points = entries(axes[a]["points"], where + "/points");
    for (std::size_t k = 0; k < points.size(); ++k)
      axis.points.push_back(read_number(points[k], at(where + "/points", k)));
  }
  read_grid(given["values"], 0, table, pointer + "/values");
  return table;
}

void read_varying(const json& value, const std::string& name, std::size_t node_count, Arguments& arguments,
                  const std::string& pointer) {
  if (value.size() != 1 || !(value.contains("table") || value.contains("per_node")))
    throw mistake(pointer, value.dump(),
                  R"(a number, "inf", a choice, {"table": [[time, value], ...]}, )"
                  R"({"table": {"axes": ..., "values": ...}} or {"per_node": [value, ...]})");
  const std::string key = value.begin().key();
  const json& rows = value[key];
  const std::string where = pointer + "/" + key;
  if (key == "table") {
    arguments.tables[name] =
        rows.is_object() ? read_grid_table(rows, where) : read_time_table(entries(rows, where), where);
    return;
  }
  if (entries(rows, where).size() != node_count)
    throw mistake(where, std::to_string(rows.size()) + " values",
                  std::to_string(node_count) + ", one per node of the interface");
  for (std::size_t k = 0; k < node_count; ++k)
    arguments.per_node[name].push_back(read_number(rows[k], at(where, k)));
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
