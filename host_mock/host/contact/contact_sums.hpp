// contact_sums.hpp - what happened at the contacts of an interface in a step, added up.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/ilaw.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace ilaw::host {

struct ContactSums {
  double work = 0.0;           // of the impulses on the bodies
  double relative_work = 0.0;  // relative to a moving obstacle
  double penetration = 0.0;    // the largest
  std::int64_t left = 0;       // contacts that were held and went over the border of their surface
  double least_dissipation = 0.0;
  std::array<double, ILAW_ENERGY_COUNT> energy{};
  std::array<std::int64_t, ILAW_STATUS_COUNT> statuses{};
  std::vector<double> amounts;  // in the order of the instance; empty where the law gives none
  double stable_step = std::numeric_limits<double>::infinity();

  // Keeps the memory of the amounts.
  void clear() {
    *this = {.amounts = std::move(amounts)};
    amounts.clear();
  }
  void add(const ContactSums& other) {
    work += other.work;
    relative_work += other.relative_work;
    penetration = std::max(penetration, other.penetration);
    left += other.left;
    least_dissipation = std::min(least_dissipation, other.least_dissipation);
    for (std::size_t k = 0; k < energy.size(); ++k) energy[k] += other.energy[k];
    for (std::size_t k = 0; k < statuses.size(); ++k) statuses[k] += other.statuses[k];
    for (std::size_t k = 0; k < other.amounts.size(); ++k) add_amount(k, other.amounts[k]);
    add_stable_step(other.stable_step);
  }
  void add_amount(std::size_t k, double amount) {
    if (amounts.size() <= k) amounts.resize(k + 1);
    amounts[k] += amount;
  }
  // As a law reported it; 0: its library does not say.
  void add_stable_step(double step) {
    if (step > 0.0) stable_step = std::min(stable_step, step);
  }
  // Energies that a law gave for a contact. Dissipated parts are never negative.
  void add_energy(const double* parts) {
    for (std::size_t k = 0; k < energy.size(); ++k) energy[k] += parts[k];
    for (std::size_t k = 0; k < ILAW_ENERGY_STORED; ++k)
      least_dissipation = parts[k] < least_dissipation ? parts[k] : least_dissipation;
  }
  // Adds one part that is dissipated, for some contacts. Most often all are zero, and none has a sign:
  // neither then changes a sum or the least, and seeing it takes no chain of additions.
  void add_dissipation(std::size_t part, const double* values, std::ptrdiff_t count) {
    constexpr std::ptrdiff_t block = 16;
    double sum = energy[part];
    std::uint64_t bits = 0;
    for (std::ptrdiff_t first = 0; first < count; first += block) {
      const std::ptrdiff_t end = std::min(count, first + block);
      // The compiler knows the size of a full block: no loop.
      const std::uint64_t these =
          end - first == block ? bits_of(values + first, block) : bits_of(values + first, end - first);
      bits |= these;
      if (these << 1 == 0) continue;
      for (std::ptrdiff_t i = first; i < end; ++i) sum += values[i];
    }
    energy[part] = sum;
    if (bits >> 63 == 0) return;
    for (std::ptrdiff_t i = 0; i < count; ++i)
      least_dissipation = values[i] < least_dissipation ? values[i] : least_dissipation;
  }

 private:
  static std::uint64_t bits_of(const double* values, std::ptrdiff_t count) {
    std::uint64_t bits = 0;
    for (std::ptrdiff_t i = 0; i < count; ++i) bits |= std::bit_cast<std::uint64_t>(values[i]);
    return bits;
  }
};

}  // namespace ilaw::host
