// process_run.hpp - runs of a study, each in a process of its own: a law that crashes ends one run, and
// scenes are read while the process has one thread, as readers of meshes want it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "study/errors.hpp"

#include <functional>

namespace ilaw::host {

using SceneMaker = std::function<Scene()>;

// As trace_of, seconds_of and is_stable, for the scene that make reads there; threads are those of the run.
Trace trace_in_process(const SceneMaker& make, int threads);
double seconds_in_process(const SceneMaker& make, int threads);
bool is_stable_in_process(const SceneMaker& make, int threads);

}  // namespace ilaw::host
