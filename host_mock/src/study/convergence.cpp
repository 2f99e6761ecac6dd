// SPDX-License-Identifier: BSD-3-Clause
#include "study/convergence.hpp"

#include "scene/json_text.hpp"

#include <cmath>
#include <cstdio>
#include <string>

namespace ilaw::host {
namespace {

using nlohmann::json;

// Multiplies element counts; says whether the model had any.
bool refine_mesh(json& model, double by) {
  const auto scaled = [by](int count) { return static_cast<int>(std::lround(count * by)); };
  bool refined = false;
  for (const char* bodies : {"bars", "blocks"}) {
    if (!model.contains(bodies)) continue;
    for (json& body : model[bodies]) {
      json& elements = body["elements"];
      if (elements.is_number())
        elements = scaled(elements.get<int>());
      else
        for (json& along : elements) along = scaled(along.get<int>());
      refined = true;
    }
  }
  return refined;
}

// Nodes are numbered anew on every mesh, so that the same number is another point.
[[noreturn]] void refuse_number(const std::string& pointer, const json& found) {
  throw mistake(pointer, found.dump(), "a set, a box or near: on a refined mesh a number is another node");
}

void refuse_node_numbers(const json& part, const std::string& pointer) {
  if (!part.is_structured()) return;
  for (const auto& [key, value] : part.items()) {
    const std::string inner = pointer + "/" + key;
    if (key == "per_node") refuse_number(inner, value);
    if ((key == "nodes" || key == "watch") && value.is_array())
      for (std::size_t i = 0; i < value.size(); ++i)
        if (value[i].is_number()) refuse_number(at(inner, i), value[i]);
    refuse_node_numbers(value, inner);
  }
}

// The scene of a level.
Scene scene_at(const json& source, const Sweep& sweep, int level, const std::filesystem::path& file) {
  json refined = source;
  const double by = std::pow(sweep.factor, level) / sweep.first;
  json& time = refined["time"];
  if (sweep.with_mesh && !refine_mesh(refined["model"], by))
    throw mistake("/converge/refine", "\"mesh\"", "\"time\": the model has no mesh");
  // With cfl the time step follows the mesh.
  const bool follows = sweep.with_mesh && time.contains("cfl");
  const char* key = time.contains("dt") ? "dt" : "cfl";
  if (!follows) time[key] = time[key].get<double>() / by;
  Scene scene = read_scene(refined, file);
  if (scene.output.watch.empty()) throw mistake("/output/watch", "no node", "those to compare");
  return scene;
}

}  // namespace

double ErrorTable::error(std::size_t run, std::size_t norm) const {
  const Errors& one = errors[run];
  return std::array{one.u_L2, one.u_max, one.v_L1, one.instant}[norm];
}

double ErrorTable::order(std::size_t norm) const {
  std::vector<double> steps, values;
  for (std::size_t k = 0; k < errors.size(); ++k) {
    steps.push_back(runs[k].dt);
    values.push_back(error(k, norm));
  }
  // Errors are relative but those of instants.
  const bool is_instant = norm + 1 == norms.size();
  return order_of(steps, values, is_instant ? runs[0].dt * static_cast<double>(runs[0].steps) : 1.0);
}

void check_sweep(const json& source, const Sweep& sweep, const std::filesystem::path& file) {
  exact_solution(scene_at(source, sweep, 0, file));
  if (sweep.with_mesh) refuse_node_numbers(source, "");
}

ErrorTable run_levels(const json& source, const Sweep& sweep, const std::filesystem::path& file) {
  ErrorTable table;
  for (int level = 0; level < sweep.levels; ++level) {
    Scene scene = scene_at(source, sweep, level, file);
    const std::vector<ExactNode> exact = exact_solution(scene);
    table.runs.push_back(trace_of(scene));
    table.exact = !exact.empty();
    if (table.exact) table.errors.push_back(errors_against(exact, table.runs.back()));
    std::fprintf(stderr, "level %d of %d: %lld steps of %g in %.2g s\n", level + 1, sweep.levels,
                 static_cast<long long>(scene.steps), scene.dt, table.runs.back().seconds);
  }
  for (std::size_t k = 0; !table.exact && k + 1 < table.runs.size(); ++k)
    table.errors.push_back(errors_against(table.runs.back(), table.runs[k]));
  return table;
}

}  // namespace ilaw::host
