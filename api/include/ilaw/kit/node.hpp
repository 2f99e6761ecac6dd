// node.hpp - what a law's step sees: one interface node, in its local frame.
// Dimensions 1 and 2 are the same equations with zero tangential components, so a law is written once.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/ilaw.h>
#include <ilaw/kit/math.hpp>

namespace ilaw::kit {

// A vector in the local frame: normal, first and second tangential component.
struct vector {
  double n = 0.0, t1 = 0.0, t2 = 0.0;

  friend constexpr vector operator+(vector a, vector b) { return {a.n + b.n, a.t1 + b.t1, a.t2 + b.t2}; }
  friend constexpr vector operator-(vector a, vector b) { return {a.n - b.n, a.t1 - b.t1, a.t2 - b.t2}; }
  friend constexpr vector operator-(vector a) { return {-a.n, -a.t1, -a.t2}; }
  friend constexpr vector operator*(double s, vector a) { return {s * a.n, s * a.t1, s * a.t2}; }
  double tangential_length() const { return length(t1, t2); }
};

// Smallest H allowed: below it 1/H overflows.
inline constexpr double smallest_delassus = std::numeric_limits<double>::min();

inline bool finite(vector a) { return finite(a.n) && finite(a.t1) && finite(a.t2); }

// The three forms of H, with the same operations: H r, H^-1 v, and whether H is positive definite.
struct scalar_delassus {
  static constexpr int components = 1;
  double h;

  static scalar_delassus from(const double* c) { return {c[0]}; }
  double normal() const { return h; }
  double tangential() const { return h; }
  bool tangentially_isotropic() const { return true; }
  bool positive() const { return finite(h) && h >= smallest_delassus; }
  vector times(vector r) const { return h * r; }
  vector solve(vector v) const { return {v.n / h, v.t1 / h, v.t2 / h}; }
};

struct diagonal_delassus {
  static constexpr int components = 3;
  double n, t1, t2;

  static diagonal_delassus from(const double* c) { return {c[0], c[1], c[2]}; }
  double normal() const { return n; }
  double tangential() const { return t1; }
  bool tangentially_isotropic() const { return t1 == t2; }
  bool positive() const {
    return finite(n) && finite(t1) && finite(t2) && n >= smallest_delassus && t1 >= smallest_delassus &&
           t2 >= smallest_delassus;
  }
  vector times(vector r) const { return {n * r.n, t1 * r.t1, t2 * r.t2}; }
  vector solve(vector v) const { return {v.n / n, v.t1 / t1, v.t2 / t2}; }
};

struct full_delassus {
  static constexpr int components = 6;
  double nn, t11, t22, n1, n2, t12;

  static full_delassus from(const double* c) { return {c[0], c[1], c[2], c[3], c[4], c[5]}; }
  double normal() const { return nn; }
  double tangential() const { return t11; }
  bool decoupled() const { return n1 == 0.0 && n2 == 0.0 && t12 == 0.0; }
  bool tangentially_isotropic() const { return decoupled() && t11 == t22; }

  // LDL^T: pivots and multipliers. H is positive definite exactly when the pivots are positive.
  struct factors {
    double d0, d1, d2, l10, l20, l21;
  };
  factors factorise() const {
    const double l10 = n1 / nn, l20 = n2 / nn;
    const double d1 = t11 - l10 * n1;
    const double l21 = (t12 - l20 * n1) / d1;
    return {nn, d1, (t22 - l20 * n2) - l21 * (t12 - l20 * n1), l10, l20, l21};
  }
  bool positive() const {
    const factors f = factorise();
    return finite(nn) && finite(f.d1) && finite(f.d2) && finite(f.l21) && f.d0 >= smallest_delassus &&
           f.d1 >= smallest_delassus && f.d2 >= smallest_delassus;
  }
  vector times(vector r) const {
    return {nn * r.n + n1 * r.t1 + n2 * r.t2, n1 * r.n + t11 * r.t1 + t12 * r.t2,
            n2 * r.n + t12 * r.t1 + t22 * r.t2};
  }
  vector solve(vector v) const {
    const factors f = factorise();
    const double y1 = v.t1 - f.l10 * v.n;
    const double y2 = (v.t2 - f.l20 * v.n) - f.l21 * y1;
    const double x2 = y2 / f.d2;
    const double x1 = y1 / f.d1 - f.l21 * x2;
    return {(v.n / f.d0 - f.l10 * x1) - f.l20 * x2, x1, x2};
  }
};

// Why a node is refused; the text goes into the report.
enum class refusal : int {
  none = 0,
  anisotropic_delassus,  // the law has no closed form for this H
  no_solution,           // the law's equations have none for this input
};

// Memory of a law beyond its named state: doubles of one node, wherever the host keeps them.
struct const_history {
  const double* values;
  std::int64_t stride;
  double operator[](std::int64_t k) const { return values[k * stride]; }
};
struct history {
  double* values;
  std::int64_t stride;
  double& operator[](std::int64_t k) const { return values[k * stride]; }
  operator const_history() const { return {values, stride}; }
};

struct stateless {};

// One node in one step. A step reads the first part and writes the second.
template <class Delassus, class State = stateless>
struct node {
  double time, velocity_step, position_step;
  vector v_free;      // relative velocity without interface
  vector v_previous;  // relative velocity of the half step before; zero unless the law reads it
  Delassus delassus;
  double gap;   // offset already taken off
  double area;  // zero unless the law reads it
  const_history past;

  vector impulse;
  State state;          // comes in as it was, leaves as it is
  double stored = 0.0;  // energy stored by the interface at the end of the step
  int status = ILAW_FREE;
  refusal refused = refusal::none;
};

}  // namespace ilaw::kit
