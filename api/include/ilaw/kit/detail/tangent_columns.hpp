// tangent_columns.hpp - the tangents of a block of nodes: chosen, given by the host, or carried along.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/frame.hpp>
#include <ilaw/kit/detail/gather.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// Tangents of a block's nodes, as columns to be written. Each loop stands alone, as vector code.
class tangent_columns {
 public:
  template <class Column>
  tangent_columns(Column* first, Column* second) {
    for (int c = 0; c < 3; ++c) {
      first_[c] = first[c].values;
      second_[c] = second[c].values;
    }
  }

  // A tangent that is none makes the second one NaN, and so the node's vectors.
  void put(int i, axis n, axis t1, bool is_tangent) const {
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    const axis t2 = cross(n, t1);
    columns::put(first_, i, t1);
    columns::put(second_, i, {is_tangent ? t2.x : none, is_tangent ? t2.y : none, is_tangent ? t2.z : none});
  }

  [[gnu::noinline, gnu::flatten]] void choose(int count, const double* const* normals) const {
    const tangent_columns own = *this;
    const double* const n[] = {normals[0], normals[1], normals[2]};
#pragma omp simd
    for (int i = 0; i < count; ++i) own.put(i, columns::get(n, i), any_tangent(columns::get(n, i)), true);
  }

  [[gnu::noinline, gnu::flatten]] void keep(int count, const double* const* normals,
                                            const double* const* tangents) const {
    const tangent_columns own = *this;
    const double *const n[] = {normals[0], normals[1], normals[2]}, *const t[] = {tangents[0], tangents[1],
                                                                                  tangents[2]};
#pragma omp simd
    for (int i = 0; i < count; ++i) own.keep_at(i, n, t);
  }

  // From the frames of the step before: three columns of the normal, three of the tangent.
  [[gnu::noinline, gnu::flatten]] void transport(int count, const double* const* normals,
                                                 const double* const* before) const {
    const tangent_columns own = *this;
    const double* const n[] = {normals[0], normals[1], normals[2]};
    const double* const f[] = {before[0], before[1], before[2], before[3], before[4], before[5]};
#pragma omp simd
    for (int i = 0; i < count; ++i) own.transport_at(i, n, f);
  }

 private:
  void keep_at(int i, const double* const* normals, const double* const* tangents) const {
    const axis n = columns::get(normals, i), t = columns::get(tangents, i);
    const bool is_unit = unit(t), is_across = orthogonal(n, t);
    put(i, n, t, is_unit & is_across);
  }
  void transport_at(int i, const double* const* normals, const double* const* before) const {
    const axis n = columns::get(before, i), t = columns::get(before + 3, i), now = columns::get(normals, i);
    const bool was_unit = unit(n), is_unit = unit(t), is_across = orthogonal(n, t);
    put(i, now, transported_tangent(n, t, now), was_unit & is_unit & is_across);
  }

  double *first_[3], *second_[3];
};

}  // namespace ilaw::kit::detail
