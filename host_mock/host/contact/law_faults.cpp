// SPDX-License-Identifier: BSD-3-Clause
#include "contact/law_faults.hpp"

#include <array>
#include <cmath>
#include <cstdio>

namespace ilaw::host {

bool show_fault(const ContactSums& sums) {
  double energies = 0.0;
  for (const double energy : sums.energy) energies += energy;
  return sums.least_dissipation < 0.0 || std::isnan(energies) || !std::isfinite(sums.work) ||
         sums.statuses[ILAW_BAD_INPUT] > 0;
}

const char* fault_of(const double* impulse, int dimension, const double* energy, int status) {
  static thread_local std::array<char, 128> text;
  const auto found = [](const char* what, double value, const char* expected) {
    std::snprintf(text.data(), text.size(), "found %s %g, expected %s", what, value, expected);
    return text.data();
  };
  if (status == ILAW_BAD_INPUT) return "found the status of bad input, but no code that says so";
  for (int c = 0; c < dimension; ++c)
    if (!std::isfinite(impulse[c])) return found("the impulse", impulse[c], "a finite one");
  for (int k = 0; k < ILAW_ENERGY_COUNT; ++k)
    if (std::isnan(energy[k])) return found("the energy", energy[k], "a number");
  for (int k = 0; k < ILAW_ENERGY_STORED; ++k)
    if (energy[k] < 0.0) return found("a dissipated energy of", energy[k], "none below 0");
  return nullptr;
}

}  // namespace ilaw::host
