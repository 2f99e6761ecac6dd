// errors.hpp - how far a run is from a reference, in norms that fit motions with jumps.
//   u_L2    root of the mean square of position errors over time, relative to that of the reference
//   u_max   largest position error, relative to the largest displacement of the reference
//   v_L1    mean of |velocity errors| over time, relative to that of the reference: a jump that is
//           displaced by one step changes it by O(h); in L2 it would be O(sqrt h), in the maximum norm
//           nothing would ever converge
//   instant largest error of an instant (first and last impulse of a contact, its last rupture), in
//           time units
//   impulse mean of |errors| of the impulse that interfaces have given so far, relative to the mean
//           of that impulse
//   energy  mean error of the work that interfaces have done so far, relative to the largest energy
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "step/integrator.hpp"
#include "study/exact.hpp"

#include <array>
#include <cstddef>
#include <vector>

namespace ilaw::host {

// The motion and the contacts of the watched nodes in a run.
struct Trace {
  double dt = 0.0, seconds = 0.0;
  std::int64_t steps = 0;
  int dimension = 1;
  std::vector<Dofs> displacement, velocity;  // per step: at t_{n+1}, and at the half step after it
  std::vector<ContactInstants> instants;     // per watched node
  // Given by the interfaces up to the half step after t_{n+1}: summed impulse, per interface and
  // component, and work.
  std::vector<Dofs> impulse;
  std::vector<double> work;
  double energy = 0.0, penetration = 0.0;  // the largest
};

// Runs a scene to its end. Throws std::runtime_error when it fails.
Trace trace_of(Scene& scene);

// Seconds that the processor takes for the steps of a run, without recording anything.
double seconds_of(Scene& scene);

enum Norm : std::size_t { norm_u_L2, norm_u_max, norm_v_L1, norm_instant, norm_impulse, norm_energy };
constexpr std::array<const char*, 6> norm_names{"u_L2", "u_max", "v_L1", "instant", "impulse", "energy"};

struct Errors {
  double u_L2, u_max, v_L1, instant, impulse, energy;  // NaN where there is nothing to compare
  double operator[](std::size_t norm) const {
    return std::array{u_L2, u_max, v_L1, instant, impulse, energy}[norm];
  }
};
Errors errors_against(const std::vector<ExactNode>& exact, const Trace& trace);
// Against a run of the same scene with smaller steps.
Errors errors_against(const Trace& reference, const Trace& trace);

// Errors below this part of their quantity are those of the arithmetic: 1e5 steps add up to so many
// roundings. In time units for instants, relative to the end of the run.
constexpr double rounding_level = 1e-11;

// Slope of log(error) over log(h) by least squares, without the errors that are at rounding level
// (that part of scale, the size of the quantity): these no longer depend on h. NaN where that
// leaves fewer than three errors, or where one is missing.
double order_of(const std::vector<double>& h, const std::vector<double>& errors, double scale = 1.0);

}  // namespace ilaw::host
