// roots.hpp - roots of functions of one number, in all lanes side by side.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/math.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

// A function at one place x. The equation x = g(x) has value = size (x - g(x)); in any other, size is about
// that slope: x is a root where |value| <= 2^-50 size x, and x - value/size follows where a step leaves the
// bracket. Its slope is rise/run, an estimate or, where it is exact, the derivative.
template <class V>
struct root_trial {
  V value, size, rise, run;
  mask_of<V> is_exact;
};

// Where f, not positive at low >= 0 and not negative at high, changes sign, in the lanes where active; others
// keep x. Newton's steps where the slope is exact, else secants after the first (Dekker 1969); the fixed
// point where these leave the bracket; bisection after most_steps of them. The last place that f is called at
// is the result, in all lanes, so what f keeps of it may be used. A jump across zero is found as well. NaN
// where f is at the last place at which it was looked at.
template <class V, class Function>
ILAW_KIT_INLINE V root_between(V low, V high, V x, mask_of<V> active, Function f) {
  constexpr int most_steps = 24, most_bisections = 80;
  constexpr double rounding = 0x1p-50, close = 0x1p-64;  // close: of the product of the last two errors
  V before = x, value_before = 0.0;
  mask_of<V> is_lost = none<V>();
  for (int k = 0;; ++k) {
    const root_trial<V> t = f(x);
    is_lost = (is_lost & !active) | (active & (t.value != t.value));
    active = active & ((absolute(t.value) > rounding * (absolute(x) * t.size)) | is_lost);
    if (!any(active) || k == most_steps + most_bisections) return select(is_lost, V(not_a_number), x);
    low = select(active & (t.value < 0.0), x, low);
    high = select(active & (t.value >= 0.0), x, high);
    V rise = t.rise, run = t.run;
    if (k > 0) {
      rise = select(t.is_exact, rise, t.value - value_before);
      run = select(t.is_exact, run, x - before);
    }
    const V along = x - t.value * run / rise;
    const mask_of<V> inside = (along > low) & (along < high);
    V next = along;
    if (any(!inside)) next = select(inside, along, smaller(larger(x - t.value / t.size, low), high));
    if (k >= most_steps) [[unlikely]]
      next = halfway(low, high);
    const V step = absolute(next - x);
    const V last = k == 0 ? step : select(t.is_exact, step, absolute(x - before));
    const V down = power_scale_of(absolute(x)).down, size = down * x;  // lest the squares leave the numbers
    mask_of<V> moves = (down * step) * (down * last) > close * (size * size);
    if (k >= most_steps) [[unlikely]]
      moves = (next > low) & (next < high);
    before = select(active, x, before);
    value_before = select(active, t.value, value_before);
    x = select(active, next, x);
    active = active & moves;
  }
}

template <class V>
struct value_and_slope {
  V value, slope;
};

// Where f, not positive at low and not negative at high, changes sign, in the lanes where active; others keep
// high. Newton's steps from high on, halves of the bracket where these leave it and after most_steps of them.
// For x of size 1 to 1e3, such as logarithms: the error is 2^-50, or the rounding of x.
template <class V, class Function>
ILAW_KIT_INLINE V newton_between(V low, V high, mask_of<V> active, Function f) {
  constexpr int most_steps = 20, most_bisections = 80;
  constexpr double close = 0x1p-33, closest = 0x1p-50;  // close: the next step of Newton is the square of it
  V x = high;
  for (int k = 0; any(active) && k < most_steps + most_bisections; ++k) {
    const value_and_slope<V> at = f(x);
    low = select(at.value < 0.0, x, low);
    high = select(at.value < 0.0, high, x);
    const V newton = x - at.value / at.slope;
    const mask_of<V> inside = (newton >= low) & (newton <= high) & (V(k) < V(most_steps));
    const V next = select(inside, newton, 0.5 * (low + high)), step = absolute(next - x);
    x = select(active, next, x);
    active = active & (step > select(inside, V(close), V(closest)));
  }
  return x;
}

// The largest part of [0, 1] at which `holds` is true, as it is at 0 where active, and false at 1: bisection
// to neighbouring numbers. 0 in other lanes.
template <class V, class Predicate>
ILAW_KIT_INLINE V last_part(mask_of<V> active, Predicate holds) {
  V low = 0.0, high = 1.0, middle = 0.5;
  for (; any(active); active = active & (middle > low) & (middle < high)) {
    const mask_of<V> is_so = holds(middle);
    low = select(active & is_so, middle, low);
    high = select(active & !is_so, middle, high);
    middle = 0.5 * (low + high);
  }
  return low;
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
// as an extremum towards zero. More samples near 0, the scale of stiff directions.
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

}  // namespace ilaw::kit
