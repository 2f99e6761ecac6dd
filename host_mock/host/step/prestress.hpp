// prestress.hpp - the static equilibrium that a run may start from.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace ilaw::host {

struct PrestressSetup {
  double ramp = 0.0;        // loads and obstacles first go through the times from -ramp to 0
  double tolerance = 1e-6;  // of the residual, against the loads
  std::int64_t steps = 200000;
};

// How it was found. residual: norm of the forces that no other balances, at rest, over the largest norm of
// loads, reactions and contact forces.
struct PrestressReport {
  std::int64_t steps = 0;
  double residual = 0.0;
};

}  // namespace ilaw::host
