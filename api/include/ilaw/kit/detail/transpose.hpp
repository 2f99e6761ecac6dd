// transpose.hpp - registers of rows of two, three, four and six numbers to columns and back, in registers.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/pack.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

using one_floats = float __attribute__((vector_size(4 * register_lanes)));

// Lanes of rows of so many numbers: which of three registers has the wanted numbers of a lane.
template <int Numbers, int Group>
constexpr int holder_of(int lane) {
  int vector = 0;
  while ((vector * register_lanes + lane) % Numbers / (Numbers / 3) != Group) ++vector;
  return vector;
}
// AVX-512 takes any lanes of two registers in one instruction; the others move lanes and blend.
template <int Column, class One, int... K>
ILAW_KIT_INLINE One column_of_three(One a, One b, One c, std::integer_sequence<int, K...>) {
  constexpr int lanes = register_lanes;
#if defined(__AVX512F__)
  constexpr auto from = [](int lane) { return 3 * lane + Column; };
  const One two = __builtin_shufflevector(a, b, (from(K) < 2 * lanes ? from(K) : 0)...);
  return __builtin_shufflevector(two, c, (from(K) < 2 * lanes ? K : from(K) - lanes)...);
#else
  const One two = __builtin_shufflevector(a, b, (holder_of<3, Column>(K) == 1 ? K + lanes : K)...);
  const One all = __builtin_shufflevector(two, c, (holder_of<3, Column>(K) == 2 ? K + lanes : K)...);
  return __builtin_shufflevector(all, all, (3 * K + Column) % lanes...);
#endif
}
template <int Column>
constexpr int row_in_lane(int lane) {
  int row = 0;
  while ((3 * row + Column) % register_lanes != lane) ++row;
  return row;
}
template <int Vector, class One, int... K>
ILAW_KIT_INLINE One row_of_three(One a, One b, One c, std::integer_sequence<int, K...>) {
  constexpr int lanes = register_lanes, from = Vector * lanes;
#if defined(__AVX512F__)
  constexpr auto row = [](int lane) { return (from + lane) / 3; };
  constexpr auto column = [](int lane) { return (from + lane) % 3; };
  const One two = __builtin_shufflevector(a, b, (column(K) == 1 ? row(K) + lanes : row(K))...);
  return __builtin_shufflevector(two, c, (column(K) == 2 ? row(K) + lanes : K)...);
#else
  const One u = __builtin_shufflevector(a, a, row_in_lane<0>(K)...);
  const One v = __builtin_shufflevector(b, b, row_in_lane<1>(K)...);
  const One w = __builtin_shufflevector(c, c, row_in_lane<2>(K)...);
  const One two = __builtin_shufflevector(u, v, ((from + K) % 3 == 1 ? K + lanes : K)...);
  return __builtin_shufflevector(two, w, ((from + K) % 3 == 2 ? K + lanes : K)...);
#endif
}

// Of two registers side by side every second number, from the first or second on; and the reverse.
template <int Column, int... K>
ILAW_KIT_INLINE one every_second(one a, one b, std::integer_sequence<int, K...>) {
  return __builtin_shufflevector(a, b, 2 * K + Column...);
}
template <int Half, int... K>
ILAW_KIT_INLINE one zipped(one a, one b, std::integer_sequence<int, K...>) {
  return __builtin_shufflevector(a, b, (Half * register_lanes / 2 + K / 2 + K % 2 * register_lanes)...);
}

// Rows of six: pairs as rows of three, then each register of pairs to its columns.
template <int Group, int... K>
ILAW_KIT_INLINE one pairs_of_three(one a, one b, one c, std::integer_sequence<int, K...>) {
  const one two = __builtin_shufflevector(a, b, (holder_of<6, Group>(K) == 1 ? K + register_lanes : K)...);
  return __builtin_shufflevector(two, c, (holder_of<6, Group>(K) == 2 ? K + register_lanes : K)...);
}
template <int Column, int... K>
ILAW_KIT_INLINE one column_of_six(one low, one high, std::integer_sequence<int, K...>) {
  constexpr int half = register_lanes / 2;
  return __builtin_shufflevector(low, high,
                                 (K / half * register_lanes + (6 * (K % half) + Column) % register_lanes)...);
}

// ---- registers in memory
// ----------------------------------------------------------------------------------------------

ILAW_KIT_INLINE one one_at(const double* p) {
  one v;
  __builtin_memcpy(&v, p, sizeof v);
  ILAW_KIT_IN_REGISTER(v);
  return v;
}
ILAW_KIT_INLINE void put_one(one v, double* p) { __builtin_memcpy(p, &v, sizeof v); }
ILAW_KIT_INLINE one_floats floats_at(const float* p) {
  one_floats v;
  __builtin_memcpy(&v, p, sizeof v);
  return v;
}
ILAW_KIT_INLINE one one_at(const float* p) { return __builtin_convertvector(floats_at(p), one); }
ILAW_KIT_INLINE void put_one(one v, float* p) {
  const one_floats f = __builtin_convertvector(v, one_floats);
  __builtin_memcpy(p, &f, sizeof f);
}

// Whole numbers 0..255 as bytes.
ILAW_KIT_INLINE void put_bytes(one v, std::uint8_t* p) {
#if defined(__AVX512F__)
  const __m128i bytes = _mm256_cvtepi32_epi8(_mm512_cvttpd_epi32((__m512d)v));
  __builtin_memcpy(p, &bytes, register_lanes);
#elif defined(__AVX__)
  const __m128i ints = _mm256_cvttpd_epi32((__m256d)v), words = _mm_packs_epi32(ints, ints);
  const __m128i bytes = _mm_packus_epi16(words, words);
  __builtin_memcpy(p, &bytes, register_lanes);
#else
  for (int k = 0; k < register_lanes; ++k) p[k] = static_cast<std::uint8_t>(v[k]);
#endif
}

}  // namespace ilaw::kit::detail
