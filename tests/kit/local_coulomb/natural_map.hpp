// natural_map.hpp - how far an impulse is from solving a local problem, worked out in long double so that the
// measure does not add to what it measures.
#pragma once

#include <ilaw/kit/local_coulomb.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace ilaw::testing {

using Exact = std::array<long double, 3>;

// v = q + H r.
inline Exact velocity(const kit::local_coulomb& p, const Exact& r) {
  return {p.q[0] + p.h[0] * r[0] + p.h[3] * r[1] + p.h[4] * r[2],
          p.q[1] + p.h[3] * r[0] + p.h[1] * r[1] + p.h[5] * r[2],
          p.q[2] + p.h[4] * r[0] + p.h[5] * r[1] + p.h[2] * r[2]};
}

inline long double norm(const Exact& a) { return std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]); }

// The nearest point of the cone |x_T| <= mu x_N.
inline Exact projected_on_cone(const Exact& x, long double mu) {
  const long double tangential = std::hypot(x[1], x[2]);
  if (mu * tangential <= -x[0]) return {};
  if (tangential <= mu * x[0]) return x;
  const long double normal = (x[0] + mu * tangential) / (1.0L + mu * mu), part = mu * normal / tangential;
  return {normal, part * x[1], part * x[2]};
}

// r - P(r - (v_N + mu |v_T|, v_T)), zero exactly at the solutions (De Saxce and Feng 1991), isotropic
// friction.
inline long double natural_map_residual(const kit::local_coulomb& p, const double* impulse) {
  const Exact r{impulse[0], impulse[1], impulse[2]}, v = velocity(p, r);
  const long double mu = p.mu[0];
  const Exact moved{r[0] - v[0] - mu * std::hypot(v[1], v[2]), r[1] - v[1], r[2] - v[2]};
  const Exact nearest = projected_on_cone(moved, mu);
  return norm({r[0] - nearest[0], r[1] - nearest[1], r[2] - nearest[2]});
}

}  // namespace ilaw::testing
