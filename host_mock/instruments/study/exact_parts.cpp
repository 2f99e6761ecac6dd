// SPDX-License-Identifier: BSD-3-Clause
#include "study/exact_parts.hpp"

#include "base/scene_error.hpp"

#include <algorithm>

namespace ilaw::host {

using nlohmann::json;

void require(bool good, const std::string& expected) {
  if (!good) throw SceneError("/exact", "expected " + expected);
}

OneBody one_body(const Scene& scene, const char* kind, const std::string& wanted) {
  const json& model = scene.source["model"];
  require(model["type"] == kind && model[kind].size() == 1, wanted);
  const json& interface = scene.source["interfaces"][0];
  json loads = json::array();
  for (const json& load : scene.source.value("loads", json::array()))
    if (load["type"] != "bulk_viscosity")
      loads.push_back(load);  // an aid of the mesh, which the body does not have
  return {model, model[kind][0], interface, loads, interface.value("parameters", json::object())};
}

ExactNode node_of(const std::function<Motion1D(double)>& motion) {
  return {[=](double time) { return motion(time).displacement; },
          [=](double time) { return motion(time).velocity; },
          {}};
}

ExactNode piecewise(const std::vector<double>& instants, const std::vector<double>& velocities) {
  const auto velocity = [=](double time) {
    const auto k = std::upper_bound(instants.begin(), instants.end(), time) - instants.begin();
    return velocities[static_cast<std::size_t>(k)];
  };
  const auto displacement = [=](double time) {
    double sum = 0.0, from = 0.0;
    for (std::size_t k = 0; k < velocities.size() && from < time; ++k) {
      const double to = k < instants.size() ? std::min(instants[k], time) : time;
      sum += velocities[k] * (to - from);
      from = to;
    }
    return sum;
  };
  return {displacement, velocity, {}};
}

}  // namespace ilaw::host
