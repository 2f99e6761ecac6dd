// pack.hpp - the number type V of a law: a double, or a pack of doubles side by side, one per node (lane).
//
// A lane gets the bits that a double gets: one rounding per operation, with -ffp-contract=off. Comparisons of
// packs give masks, of doubles bools; mask_of<V> is either. The same words serve both: select, zero_unless,
// any, larger.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include <bit>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>

// ---- instruction-set levels

// ilaw_add_plugin compiles a law's source once per level, with the compiler's -march. Each level lives in an
// inline namespace of its own, so that the linker never mixes their code. All levels give the same bits: they
// do the same IEEE operations in the same order.
#ifndef ILAW_KIT_LEVEL
#define ILAW_KIT_LEVEL baseline
#endif

// Whether better levels are compiled beside this one. It then serves processors older than 2013 and must give
// the bits, not the speed: all its nodes go the careful way, and the fast loops are not compiled.
#ifdef ILAW_KIT_OTHER_LEVELS
#define ILAW_KIT_IS_SPARE true
#else
#define ILAW_KIT_IS_SPARE false
#endif

#ifdef __FAST_MATH__
#error "the kit needs IEEE arithmetic: compile without -ffast-math"
#endif

// Small functions of packs: a call would pass their registers through memory.
#define ILAW_KIT_INLINE [[gnu::always_inline]] inline
#define ILAW_KIT_LAMBDA __attribute__((always_inline))

// Functions that a loop over packs rarely needs. On a device a call would put the node into memory.
#if defined(ILAW_KIT_DEVICE)
#define ILAW_KIT_APART ILAW_KIT_INLINE
#else
#define ILAW_KIT_APART [[gnu::noinline]]
#endif

// A value that is kept in a vector register: compilers would else read parts of it from memory again.
#if defined(__SSE2__)
#define ILAW_KIT_IN_REGISTER(value) asm("" : "+v"(value))
#else
#define ILAW_KIT_IN_REGISTER(value) static_cast<void>(value)
#endif

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

inline constexpr double infinity = std::numeric_limits<double>::infinity();
inline constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

// ---- doubles

constexpr bool any(bool m) { return m; }
constexpr double select(bool m, double a, double b) { return m ? a : b; }
constexpr double zero_unless(bool m, double a) { return m ? a : 0.0; }
constexpr double larger(double a, double b) { return a > b ? a : b; }
constexpr double smaller(double a, double b) { return a < b ? a : b; }
constexpr double positive_part(double x) { return x > 0.0 ? x : 0.0; }
ILAW_KIT_INLINE double absolute(double x) { return __builtin_fabs(x); }
ILAW_KIT_INLINE double square_root(double x) { return __builtin_sqrt(x); }

namespace detail {

// ---- one register

#if defined(__AVX512F__)
inline constexpr int register_lanes = 8;
#elif defined(__AVX__)
inline constexpr int register_lanes = 4;
#else
inline constexpr int register_lanes = 2;
#endif
inline constexpr auto each_lane = std::make_integer_sequence<int, register_lanes>{};

using one = double __attribute__((vector_size(8 * register_lanes)));
using one_bits = std::uint64_t __attribute__((vector_size(8 * register_lanes)));
using one_ints = std::int64_t __attribute__((vector_size(8 * register_lanes)));

#if defined(__AVX512F__)
using one_mask = __mmask8;
ILAW_KIT_INLINE one_mask and_of(one_mask a, one_mask b) { return _kand_mask8(a, b); }
ILAW_KIT_INLINE one_mask or_of(one_mask a, one_mask b) { return _kor_mask8(a, b); }
ILAW_KIT_INLINE one_mask not_of(one_mask a) { return _knot_mask8(a); }
ILAW_KIT_INLINE one blend(one_mask m, one a, one b) {
  return (one)_mm512_mask_blend_pd(m, (__m512d)b, (__m512d)a);
}
ILAW_KIT_INLINE one zeroed(one_mask m, one a) { return (one)_mm512_maskz_mov_pd(m, (__m512d)a); }
ILAW_KIT_INLINE unsigned bits_of_mask(one_mask m) { return m; }
ILAW_KIT_INLINE one_mask mask_of_bits(unsigned bits) { return static_cast<one_mask>(bits); }
#define ILAW_KIT_COMPARE(name, op, code) \
  ILAW_KIT_INLINE one_mask name(one a, one b) { return _mm512_cmp_pd_mask((__m512d)a, (__m512d)b, code); }
#else
using one_mask = one_ints;
ILAW_KIT_INLINE one_mask and_of(one_mask a, one_mask b) { return a & b; }
ILAW_KIT_INLINE one_mask or_of(one_mask a, one_mask b) { return a | b; }
ILAW_KIT_INLINE one_mask not_of(one_mask a) { return ~a; }
#if defined(__AVX__)
ILAW_KIT_INLINE one blend(one_mask m, one a, one b) { return m ? a : b; }
#else  // GCC 12 stops with an internal error at m ? a : b where it is not optimised
ILAW_KIT_INLINE one blend(one_mask m, one a, one b) { return (one)((m & (one_ints)a) | (~m & (one_ints)b)); }
#endif
ILAW_KIT_INLINE one zeroed(one_mask m, one a) { return (one)(m & (one_ints)a); }
ILAW_KIT_INLINE unsigned bits_of_mask(one_mask m) {
#if defined(__AVX__)
  return static_cast<unsigned>(_mm256_movemask_pd((__m256d)m));
#elif defined(__SSE2__)
  return static_cast<unsigned>(_mm_movemask_pd((__m128d)m));
#else
  unsigned bits = 0;
  for (int k = 0; k < register_lanes; ++k) bits |= m[k] != 0 ? 1u << k : 0u;
  return bits;
#endif
}
ILAW_KIT_INLINE one_mask mask_of_bits(unsigned bits) {
  one_ints lane{};
  for (int k = 0; k < register_lanes; ++k) lane[k] = std::int64_t{1} << k;
  return ((static_cast<std::int64_t>(bits) - one_ints{}) & lane) != 0;
}
#define ILAW_KIT_COMPARE(name, op, code) \
  ILAW_KIT_INLINE one_mask name(one a, one b) { return a op b; }
#endif
ILAW_KIT_COMPARE(is_below, <, _CMP_LT_OQ)
ILAW_KIT_COMPARE(is_at_most, <=, _CMP_LE_OQ)
ILAW_KIT_COMPARE(is_above, >, _CMP_GT_OQ)
ILAW_KIT_COMPARE(is_at_least, >=, _CMP_GE_OQ)
ILAW_KIT_COMPARE(is_equal, ==, _CMP_EQ_OQ)
ILAW_KIT_COMPARE(is_different, !=, _CMP_NEQ_UQ)
#undef ILAW_KIT_COMPARE

// An operation of the level on registers, where it has one.
#if defined(__AVX512F__)
#define ILAW_KIT_ON_REGISTERS(operation) _mm512_##operation##_pd
using native_one = __m512d;
#elif defined(__AVX__)
#define ILAW_KIT_ON_REGISTERS(operation) _mm256_##operation##_pd
using native_one = __m256d;
#elif defined(__SSE2__)
#define ILAW_KIT_ON_REGISTERS(operation) _mm_##operation##_pd
using native_one = __m128d;
#endif
#if defined(ILAW_KIT_ON_REGISTERS)
ILAW_KIT_INLINE one larger_of(one a, one b) {
  return (one)ILAW_KIT_ON_REGISTERS(max)((native_one)a, (native_one)b);
}
ILAW_KIT_INLINE one smaller_of(one a, one b) {
  return (one)ILAW_KIT_ON_REGISTERS(min)((native_one)a, (native_one)b);
}
ILAW_KIT_INLINE one root_of(one x) { return (one)ILAW_KIT_ON_REGISTERS(sqrt)((native_one)x); }
#undef ILAW_KIT_ON_REGISTERS
#else
ILAW_KIT_INLINE one larger_of(one a, one b) { return a > b ? a : b; }
ILAW_KIT_INLINE one smaller_of(one a, one b) { return a < b ? a : b; }
ILAW_KIT_INLINE one root_of(one x) {
  for (int k = 0; k < register_lanes; ++k) x[k] = __builtin_sqrt(x[k]);
  return x;
}
#endif

}  // namespace detail

// ---- packs

template <int Registers>
struct pack_of;

// One truth per lane. Masks are joined by & and |, and have no && or ||, which would be one truth for all
// lanes.
template <int Registers>
struct pack_mask {
  detail::one_mask m[Registers];

  template <class F, int... K>
  ILAW_KIT_INLINE static pack_mask each(F f, std::integer_sequence<int, K...>) {
    return {{f(K)...}};
  }
  template <class F>
  ILAW_KIT_INLINE static pack_mask each(F f) {
    return each(f, std::make_integer_sequence<int, Registers>{});
  }
  ILAW_KIT_INLINE static pack_mask of(bool all) {
    return each([all](int) ILAW_KIT_LAMBDA { return detail::mask_of_bits(all ? ~0U : 0U); });
  }

  ILAW_KIT_INLINE friend pack_mask operator&(pack_mask a, pack_mask b) {
    return each([&](int k) ILAW_KIT_LAMBDA { return detail::and_of(a.m[k], b.m[k]); });
  }
  ILAW_KIT_INLINE friend pack_mask operator|(pack_mask a, pack_mask b) {
    return each([&](int k) ILAW_KIT_LAMBDA { return detail::or_of(a.m[k], b.m[k]); });
  }
  ILAW_KIT_INLINE friend pack_mask operator!(pack_mask a) {
    return each([&](int k) ILAW_KIT_LAMBDA { return detail::not_of(a.m[k]); });
  }
  // With an option of the law, which is the same in all lanes.
  ILAW_KIT_INLINE friend pack_mask operator&(pack_mask a, bool b) { return a & of(b); }
  ILAW_KIT_INLINE friend pack_mask operator&(bool a, pack_mask b) { return of(a) & b; }
  ILAW_KIT_INLINE friend pack_mask operator|(pack_mask a, bool b) { return a | of(b); }
  ILAW_KIT_INLINE friend pack_mask operator|(bool a, pack_mask b) { return of(a) | b; }
  explicit operator bool() const = delete;  // write any(mask): is it one for all lanes?
  template <class Other>
  friend void operator&&(pack_mask a, Other b) = delete;  // write & between masks
  template <class Other>
  friend void operator||(pack_mask a, Other b) = delete;  // write | between masks

  ILAW_KIT_INLINE unsigned bits() const {  // one per lane
    unsigned all = detail::bits_of_mask(m[0]);
#pragma GCC unroll 4
    for (int k = 1; k < Registers; ++k) all |= detail::bits_of_mask(m[k]) << (detail::register_lanes * k);
    return all;
  }
  ILAW_KIT_INLINE friend bool any(pack_mask a) { return a.bits() != 0; }
  ILAW_KIT_INLINE friend pack_of<Registers> select(pack_mask a, pack_of<Registers> x, pack_of<Registers> y) {
    return pack_of<Registers>::each([&](int k)
                                        ILAW_KIT_LAMBDA { return detail::blend(a.m[k], x.v[k], y.v[k]); });
  }
  ILAW_KIT_INLINE friend pack_of<Registers> zero_unless(pack_mask a, pack_of<Registers> x) {
    return pack_of<Registers>::each([&](int k) ILAW_KIT_LAMBDA { return detail::zeroed(a.m[k], x.v[k]); });
  }
};

template <int Registers>
struct pack_of {
  static constexpr int size = detail::register_lanes * Registers;
  using mask = pack_mask<Registers>;

  detail::one v[Registers];

  pack_of() = default;
  pack_of(const pack_of&) = default;
  // Register by register: g++ 12 loses the assignment of a whole vector of packs (node.impulse = node.v_free)
  // between scalar replacement and value numbering.
  ILAW_KIT_INLINE pack_of& operator=(const pack_of& a) {
#pragma GCC unroll 4
    for (int k = 0; k < Registers; ++k) v[k] = a.v[k];
    return *this;
  }
  template <class F, int... K>
  ILAW_KIT_INLINE pack_of(F f, std::integer_sequence<int, K...>) : v{f(K)...} {}
  ILAW_KIT_INLINE pack_of(double x)
      : pack_of([x](int) ILAW_KIT_LAMBDA { return x - detail::one{}; },
                std::make_integer_sequence<int, Registers>{}) {}
  template <class F>
  ILAW_KIT_INLINE static pack_of each(F f) {
    return pack_of(f, std::make_integer_sequence<int, Registers>{});
  }

#define ILAW_KIT_OPERATION(op)                                            \
  ILAW_KIT_INLINE friend pack_of operator op(pack_of a, pack_of b) {      \
    return each([&](int k) ILAW_KIT_LAMBDA { return a.v[k] op b.v[k]; }); \
  }
  ILAW_KIT_OPERATION(+)
  ILAW_KIT_OPERATION(-)
  ILAW_KIT_OPERATION(*)
  ILAW_KIT_OPERATION(/)
#undef ILAW_KIT_OPERATION
#define ILAW_KIT_COMPARISON(op, name)                                                       \
  ILAW_KIT_INLINE friend mask operator op(pack_of a, pack_of b) {                           \
    return mask::each([&](int k) ILAW_KIT_LAMBDA { return detail::name(a.v[k], b.v[k]); }); \
  }
  ILAW_KIT_COMPARISON(<, is_below)
  ILAW_KIT_COMPARISON(<=, is_at_most)
  ILAW_KIT_COMPARISON(>, is_above)
  ILAW_KIT_COMPARISON(>=, is_at_least)
  ILAW_KIT_COMPARISON(==, is_equal)
  ILAW_KIT_COMPARISON(!=, is_different)
#undef ILAW_KIT_COMPARISON
  ILAW_KIT_INLINE friend pack_of operator-(pack_of a) {
    return each([&](int k) ILAW_KIT_LAMBDA { return -a.v[k]; });
  }
  ILAW_KIT_INLINE friend pack_of& operator+=(pack_of& a, pack_of b) { return a = a + b; }
  ILAW_KIT_INLINE friend pack_of& operator-=(pack_of& a, pack_of b) { return a = a - b; }
  ILAW_KIT_INLINE friend pack_of& operator*=(pack_of& a, pack_of b) { return a = a * b; }

  ILAW_KIT_INLINE friend pack_of larger(pack_of a, pack_of b) {
    return each([&](int k) ILAW_KIT_LAMBDA { return detail::larger_of(a.v[k], b.v[k]); });
  }
  ILAW_KIT_INLINE friend pack_of smaller(pack_of a, pack_of b) {
    return each([&](int k) ILAW_KIT_LAMBDA { return detail::smaller_of(a.v[k], b.v[k]); });
  }
  ILAW_KIT_INLINE friend pack_of positive_part(pack_of x) { return larger(x, pack_of(0.0)); }
  ILAW_KIT_INLINE friend pack_of square_root(pack_of x) {
    return each([&](int k) ILAW_KIT_LAMBDA { return detail::root_of(x.v[k]); });
  }
  ILAW_KIT_INLINE friend pack_of absolute(pack_of x) {
    constexpr std::uint64_t all_but_sign = 0x7FFFFFFFFFFFFFFF;
    return each([&](int k) ILAW_KIT_LAMBDA {
      return (detail::one)((detail::one_bits)x.v[k] & (all_but_sign - detail::one_bits{}));
    });
  }
  ILAW_KIT_INLINE double operator[](int lane) const {
    return v[lane / detail::register_lanes][lane % detail::register_lanes];
  }
};

using pack = pack_of<1>;

// A pack of one lane, for nodes one by one: on a device, and where a loop leaves some. Not a double, with
// which laws mean the scalar fallback and may compute in another way.
struct mask_of_one {
  bool m;

  ILAW_KIT_INLINE friend mask_of_one operator&(mask_of_one a, mask_of_one b) { return {a.m && b.m}; }
  ILAW_KIT_INLINE friend mask_of_one operator|(mask_of_one a, mask_of_one b) { return {a.m || b.m}; }
  ILAW_KIT_INLINE friend mask_of_one operator!(mask_of_one a) { return {!a.m}; }
  ILAW_KIT_INLINE friend mask_of_one operator&(mask_of_one a, bool b) { return {a.m && b}; }
  ILAW_KIT_INLINE friend mask_of_one operator&(bool a, mask_of_one b) { return {a && b.m}; }
  ILAW_KIT_INLINE friend mask_of_one operator|(mask_of_one a, bool b) { return {a.m || b}; }
  ILAW_KIT_INLINE friend mask_of_one operator|(bool a, mask_of_one b) { return {a || b.m}; }
  ILAW_KIT_INLINE friend bool any(mask_of_one a) { return a.m; }
};

struct pack_of_one {
  static constexpr int size = 1;
  using mask = mask_of_one;
  double v;

  pack_of_one() = default;
  pack_of_one(const pack_of_one&) = default;
  ILAW_KIT_INLINE pack_of_one& operator=(const pack_of_one& a) {  // as pack_of, for g++ 12
    v = a.v;
    return *this;
  }
  ILAW_KIT_INLINE pack_of_one(double x) : v(x) {}
  template <class T>
  ILAW_KIT_INLINE explicit operator T() const requires std::is_arithmetic_v<T> {
    return static_cast<T>(v);
  }

#define ILAW_KIT_OPERATION(op) \
  ILAW_KIT_INLINE friend pack_of_one operator op(pack_of_one a, pack_of_one b) { return a.v op b.v; }
  ILAW_KIT_OPERATION(+)
  ILAW_KIT_OPERATION(-)
  ILAW_KIT_OPERATION(*)
  ILAW_KIT_OPERATION(/)
#undef ILAW_KIT_OPERATION
#define ILAW_KIT_COMPARISON(op) \
  ILAW_KIT_INLINE friend mask operator op(pack_of_one a, pack_of_one b) { return {a.v op b.v}; }
  ILAW_KIT_COMPARISON(<)
  ILAW_KIT_COMPARISON(<=)
  ILAW_KIT_COMPARISON(>)
  ILAW_KIT_COMPARISON(>=)
  ILAW_KIT_COMPARISON(==)
  ILAW_KIT_COMPARISON(!=)
#undef ILAW_KIT_COMPARISON
  ILAW_KIT_INLINE friend pack_of_one operator-(pack_of_one a) { return -a.v; }
  ILAW_KIT_INLINE friend pack_of_one& operator+=(pack_of_one& a, pack_of_one b) { return a = a + b; }
  ILAW_KIT_INLINE friend pack_of_one& operator-=(pack_of_one& a, pack_of_one b) { return a = a - b; }
  ILAW_KIT_INLINE friend pack_of_one& operator*=(pack_of_one& a, pack_of_one b) { return a = a * b; }

  ILAW_KIT_INLINE friend pack_of_one select(mask m, pack_of_one a, pack_of_one b) { return m.m ? a.v : b.v; }
  ILAW_KIT_INLINE friend pack_of_one zero_unless(mask m, pack_of_one a) { return m.m ? a.v : 0.0; }
  ILAW_KIT_INLINE friend pack_of_one larger(pack_of_one a, pack_of_one b) { return kit::larger(a.v, b.v); }
  ILAW_KIT_INLINE friend pack_of_one smaller(pack_of_one a, pack_of_one b) { return kit::smaller(a.v, b.v); }
  ILAW_KIT_INLINE friend pack_of_one positive_part(pack_of_one x) { return kit::positive_part(x.v); }
  ILAW_KIT_INLINE friend pack_of_one square_root(pack_of_one x) { return kit::square_root(x.v); }
  ILAW_KIT_INLINE friend pack_of_one absolute(pack_of_one x) { return kit::absolute(x.v); }
  ILAW_KIT_INLINE double operator[](int /*lane*/) const { return v; }
};

template <class V>
using mask_of = decltype(V{} < V{});

namespace detail {

// ---- the bits of a number, for functions made from its exponent

template <class V>
struct bits_of {  // of a pack
  using type = bits_of;
  one_bits b[V::size / register_lanes];

  template <class F>
  ILAW_KIT_INLINE static bits_of each(F f) {
    bits_of a;
#pragma GCC unroll 4
    for (int k = 0; k < V::size / register_lanes; ++k) a.b[k] = f(k);
    return a;
  }
  ILAW_KIT_INLINE static bits_of in(V x) {
    return each([&](int k) ILAW_KIT_LAMBDA { return (one_bits)x.v[k]; });
  }
  ILAW_KIT_INLINE static bits_of of(std::uint64_t all) {
    return each([&](int) ILAW_KIT_LAMBDA { return all - one_bits{}; });
  }
  ILAW_KIT_INLINE static V number(bits_of a) {
    return V::each([&](int k) ILAW_KIT_LAMBDA { return (one)a.b[k]; });
  }
#define ILAW_KIT_OPERATION(op)                                            \
  ILAW_KIT_INLINE friend bits_of operator op(bits_of x, bits_of y) {      \
    return each([&](int k) ILAW_KIT_LAMBDA { return x.b[k] op y.b[k]; }); \
  }
  ILAW_KIT_OPERATION(+)
  ILAW_KIT_OPERATION(-)
  ILAW_KIT_OPERATION(&)
  ILAW_KIT_OPERATION(|)
#undef ILAW_KIT_OPERATION
  ILAW_KIT_INLINE friend bits_of operator<<(bits_of a, int n) {
    return each([&](int k) ILAW_KIT_LAMBDA { return a.b[k] << n; });
  }
  ILAW_KIT_INLINE friend bits_of operator>>(bits_of a, int n) {
    return each([&](int k) ILAW_KIT_LAMBDA { return a.b[k] >> n; });
  }
};
template <>
struct bits_of<double> {
  using type = std::uint64_t;
  ILAW_KIT_INLINE static type in(double x) { return std::bit_cast<type>(x); }
  ILAW_KIT_INLINE static type of(std::uint64_t all) { return all; }
  ILAW_KIT_INLINE static double number(type bits) { return std::bit_cast<double>(bits); }
};
template <>
struct bits_of<pack_of_one> : bits_of<double> {
  ILAW_KIT_INLINE static type in(pack_of_one x) { return std::bit_cast<type>(x.v); }
  ILAW_KIT_INLINE static pack_of_one number(type bits) { return std::bit_cast<double>(bits); }
};

// Whether numbers differ in any bit, as 0 and -0 do.
ILAW_KIT_INLINE one_mask have_other_bits(one a, one b) {
#if defined(__AVX512F__)
  return _mm512_cmpneq_epi64_mask((__m512i)a, (__m512i)b);
#else
  return (one_bits)a != (one_bits)b;
#endif
}
template <int Registers>
ILAW_KIT_INLINE pack_mask<Registers> have_other_bits(pack_of<Registers> a, pack_of<Registers> b) {
  return pack_mask<Registers>::each([&](int k) ILAW_KIT_LAMBDA { return have_other_bits(a.v[k], b.v[k]); });
}
ILAW_KIT_INLINE bool have_other_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) != std::bit_cast<std::uint64_t>(b);
}
ILAW_KIT_INLINE mask_of_one have_other_bits(pack_of_one a, pack_of_one b) {
  return {have_other_bits(a.v, b.v)};
}

// ---- the lanes of a V

template <class V>
inline constexpr int lanes_of = V::size;
template <>
inline constexpr int lanes_of<double> = 1;

template <int Registers>
ILAW_KIT_INLINE unsigned mask_bits(pack_mask<Registers> m) {
  return m.bits();
}
ILAW_KIT_INLINE unsigned mask_bits(bool m) { return m ? 1U : 0U; }
ILAW_KIT_INLINE unsigned mask_bits(mask_of_one a) { return a.m ? 1U : 0U; }
template <class V>
ILAW_KIT_INLINE mask_of<V> mask_from(unsigned bits) {
  return mask_of<V>::each([&](int k) ILAW_KIT_LAMBDA { return mask_of_bits(bits >> (register_lanes * k)); });
}
template <>
ILAW_KIT_INLINE bool mask_from<double>(unsigned bits) {
  return bits != 0;
}
template <>
ILAW_KIT_INLINE mask_of_one mask_from<pack_of_one>(unsigned bits) {
  return {bits != 0};
}
ILAW_KIT_INLINE double lane_of(double x, int /*lane*/) { return x; }
ILAW_KIT_INLINE double lane_of(pack_of_one x, int /*lane*/) { return x.v; }
template <int Registers>
ILAW_KIT_INLINE double lane_of(pack_of<Registers> x, int lane) {
  return x[lane];
}

}  // namespace detail

// No lane, and all of them.
template <class V>
ILAW_KIT_INLINE mask_of<V> none() {
  return detail::mask_from<V>(0U);
}
template <class V>
ILAW_KIT_INLINE mask_of<V> all() {
  return detail::mask_from<V>(~0U);
}

// f of numbers, in each lane.
template <class V, class Function, class... More>
V lane_by_lane(Function f, V first, More... more) {
  double found[detail::lanes_of<V>];
  for (int lane = 0; lane < detail::lanes_of<V>; ++lane)
    found[lane] = f(detail::lane_of(first, lane), detail::lane_of(more, lane)...);
  V result;
  __builtin_memcpy(static_cast<void*>(&result), found, sizeof found);
  return result;
}

// Zero where a check passes, NaN where not: checks multiply such residuals instead of joining masks.
template <class V>
ILAW_KIT_INLINE V nan_unless(mask_of<V> good, V found) {
  return select(good, found, V(not_a_number));
}

}  // namespace ilaw::kit
