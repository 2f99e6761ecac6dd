// newton.hpp - a step of Newton's method for the impulses of contacts that share nodes (Alart and Curnier
// 1991), for those that sweeps do not solve: ties of masses that are far apart, which are linear while they
// hold.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "step/islands.hpp"

namespace ilaw::host {

// Scaled impulses to which the tangents of all laws lead, from those that v has. What contacts have
// then are answers to other velocities.
Dofs newton_impulses(const ContactGroup& group, const double* inverse_mass, const StepView& step,
                     const Dofs& v);

}  // namespace ilaw::host
