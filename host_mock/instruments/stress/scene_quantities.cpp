// SPDX-License-Identifier: BSD-3-Clause
#include "stress/scene_quantities.hpp"

#include <algorithm>
#include <set>

namespace ilaw::host {
namespace {

using nlohmann::json;
using enum Quantity::Form;

// Powers of mass, length and time.
constexpr Quantity quantities[] = {
    {"/model/dimension", neutral},
    {"/model/points/*/mass", scalar, 1},
    {"/model/points/*/position", place, 0, 1},
    {"/model/points/*/velocity", vector, 0, 1, -1},
    {"/model/points/*/area", scalar, 0, 2},
    {"/model/points/*/stiffness", each, 1, 0, -2},
    {"/model/mass", scalar, 1},
    {"/model/stiffness", scalar, 1, 0, -2},
    {"/model/length", scalar, 0, 1},
    {"/model/area", scalar, 0, 2},
    {"/model/position", vector, 0, 1},  // from the pivot
    {"/model/velocity", vector, 0, 1, -1},
    {"/model/bars/*/start", place, 0, 1},
    {"/model/bars/*/length", scalar, 0, 1},
    {"/model/bars/*/elements", neutral},
    {"/model/bars/*/young", scalar, 1, -1, -2},
    {"/model/bars/*/density", scalar, 1, -3},
    {"/model/bars/*/section", scalar, 0, 2},
    {"/model/bars/*/velocity", vector, 0, 1, -1},
    {"/model/blocks/*/corner", place, 0, 1},
    {"/model/blocks/*/size", each, 0, 1},
    {"/model/blocks/*/elements", neutral},
    {"/model/blocks/*/velocity", vector, 0, 1, -1},
    {"/model/blocks/*/material/young", scalar, 1, -1, -2},
    {"/model/blocks/*/material/poisson", neutral},
    {"/model/blocks/*/material/density", scalar, 1, -3},
    {"/sets/*/box", place, 0, 1},
    {"/sets/*/near", place, 0, 1},
    {"/springs/*/nodes", neutral},
    {"/springs/*/to", neutral},
    {"/springs/*/anchor", place, 0, 1},
    {"/springs/*/stiffness", scalar, 1, 0, -2},
    {"/springs/*/damping", scalar, 1, 0, -1},
    {"/springs/*/length", scalar, 0, 1},
    {"/prestress/ramp", scalar, 0, 0, 1},
    {"/prestress/tolerance", neutral},
    {"/prestress/steps", neutral},
    {"/time/dt", scalar, 0, 0, 1},
    {"/time/end", scalar, 0, 0, 1},
    {"/time/cfl", neutral},
    {"/loads/*/nodes", neutral},
    {"/loads/*/nodes/box", place, 0, 1},
    {"/loads/*/axes", axes},
    {"/loads/*/acceleration", vector, 0, 1, -2},
    {"/loads/*/direction", vector},
    {"/loads/*/impulse", vector, 1, 1, -1},
    {"/loads/*/time", instant, 0, 0, 1},
    {"/loads/*/velocity", vector, 0, 1, -1},
    {"/loads/*/rate", scalar, 0, 0, -1},
    {"/interfaces/*/nodes", neutral},
    {"/interfaces/*/nodes/box", place, 0, 1},
    {"/interfaces/*/against/nodes", neutral},
    {"/interfaces/*/against/normal", vector},
    {"/interfaces/*/obstacle/point", place, 0, 1},
    {"/interfaces/*/obstacle/center", place, 0, 1},
    {"/interfaces/*/obstacle/normal", vector},
    {"/interfaces/*/obstacle/axis", vector},
    {"/interfaces/*/obstacle/radius", scalar, 0, 1},
    {"/interfaces/*/obstacle/velocity", vector, 0, 1, -1},
    {"/interfaces/*/obstacle/rate", spin, 0, 0, -1},
    {"/interfaces/*/obstacle/tilt/axis", vector},
};

// Rows [time, ...] of a curve.
constexpr Quantity curves[] = {
    {"/loads/*/path", vector, 0, 1},
    {"/interfaces/*/obstacle/path", vector, 0, 1},
    {"/interfaces/*/obstacle/angles", spin},
    {"/interfaces/*/obstacle/tilt/angles", spin},
};
// The rows of a load by its type.
constexpr Quantity histories[] = {
    {"force", scalar, 1, 1, -2}, {"gravity", scalar}, {"damping", scalar}, {"pressure", scalar, 1, -1, -2}};

constexpr Quantity time_of_row = {"time", instant, 0, 0, 1};

template <std::size_t N>
const Quantity* find(const Quantity (&known)[N], const std::string& pattern) {
  const auto found = std::find_if(std::begin(known), std::end(known),
                                  [&](const Quantity& one) { return one.pattern == pattern; });
  return found == std::end(known) ? nullptr : found;
}

bool is_text(const json& value) { return value.is_string() || value.is_boolean() || value.is_null(); }

class Walk {
 public:
  explicit Walk(const std::function<void(const Quantity&, json&)>& visit) : visit_(visit) {}

  bool operator()(json& value, const std::string& pattern, const json& parent) {
    if (pattern == "/interfaces/*/parameters" || is_text(value)) return true;
    if (const Quantity* curve = curve_of(pattern, parent)) return rows(value, *curve);
    const Quantity* const quantity = find(quantities, pattern);
    if (quantity && !value.is_object()) return give(*quantity, value);
    if (value.is_object()) {
      bool all = true;
      for (auto item = value.begin(); item != value.end(); ++item)
        all = (*this)(item.value(), pattern + "/" + (pattern == "/sets" ? "*" : item.key()), value) && all;
      return all;
    }
    return value.is_array() && std::all_of(value.begin(), value.end(),
                                           [&](json& one) { return (*this)(one, pattern + "/*", value); });
  }

 private:
  static const Quantity* curve_of(const std::string& pattern, const json& parent) {
    if (pattern == "/loads/*/history") return find(histories, parent["type"].get<std::string>());
    return find(curves, pattern);
  }

  // A list of vectors is given vector by vector.
  bool give(const Quantity& quantity, json& value) {
    if (value.is_array() && !value.empty() && value[0].is_array()) {
      for (json& one : value) visit_(quantity, one);
      return true;
    }
    visit_(quantity, value);
    return true;
  }

  bool rows(json& value, const Quantity& quantity) {
    if (value.is_object()) return value.contains("rows") && rows(value["rows"], quantity);
    for (json& row : value) {
      visit_(time_of_row, row[0]);
      json rest = json::array();
      for (std::size_t k = 1; k < row.size(); ++k) rest.push_back(row[k]);
      visit_(quantity, rest);
      for (std::size_t k = 1; k < row.size(); ++k) row[k] = rest[k - 1];
    }
    return true;
  }

  const std::function<void(const Quantity&, json&)>& visit_;
};

}  // namespace

bool for_each_quantity(json& scene, const std::function<void(const Quantity&, json&)>& visit) {
  static const std::set<std::string> told = {"title",  "doc",   "units",    "output",
                                             "expect", "exact", "converge", "study"};
  bool all = true;
  for (auto item = scene.begin(); item != scene.end(); ++item)
    if (!told.contains(item.key())) all = Walk(visit)(item.value(), "/" + item.key(), scene) && all;
  return all;
}

}  // namespace ilaw::host
