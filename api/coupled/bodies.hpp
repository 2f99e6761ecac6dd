// bodies.hpp - velocities of the bodies, and what impulses at an arm do to them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vector.hpp"

#include <ilaw/coupled.h>

#include <cstdint>
#include <limits>
#include <vector>

namespace ilaw::coupled {

struct Motion {
  Vector velocity{}, spin{};
};
inline Motion operator+(const Motion& a, const Motion& b) {
  return {a.velocity + b.velocity, a.spin + b.spin};
}
inline Motion operator-(const Motion& a, const Motion& b) {
  return {a.velocity - b.velocity, a.spin - b.spin};
}
inline Motion operator*(double s, const Motion& a) { return {s * a.velocity, s * a.spin}; }

// Component c of entry i; of an absent array, zero.
inline double value(const ilaw_input& array, std::int64_t i, std::int64_t c = 0) {
  return array.values ? array.values[i * array.node_stride + c * array.component_stride] : 0.0;
}
// More entries than any memory has: their sizes would wrap.
inline constexpr std::int64_t most_entries = std::int64_t{1} << 40;

// Whether an output gives two numbers the same place.
inline bool collides(const ilaw_output& a, std::int64_t count, std::int64_t components) {
  return a.values && components > 0 &&
         ((count > 1 && a.node_stride == 0) || (count > 0 && components > 1 && a.component_stride == 0));
}

// NaN counts as infinite, and so is no maximum that is overlooked.
inline double larger(double a, double b) {
  if (!(a == a) || !(b == b)) return std::numeric_limits<double>::infinity();
  return a < b ? b : a;
}

Vector vector(const ilaw_input& array, std::int64_t i, std::uint32_t dimension);
void store(const ilaw_output& array, std::int64_t i, std::uint32_t dimension, const Vector& values);

class Bodies {
 public:
  void read(const ilaw_bodies& given);

  std::int64_t count() const { return given_.count; }
  std::uint32_t dimension() const { return given_.dimension; }
  bool rotate() const { return given_.inverse_inertia.values != nullptr; }
  bool are_spheres() const { return given_.inverse_inertia.component_stride == 0; }
  bool have_previous() const { return given_.v_previous.values != nullptr; }

  const std::vector<Motion>& free() const { return free_; }
  Motion previous(std::int64_t body) const;

  // What a unit impulse at the arm changes of the velocity there: one body's part of H.
  Symmetric delassus(std::int64_t body, const Vector& arm) const;

  // Sums over contacts: per body how many are active, the impulse and its moment.
  std::int64_t components() const { return rotate() ? 7 : 4; }
  // Change of a body's velocities by the sums.
  Motion change(const std::vector<double>& sums, std::int64_t body) const;
  // Of this rank's own bodies: impulses of the one, times the difference of velocities that the other makes.
  double product(const std::vector<double>& sums, const std::vector<Motion>& difference) const;

  void write(const std::vector<Motion>& velocities, const std::vector<double>& sums) const;

 private:
  Symmetric inverse_inertia(std::int64_t body) const;

  ilaw_bodies given_{};
  std::vector<Motion> free_;
};

}  // namespace ilaw::coupled
