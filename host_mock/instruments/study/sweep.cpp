// SPDX-License-Identifier: BSD-3-Clause
#include "study/sweep.hpp"

#include "scene/json_text.hpp"

#include <cmath>
#include <string>

namespace ilaw::host {
namespace {

using nlohmann::json;

void refine_mesh(json& model, double by) {
  const auto scaled = [by](int count) { return static_cast<int>(std::lround(count * by)); };
  for (const char* bodies : {"bars", "blocks"}) {
    if (!model.contains(bodies)) continue;
    for (json& body : model[bodies]) {
      json& elements = body["elements"];
      if (elements.is_number())
        elements = scaled(elements.get<int>());
      else
        for (json& along : elements) along = scaled(along.get<int>());
    }
  }
}

[[noreturn]] void refuse_number(const std::string& pointer, const json& found) {
  throw mistake(pointer, found.dump(), "a set, a box or near: on a refined mesh a number is another node");
}

void refuse_numbers_in(const json& part, const std::string& pointer) {
  if (!part.is_structured()) return;
  for (const auto& [key, value] : part.items()) {
    const std::string inner = pointer + "/" + key;
    if (key == "per_node") refuse_number(inner, value);
    const bool names_nodes = key == "nodes" || key == "watch" || key == "to" || pointer == "/sets";
    if (names_nodes && value.is_array())
      for (std::size_t i = 0; i < value.size(); ++i)
        if (value[i].is_number()) refuse_number(at(inner, i), value[i]);
    refuse_numbers_in(value, inner);
  }
}

}  // namespace

Sweep read_sweep(const json& given) {
  return {given.value("levels", 5), given.value("factor", 2.0), given.value("first", 1.0),
          given.value("refine", "time") == "mesh"};
}

json refined(const json& source, const Sweep& sweep, double by) {
  json scene = source;
  json& time = scene["time"];
  if (sweep.with_mesh) refine_mesh(scene["model"], by);
  // With cfl the time step follows the mesh.
  const bool follows = sweep.with_mesh && time.contains("cfl");
  const char* key = time.contains("dt") ? "dt" : "cfl";
  if (!follows) time[key] = time[key].get<double>() / by;
  return scene;
}

void check_mesh(const json& source, const Sweep& sweep, const std::string& pointer) {
  if (!sweep.with_mesh) return;
  const json& model = source["model"];
  if (model.contains("meshes"))
    throw mistake(pointer + "/refine", "\"mesh\"", "\"time\": a mesh from a file cannot be refined");
  if (!model.contains("bars") && !model.contains("blocks"))
    throw mistake(pointer + "/refine", "\"mesh\"", "\"time\": the model has no mesh");
  refuse_numbers_in(source, "");
}

}  // namespace ilaw::host
