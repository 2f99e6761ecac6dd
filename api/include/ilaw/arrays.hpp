// arrays.hpp - ilaw_input and ilaw_output of a host's arrays, for C++: the pointer's type chooses the member.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/ilaw.h>

#include <cstdint>

namespace ilaw {

constexpr ilaw_input input(const double* values, std::int64_t node_stride, std::int64_t component_stride) {
  return {values, nullptr, node_stride, component_stride};
}
constexpr ilaw_input input(const float* floats, std::int64_t node_stride, std::int64_t component_stride) {
  return {nullptr, floats, node_stride, component_stride};
}
constexpr ilaw_output output(double* values, std::int64_t node_stride, std::int64_t component_stride) {
  return {values, nullptr, node_stride, component_stride};
}
constexpr ilaw_output output(float* floats, std::int64_t node_stride, std::int64_t component_stride) {
  return {nullptr, floats, node_stride, component_stride};
}

}  // namespace ilaw
