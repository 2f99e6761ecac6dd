// stable_step.hpp - the largest time step at which the interfaces of a scene are stable, by trial.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "scene/scene.hpp"

#include <functional>

namespace ilaw::host {

// A run is stable when it does not fail and its interfaces never put in more than this part of the
// largest energy so far: the run itself warns of more.
constexpr double most_energy_put_in = 0.1;
bool is_stable(Scene scene);

// The largest stable step, as a part of that of the scene at 1, which is the largest that is tried;
// found by halving and bisection to a hundredth, in a process for each run. 0: not even a millionth is
// stable.
double largest_stable_step(const std::function<Scene(double)>& scene_at, int threads = 1);

}  // namespace ilaw::host
