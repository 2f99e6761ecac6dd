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

// Whether f, positive at both ends of [low, high] and with one minimum between them, is anywhere not: golden
// section (Kiefer 1953), to 1e-6 of the interval.
template <class Function>
bool dips(double low, double high, Function f) {
  constexpr double golden = 0.6180339887498949;
  double a = high - golden * (high - low), b = low + golden * (high - low), fa = f(a), fb = f(b);
  for (int k = 0; k < 28 && fa > 0.0 && fb > 0.0; ++k)
    if (fa < fb) {
      high = b;
      b = a;
      fb = fa;
      a = high - golden * (high - low);
      fa = f(a);
    } else {
      low = a;
      a = b;
      fa = fb;
      b = low + golden * (high - low);
      fb = f(b);
    }
  return !(fa > 0.0 && fb > 0.0);
}

// Whether f, positive at 0 and negative at 1, changes sign more than once. Two changes between samples show
// as an extremum towards zero. More samples near 0: that is the scale of stiff directions.
template <class Function>
bool changes_sign_again(Function f) {
  constexpr int samples = 32;
  double x[3] = {}, y[3] = {infinity, infinity, infinity};  // the last three samples
  int changes = 0;
  for (int k = 1; k <= samples; ++k) {
    const double part = static_cast<double>(k) / samples;
    x[0] = x[1];
    x[1] = x[2];
    x[2] = part * part * part;
    y[0] = y[1];
    y[1] = y[2];
    y[2] = f(x[2]);
    const double sign = y[1] > 0.0 ? 1.0 : -1.0;
    if (!(sign * y[2] > 0.0) && ++changes > 1) return true;
    const bool turns = sign * y[0] >= sign * y[1] && sign * y[1] <= sign * y[2];
    if (turns && dips(x[0], x[2], [&](double p) { return sign * f(p); })) return true;
  }
  return false;
}

}  // namespace ILAW_KIT_LEVEL
}  // namespace cohesive_law
