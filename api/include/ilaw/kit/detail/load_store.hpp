// load_store.hpp - packs of numbers from a host's arrays, and back: rows (components side by side) and
// columns, of doubles and floats.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/vector.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// ---- rows of two, three and four numbers to columns and back, in registers

// A register as a host's array has it: floats are turned while they are narrow.
using one_floats = float __attribute__((vector_size(4 * register_lanes)));
template <class Number>
using one_of = std::conditional_t<std::is_same_v<std::remove_const_t<Number>, float>, one_floats, one>;

// Rows of three: which of three registers has the wanted number of a row at this lane.
template <int Column>
constexpr int holder_of(int lane) {
  int vector = 0;
  while ((vector * register_lanes + lane) % 3 != Column) ++vector;
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
  const One two = __builtin_shufflevector(a, b, (holder_of<Column>(K) == 1 ? K + lanes : K)...);
  const One all = __builtin_shufflevector(two, c, (holder_of<Column>(K) == 2 ? K + lanes : K)...);
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

// Every second number of two registers side by side, from the first or second on; and the reverse.
template <int Column, class One, int... K>
ILAW_KIT_INLINE One every_second(One a, One b, std::integer_sequence<int, K...>) {
  return __builtin_shufflevector(a, b, 2 * K + Column...);
}
template <int Half, class One, int... K>
ILAW_KIT_INLINE One zipped(One a, One b, std::integer_sequence<int, K...>) {
  return __builtin_shufflevector(a, b, (Half * register_lanes / 2 + K / 2 + K % 2 * register_lanes)...);
}

// ---- registers in memory

ILAW_KIT_INLINE one widened(one v) { return v; }
ILAW_KIT_INLINE one widened(one_floats v) { return __builtin_convertvector(v, one); }
template <class Number>
ILAW_KIT_INLINE one_of<Number> narrowed(one v) {
  if constexpr (std::is_same_v<Number, float>)
    return __builtin_convertvector(v, one_floats);
  else
    return v;
}
template <class Number>
ILAW_KIT_INLINE one_of<Number> one_at(const Number* p) {
  one_of<Number> v;
  __builtin_memcpy(&v, p, sizeof v);
  if constexpr (std::is_same_v<Number, double>) ILAW_KIT_IN_REGISTER(v);
  return v;
}
template <class One>
ILAW_KIT_INLINE void put_one(One v, void* p) {
  __builtin_memcpy(p, &v, sizeof v);
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

// ---- arrays

// Component c of node i stands at at[i * count + c] in rows, at[i + c * component] in columns. Null: absent.
template <class Number>
struct array {
  Number* at = nullptr;
  std::int64_t component = 0;
  int count = 0;  // components
  int rows = 0;   // components, 0 for columns

  Number& of(std::int64_t node, int c) const { return at[rows ? node * count + c : node + c * component]; }
};

template <class V, class Number>
ILAW_KIT_INLINE V load(const Number* p) {
  if constexpr (lanes_of<V> == 1)
    return static_cast<double>(*p);
  else
    return V::each([&](int r) ILAW_KIT_LAMBDA { return widened(one_at(p + r * register_lanes)); });
}
template <class V, class Number>
ILAW_KIT_INLINE void store(V a, Number* p) {
  if constexpr (lanes_of<V> == 1)
    *p = static_cast<Number>(a);
  else {
#pragma GCC unroll 4
    for (int r = 0; r < V::size / register_lanes; ++r)
      put_one(narrowed<Number>(a.v[r]), p + r * register_lanes);
  }
}
template <class V>
ILAW_KIT_INLINE void store_bytes(V a, std::uint8_t* p) {
  if constexpr (lanes_of<V> == 1)
    *p = static_cast<std::uint8_t>(a);
  else {
#pragma GCC unroll 4
    for (int r = 0; r < V::size / register_lanes; ++r) put_bytes(a.v[r], p + r * register_lanes);
  }
}

// Registers of rows of N numbers, N of 2, 3 and 4, to those of columns.
template <int N, class One>
ILAW_KIT_INLINE void to_columns(const One (&in)[N], One (&out)[N]) {
  constexpr auto all = each_lane;
  if constexpr (N == 2) {
    out[0] = every_second<0>(in[0], in[1], all);
    out[1] = every_second<1>(in[0], in[1], all);
  } else if constexpr (N == 3) {
    out[0] = column_of_three<0>(in[0], in[1], in[2], all);
    out[1] = column_of_three<1>(in[0], in[1], in[2], all);
    out[2] = column_of_three<2>(in[0], in[1], in[2], all);
  } else {
    static_assert(N == 4);
    const One a = every_second<0>(in[0], in[1], all), b = every_second<1>(in[0], in[1], all);
    const One c = every_second<0>(in[2], in[3], all), d = every_second<1>(in[2], in[3], all);
    out[0] = every_second<0>(a, c, all);
    out[1] = every_second<0>(b, d, all);
    out[2] = every_second<1>(a, c, all);
    out[3] = every_second<1>(b, d, all);
  }
}
// And back.
template <int N, class One>
ILAW_KIT_INLINE void to_rows(const One (&in)[N], One (&out)[N]) {
  constexpr auto all = each_lane;
  if constexpr (N == 2) {
    out[0] = zipped<0>(in[0], in[1], all);
    out[1] = zipped<1>(in[0], in[1], all);
  } else if constexpr (N == 3) {
    out[0] = row_of_three<0>(in[0], in[1], in[2], all);
    out[1] = row_of_three<1>(in[0], in[1], in[2], all);
    out[2] = row_of_three<2>(in[0], in[1], in[2], all);
  } else {
    static_assert(N == 4);
    const One e = zipped<0>(in[0], in[2], all), f = zipped<0>(in[1], in[3], all);
    const One g = zipped<1>(in[0], in[2], all), h = zipped<1>(in[1], in[3], all);
    out[0] = zipped<0>(e, f, all);
    out[1] = zipped<1>(e, f, all);
    out[2] = zipped<0>(g, h, all);
    out[3] = zipped<1>(g, h, all);
  }
}

// Rows of N numbers, N of 2, 3 and 4, from p on. found: times all numbers read, each in some lane; so
// columns that nobody reads are never made.
template <int N, class V, class Number>
ILAW_KIT_INLINE void load_rows(V (&to)[N], const Number* p, V& found) {
  if constexpr (lanes_of<V> == 1) {
    for (int c = 0; c < N; ++c) {
      to[c] = static_cast<double>(p[c]);
      found = found * to[c];
    }
  } else {
#pragma GCC unroll 4
    for (int r = 0; r < V::size / register_lanes; ++r) {
      const Number* const q = p + N * register_lanes * r;
      one_of<Number> in[N], out[N];
#pragma GCC unroll 8
      for (int c = 0; c < N; ++c) {
        in[c] = one_at(q + c * register_lanes);
        if constexpr (std::is_same_v<Number, double>) found.v[r] = found.v[r] * in[c];
      }
      to_columns(in, out);
#pragma GCC unroll 8
      for (int c = 0; c < N; ++c) {
        to[c].v[r] = widened(out[c]);
        if constexpr (std::is_same_v<Number, float>) found.v[r] = found.v[r] * to[c].v[r];
      }
    }
  }
}
template <int N, class V, class Number>
ILAW_KIT_INLINE void store_rows(const V (&a)[N], Number* p) {
  if constexpr (lanes_of<V> == 1) {
    for (int c = 0; c < N; ++c) p[c] = static_cast<Number>(a[c]);
  } else {
#pragma GCC unroll 4
    for (int r = 0; r < V::size / register_lanes; ++r) {
      one_of<Number> in[N], out[N];
#pragma GCC unroll 8
      for (int c = 0; c < N; ++c) in[c] = narrowed<Number>(a[c].v[r]);
      to_rows(in, out);
      Number* const q = p + N * register_lanes * r;
#pragma GCC unroll 8
      for (int c = 0; c < N; ++c) put_one(out[c], q + c * register_lanes);
    }
  }
}

// A vector of one to three components; those beyond the dimension are zero. Filled by reference in both arms:
// a struct that comes through a branch goes through memory.
template <class V, class Array>
ILAW_KIT_INLINE void load_vector(axis<V>& to, const Array& a, std::int64_t i, V& found) {
  if (a.rows == 3) {
    V c[3];
    load_rows(c, a.at + 3 * i, found);
    to.x = c[0];
    to.y = c[1];
    to.z = c[2];
  } else if (a.count == 3) {
    to.x = load<V>(a.at + i);
    to.y = load<V>(a.at + a.component + i);
    to.z = load<V>(a.at + 2 * a.component + i);
    found = found * to.x * to.y * to.z;
  } else {
    to.z = 0.0;
    if (a.rows) {
      V c[2];
      load_rows(c, a.at + 2 * i, found);
      to.x = c[0];
      to.y = c[1];
    } else {
      to.x = load<V>(a.at + i);
      to.y = 0.0;
      if (a.count > 1) to.y = load<V>(a.at + a.component + i);
      found = found * to.x * to.y;
    }
  }
}
template <class V, class Array>
ILAW_KIT_INLINE void store_vector(axis<V> a, const Array& to, std::int64_t i) {
  if (to.rows == 3) {
    const V c[3] = {a.x, a.y, a.z};
    store_rows(c, to.at + 3 * i);
  } else if (to.rows == 2) {
    const V c[2] = {a.x, a.y};
    store_rows(c, to.at + 2 * i);
  } else {
    store(a.x, to.at + i);
    if (to.count > 1) store(a.y, to.at + to.component + i);
    if (to.count > 2) store(a.z, to.at + 2 * to.component + i);
  }
}

// Longer rows: two of their numbers at a time, the last two perhaps once more.
using pair_of_doubles = double __attribute__((vector_size(16)));
using pair_of_floats = float __attribute__((vector_size(8)));
template <class Number>
using pair_of =
    std::conditional_t<std::is_same_v<std::remove_const_t<Number>, float>, pair_of_floats, pair_of_doubles>;
// Two numbers of every second row, side by side.
template <int N, class Number>
ILAW_KIT_INLINE one_of<Number> every_second_row(const Number* p) {
  pair_of<Number> pair[register_lanes / 2];
#pragma GCC unroll 4
  for (int k = 0; k < register_lanes / 2; ++k) __builtin_memcpy(&pair[k], p + 2 * k * N, sizeof pair[k]);
  if constexpr (register_lanes == 2) {
    return pair[0];
  } else if constexpr (register_lanes == 4) {
    return __builtin_shufflevector(pair[0], pair[1], 0, 1, 2, 3);
  } else {
    const auto low = __builtin_shufflevector(pair[0], pair[1], 0, 1, 2, 3);
    const auto high = __builtin_shufflevector(pair[2], pair[3], 0, 1, 2, 3);
    return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
  }
}
template <int N, class Number>
ILAW_KIT_INLINE void put_every_second_row(one_of<Number> pairs, Number* p) {
  pair_of<Number> pair[register_lanes / 2];
  __builtin_memcpy(pair, &pairs, sizeof pairs);
#pragma GCC unroll 4
  for (int k = 0; k < register_lanes / 2; ++k) __builtin_memcpy(p + 2 * k * N, &pair[k], sizeof pair[k]);
}
// Squares of two by two lanes, turned about their diagonal: of pairs of even and odd rows to two columns, and
// back. Which: the first result or the second.
template <int Which, class One, int... K>
ILAW_KIT_INLINE One turned(One a, One b, std::integer_sequence<int, K...>) {
  return __builtin_shufflevector(a, b, (K - K % 2 + Which + K % 2 * register_lanes)...);
}
template <int N, class V, class Number>
ILAW_KIT_INLINE void load_long_rows(V (&to)[N], const Number* p) {
#pragma GCC unroll 4
  for (int r = 0; r < V::size / register_lanes; ++r) {
    const Number* const q = p + N * register_lanes * r;
#pragma GCC unroll 8
    for (int k = 0; k < N; k += 2) {
      const int c = k + 2 <= N ? k : N - 2;
      const auto even = every_second_row<N>(q + c), odd = every_second_row<N>(q + N + c);
      to[c].v[r] = widened(turned<0>(even, odd, each_lane));
      to[c + 1].v[r] = widened(turned<1>(even, odd, each_lane));
    }
  }
}
template <int N, class V, class Number>
ILAW_KIT_INLINE void store_long_rows(const V (&a)[N], Number* p) {
#pragma GCC unroll 4
  for (int r = 0; r < V::size / register_lanes; ++r) {
    Number* const q = p + N * register_lanes * r;
#pragma GCC unroll 8
    for (int k = 0; k < N; k += 2) {
      const int c = k + 2 <= N ? k : N - 2;
      const auto x = narrowed<Number>(a[c].v[r]), y = narrowed<Number>(a[c + 1].v[r]);
      put_every_second_row<N>(turned<0>(x, y, each_lane), q + c);
      put_every_second_row<N>(turned<1>(x, y, each_lane), q + N + c);
    }
  }
}

// N numbers of each node, in rows or columns.
template <int N, class V, class Array>
ILAW_KIT_INLINE void load_numbers(V (&to)[N], const Array& a, std::int64_t i) {
  if constexpr (N > 1) {
    if (a.rows) {
      V unused = 0.0;
      if constexpr (N <= 4 || lanes_of<V> == 1)
        load_rows(to, a.at + N * i, unused);
      else
        load_long_rows(to, a.at + N * i);
      return;
    }
  }
#pragma GCC unroll 16
  for (int c = 0; c < N; ++c) to[c] = load<V>(a.at + c * a.component + i);
}
template <int N, class V, class Array>
ILAW_KIT_INLINE void store_numbers(const V (&a)[N], const Array& to, std::int64_t i) {
  if constexpr (N > 1) {
    if (to.rows) {
      if constexpr (N <= 4 || lanes_of<V> == 1)
        store_rows(a, to.at + N * i);
      else
        store_long_rows(a, to.at + N * i);
      return;
    }
  }
#pragma GCC unroll 16
  for (int c = 0; c < N; ++c) store(a[c], to.at + c * to.component + i);
}

}  // namespace ilaw::kit::detail
