// root.hpp - a bracketed root that is always found.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit.hpp>

namespace cohesive_law {
inline namespace ILAW_KIT_LEVEL {

using namespace ilaw::kit;

// Where f changes sign in [low, high], with f(low) <= 0 <= f(high), to the last bits: inverse quadratic
// interpolation where it is safe, else bisection (Chandrupatla 1997). A jump across zero is found as well.
template <class Function>
double sign_change(double low, double high, Function f) {
  double a = high, fa = f(high), b = low, fb = f(low);
  if (!(fb < 0.0)) return low;
  if (!(fa > 0.0)) return high;
  double share = 0.5;
  for (int k = 0; k < 200; ++k) {
    const double x = a + share * (b - a), fx = f(x);
    double c, fc;  // the end left behind
    if ((fx > 0.0) == (fa > 0.0)) {
      c = a;
      fc = fa;
    } else {
      c = b;
      fc = fb;
      b = a;
      fb = fa;
    }
    a = x;
    fa = fx;
    const bool a_is_better = absolute(fa) < absolute(fb);
    const double best = a_is_better ? a : b;
    const double tolerance = 2.0 * std::numeric_limits<double>::epsilon() * absolute(best);
    const double width = absolute(b - a);
    if (fa == 0.0) return a;
    if (width <= 2.0 * tolerance) return best;
    const double xi = (a - b) / (c - b), phi = (fa - fb) / (fc - fb);
    const bool is_smooth = phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi;
    const double quadratic =
        fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb);
    const double margin = tolerance / width;
    share = is_smooth ? smaller(larger(quadratic, margin), 1.0 - margin) : 0.5;
  }
  return absolute(fa) < absolute(fb) ? a : b;
}

}  // namespace ILAW_KIT_LEVEL
}  // namespace cohesive_law
