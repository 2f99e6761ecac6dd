// number.hpp - the number type V of a law on a device: a pack of one lane. Not a double, with which
// laws mean the scalar fallback and may compute in another way.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/node.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

struct device_mask {
  bool m;

  ILAW_KIT_INLINE friend device_mask operator&(device_mask a, device_mask b) { return {a.m && b.m}; }
  ILAW_KIT_INLINE friend device_mask operator|(device_mask a, device_mask b) { return {a.m || b.m}; }
  ILAW_KIT_INLINE friend device_mask operator!(device_mask a) { return {!a.m}; }
  ILAW_KIT_INLINE friend device_mask operator&(device_mask a, bool b) { return {a.m && b}; }
  ILAW_KIT_INLINE friend device_mask operator&(bool a, device_mask b) { return {a && b.m}; }
  ILAW_KIT_INLINE friend device_mask operator|(device_mask a, bool b) { return {a.m || b}; }
  ILAW_KIT_INLINE friend device_mask operator|(bool a, device_mask b) { return {a || b.m}; }
  ILAW_KIT_INLINE friend bool any(device_mask a) { return a.m; }
  ILAW_KIT_INLINE friend unsigned mask_bits(device_mask a) { return a.m ? 1U : 0U; }
};

struct device_number {
  static constexpr int size = 1;
  using mask = device_mask;
  double v;

  device_number() = default;
  ILAW_KIT_INLINE device_number(double x) : v(x) {}
  template <class T>
  ILAW_KIT_INLINE explicit operator T() const requires std::is_arithmetic_v<T> {
    return static_cast<T>(v);
  }

#define ILAW_KIT_OPERATION(op) \
  ILAW_KIT_INLINE friend device_number operator op(device_number a, device_number b) { return a.v op b.v; }
  ILAW_KIT_OPERATION(+)
  ILAW_KIT_OPERATION(-)
  ILAW_KIT_OPERATION(*)
  ILAW_KIT_OPERATION(/)
#undef ILAW_KIT_OPERATION
#define ILAW_KIT_COMPARISON(op) \
  ILAW_KIT_INLINE friend mask operator op(device_number a, device_number b) { return {a.v op b.v}; }
  ILAW_KIT_COMPARISON(<)
  ILAW_KIT_COMPARISON(<=)
  ILAW_KIT_COMPARISON(>)
  ILAW_KIT_COMPARISON(>=)
  ILAW_KIT_COMPARISON(==)
  ILAW_KIT_COMPARISON(!=)
#undef ILAW_KIT_COMPARISON
  ILAW_KIT_INLINE friend device_number operator-(device_number a) { return -a.v; }
  ILAW_KIT_INLINE friend device_number& operator+=(device_number& a, device_number b) { return a = a + b; }
  ILAW_KIT_INLINE friend device_number& operator-=(device_number& a, device_number b) { return a = a - b; }
  ILAW_KIT_INLINE friend device_number& operator*=(device_number& a, device_number b) { return a = a * b; }

  ILAW_KIT_INLINE friend device_number select(mask m, device_number a, device_number b) {
    return m.m ? a.v : b.v;
  }
  ILAW_KIT_INLINE friend device_number zero_unless(mask m, device_number a) { return m.m ? a.v : 0.0; }
  ILAW_KIT_INLINE friend device_number larger(device_number a, device_number b) {
    return kit::larger(a.v, b.v);
  }
  ILAW_KIT_INLINE friend device_number smaller(device_number a, device_number b) {
    return kit::smaller(a.v, b.v);
  }
  ILAW_KIT_INLINE friend device_number positive_part(device_number x) { return kit::positive_part(x.v); }
  ILAW_KIT_INLINE friend device_number square_root(device_number x) { return kit::square_root(x.v); }
  ILAW_KIT_INLINE friend device_number absolute(device_number x) { return kit::absolute(x.v); }
  ILAW_KIT_INLINE friend device_number exp(device_number x) { return kit::exp(x.v); }
  ILAW_KIT_INLINE friend device_number log(device_number x) { return kit::log(x.v); }

  ILAW_KIT_INLINE friend mask have_other_bits(device_number a, device_number b) {
    return {detail::have_other_bits(a.v, b.v)};
  }
  ILAW_KIT_INLINE friend double lane_of(device_number x, int /*lane*/) { return x.v; }
  ILAW_KIT_INLINE double operator[](int /*lane*/) const { return v; }
};

template <>
struct bits_of<device_number> {
  using type = std::uint64_t;
  ILAW_KIT_INLINE static type in(device_number x) { return std::bit_cast<type>(x.v); }
  ILAW_KIT_INLINE static type of(std::uint64_t all) { return all; }
  ILAW_KIT_INLINE static device_number number(type bits) { return std::bit_cast<double>(bits); }
};
template <>
ILAW_KIT_INLINE device_mask mask_from<device_number>(unsigned bits) {
  return {bits != 0};
}
ILAW_KIT_INLINE status_of<device_number> select(device_mask m, status_value a, status_value b) {
  return m.m ? a : b;
}

}  // namespace ilaw::kit::detail
