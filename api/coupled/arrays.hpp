// arrays.hpp - reading and writing the host's strided arrays.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vector.hpp"

#include <ilaw/ilaw.h>

#include <cstdint>
#include <cstdlib>
#include <numeric>

namespace ilaw::coupled {

// Component c of entry i; zero where the array is absent.
inline double value(const ilaw_input& array, std::int64_t i, std::int64_t c = 0) {
  return array.values ? array.values[i * array.node_stride + c * array.component_stride] : 0.0;
}

inline Vector vector(const ilaw_input& array, std::int64_t i, std::uint32_t dimension) {
  Vector read{};
  if (!array.values) return read;
  const double* first = array.values + i * array.node_stride;
  if (dimension == 3) return {first[0], first[array.component_stride], first[2 * array.component_stride]};
  for (std::uint32_t c = 0; c < dimension; ++c) read[c] = first[c * array.component_stride];
  return read;
}

inline void store(const ilaw_output& array, std::int64_t i, std::uint32_t dimension, const Vector& values) {
  if (!array.values) return;
  double* first = array.values + i * array.node_stride;
  for (std::uint32_t c = 0; c < dimension; ++c) first[c * array.component_stride] = values[c];
}

// A flat array of all degrees of freedom, whose first numbers would be taken for every component.
inline bool is_flat(const ilaw_input& a, std::uint32_t components) {
  return a.values && components > 1 && a.component_stride == 0;
}

// Upper bound of counts: sizes of arrays cannot overflow.
inline constexpr std::int64_t max_entries = std::int64_t{1} << 40;

// Whether two numbers of an output have the same address: i s + c t is that of another i and c.
inline bool collides(const ilaw_output& a, std::int64_t count, std::int64_t components) {
  const std::int64_t s = std::abs(a.node_stride), t = std::abs(a.component_stride);
  if (!a.values || count < 1 || components < 1 || count * components == 1) return false;
  if (s == 0 && t == 0) return true;
  const std::int64_t common = std::gcd(s, t);
  return t / common < count && s / common < components;
}

}  // namespace ilaw::coupled
