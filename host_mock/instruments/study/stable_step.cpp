// SPDX-License-Identifier: BSD-3-Clause
#include "study/stable_step.hpp"

#include "step/integrator.hpp"
#include "study/process_run.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace ilaw::host {

bool is_stable(Scene scene) {
  Integrator integrator(*scene.model, scene.loads, scene.interfaces, scene.dt, scene.prestress);
  // A report costs as much as a step.
  const std::int64_t every = std::max<std::int64_t>(scene.steps / 500, 1);
  try {
    while (integrator.steps() < scene.steps) {
      integrator.step();
      if (integrator.steps() % every != 0 && integrator.steps() < scene.steps) continue;
      const EnergyReport energy = integrator.energy();
      if (!(energy.reaction_work <= most_energy_put_in * energy.scale)) return false;
    }
  } catch (const std::runtime_error&) {
    return false;
  }
  return true;
}

double largest_stable_step(const std::function<Scene(double)>& scene_at, int threads) {
  constexpr double least = 1e-6, accuracy = 1.01;
  const auto is_stable_at = [&](double part) {
    return is_stable_in_process([&] { return scene_at(part); }, threads);
  };
  double low = 1.0;
  while (!is_stable_at(low)) {
    low *= 0.5;
    if (low < least) return 0.0;
  }
  if (low == 1.0) return low;
  double high = 2.0 * low;
  while (high > accuracy * low) {
    const double middle = std::sqrt(low * high);
    (is_stable_at(middle) ? low : high) = middle;
  }
  return low;
}

}  // namespace ilaw::host
