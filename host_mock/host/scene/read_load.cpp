// SPDX-License-Identifier: BSD-3-Clause
#include "scene/readers.hpp"

#include "model/bulk_viscosity.hpp"
#include "model/load.hpp"
#include "model/pressure.hpp"
#include "scene/json_text.hpp"
#include "scene/values.hpp"

#include <numeric>
#include <vector>

namespace ilaw::host {
namespace {

using nlohmann::json;

// Part of a total force for each node, by tributary area.
std::vector<double> shares_of(const NodeSet& set, const std::string& pointer) {
  const double sum = std::accumulate(set.areas.begin(), set.areas.end(), 0.0);
  if (!(sum > 0.0)) throw SceneError(pointer, "the nodes have no area to share a total force by");
  std::vector<double> shares = set.areas;
  for (double& share : shares) share /= sum;
  return shares;
}

std::vector<double> masses_of(const std::vector<int>& nodes, const Model& model) {
  std::vector<double> masses;
  masses.reserve(nodes.size());
  for (const int node : nodes) masses.push_back(model.mass()[Eigen::Index{node} * model.dimension()]);
  return masses;
}

// A factor over time; 1 where none is given.
Table read_factor(const json& load, const std::string& pointer) {
  if (!load.contains("history")) return {{0.0}, {Vector::Ones(1)}};
  return read_table(load["history"], 1, pointer + "/history");
}

// A negative rate would drive the motion.
std::unique_ptr<Load> read_damping(const json& load, const Model& model, const NodeSet& set,
                                   const std::string& pointer) {
  const std::string key = pointer + "/history";
  const json history = load.value("history", json::array());
  if (history.contains("sine")) throw mistake(key, "a sine", "rows: a rate is not negative");
  for (const json& row : history.is_object() ? history["rows"] : history)
    if (row.size() == 2 && row[1].get<double>() < 0.0)
      throw mistake(key, row.dump(), "factors of at least 0");
  return std::make_unique<Damping>(model, set.nodes, load["rate"].get<double>(), read_factor(load, pointer));
}

std::unique_ptr<Load> read_prescribed(const json& load, const Model& model, const NodeSet& set,
                                      const std::string& pointer) {
  const int d = model.dimension();
  std::vector<int> axes(static_cast<std::size_t>(d));
  std::iota(axes.begin(), axes.end(), 0);
  if (load.contains("axes")) axes = load["axes"].get<std::vector<int>>();
  for (const int axis : axes)
    if (axis >= d)
      throw mistake(pointer + "/axes", "axis " + std::to_string(axis), "0 to " + std::to_string(d - 1));
  return std::make_unique<PrescribedMotion>(model, set.nodes, axes, read_motion(load, d, pointer));
}

std::unique_ptr<Load> read_bulk_viscosity(const json& load, const Model& model, const std::string& pointer) {
  if (model.volume_elements().empty())
    throw SceneError(pointer, "this model has no elements whose volume could change");
  return std::make_unique<BulkViscosity>(model, load.value("linear", 0.06), load.value("quadratic", 1.2));
}

std::unique_ptr<Load> read_pressure(const json& load, const Model& model, const std::string& pointer) {
  return std::make_unique<Pressure>(
      model, select_surface(load["surface"].get<std::string>(), model, pointer + "/surface").facets,
      read_table(load["history"], 1, pointer + "/history"));
}

std::unique_ptr<Load> read_heat_load(const json& load, const Model& model, const NodeSet& set,
                                     const std::string& pointer) {
  require_temperatures(set.nodes, model, pointer + "/nodes");
  return std::make_unique<HeatLoad>(
      load["type"] == "temperature" ? HeatLoad::Kind::temperature : HeatLoad::Kind::flux, set,
      read_table(load["history"], 1, pointer + "/history"));
}

}  // namespace

std::unique_ptr<Load> read_load(const json& load, const Model& model, const std::string& pointer) {
  const int d = model.dimension();
  const std::string type = load["type"].get<std::string>();
  if (type == "bulk_viscosity") return read_bulk_viscosity(load, model, pointer);
  if (type == "pressure") return read_pressure(load, model, pointer);
  const NodeSet set = select_nodes(load.value("nodes", json("all")), model, pointer + "/nodes");
  if (type == "temperature" || type == "heat_flux") return read_heat_load(load, model, set, pointer);
  if (type == "gravity")
    return std::make_unique<Force>(set.nodes, masses_of(set.nodes, model),
                                   read_vector(load["acceleration"], d, pointer + "/acceleration"),
                                   read_factor(load, pointer));
  if (type == "force") {
    const std::vector<double> shares = load.value("total", false)
                                           ? shares_of(set, pointer + "/nodes")
                                           : std::vector<double>(set.nodes.size(), 1.0);
    return std::make_unique<Force>(set.nodes, shares,
                                   read_vector(load["direction"], d, pointer + "/direction"),
                                   read_table(load["history"], 1, pointer + "/history"));
  }
  if (type == "damping") return read_damping(load, model, set, pointer);
  if (type == "motion") return read_prescribed(load, model, set, pointer);
  const double time = load["time"].get<double>();
  if (time <= 0.0) throw mistake(pointer + "/time", load["time"].dump(), "a time > 0");
  return std::make_unique<Shock>(set.nodes, time, read_vector(load["impulse"], d, pointer + "/impulse"));
}

}  // namespace ilaw::host
