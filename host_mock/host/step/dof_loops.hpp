// dof_loops.hpp - loops over all degrees of freedom, with threads where there are many.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/parallel.hpp"
#include "model/load.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace ilaw::host {

// Nodes that a motion drives have the velocity without damping, and no impulse of it.
void leave_driven_undamped(const Loads& loads, Eigen::Index d, const Dofs& undamped, Dofs& v, Dofs& impulse);

// Degrees of freedom that are worth a thread: whole nodes in 1D, 2D and 3D.
constexpr std::ptrdiff_t dof_chunk = chunk_of(6 * 4096);

// Calls f(first, end) for parts of the degrees of freedom. f touches those in [first, end) alone.
template <class F>
void for_each_part(Eigen::Index count, F f) {
  for_each_chunk(count, dof_chunk,
                 [&](std::ptrdiff_t, std::ptrdiff_t first, std::ptrdiff_t end) { f(first, end); });
}

// The results of f for all parts, combined by join.
template <class F, class Join>
auto over_parts(Eigen::Index count, F f, Join join) {
  if (count <= dof_chunk) return f(Eigen::Index{0}, count);
  std::vector<decltype(f(count, count))> values(static_cast<std::size_t>(chunks_of(count, dof_chunk)));
  for_each_chunk(count, dof_chunk, [&](std::ptrdiff_t c, std::ptrdiff_t first, std::ptrdiff_t end) {
    values[static_cast<std::size_t>(c)] = f(first, end);
  });
  return std::accumulate(values.begin() + 1, values.end(), values.front(), join);
}

// The largest of what f returns.
template <class F>
double largest_of_parts(Eigen::Index count, F f) {
  return over_parts(count, f, [](double a, double b) { return std::max(a, b); });
}

// The largest squared speed of the nodes in a part, infinity where one is not finite.
template <int D>
double largest_square(const double* v, Eigen::Index first, Eigen::Index end) {
  double largest = 0.0;
  Eigen::Index wild = 0;
  for (Eigen::Index i = first; i < end; i += D) {
    double square = 0.0;
    for (int c = 0; c < D; ++c) square += v[i + c] * v[i + c];
    largest = square > largest ? square : largest;
    wild += !(square <= std::numeric_limits<double>::max());
  }
  return wild > 0 ? std::numeric_limits<double>::infinity() : largest;
}

inline double largest_square(const Dofs& v, Eigen::Index d, Eigen::Index first, Eigen::Index end) {
  if (d == 1) return largest_square<1>(v.data(), first, end);
  return d == 2 ? largest_square<2>(v.data(), first, end) : largest_square<3>(v.data(), first, end);
}

// The largest speed of the nodes, which have d components each.
inline double largest_speed(const Dofs& v, Eigen::Index d) {
  return std::sqrt(largest_of_parts(
      v.size(), [&](Eigen::Index first, Eigen::Index end) { return largest_square(v, d, first, end); }));
}

}  // namespace ilaw::host
