// pack.hpp - doubles side by side, as many as the instruction set of this level holds, for solvers that are
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

#if defined(__AVX512F__)
inline constexpr int pack_size = 8;
#elif defined(__AVX__)
inline constexpr int pack_size = 4;
#else
inline constexpr int pack_size = 2;
#endif

// What comparisons of packs give: per lane all bits or none.
class mask {
 public:
  using lanes = std::int64_t __attribute__((vector_size(8 * pack_size)));

  explicit mask(lanes v) : v_(v) {}
  explicit mask(bool all) : v_((all ? std::int64_t{-1} : std::int64_t{0}) - lanes{}) {}
  friend mask operator&(mask a, mask b) { return mask(a.v_ & b.v_); }
  friend mask operator|(mask a, mask b) { return mask(a.v_ | b.v_); }
  friend mask operator!(mask a) { return mask(~a.v_); }
  bool operator[](int lane) const { return v_[lane] != 0; }
  lanes values() const { return v_; }

 private:
  lanes v_;
};

class pack {
 public:
  using lanes = double __attribute__((vector_size(8 * pack_size)));
  using integers = std::uint64_t __attribute__((vector_size(8 * pack_size)));

  pack() = default;
  pack(double all) : v_(all - lanes{}) {}
  explicit pack(lanes v) : v_(v) {}
  explicit pack(integers bits) : v_(reinterpret_cast<lanes>(bits)) {}

  static pack load(const double* values) {
    pack p;
    __builtin_memcpy(&p.v_, values, sizeof p.v_);
    return p;
  }
  void store(double* values) const { __builtin_memcpy(values, &v_, sizeof v_); }
  lanes values() const { return v_; }
  integers bits() const { return reinterpret_cast<integers>(v_); }

  friend pack operator+(pack a, pack b) { return pack(a.v_ + b.v_); }
  friend pack operator-(pack a, pack b) { return pack(a.v_ - b.v_); }
  friend pack operator*(pack a, pack b) { return pack(a.v_ * b.v_); }
  friend pack operator/(pack a, pack b) { return pack(a.v_ / b.v_); }
  friend pack operator-(pack a) { return pack(-a.v_); }
  friend mask operator<(pack a, pack b) { return mask(a.v_ < b.v_); }
  friend mask operator<=(pack a, pack b) { return mask(a.v_ <= b.v_); }
  friend mask operator>(pack a, pack b) { return mask(a.v_ > b.v_); }
  friend mask operator>=(pack a, pack b) { return mask(a.v_ >= b.v_); }
  friend mask operator==(pack a, pack b) { return mask(a.v_ == b.v_); }
  friend mask operator!=(pack a, pack b) { return mask(a.v_ != b.v_); }

 private:
  lanes v_;
};

// The same words for a double (math.hpp) and for a pack.
inline pack select(mask m, pack a, pack b) { return pack(m.values() ? a.values() : b.values()); }

inline bool any(bool m) { return m; }
inline bool any(mask m) {
  using bytes = signed char __attribute__((vector_size(pack_size)));
  const bytes narrow = __builtin_convertvector(m.values(), bytes);
  std::uint64_t found = 0;
  __builtin_memcpy(&found, &narrow, sizeof narrow);
  return found != 0;
}

inline pack absolute(pack x) {
  constexpr std::uint64_t all_but_sign = 0x7FFFFFFFFFFFFFFF;
  return pack(x.bits() & (all_but_sign - pack::integers{}));
}
inline pack square_root(pack x) {
#if defined(__AVX512F__) && defined(__clang__)
  constexpr int current_rounding = 4;
  return pack(__builtin_ia32_sqrtpd512(x.values(), current_rounding));
#elif defined(__AVX512F__)
  constexpr int current_rounding = 4;
  constexpr char every_lane = -1;
  return pack(__builtin_ia32_sqrtpd512_mask(x.values(), x.values(), every_lane, current_rounding));
#elif defined(__AVX__)
  return pack(__builtin_ia32_sqrtpd256(x.values()));
#elif defined(__SSE2__)
  return pack(__builtin_ia32_sqrtpd(x.values()));
#else
  pack::lanes root = x.values();
  for (int k = 0; k < pack_size; ++k) root[k] = square_root(root[k]);
  return pack(root);
#endif
}
inline pack larger(pack a, pack b) { return select(a > b, a, b); }
inline pack smaller(pack a, pack b) { return select(a < b, a, b); }
inline pack positive_part(pack x) { return select(x > 0.0, x, 0.0); }
inline pack halfway(pack low, pack high) { return pack(low.bits() + ((high.bits() - low.bits()) >> 1)); }

namespace detail {

template <>
struct bits_of<pack> {
  using type = pack::integers;
  static type in(pack x) { return x.bits(); }
  static type of(std::uint64_t all) { return all - type{}; }
  static pack number(type bits) { return pack(bits); }
};

}  // namespace detail

inline pack exp(pack x) { return detail::exponential(x); }
inline pack log(pack x) { return detail::logarithm(x); }

// What a comparison of V gives.
template <class V>
using mask_of = decltype(V{} < V{});

}  // namespace ilaw::kit
