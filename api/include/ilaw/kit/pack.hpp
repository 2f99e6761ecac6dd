// pack.hpp - doubles side by side, some registers of this level's instruction set full, for solvers that are
// written once for one problem (V = double) and for a pack of them (V = pack).
//
// Made of the vector extensions of GCC and clang: they compile to the same instructions as
// std::experimental::simd and take 0.03 s to compile instead of 2 s per instruction set, and, unlike it or
// Highway, bring no function that a linker could share between levels. Both compilers keep to one rounding
// per operation with -ffp-contract=off, so that a lane gets the bits that a double gets.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/math.hpp>

#include <cstdint>

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

// What one register of this level holds, and how many of them make a pack: one waits for its division or
// root while the other works.
#if defined(__AVX512F__)
inline constexpr int register_size = 8;
#elif defined(__AVX__)
inline constexpr int register_size = 4;
#else
inline constexpr int register_size = 2;
#endif
inline constexpr int pack_registers = 2;
inline constexpr int pack_size = pack_registers * register_size;

namespace detail {

template <class Number>
struct register_of;
template <>
struct register_of<double> {
  using type = double __attribute__((vector_size(8 * register_size)));
};
template <>
struct register_of<std::int64_t> {
  using type = std::int64_t __attribute__((vector_size(8 * register_size)));
};
template <>
struct register_of<std::uint64_t> {
  using type = std::uint64_t __attribute__((vector_size(8 * register_size)));
};
template <class Number>
struct registers {
  using one = typename register_of<Number>::type;
  one part[pack_registers];
};

// Register by register.
template <class Result, class Function>
[[gnu::always_inline]] inline registers<Result> each(Function f) {
  registers<Result> all;
  for (int k = 0; k < pack_registers; ++k) all.part[k] = f(k);
  return all;
}

}  // namespace detail

// The bits of a pack.
class bit_pack {
 public:
  using lanes = detail::registers<std::uint64_t>;

  explicit bit_pack(lanes v) : v_(v) {}
  explicit bit_pack(std::uint64_t all)
      : v_(detail::each<std::uint64_t>([all](int) { return all - lanes::one{}; })) {}
  const lanes& values() const { return v_; }

#define ILAW_KIT_OF_BITS(operation)                                                               \
  friend bit_pack operator operation(bit_pack a, bit_pack b) {                                    \
    return bit_pack(                                                                              \
        detail::each<std::uint64_t>([&](int k) { return a.v_.part[k] operation b.v_.part[k]; })); \
  }
  ILAW_KIT_OF_BITS(+)
  ILAW_KIT_OF_BITS(-)
  ILAW_KIT_OF_BITS(&)
  ILAW_KIT_OF_BITS(|)
#undef ILAW_KIT_OF_BITS
  friend bit_pack operator<<(bit_pack a, int n) {
    return bit_pack(detail::each<std::uint64_t>([&](int k) { return a.v_.part[k] << n; }));
  }
  friend bit_pack operator>>(bit_pack a, int n) {
    return bit_pack(detail::each<std::uint64_t>([&](int k) { return a.v_.part[k] >> n; }));
  }

 private:
  lanes v_;
};

// What comparisons of packs give: per lane all bits or none.
class mask {
 public:
  using lanes = detail::registers<std::int64_t>;

  explicit mask(lanes v) : v_(v) {}
  explicit mask(bool all)
      : v_(detail::each<std::int64_t>(
            [all](int) { return (all ? std::int64_t{-1} : std::int64_t{0}) - lanes::one{}; })) {}
  friend mask operator&(mask a, mask b) {
    return mask(detail::each<std::int64_t>([&](int k) { return a.v_.part[k] & b.v_.part[k]; }));
  }
  friend mask operator|(mask a, mask b) {
    return mask(detail::each<std::int64_t>([&](int k) { return a.v_.part[k] | b.v_.part[k]; }));
  }
  friend mask operator!(mask a) {
    return mask(detail::each<std::int64_t>([&](int k) { return ~a.v_.part[k]; }));
  }
  bool operator[](int lane) const { return v_.part[lane / register_size][lane % register_size] != 0; }
  const lanes& values() const { return v_; }

 private:
  lanes v_;
};

class pack {
 public:
  using lanes = detail::registers<double>;

  pack() = default;
  pack(double all) : v_(detail::each<double>([all](int) { return all - lanes::one{}; })) {}
  explicit pack(lanes v) : v_(v) {}
  explicit pack(bit_pack bits)
      : v_(detail::each<double>([&](int k) { return reinterpret_cast<lanes::one>(bits.values().part[k]); })) {
  }

  static pack load(const double* values) {
    pack p;
    __builtin_memcpy(&p.v_, values, sizeof p.v_);
    return p;
  }
  void store(double* values) const { __builtin_memcpy(values, &v_, sizeof v_); }
  const lanes& values() const { return v_; }
  double operator[](int lane) const { return v_.part[lane / register_size][lane % register_size]; }
  bit_pack bits() const {
    return bit_pack(detail::each<std::uint64_t>(
        [&](int k) { return reinterpret_cast<bit_pack::lanes::one>(v_.part[k]); }));
  }

#define ILAW_KIT_OF_PACKS(operation)                                                               \
  friend pack operator operation(pack a, pack b) {                                                 \
    return pack(detail::each<double>([&](int k) { return a.v_.part[k] operation b.v_.part[k]; })); \
  }
  ILAW_KIT_OF_PACKS(+)
  ILAW_KIT_OF_PACKS(-)
  ILAW_KIT_OF_PACKS(*)
  ILAW_KIT_OF_PACKS(/)
#undef ILAW_KIT_OF_PACKS
#define ILAW_KIT_OF_PACKS(operation)                                                                     \
  friend mask operator operation(pack a, pack b) {                                                       \
    return mask(detail::each<std::int64_t>([&](int k) { return a.v_.part[k] operation b.v_.part[k]; })); \
  }
  ILAW_KIT_OF_PACKS(<)
  ILAW_KIT_OF_PACKS(<=)
  ILAW_KIT_OF_PACKS(>)
  ILAW_KIT_OF_PACKS(>=)
  ILAW_KIT_OF_PACKS(==)
  ILAW_KIT_OF_PACKS(!=)
#undef ILAW_KIT_OF_PACKS
  friend pack operator-(pack a) {
    return pack(detail::each<double>([&](int k) { return -a.v_.part[k]; }));
  }

 private:
  lanes v_;
};

// The same words for a double (math.hpp) and for a pack.
[[gnu::always_inline]] inline pack select(mask m, pack a, pack b) {
  return pack(detail::each<double>(
      [&](int k) { return m.values().part[k] ? a.values().part[k] : b.values().part[k]; }));
}

// The words of math.hpp for one register, which those for a pack are made of.
namespace detail {

using one_register = registers<double>::one;
using register_mask = decltype(one_register{} < one_register{});

[[gnu::always_inline]] inline bool any_lane(register_mask m) {
  using bytes = signed char __attribute__((vector_size(register_size)));
  std::uint64_t found = 0;
  const bytes narrow = __builtin_convertvector(m, bytes);
  __builtin_memcpy(&found, &narrow, sizeof narrow);
  return found != 0;
}

// The bits of one register; see bits_of in math.hpp.
template <>
struct bits_of<one_register> {
  using type = registers<std::uint64_t>::one;
  static type in(one_register x) { return reinterpret_cast<type>(x); }
  static type of(std::uint64_t all) { return all - type{}; }
  static one_register number(type bits) { return reinterpret_cast<one_register>(bits); }
};

}  // namespace detail

[[gnu::always_inline]] inline detail::one_register absolute(detail::one_register x) {
  using bits = detail::bits_of<detail::one_register>;
  constexpr std::uint64_t all_but_sign = 0x7FFFFFFFFFFFFFFF;
  return bits::number(bits::in(x)&all_but_sign);
}
[[gnu::always_inline]] inline detail::one_register square_root(detail::one_register x) {
#if defined(__AVX512F__) && defined(__clang__)
  constexpr int current_rounding = 4;
  return __builtin_ia32_sqrtpd512(x, current_rounding);
#elif defined(__AVX512F__)
  constexpr int current_rounding = 4;
  constexpr char every_lane = -1;
  return __builtin_ia32_sqrtpd512_mask(x, x, every_lane, current_rounding);
#elif defined(__AVX__)
  return __builtin_ia32_sqrtpd256(x);
#elif defined(__SSE2__)
  return __builtin_ia32_sqrtpd(x);
#else
  for (int k = 0; k < register_size; ++k) x[k] = square_root(x[k]);
  return x;
#endif
}
inline detail::one_register larger(detail::one_register a, detail::one_register b) { return a > b ? a : b; }
inline detail::one_register smaller(detail::one_register a, detail::one_register b) { return a < b ? a : b; }

inline bool any(bool m) { return m; }
[[gnu::always_inline]] inline bool any(mask m) {
  auto all = m.values().part[0];
  for (int k = 1; k < pack_registers; ++k) all = all | m.values().part[k];
  return detail::any_lane(all);
}

[[gnu::always_inline]] inline pack absolute(pack x) {
  return pack(detail::each<double>([&](int k) { return absolute(x.values().part[k]); }));
}
[[gnu::always_inline]] inline pack square_root(pack x) {
  return pack(detail::each<double>([&](int k) { return square_root(x.values().part[k]); }));
}
[[gnu::always_inline]] inline pack larger(pack a, pack b) { return select(a > b, a, b); }
[[gnu::always_inline]] inline pack smaller(pack a, pack b) { return select(a < b, a, b); }
[[gnu::always_inline]] inline pack positive_part(pack x) { return select(x > 0.0, x, 0.0); }
[[gnu::always_inline]] inline pack halfway(pack low, pack high) {
  return pack(low.bits() + ((high.bits() - low.bits()) >> 1));
}

namespace detail {

template <>
struct bits_of<pack> {
  using type = bit_pack;
  static type in(pack x) { return x.bits(); }
  static type of(std::uint64_t all) { return type(all); }
  static pack number(type bits) { return pack(bits); }
};

}  // namespace detail

inline pack exp(pack x) { return detail::exponential(x); }
inline pack log(pack x) { return detail::logarithm(x); }

// A number that is zero for sure: what it multiplies is not worked out, which changes no bit but the sign of
// a zero.
struct sure_zero {
  friend sure_zero operator*(sure_zero, sure_zero) { return {}; }
  template <class V>
  friend sure_zero operator*(V /*x*/, sure_zero) {
    return {};
  }
  template <class V>
  friend sure_zero operator*(sure_zero, V /*x*/) {
    return {};
  }
  template <class V>
  friend V operator+(V x, sure_zero) {
    return x;
  }
  template <class V>
  friend V operator-(V x, sure_zero) {
    return x;
  }
};

// What a comparison of V gives.
template <class V>
using mask_of = decltype(V{} < V{});

}  // namespace ilaw::kit
