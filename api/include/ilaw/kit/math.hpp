// math.hpp - functions that give the same bits on every processor and vectorise.
// libm may not be used for them: its exp differs in the last place between processors with and without FMA.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/level.hpp>

#include <bit>
#include <cstdint>
#include <limits>

#ifdef __FAST_MATH__
#error "the kit needs IEEE arithmetic: compile without -ffast-math"
#endif

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

inline constexpr double infinity = std::numeric_limits<double>::infinity();

// IEEE operations, spelled so that they inline into vector code; exact or correctly rounded everywhere.
constexpr bool finite(double x) { return x - x == 0.0; }
constexpr double larger(double a, double b) { return a > b ? a : b; }
constexpr double smaller(double a, double b) { return a < b ? a : b; }
constexpr double positive_part(double x) { return x > 0.0 ? x : 0.0; }
inline double absolute(double x) { return __builtin_fabs(x); }
inline double square_root(double x) { return __builtin_sqrt(x); }

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
  const auto exponent = static_cast<std::int64_t>(k);
  const std::int64_t half = exponent / 2;
  const double first = std::bit_cast<double>((half + 1023) << 52);
  const double second = std::bit_cast<double>((exponent - half + 1023) << 52);
  const double result = (1.0 + p) * first * second;
  return x == x ? result : x;
}

}  // namespace ilaw::kit
