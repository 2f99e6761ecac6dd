// math.hpp - functions that give the same bits on every processor and vectorise.
// libm may not be used for them: its exp differs in the last place between processors with and without FMA.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/level.hpp>

#include <bit>
#include <cstdint>
#include <limits>

#ifdef __FAST_MATH__
#error "the kit needs IEEE arithmetic: compile without -ffast-math"
#endif

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

inline constexpr double infinity = std::numeric_limits<double>::infinity();

// IEEE operations, spelled so that they inline into vector code; exact or correctly rounded everywhere.
constexpr bool is_finite(double x) { return x - x == 0.0; }
constexpr double larger(double a, double b) { return a > b ? a : b; }
constexpr double smaller(double a, double b) { return a < b ? a : b; }
constexpr double positive_part(double x) { return x > 0.0 ? x : 0.0; }
// Adding and subtracting the number rounds to the nearest whole one, in vector code too.
inline bool is_whole(double x) {
  constexpr double to_integer = 0x1.8p52;
  return ((x + to_integer) - to_integer == x) | (__builtin_fabs(x) >= 0x1p51);
}
inline double absolute(double x) { return __builtin_fabs(x); }
// x or 0. By its bits, since GCC vectorises no choice by a condition that is the same at all nodes.
inline double kept_if(bool condition, double x) {
  return std::bit_cast<double>(std::bit_cast<std::uint64_t>(x) &
                               (std::uint64_t{0} - std::uint64_t{condition}));
}
inline double square_root(double x) { return __builtin_sqrt(x); }

// Halfway between two positive numbers as the bits count: a bisection ends after 64 steps at neighbours.
inline double halfway(double low, double high) {
  const auto a = std::bit_cast<std::uint64_t>(low), b = std::bit_cast<std::uint64_t>(high);
  return std::bit_cast<double>(a + (b - a) / 2);
}

// Powers of two that bring a number to [2, 4) and back: number * down lies there, number = scaled * up / 2.
// They are made from its exponent by integer arithmetic, which vectorises without a branch or a division.
struct power_scale {
  double down, up;
};
inline power_scale power_scale_of(double largest) {
  constexpr std::uint64_t exponent_bits = 0x7FF0000000000000;
  const std::uint64_t exponent =
      std::bit_cast<std::uint64_t>(larger(largest, std::numeric_limits<double>::min())) & exponent_bits;
  return {std::bit_cast<double>(exponent_bits - exponent), std::bit_cast<double>(exponent)};
}

// |(a, b)| and |(a, b, c)| without overflow or underflow on the way.
inline double length(double a, double b) {
  const power_scale scale = power_scale_of(larger(absolute(a), absolute(b)));
  a *= scale.down;
  b *= scale.down;
  return 0.5 * square_root(a * a + b * b) * scale.up;
}
inline double length(double a, double b, double c) {
  const power_scale scale = power_scale_of(larger(larger(absolute(a), absolute(b)), absolute(c)));
  a *= scale.down;
  b *= scale.down;
  c *= scale.down;
  return 0.5 * square_root(a * a + b * b + c * c) * scale.up;
}

// e^x to 1 ulp: x = k ln2 + s with |s| <= ln2/2 (Cody and Waite 1980), Taylor polynomial of degree 13 whose
// remainder is below 5e-18, scaled by 2^k in two steps so that results below the normal range round once.
inline double exp(double x) {
  constexpr double log2e = 1.4426950408889634;
  constexpr double ln2_high = 6.93147180369123816490e-01;  // 32 bits: k * ln2_high is exact
  constexpr double ln2_low = 1.90821492927058770002e-10;
  constexpr double to_integer = 0x1.8p52;  // adding and subtracting it rounds to the nearest integer
  const double clamped = smaller(larger(x, -746.0), 710.0);
  const double k = (clamped * log2e + to_integer) - to_integer;
  const double s = (clamped - k * ln2_high) - k * ln2_low;
  double p = 1.0 / 6227020800.0;
  p = p * s + 1.0 / 479001600.0;
  p = p * s + 1.0 / 39916800.0;
  p = p * s + 1.0 / 3628800.0;
  p = p * s + 1.0 / 362880.0;
  p = p * s + 1.0 / 40320.0;
  p = p * s + 1.0 / 5040.0;
  p = p * s + 1.0 / 720.0;
  p = p * s + 1.0 / 120.0;
  p = p * s + 1.0 / 24.0;
  p = p * s + 1.0 / 6.0;
  p = p * s + 0.5;
  p = p * (s * s) + s;  // the small terms first, so that 1 is added last
  // 2^j from the bits of j + 1023 behind a 1 that is shifted out: no conversion, which few processors have in
  // vectors.
  const auto power_of_two = [](double j) {
    return std::bit_cast<double>(std::bit_cast<std::uint64_t>(j + (0x1p52 + 1023.0)) << 52);
  };
  const double half = (k * 0.5 + to_integer) - to_integer;
  const double first = power_of_two(half), second = power_of_two(k - half);
  const double result = (1.0 + p) * first * second;
  return x == x ? result : x;
}

// ln x to 1 ulp: x = 2^k (1 + f) with 1 + f in [sqrt(1/2), sqrt(2)), and ln(1 + f) = 2 artanh(s), s = f/(2 +
// f), whose series to s^23 leaves less than 1e-18. Summed so that f, which is exact, is added last (after
// FreeBSD's).
inline double log(double x) {
  constexpr double ln2_high = 6.93147180369123816490e-01, ln2_low = 1.90821492927058770002e-10;
  constexpr std::uint64_t one = 0x3FF0000000000000, root_half = 0x3FE6A09E00000000;
  const bool tiny = x < std::numeric_limits<double>::min();
  const std::uint64_t moved = std::bit_cast<std::uint64_t>(tiny ? x * 0x1p54 : x) + (one - root_half);
  const double k =
      std::bit_cast<double>((moved >> 52) | 0x4330000000000000) - (tiny ? 0x1p52 + 1077.0 : 0x1p52 + 1023.0);
  const double f = std::bit_cast<double>((moved & 0x000FFFFFFFFFFFFF) + root_half) - 1.0;
  const double s = f / (2.0 + f), z = s * s;
  double p = 2.0 / 23.0;
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
  const double half_square = 0.5 * f * f;
  const double result = k * ln2_high - ((half_square - (s * (half_square + p * z) + k * ln2_low)) - f);
  const double outside = x == 0.0 ? -infinity : (x > 0.0 ? x : std::numeric_limits<double>::quiet_NaN());
  return x > 0.0 && x < infinity ? result : (x == x ? outside : x);
}

// x^y for x >= 0, y > 0, within 1 + |y ln x| ulp; exact or correctly rounded where laws need it most.
inline double power(double x, double y) {
  const double general = exp(y * log(x));
  return y == 1.0 ? x : (y == 1.5 ? x * square_root(x) : (y == 2.0 ? x * x : general));
}

}  // namespace ilaw::kit
