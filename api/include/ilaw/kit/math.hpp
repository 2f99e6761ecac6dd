// math.hpp - functions that give the same bits on every processor, for a double and for a pack.
// libm may not be used for them: its exp differs in the last place between processors with and without FMA.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/pack.hpp>

#include <type_traits>

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

constexpr bool is_finite(double x) { return x - x == 0.0; }
// Adding and subtracting the number rounds to the nearest whole one.
template <class V>
ILAW_KIT_INLINE mask_of<V> is_whole(V x) {
  constexpr double to_integer = 0x1.8p52;
  return ((x + to_integer) - to_integer == x) | (absolute(x) >= 0x1p51);
}
// The largest whole number up to x, for |x| < 2^63.
inline double floor_of(double x) {
  const auto cut = static_cast<double>(static_cast<std::int64_t>(x));
  return cut > x ? cut - 1.0 : cut;
}

// Halfway between two positive numbers as their bits count: a bisection ends after 64 steps at neighbours.
template <class V>
ILAW_KIT_INLINE V halfway(V low, V high) {
  using bits = detail::bits_of<V>;
  return bits::number(bits::in(low) + ((bits::in(high)-bits::in(low)) >> 1));
}

// Powers of two that bring a number to [2, 4) and back: number * down lies there, number = scaled * up / 2.
// They are made from its exponent by integer arithmetic, which vectorises without a branch or a division.
template <class V>
struct power_scale {
  V down, up;
};
template <class V>
ILAW_KIT_INLINE power_scale<V> power_scale_of(V largest) {
  using bits = detail::bits_of<V>;
  constexpr std::uint64_t exponent_bits = 0x7FF0000000000000;
  // A sum, of which compilers make one instruction, and of the choice of the larger one four.
  const auto exponent = bits::in(largest + std::numeric_limits<double>::min()) & bits::of(exponent_bits);
  return {bits::number(bits::of(exponent_bits) - exponent), bits::number(exponent)};
}

// A length without overflow or underflow on the way: square is that of down * the vector.
template <class V>
struct scaled_length {
  V square, down, up;
  ILAW_KIT_INLINE V root() const { return square_root(square); }  // of down * the vector
  ILAW_KIT_INLINE V length() const { return 0.5 * root() * up; }
};
template <class V>
ILAW_KIT_INLINE scaled_length<V> scaled_length_of(V a, V b) {
  const power_scale<V> scale = power_scale_of(larger(absolute(a), absolute(b)));
  a = a * scale.down;
  b = b * scale.down;
  return {a * a + b * b, scale.down, scale.up};
}
template <class V>
ILAW_KIT_INLINE scaled_length<V> scaled_length_of(V a, V b, V c) {
  const auto scale = power_scale_of(larger(larger(absolute(a), absolute(b)), absolute(c)));
  a = a * scale.down;
  b = b * scale.down;
  c = c * scale.down;
  return {a * a + b * b + c * c, scale.down, scale.up};
}
template <class V>
ILAW_KIT_INLINE V length(V a, V b) {
  return scaled_length_of(a, b).length();
}
template <class V>
ILAW_KIT_INLINE V length(V a, V b, V c) {
  return scaled_length_of(a, b, c).length();
}

namespace detail {

// e^x = (1 + p) first second, two powers of two so that results below the normal range round once.
template <class V>
struct exponential_parts {
  V p, first, second;
};

// To 1 ulp: x = k ln2 + s with |s| <= ln2/2 (Cody and Waite 1980), p the Taylor polynomial of degree 13,
// whose remainder is below 5e-18.
template <class V>
ILAW_KIT_INLINE exponential_parts<V> parts_of_exponential(V x) {
  using bits = bits_of<V>;
  constexpr double log2e = 1.4426950408889634;
  constexpr double ln2_high = 6.93147180369123816490e-01;  // 32 bits: k * ln2_high is exact
  constexpr double ln2_low = 1.90821492927058770002e-10;
  constexpr double to_integer = 0x1.8p52;  // adding and subtracting it rounds to the nearest integer
  const V clamped = smaller(larger(x, V(-746.0)), V(710.0));
  const V k = (clamped * log2e + to_integer) - to_integer;
  const V s = (clamped - k * ln2_high) - k * ln2_low;
  // By Estrin's scheme, which waits half as long as Horner's.
  const V s2 = s * s, s4 = s2 * s2;
  const V low = (1.0 / 6.0 + s * (1.0 / 24.0)) + s2 * (1.0 / 120.0 + s * (1.0 / 720.0));
  const V middle = (1.0 / 5040.0 + s * (1.0 / 40320.0)) + s2 * (1.0 / 362880.0 + s * (1.0 / 3628800.0));
  const V high = (1.0 / 39916800.0 + s * (1.0 / 479001600.0)) + s2 * (1.0 / 6227020800.0);
  const V p = (0.5 + s * (low + s4 * (middle + s4 * high))) * s2 + s;  // the small terms first
  // 2^j from the bits of j + 1023 behind a 1 that is shifted out: no conversion, which few processors have in
  // vectors.
  const auto power_of_two = [](V j) ILAW_KIT_LAMBDA {
    return bits::number(bits::in(j + (0x1p52 + 1023.0)) << 52);
  };
  const V half = (k * 0.5 + to_integer) - to_integer;
  return {p, power_of_two(half), power_of_two(k - half)};
}
template <class V>
ILAW_KIT_INLINE V exponential(V x) {
  const exponential_parts<V> e = parts_of_exponential(x);
  const V result = (1.0 + e.p) * e.first * e.second;  // 1 is added last
  return select(x == x, result, x);
}

// ln x to 1 ulp: x = 2^k (1 + f) with 1 + f in [sqrt(1/2), sqrt(2)), and ln(1 + f) = 2 artanh(s), s = f/(2 +
// f), whose series to s^23 leaves less than 1e-18. Summed so that f, which is exact, is added last (after
// FreeBSD's).
template <class V>
ILAW_KIT_INLINE V logarithm(V x) {
  using bits = bits_of<V>;
  constexpr double ln2_high = 6.93147180369123816490e-01, ln2_low = 1.90821492927058770002e-10;
  constexpr std::uint64_t bits_of_one = 0x3FF0000000000000, root_half = 0x3FE6A09E00000000;
  const auto tiny = x < std::numeric_limits<double>::min();
  const auto moved = bits::in(select(tiny, x * 0x1p54, x)) + bits::of(bits_of_one - root_half);
  const V k = bits::number((moved >> 52) | bits::of(0x4330000000000000)) -
              select(tiny, V(0x1p52 + 1077.0), V(0x1p52 + 1023.0));
  const V f = bits::number((moved & bits::of(0x000FFFFFFFFFFFFF)) + bits::of(root_half)) - 1.0;
  const V s = f / (2.0 + f), z = s * s;
  V p = 2.0 / 23.0;
  p = p * z + 2.0 / 21.0;
  p = p * z + 2.0 / 19.0;
  p = p * z + 2.0 / 17.0;
  p = p * z + 2.0 / 15.0;
  p = p * z + 2.0 / 13.0;
  p = p * z + 2.0 / 11.0;
  p = p * z + 2.0 / 9.0;
  p = p * z + 2.0 / 7.0;
  p = p * z + 2.0 / 5.0;
  p = p * z + 2.0 / 3.0;
  const V half_square = 0.5 * f * f;
  const V result = k * ln2_high - ((half_square - (s * (half_square + p * z) + k * ln2_low)) - f);
  const V nan = std::numeric_limits<double>::quiet_NaN();
  const V outside = select(x == 0.0, V(-infinity), select(x > 0.0, x, nan));
  return select((x > 0.0) & (x < infinity), result, select(x == x, outside, x));
}

}  // namespace detail

inline double exp(double x) { return detail::exponential(x); }
inline double log(double x) { return detail::logarithm(x); }
ILAW_KIT_INLINE pack_of_one exp(pack_of_one x) { return exp(x.v); }
ILAW_KIT_INLINE pack_of_one log(pack_of_one x) { return log(x.v); }
// Calls, lest a loop have several hundred bytes at each place. Two registers would be passed through memory.
[[gnu::noinline]] inline pack exp(pack x) { return detail::exponential(x); }
[[gnu::noinline]] inline pack log(pack x) { return detail::logarithm(x); }
template <int Registers>
ILAW_KIT_INLINE pack_of<Registers> exp(pack_of<Registers> x) {
  return detail::exponential(x);
}
template <int Registers>
ILAW_KIT_INLINE pack_of<Registers> log(pack_of<Registers> x) {
  return detail::logarithm(x);
}

// e^x and, for x <= 0 and to 2 ulp also where it is small, e^x - 1.
template <class V>
struct exponentials {
  V exp, minus_one;
};
template <class V>
exponentials<V> exponentials_of(V x) {
  const detail::exponential_parts<V> e = detail::parts_of_exponential(x);
  const V whole = (1.0 + e.p) * e.first * e.second, scale = e.first * e.second;
  return {select(x == x, whole, x), select(x == x, e.p * scale + (scale - 1.0), x)};
}
template <class V>
V exp_minus_one(V x) {
  return exponentials_of(x).minus_one;
}
// ln(1 + x) for -1/2 <= x <= 1, to 2 ulp also where it is small.
// The rounding error of the sum is added, times the derivative 1/sum.
template <class V>
V log_one_plus(V x) {
  const V sum = 1.0 + x;
  return detail::logarithm(sum) + (x - (sum - 1.0)) / sum;
}

// x^y for x >= 0, y > 0, within 1 + |y ln x| ulp; exact or correctly rounded where laws need it most.
template <class V>
V power(V x, std::type_identity_t<V> y) {
  const V general = exp(y * log(x));
  const V squared = select(y == 2.0, x * x, general);
  return select(y == 1.0, x, select(y == 1.5, x * square_root(x), squared));
}

}  // namespace ilaw::kit
