// node.hpp - what a law's step sees: one interface node, in its local frame.
// Dimensions 1 and 2 are the same equations with zero tangential components, so a law is written once.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/kit_batch.hpp>
#include <ilaw/kit/math.hpp>

#include <type_traits>

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

// A vector in the local frame: normal, first and second tangential component.
struct vector {
  double n = 0.0, t1 = 0.0, t2 = 0.0;

  friend constexpr vector operator+(vector a, vector b) { return {a.n + b.n, a.t1 + b.t1, a.t2 + b.t2}; }
  friend constexpr vector operator-(vector a, vector b) { return {a.n - b.n, a.t1 - b.t1, a.t2 - b.t2}; }
  friend constexpr vector operator-(vector a) { return {-a.n, -a.t1, -a.t2}; }
  friend constexpr vector operator*(double s, vector a) { return {s * a.n, s * a.t1, s * a.t2}; }
  scaled_length<double> scaled_tangential_length() const { return scaled_length_of(t1, t2); }
  double tangential_length() const { return length(t1, t2); }
};

// A vector for laws that are isotropic in the tangent plane: normal part and tangential rest, the latter in
// the host's axes, so that no tangent needs to be chosen. A step that is written with the operations that it
// shares with vector works on both.
struct projected_vector {
  double n = 0.0, x = 0.0, y = 0.0, z = 0.0;

  friend constexpr projected_vector operator+(projected_vector a, projected_vector b) {
    return {a.n + b.n, a.x + b.x, a.y + b.y, a.z + b.z};
  }
  friend constexpr projected_vector operator-(projected_vector a, projected_vector b) {
    return {a.n - b.n, a.x - b.x, a.y - b.y, a.z - b.z};
  }
  friend constexpr projected_vector operator-(projected_vector a) { return {-a.n, -a.x, -a.y, -a.z}; }
  friend constexpr projected_vector operator*(double s, projected_vector a) {
    return {s * a.n, s * a.x, s * a.y, s * a.z};
  }
  scaled_length<double> scaled_tangential_length() const { return scaled_length_of(x, y, z); }
  double tangential_length() const { return length(x, y, z); }
};

// a.b, normal and tangential part apart.
constexpr double normal_product(vector a, vector b) { return a.n * b.n; }
constexpr double normal_product(projected_vector a, projected_vector b) { return a.n * b.n; }
constexpr double tangential_product(vector a, vector b) { return a.t1 * b.t1 + a.t2 * b.t2; }
constexpr double tangential_product(projected_vector a, projected_vector b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

// Smallest H allowed: below it 1/H overflows.
inline constexpr double smallest_delassus = std::numeric_limits<double>::min();

// Largest tr(H) tr(H^-1) allowed, which no rotation changes: beyond it rounding decides whether H is
// definite. It lies between the condition number and nine times that.
inline constexpr double largest_condition = 0x1p43;

// Checks give a defect: zero where all is well, NaN where not. They need no branch and no logical operation,
// which compilers vectorise less reliably than arithmetic. Defects add up; found, what checks before gave, is
// handed on for less: one product for each number, since zero times what is not finite is NaN.
constexpr double defect(double x, double found = 0.0) { return found * x; }
constexpr double defect(vector a, double found = 0.0) { return found * a.n * a.t1 * a.t2; }
constexpr double defect(projected_vector a, double found = 0.0) { return found * a.n * a.x * a.y * a.z; }
constexpr double defect_unless(bool good, double found = 0.0) {
  return good ? found : std::numeric_limits<double>::quiet_NaN();
}

// The forms of H, with the same operations: H r, H^-1 v, and the defect of one that is not finite and, by
// largest_condition, positive definite. anisotropy() is zero where closed forms for H = diag(h_N, h_T, h_T)
// hold. A scalar H is transverse with twice the same value, whose operations are the same to the last bit.
struct transverse_delassus {
  static constexpr int components = 2;
  double n, t;

  static transverse_delassus from(const double* c) { return {c[0], c[1]}; }
  double normal() const { return n; }
  double tangential() const { return t; }
  double anisotropy() const { return 0.0; }
  // tr(H) tr(H^-1) = 5 + 2 (n/t + t/n) here. What is not finite leaves n - t so, and is no number or large.
  double positive_defect(double found = 0.0) const {
    constexpr double least_ratio = 2.0 / largest_condition;
    const double low = smaller(n, t), apart = absolute(n - t);
    return defect_unless(least_ratio * apart <= low - smallest_delassus, found);
  }
  vector times(vector r) const { return {n * r.n, t * r.t1, t * r.t2}; }
  projected_vector times(projected_vector r) const { return {n * r.n, t * r.x, t * r.y, t * r.z}; }
  // One division for the tangential parts. All forms multiply by an inverse, so that their bits are the same.
  vector solve(vector v) const {
    const double by_n = 1.0 / n, by_t = 1.0 / t;
    return {by_n * v.n, by_t * v.t1, by_t * v.t2};
  }
  projected_vector solve(projected_vector v) const {
    const double by_n = 1.0 / n, by_t = 1.0 / t;
    return {by_n * v.n, by_t * v.x, by_t * v.y, by_t * v.z};
  }
};

struct diagonal_delassus {
  static constexpr int components = 3;
  double n, t1, t2;

  static diagonal_delassus from(const double* c) { return {c[0], c[1], c[2]}; }
  double normal() const { return n; }
  double tangential() const { return t1; }
  double anisotropy() const { return absolute(t1 - t2); }
  double positive_defect(double found = 0.0) const {
    const double trace = n + t1 + t2, scale = power_scale_of(trace).down;
    const double a = scale * n, b = scale * t1, c = scale * t2, low = smaller(smaller(n, t1), t2);
    const bool is_fair = scale * trace * (b * c + a * c + a * b) <= largest_condition * (a * b * c);
    return defect_unless((low >= smallest_delassus) & is_fair, found);
  }
  vector times(vector r) const { return {n * r.n, t1 * r.t1, t2 * r.t2}; }
  vector solve(vector v) const { return {1.0 / n * v.n, 1.0 / t1 * v.t1, 1.0 / t2 * v.t2}; }
};

struct full_delassus {
  static constexpr int components = 6;
  double nn, t11, t22, n1, n2, t12;

  static full_delassus from(const double* c) { return {c[0], c[1], c[2], c[3], c[4], c[5]}; }
  double normal() const { return nn; }
  double tangential() const { return t11; }
  double anisotropy() const { return absolute(t11 - t22) + absolute(n1) + absolute(n2) + absolute(t12); }

  // LDL^T: pivots, the inverse of two, which are divided by once, and multipliers. H is positive definite
  // exactly when the pivots are positive.
  struct factors {
    double d0, d1, d2, by_d0, by_d1, l10, l20, l21;

    // Without a division: tr(H^-1) is the sum of these products over that of the pivots.
    bool is_fair(double trace) const {
      const double scale = power_scale_of(trace).down, l = l10 * l21 - l20;
      const double a = scale * d0, b = scale * d1, c = scale * d2;
      const double products = b * c + (1.0 + l10 * l10) * (a * c) + (1.0 + l21 * l21 + l * l) * (a * b);
      return scale * trace * products <= largest_condition * (a * b * c);
    }
  };
  factors factorise() const {
    const double by_d0 = 1.0 / nn, l10 = n1 * by_d0, l20 = n2 * by_d0;
    const double d1 = t11 - l10 * n1, by_d1 = 1.0 / d1;
    const double rest = t12 - l20 * n1, l21 = rest * by_d1;
    return {nn, d1, (t22 - l20 * n2) - l21 * rest, by_d0, by_d1, l10, l20, l21};
  }
  double positive_defect(double found = 0.0) const {
    const factors f = factorise();
    // What is not finite is not fair: it leaves no number to compare, or a trace of inf.
    const double low = smaller(smaller(f.d0, f.d1), f.d2);
    return defect_unless((low >= smallest_delassus) & f.is_fair(nn + t11 + t22), found);
  }
  vector times(vector r) const {
    return {nn * r.n + n1 * r.t1 + n2 * r.t2, n1 * r.n + t11 * r.t1 + t12 * r.t2,
            n2 * r.n + t12 * r.t1 + t22 * r.t2};
  }
  // The same in the host's axes, where rows have no normal or tangential meaning yet.
  template <class Axis>
  Axis row_times(Axis a) const {
    return {nn * a.x + n1 * a.y + n2 * a.z, n1 * a.x + t11 * a.y + t12 * a.z,
            n2 * a.x + t12 * a.y + t22 * a.z};
  }
  vector solve(vector v) const {
    const factors f = factorise();
    const double y1 = v.t1 - f.l10 * v.n;
    const double y2 = (v.t2 - f.l20 * v.n) - f.l21 * y1;
    const double x2 = 1.0 / f.d2 * y2;
    const double x1 = y1 * f.by_d1 - f.l21 * x2;
    return {(v.n * f.by_d0 - f.l10 * x1) - f.l20 * x2, x1, x2};
  }
};

// Why a law refuses a node; the text goes into the report. A double, like the status, to stay in vector code.
inline constexpr double not_refused = 0.0;
inline constexpr double several_solutions = 1.0;    // the law's equations have more than one
inline constexpr double no_solution = 2.0;          // the law's equations have none for this input
inline constexpr double impossible_state = 3.0;     // the law cannot have written this state
inline constexpr double time_before_history = 4.0;  // the clock was set back

// History of a law beyond its named state: doubles of one node, wherever the host keeps them.
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

// What turning H to other axes leaves where an entry was zero: some ulp of the others.
template <class Delassus>
double rounding_of(const Delassus& delassus) {
  return 0x1p-46 * (delassus.normal() + delassus.tangential());
}

// See ilaw.h: what holds out of reach, to the last bit.
template <class Node>
double next_gap(const Node& node) {
  return node.gap + node.position_step * node.v_free.n;
}
template <class Node>
bool is_out_of_reach(const Node& node) {
  return (node.gap > 0.0) & (next_gap(node) > 0.0);
}

// Whether closed forms for H = diag(h_N, h_T, h_T) do not hold.
template <class Delassus>
bool is_anisotropic(const Delassus& delassus) {
  return delassus.anisotropy() > rounding_of(delassus);
}

// The statuses of ilaw.h, as the doubles that vector code selects between.
namespace status {

inline constexpr double free = ILAW_FREE, closed = ILAW_CLOSED, stick = ILAW_STICK, slip = ILAW_SLIP,
                        bonded = ILAW_BONDED, broken = ILAW_BROKEN, healed = ILAW_HEALED;

}  // namespace status

struct stateless {};

// ILAW_INPUT_* as unsigned numbers, to be combined freely.
inline constexpr std::uint32_t reads_gap = ILAW_INPUT_GAP;
inline constexpr std::uint32_t reads_v_previous = ILAW_INPUT_V_PREVIOUS;
inline constexpr std::uint32_t reads_area = ILAW_INPUT_AREA;

// What stands in the place of an input that the law's card does not name: whoever reads it is told what to
// write.
template <std::uint32_t Input>
struct undeclared_input {
  operator double() const {
    static_assert(Input != reads_gap, "the law reads gap: write reads_gap among .inputs of its card");
    static_assert(Input != reads_area, "the law reads area: write reads_area among .inputs of its card");
    static_assert(Input != reads_v_previous,
                  "the law reads v_previous: write reads_v_previous among .inputs of its card");
    return 0.0;
  }
};
template <class Vector>
struct undeclared_vector {
  undeclared_input<reads_v_previous> n, t1, t2;

  operator Vector() const { return {n}; }
  double tangential_length() const { return n; }
};

template <std::uint32_t Inputs, std::uint32_t Input>
using scalar_input = std::conditional_t<(Inputs & Input) != 0, double, undeclared_input<Input>>;
template <std::uint32_t Inputs, class Vector>
using previous_input =
    std::conditional_t<(Inputs & reads_v_previous) != 0, Vector, undeclared_vector<Vector>>;

// One node in one step. A step reads the first part and writes the second. Inputs: what the law's card names.
// Vector is projected_vector only for laws that remember no vector and do not tell tangents apart.
template <class Delassus, class State = stateless, class Vector = vector,
          std::uint32_t Inputs = reads_gap | reads_v_previous | reads_area>
struct node {
  const double time, velocity_step, position_step;
  const Vector v_free;                              // relative velocity without interface
  const previous_input<Inputs, Vector> v_previous;  // relative velocity of the half step before
  const Delassus delassus;
  const scalar_input<Inputs, reads_gap> gap;  // offset already taken off
  const scalar_input<Inputs, reads_area> area;
  const const_history history;
  const vector earlier = {};  // what the law's window sums up to before the step; zero unless it has one

  Vector impulse;
  State state;          // comes in as it was, leaves as it is
  double stored = 0.0;  // energy stored by the interface at the end of the step
  // What the step added to it, by the normal and by the tangential motion; the rest of the work is
  // dissipated.
  double normal_gain = 0.0, tangential_gain = 0.0;
  double rupture = 0.0;  // part of these gains that is not stored: dissipated by rupture
  double status = status::free;
  double refused = not_refused;
};

// What initialise sees: there is no motion yet.
template <class State, std::uint32_t Inputs>
struct initial_node {
  const double time;
  const scalar_input<Inputs, reads_area> area;
  State state;
};

// The time over which a step's impulse acts: from half step to half step.
struct step_interval {
  double end, length;
};
template <class Node>
step_interval interval_of(const Node& node) {
  return {node.time + 0.5 * node.position_step, node.velocity_step};
}

// Kinds of nodes that laws tell apart when they are compiled: whether closed forms for H = diag(h_N, h_T,
// h_T) hold at all of them, and whether their vectors have tangential components with names.
template <class Node>
inline constexpr bool has_transverse_delassus =
    std::is_same_v<decltype(Node::delassus), const transverse_delassus>;
template <class Node>
inline constexpr bool has_tangents = std::is_same_v<decltype(Node::v_free), const vector>;

}  // namespace ilaw::kit
