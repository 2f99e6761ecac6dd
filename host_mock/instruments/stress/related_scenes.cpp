// SPDX-License-Identifier: BSD-3-Clause
#include "stress/related_scenes.hpp"

#include "check/units.hpp"
#include "stress/draw.hpp"
#include "stress/scene_quantities.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <string>

namespace ilaw::host {
namespace {

using nlohmann::json;
using Form = Quantity::Form;
using Made = std::optional<RelatedScene>;

bool is_of_points(const json& source) { return source["model"]["type"] == "points"; }

template <class Change>
void for_numbers(json& value, Change change) {
  if (value.is_number())
    value = change(value.get<double>());
  else
    for (json& component : value) component = change(component.get<double>());
}

// Gives a key to those bodies of a model that leave it out.
void give_default(json& source, const char* bodies, const char* key, const json& value) {
  if (!source["model"].contains(bodies)) return;
  for (json& body : source["model"][bodies])
    if (!body.contains(key)) body[key] = value;
}

// ---- more contacts, more points ----

// No node moves so far, whatever pushes it.
constexpr double beyond_reach = -1e100;

json out_of_reach(const Scene& read, const json& nodes, const std::string& name) {
  const int d = read.model->dimension();
  return {{"name", name},
          {"law", "contact"},
          {"nodes", nodes},
          {"obstacle",
           {{"type", "plane"},
            {"point", along_last_axis(d, beyond_reach)},
            {"normal", along_last_axis(d, 1.0)}}}};
}

// A node that two interfaces have is solved with others, even if one of them is out of reach.
Made bystander(const json& source, const Scene& read) {
  if (source["interfaces"].empty()) return {};
  RelatedScene made{source};
  made.source["interfaces"].push_back(out_of_reach(read, source["interfaces"][0]["nodes"], "out_of_reach"));
  return made;
}

json with_numbered_nodes(json source) {
  const std::size_t count = source["model"]["points"].size();
  json all = json::array();
  for (std::size_t k = 0; k < count; ++k) all.push_back(k);
  for (json& interface : source["interfaces"])
    if (interface["nodes"] == "all") interface["nodes"] = all;
  for (json& load : source["loads"])
    if (load.contains("nodes") && load["nodes"] == "all") load["nodes"] = all;
  return source;
}

Made bystander_elsewhere(const json& source, const Scene& read) {
  if (!is_of_points(source)) return {};
  RelatedScene made{with_numbered_nodes(source)};
  const json far = json::array({source["model"]["points"].size()});
  made.source["model"]["points"].push_back(
      {{"mass", 1.0}, {"position", along_last_axis(read.model->dimension(), 500.0)}});
  for (const char* name : {"out_of_reach", "out_of_reach_too"})
    made.source["interfaces"].push_back(out_of_reach(read, far, name));
  if (source.contains("fields"))
    for (json& values : made.source["fields"])
      if (values.is_array()) values.push_back(values.back());
  return made;
}

// All lists of nodes of a scene of points, of which each may be lengthened or renumbered; none if there are
// others than lists of numbers and "all".
std::optional<std::vector<json*>> lists_of_nodes(json& source) {
  std::vector<json*> lists;
  const auto add = [&](json& nodes) {
    if (!nodes.is_array()) return nodes == "all";
    lists.push_back(&nodes);
    return std::all_of(nodes.begin(), nodes.end(), [](const json& one) { return one.is_number(); });
  };
  bool all = is_of_points(source) && !source.contains("sets") && !source.contains("springs");
  for (json& interface : source["interfaces"]) {
    all = all && add(interface["nodes"]);
    if (interface.contains("against"))
      all = all && interface["against"].contains("nodes") && add(interface["against"]["nodes"]);
  }
  if (source.contains("loads"))
    for (json& load : source["loads"])
      if (load.contains("nodes")) all = all && add(load["nodes"]);
  return all ? std::optional(lists) : std::nullopt;
}

// Calls change for the values per node of each interface, and for the fields.
template <class Change>
void for_values_per_node(json& source, Change change) {
  for (json& interface : source["interfaces"])
    if (interface.contains("parameters"))
      for (json& value : interface["parameters"])
        if (value.is_object() && value.contains("per_node"))
          change(value["per_node"], interface["nodes"] == "all");
  if (source.contains("fields"))
    for (json& values : source["fields"])
      if (values.is_array()) change(values, true);
}

Made doubled(const json& source, const Scene&) {
  RelatedScene made{source};
  const auto lists = lists_of_nodes(made.source);
  if (!lists) return {};
  json& points = made.source["model"]["points"];
  const int count = static_cast<int>(points.size());
  for (int k = 0; k < count; ++k) points.push_back(points[static_cast<std::size_t>(k)]);
  for (json* list : *lists) {
    const json first = *list;
    for (const json& node : first) list->push_back(node.get<int>() + count);
  }
  for_values_per_node(made.source, [](json& values, bool) {
    const json first = values;
    values.insert(values.end(), first.begin(), first.end());
  });
  std::vector<int> copies(static_cast<std::size_t>(count));
  std::iota(copies.begin(), copies.end(), count);
  made.nodes.push_back(copies);
  return made;
}

Made reversed(const json& source, const Scene&) {
  RelatedScene made{source};
  const auto lists = lists_of_nodes(made.source);
  json& points = made.source["model"]["points"];
  if (!lists || points.size() < 2) return {};
  std::reverse(points.begin(), points.end());
  const int last = static_cast<int>(points.size()) - 1;
  for (json* list : *lists)
    for (json& node : *list) node = last - node.get<int>();
  for_values_per_node(made.source, [](json& values, bool is_by_point) {
    if (is_by_point) std::reverse(values.begin(), values.end());
  });
  made.nodes[0].resize(points.size());
  std::iota(made.nodes[0].rbegin(), made.nodes[0].rend(), 0);
  return made;
}

// ---- other axes and origins ----

// Axes of which bodies with meshes have names and orders of nodes.
bool has_any_axes(const json& source) {
  return is_of_points(source) || source["model"]["type"] == "rotating_spring";
}

Made in_axes(const json& source, RelatedScene made) {
  made.source = source;
  const auto [x, y, z] = made.axis;
  const double handed = 0.5 * (y - x) * (z - x) * (z - y) * made.sign[0] * made.sign[1] * made.sign[2];
  const bool all = for_each_quantity(made.source, [&](const Quantity& quantity, json& value) {
    if (quantity.form == Form::spin) for_numbers(value, [&](double angle) { return handed * angle; });
    if (quantity.form == Form::axes)
      for (json& axis : value) axis = made.axis[axis.get<std::size_t>()];
    if (quantity.form != Form::place && quantity.form != Form::vector && quantity.form != Form::each) return;
    if (!value.is_array()) return;
    const json before = value;
    for (std::size_t c = 0; c < before.size(); ++c)
      value[static_cast<std::size_t>(made.axis[c])] =
          (quantity.form == Form::each ? 1.0 : made.sign[c]) * before[c].get<double>();
  });
  return all && has_any_axes(source) ? Made(made) : std::nullopt;
}

// In 2D by a right angle, in 3D about the diagonal: no digit changes.
Made turned(const json& source, const Scene& read) {
  RelatedScene made;
  if (read.model->dimension() == 1) return {};
  made.axis = {1, 2, 0};
  if (read.model->dimension() == 2) {
    made.axis = {1, 0, 2};
    made.sign = {1.0, -1.0, 1.0};
  }
  return in_axes(source, made);
}

Made mirrored(const json& source, const Scene&) {
  RelatedScene made;
  made.sign = {-1.0, 1.0, 1.0};
  return in_axes(source, made);
}

Made moved(const json& source, const Scene& read) {
  if (source["model"]["type"] == "rotating_spring") return {};
  RelatedScene made{source};
  const double size = std::max(1e-3, read.model->position().cwiseAbs().maxCoeff());
  const double way = std::exp2(std::ceil(std::log2(size)));
  made.farthest = way;
  const bool all = for_each_quantity(made.source, [&](const Quantity& quantity, json& value) {
    if (quantity.form == Form::place) for_numbers(value, [&](double x) { return x + way; });
  });
  give_default(made.source, "bars", "start", way);
  give_default(made.source, "blocks", "corner", {way, way, way});
  return all && !source.contains("fields") ? Made(made) : std::nullopt;
}

// Tables of laws over time.
void shift_parameters(json& source, double by) {
  for (json& interface : source["interfaces"]) {
    if (!interface.contains("parameters")) continue;
    for (json& value : interface["parameters"]) {
      if (!value.is_object() || !value.contains("table")) continue;
      json& table = value["table"];
      if (table.is_array())
        for (json& row : table) row[0] = row[0].get<double>() + by;
      else
        for (json& axis : table["axes"])
          if (axis["name"] == "time")
            for (json& time : axis["points"]) time = time.get<double>() + by;
    }
  }
}

// A window of impulses may stand on a grid of times, as that of the kit does: its error depends on where in
// it a step falls.
bool keeps_history(const Scene& read) {
  return std::any_of(read.interfaces.begin(), read.interfaces.end(), [](const auto& interface) {
    const ilaw_instance_info& info = interface->info();
    const std::span variables(info.state_variables, info.state_variable_count);
    return std::any_of(variables.begin(), variables.end(), [](const ilaw_state_variable* variable) {
      return variable->kind == ILAW_KIND_HISTORY;
    });
  });
}

// A shock acts in the middle of its step, so that rounding of times moves it to no other one. An obstacle
// with a velocity has its place at time 0.
Made later(const json& source, const Scene& read) {
  if (source.contains("prestress") || keeps_history(read)) return {};
  RelatedScene made{source};
  constexpr double steps = 64.0;
  const double dt = read.dt, begin = made.begin = steps * dt;
  for (json& interface : made.source["interfaces"]) {
    json obstacle = interface.value("obstacle", json::object());
    if (!obstacle.contains("velocity")) continue;
    json& place = interface["obstacle"][obstacle.contains("center") ? "center" : "point"];
    for (std::size_t c = 0; c < place.size(); ++c) {
      const double way = begin * obstacle["velocity"][c].get<double>();
      place[c] = place[c].get<double>() - way;
      made.farthest = std::max(made.farthest, std::abs(way));
    }
  }
  const bool all = for_each_quantity(made.source, [&](const Quantity& quantity, json& value) {
    if (quantity.form != Form::instant) return;
    const bool is_shock = quantity.pattern == "/loads/*/time";
    const double time = value.get<double>();
    value = is_shock ? (steps + std::ceil(time / dt - 1e-6) - 0.5) * dt : time + begin;
  });
  shift_parameters(made.source, begin);
  return all ? Made(made) : std::nullopt;
}

// ---- other units ----

double number_of(const ilaw_parameter& parameter, const json& given) {
  if (!given.contains(parameter.name)) return parameter.default_value;
  const json& value = given[parameter.name];
  return value.is_number() ? value.get<double>() : std::numeric_limits<double>::infinity();
}

// Numbers alone: what a table or values per node measure, a scene does not say.
bool scale_parameters(json& given, const ilaw_law& law, const check::Units& units) {
  std::vector<std::string> symbols;
  std::map<std::string, double> numbers;
  for (std::uint32_t k = 0; k < law.parameter_count; ++k) {
    const ilaw_parameter& parameter = *law.parameters[k];
    symbols.emplace_back(parameter.symbol);
    numbers[parameter.symbol] = number_of(parameter, given);
  }
  for (std::uint32_t k = 0; k < law.parameter_count; ++k) {
    const ilaw_parameter& parameter = *law.parameters[k];
    if (parameter.kind == ILAW_KIND_CHOICE) continue;
    if (given.contains(parameter.name) && given[parameter.name].is_object()) return false;
    const auto unit = check::parse_unit(parameter.unit, symbols);
    if (!unit) return false;
    const double value = number_of(parameter, given), factor = unit->in(units, numbers);
    if (factor == 1.0 || !std::isfinite(value) || value == 0.0) continue;
    given[parameter.name] = value * factor;
    if (!(value * factor >= parameter.minimum && value * factor <= parameter.maximum)) return false;
  }
  return true;
}

Made in_other_units(const json& source, const Scene& read) {
  constexpr check::Units units{0x1p+10, 0x1p-6, 0x1p+4};
  RelatedScene made{source};
  made.length = units.length;
  made.time = units.time;
  bool all = !source.contains("fields") && !read.model->thermal();
  all = all && for_each_quantity(made.source, [&](const Quantity& quantity, json& value) {
          const double factor = std::pow(units.mass, quantity.mass) *
                                std::pow(units.length, quantity.length) * std::pow(units.time, quantity.time);
          if (factor != 1.0) for_numbers(value, [&](double number) { return factor * number; });
        });
  give_default(made.source, "points", "area", units.length * units.length);
  give_default(made.source, "bars", "section", units.length * units.length);
  if (source["model"]["type"] == "rotating_spring" && !source["model"].contains("area"))
    made.source["model"]["area"] = units.length * units.length;
  for (std::size_t i = 0; all && i < source["interfaces"].size(); ++i) {
    json& parameters = made.source["interfaces"][i]["parameters"];
    if (parameters.is_null()) parameters = json::object();
    all = scale_parameters(parameters, *read.interfaces[i]->library().law(read.interfaces[i]->setup().law),
                           units);
  }
  return all ? Made(made) : std::nullopt;
}

// ---- parameters in other forms ----

// Each number that the law takes so is given as form makes it.
template <class Form>
Made with_parameters(const json& source, const Scene& read, Form form) {
  RelatedScene made{source};
  // Of constants a law sees that two directions are alike.
  made.excuse = "tell the two tangential axes apart: expected a tangent";
  bool some = false;
  for (std::size_t i = 0; i < source["interfaces"].size(); ++i) {
    const Interface& interface = *read.interfaces[i];
    const ilaw_law& law = *interface.library().law(interface.setup().law);
    json& given = made.source["interfaces"][i]["parameters"];
    for (std::uint32_t k = 0; k < law.parameter_count; ++k) {
      if (!given.is_object() || !given.contains(law.parameters[k]->name)) continue;
      json& value = given[law.parameters[k]->name];
      const json other = value.is_number() ? form(*law.parameters[k], value, interface) : json();
      some = some || !other.is_null();
      if (!other.is_null()) value = other;
    }
    if (given.is_null()) made.source["interfaces"][i].erase("parameters");
  }
  return some ? Made(made) : std::nullopt;
}

Made as_tables(const json& source, const Scene& read) {
  return with_parameters(source, read, [&](const ilaw_parameter& parameter, const json& value, const auto&) {
    const auto* const end = parameter.axes + parameter.axis_count;
    const auto is_time = [](const char* axis) { return std::string(axis) == "time"; };
    if (!parameter.axes || std::find_if(parameter.axes, end, is_time) == end) return json();
    return json{{"table", {{0.0, value}, {read.dt, value}}}};
  });
}

Made per_node(const json& source, const Scene& read) {
  return with_parameters(
      source, read, [](const ilaw_parameter& parameter, const json& value, const Interface& interface) {
        if (!(parameter.flags & ILAW_FLAG_ALLOWS_PER_NODE)) return json();
        return json{{"per_node", std::vector<double>(interface.nodes().size(), value.get<double>())}};
      });
}

constexpr Relation all_relations[] = {
    {"with a contact out of reach at the same nodes", true, bystander},
    {"with contacts out of reach at a point elsewhere", true, bystander_elsewhere},
    {"twice", false, doubled},
    {"in reverse order", false, reversed},
    {"turned", false, turned},
    {"mirrored", false, mirrored},
    {"moved in space", true, moved},
    {"later", true, later},
    {"in other units", false, in_other_units},
    {"with parameters as tables", false, as_tables},
    {"with parameters per node", false, per_node},
};

}  // namespace

std::span<const Relation> relations() { return all_relations; }

json nudged(json source, double farthest, std::uint64_t seed) {
  const double off = (seed % 2 == 0 ? 40.0 : 2.0) * 0x1p-52;  // the host closes gaps of 16
  give_default(source, "bars", "start", 0.0);
  give_default(source, "blocks", "corner", {0.0, 0.0, 0.0});
  Draw draw(seed);
  for_each_quantity(source, [&](const Quantity& quantity, json& value) {
    const bool moves = quantity.pattern.starts_with("/model/") || quantity.pattern.starts_with("/loads/");
    const bool is_place = quantity.form == Form::place, is_radius = quantity.pattern.ends_with("/radius");
    const bool is_size = quantity.form == Form::vector || quantity.mass != 0.0;
    if (!is_radius && !(moves && (is_place || is_size))) return;
    for_numbers(value, [&](double old) {
      const double size = is_place && farthest > 0.0 ? farthest : std::abs(old);
      return draw.chance(0.5) ? old + off * size : old - off * size;
    });
  });
  return source;
}

}  // namespace ilaw::host
