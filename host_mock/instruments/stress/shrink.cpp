// SPDX-License-Identifier: BSD-3-Clause
#include "stress/shrink.hpp"

#include "base/words.hpp"

#include <algorithm>
#include <cstdlib>
#include <initializer_list>
#include <iterator>
#include <set>
#include <utility>
#include <vector>

namespace ilaw::host {
namespace {

using nlohmann::json;

// A run of one step can be made shorter for ever.
constexpr double shortest = 1e-9;

double rounded(double value, int digits) {
  return std::strtod(formatted("%.*e", digits - 1, value).c_str(), nullptr);
}

// Leaves out halves of a list, quarters and so on to single entries. Loads name points by number: a scene
// that names one that is gone is refused.
void add_with_less_of(const json& scene, const json::json_pointer& list, std::vector<json>& made) {
  const std::size_t count = scene.contains(list) ? scene[list].size() : 0;
  for (std::size_t part = (count + 1) / 2; part > 0; part = part > 1 ? (part + 1) / 2 : 0)
    for (std::size_t from = 0; from < count; from += part) {
      made.push_back(scene);
      json& less = made.back()[list];
      less.erase(less.begin() + static_cast<std::ptrdiff_t>(from),
                 less.begin() + static_cast<std::ptrdiff_t>(std::min(count, from + part)));
    }
}

// Lists that name points by number, entry by entry, without those of some points, which are then counted
// anew.
void keep_of(std::initializer_list<json*> lists, const std::set<int>& removed) {
  const auto is_number = [](const json& one) { return one.is_number(); };
  for (const json* list : lists)
    if (!list->is_array() || !std::all_of(list->begin(), list->end(), is_number)) return;
  for (std::size_t k = (*lists.begin())->size(); k-- > 0;)
    if (std::any_of(lists.begin(), lists.end(),
                    [&](const json* list) { return removed.count((*list)[k].get<int>()) > 0; }))
      for (json* list : lists) list->erase(k);
  for (json* list : lists)
    for (json& number : *list)
      number = number.get<int>() -
               static_cast<int>(std::distance(removed.begin(), removed.lower_bound(number.get<int>())));
}

json without_points(json scene, const std::set<int>& removed) {
  for (auto point = removed.rbegin(); point != removed.rend(); ++point)
    scene["model"]["points"].erase(static_cast<std::size_t>(*point));
  for (json& interface : scene["interfaces"])
    if (interface.contains("against"))
      keep_of({&interface["nodes"], &interface["against"]["nodes"]}, removed);
    else
      keep_of({&interface["nodes"]}, removed);
  for (json& load : scene["loads"])
    if (load.contains("nodes")) keep_of({&load["nodes"]}, removed);
  if (scene.contains("springs"))
    for (json& spring : scene["springs"]) keep_of({&spring["nodes"], &spring["to"]}, removed);
  return scene;
}

// Keeps parts of the list of an interface between points, with the partners of their nodes.
void add_with_fewer_pairs(const json& scene, std::vector<json>& made) {
  const json::json_pointer partners("/interfaces/0/against/nodes");
  if (scene["model"]["type"] != "points" || !scene.contains(partners)) return;
  const auto nodes = scene["interfaces"][0]["nodes"].get<std::vector<int>>(),
             others = scene[partners].get<std::vector<int>>();
  for (std::size_t kept = nodes.size(); kept > 1;) {
    kept = (kept + 1) / 2;
    for (std::size_t from = 0; from < nodes.size(); from += kept) {
      const std::size_t end = std::min(nodes.size(), from + kept);
      std::set<int> removed(nodes.begin(), nodes.end());
      removed.insert(others.begin(), others.end());
      for (std::size_t k = from; k < end; ++k) {
        removed.erase(nodes[k]);
        removed.erase(others[k]);
      }
      made.push_back(without_points(scene, removed));
    }
  }
}

void add_with_fewer_parameters(const json& scene, std::vector<json>& made) {
  for (std::size_t i = 0; i < scene["interfaces"].size(); ++i)
    for (const auto& item : scene["interfaces"][i]["parameters"].items()) {
      made.push_back(scene);
      made.back()["interfaces"][i]["parameters"].erase(item.key());
    }
}

void add_with_rounder_numbers(const json& scene, std::vector<json>& made) {
  const json flat = scene.flatten();
  for (const auto& [pointer, value] : flat.items()) {
    if (!value.is_number_float()) continue;
    for (const double simpler : {0.0, 1.0, rounded(value, 1), rounded(value, 3)}) {
      if (simpler == value.get<double>()) break;
      made.push_back(scene);
      made.back()[json::json_pointer(pointer)] = simpler;
    }
  }
}

std::vector<json> simpler_than(const json& scene) {
  std::vector<json> made;
  const double end = scene["time"]["end"].get<double>();
  for (const double part : {0.01, 0.1, 0.5, 0.9}) {
    if (end * part < shortest) continue;
    made.push_back(scene);
    made.back()["time"]["end"] = end * part;
  }
  add_with_less_of(scene, json::json_pointer("/model/points"), made);
  add_with_fewer_pairs(scene, made);
  for (const char* list : {"/loads", "/interfaces"}) add_with_less_of(scene, json::json_pointer(list), made);
  add_with_fewer_parameters(scene, made);
  add_with_rounder_numbers(scene, made);
  return made;
}

}  // namespace

json shrink(json scene, const std::function<bool(const json&)>& fails, int most_tries) {
  int tries = 0;
  for (bool shrunk = true; shrunk;) {
    shrunk = false;
    for (json& simpler : simpler_than(scene)) {
      if (tries++ >= most_tries) return scene;
      if (!fails(simpler)) continue;
      scene = std::move(simpler);
      shrunk = true;
      break;
    }
  }
  return scene;
}

}  // namespace ilaw::host
