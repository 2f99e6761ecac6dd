// table.hpp - numbers on a grid: linear along each axis, constant beyond its ends.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/pack.hpp>

#include <cstdint>

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

// Values on a grid of one to three axes. The last axis varies fastest.
struct table {
  static constexpr int time = -1, computed = -2;

  int axis_count = 0;      // 0: none, the table is a constant
  int source[3] = {};      // of an axis: time, computed, or a field's place among the law's parameters
  int named_axis[3] = {};  // its place in parameter::axes
  double constant = 0.0;
  bool per_node = false;
  std::uint64_t count[3] = {};
  double* points[3] = {};  // owned, with the values behind them
  double* values = nullptr;

  bool is_over_time_alone() const { return axis_count == 1 && source[0] == time; }
  double at(const double (&place)[3]) const { return axis_count > 0 ? between(0, 0, place) : constant; }

  // Position of the first point after a place on an axis.
  std::uint64_t after(int axis, double place) const {
    std::uint64_t low = 0, high = count[axis];
    while (low < high) {
      const std::uint64_t middle = (low + high) / 2;
      if (points[axis][middle] > place)
        high = middle;
      else
        low = middle + 1;
    }
    return low;
  }
  double next_time(double after_time) const {
    for (int a = 0; a < axis_count; ++a)
      if (source[a] == time)
        if (const std::uint64_t k = after(a, after_time); k < count[a]) return points[a][k];
    return infinity;
  }

 private:
  double between(int axis, std::uint64_t row, const double (&place)[3]) const {
    if (axis == axis_count) return values[row];
    const auto value = [&](std::uint64_t k) { return between(axis + 1, row * count[axis] + k, place); };
    const std::uint64_t k = after(axis, place[axis]);
    if (k == 0) return value(0);
    if (k == count[axis]) return value(k - 1);
    const double x0 = points[axis][k - 1], x1 = points[axis][k], y0 = value(k - 1), y1 = value(k);
    const double fraction = (place[axis] - x0) / (x1 - x0);
    // At its ends a segment has their values, also beside an infinite one.
    if (y0 == y1 || fraction == 0.0) return y0;
    return fraction == 1.0 ? y1 : y0 * (1.0 - fraction) + y1 * fraction;
  }
};

// A parameter that a step reads at quantities that it computes itself, such as the slip speed. Quantities
// stand in the order of parameter::axes; those over which no table is given are not read.
class grid {
 public:
  grid() = default;
  explicit grid(const table& given) : table_(&given) {}

  double at(const double* quantities) const {
    double place[3] = {};
    for (int a = 0; a < table_->axis_count; ++a) place[a] = quantities[table_->named_axis[a]];
    return table_->at(place);
  }
  // The points along an axis of parameter::axes.
  struct axis_points {
    const double* points = nullptr;
    std::int64_t count = 0;
  };
  axis_points along(int axis) const {
    for (int a = 0; a < table_->axis_count; ++a)
      if (table_->named_axis[a] == axis)
        return {table_->points[a], static_cast<std::int64_t>(table_->count[a])};
    return {};
  }

 private:
  const table* table_ = nullptr;
};

}  // namespace ilaw::kit
