// dof_loops.hpp - loops over all degrees of freedom, with threads where there are many.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "model/model.hpp"

#include <algorithm>
#include <cmath>

namespace ilaw::host {

// Calls f(i) for all degrees of freedom. f touches those of i alone.
template <class F>
void for_each_dof(Eigen::Index count, F f) {
  constexpr Eigen::Index many = 1 << 16;
#pragma omp parallel for schedule(static) if (count > many)
  for (Eigen::Index i = 0; i < count; ++i) f(i);
}

// Of the nodes, which have d components each.
inline double largest_speed(const Dofs& v, Eigen::Index d) {
  double largest = 0.0;
  const Eigen::Index nodes = v.size() / d;
  constexpr Eigen::Index many = 1 << 16;
#pragma omp parallel for schedule(static) reduction(max : largest) if (nodes > many)
  for (Eigen::Index node = 0; node < nodes; ++node) {
    double square = 0.0;
    for (Eigen::Index c = 0; c < d; ++c) square += v[node * d + c] * v[node * d + c];
    largest = std::max(largest, square);
  }
  return std::sqrt(largest);
}

}  // namespace ilaw::host
