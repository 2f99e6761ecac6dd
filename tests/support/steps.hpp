// steps.hpp - a free node on a law, at steps that share no factor: what packs solve and what is solved alone
// moves alike, and differs from the motion at a fine step by a multiple of the step.
#pragma once

#include "support/law_runner.hpp"

namespace ilaw::testing {

// Where the node is after `end`.
inline Vector moved(NodeRun node, Vector v, double end) {
  const long steps = std::lround(end / node.dt);
  Vector u{};
  node.v_previous = v;
  for (long k = 0; k < steps; ++k) {
    node.gap = u[0];
    if (node.step(v) != ILAW_OK) {
      ADD_FAILURE() << "step " << k << " of " << node.dt << " s: " << node.report.reason;
      break;
    }
    v = node.v;
    u = u + node.dt * v;
  }
  return u;
}

inline double distance(const Vector& a, const Vector& b) { return length(a - b); }

// make(step, alone): the node, in packs or solved alone. The order is one: the velocity that is given
// counts half a step early. spread: by how much the errors over the step differ.
template <class Make>
void expect_first_order(Make make, const Vector& v, double spread) {
  constexpr double end = 0.091;  // a multiple of all steps
  const double scale = length(v) * end;
  const Vector fine = moved(make(1e-5, false), v, end);
  double least = INFINITY, most = 0.0;
  for (const double step : {1e-3, 7e-4, 1.3e-3}) {
    const Vector in_packs = moved(make(step, false), v, end), alone = moved(make(step, true), v, end);
    EXPECT_LE(distance(in_packs, alone), 1e-10 * scale) << "step " << step;
    least = std::min(least, distance(in_packs, fine) / step);
    most = std::max(most, distance(in_packs, fine) / step);
  }
  EXPECT_LE(most, 4.0 * length(v));
  EXPECT_LE(most, spread * least);
}

}  // namespace ilaw::testing
