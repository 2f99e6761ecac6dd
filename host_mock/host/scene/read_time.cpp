// SPDX-License-Identifier: BSD-3-Clause
#include "scene/readers.hpp"

#include "model/thermal_model.hpp"
#include "scene/json_text.hpp"
#include "scene/scene.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace ilaw::host {
namespace {

using nlohmann::json;

ThermalModel::StableStep thermal_step(const Model& model) {
  return model.thermal() ? model.thermal()->stable_step() : ThermalModel::StableStep{};
}

double motion_step(const Scene& scene) {
  const Model& model = *scene.model;
  return critical_step(model, scene.loads, {model.initial_displacement(), model.initial_velocity()});
}

// A step given as such may be larger than the model can stand.
void check_step(Scene& scene) {
  const Model& model = *scene.model;
  constexpr double rounding = 1e-14;
  const auto [thermal, body] = thermal_step(model);
  if (scene.dt > thermal * (1.0 + rounding))
    throw mistake("/time/dt", json(scene.dt).dump(),
                  "at most " + json(thermal).dump() + ", the stable step of conduction in '" + body + "'");
  const double step = motion_step(scene);
  if (!(scene.dt > step * (1.0 + rounding))) return;
  const std::string found = json(scene.dt).dump(), critical = json(step).dump();
  if (model.critical_step_is_exact())
    throw mistake("/time/dt", found, "at most " + critical + ", the model's critical step");
  scene.warnings.push_back("/time/dt: found " + found +
                           ", which may be unstable: the critical step is known to be " + critical +
                           " at least");
}

}  // namespace

void read_time(const json& time, Scene& scene) {
  require_one_of(time, "dt", "cfl", "'dt' and 'cfl'", "/time");
  if (time.contains("cfl")) {
    const double critical = std::min(motion_step(scene), thermal_step(*scene.model).step);
    if (!std::isfinite(critical))
      throw SceneError("/time/cfl",
                       "this model has no critical time step (no internal forces), expected 'dt'");
    scene.dt = time["cfl"].get<double>() * critical;
  } else {
    scene.dt = time["dt"].get<double>();
    check_step(scene);
  }
  const double steps = time["end"].get<double>() / scene.dt;
  constexpr double most_steps = 1e15;  // beyond, n*dt no longer tells steps apart
  if (!(steps <= most_steps))
    throw SceneError("/time", "end/dt is " + json(steps).dump() + " steps, expected at most 1e15");
  const double rounded = std::round(steps);
  scene.steps =
      static_cast<std::int64_t>(std::abs(steps - rounded) <= 1e-9 * rounded ? rounded : std::ceil(steps));
}

}  // namespace ilaw::host
