// load_store.hpp - packs of numbers from a host's arrays, and back: rows (components side by side) and columns, of
// doubles and floats.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/transpose.hpp>
#include <ilaw/kit/vector.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// Component c of node i stands at at[i * count + c] in rows, at[i + c * component] in columns. Null: absent.
template <class Number>
struct array {
  Number* at = nullptr;
  std::int64_t component = 0;
  int count = 0;  // components
  bool rows = false;
};

// Which lanes of a pack are nodes: all of them, or the first count.
template <class V>
struct all_lanes {
  static constexpr int count = lanes_of<V>;
  static constexpr bool are_all = true;

  template <class Number>
  ILAW_KIT_INLINE static one get(const Number* p, int /*count*/, double /*fill*/) {
    return one_at(p);
  }
  template <class Number>
  ILAW_KIT_INLINE static void put(one v, Number* p, int /*count*/) {
    put_one(v, p);
  }
  template <class Number>
  ILAW_KIT_INLINE V load(const Number* p, double /*fill*/ = 0.0) const {
    if constexpr (count == 1)
      return static_cast<double>(*p);
    else
      return V::each([&](int r) ILAW_KIT_LAMBDA { return one_at(p + r * register_lanes); });
  }
  template <class Number>
  ILAW_KIT_INLINE void store(V a, Number* p) const {
    if constexpr (count == 1)
      *p = static_cast<Number>(a);
    else
      for (int r = 0; r < count / register_lanes; ++r) put_one(a.v[r], p + r * register_lanes);
  }
  ILAW_KIT_INLINE void store_bytes(V a, std::uint8_t* p) const {
    if constexpr (count == 1)
      *p = static_cast<std::uint8_t>(a);
    else
      for (int r = 0; r < count / register_lanes; ++r) put_bytes(a.v[r], p + r * register_lanes);
  }
  ILAW_KIT_INLINE unsigned own(unsigned bits) const { return bits; }
};
template <class V>
struct some_lanes {
  int count;
  static constexpr bool are_all = false;

  template <class Number>
  ILAW_KIT_INLINE static one get(const Number* p, int count, double fill) {
    return some_at(p, count, fill);
  }
  template <class Number>
  ILAW_KIT_INLINE static void put(one v, Number* p, int count) {
    put_some(v, p, count);
  }
  template <class Number>
  ILAW_KIT_INLINE V load(const Number* p, double fill = 0.0) const {
    if constexpr (lanes_of<V> == 1)
      return static_cast<double>(*p);
    else
      return V::each(
          [&](int r) ILAW_KIT_LAMBDA { return some_at(p + r * register_lanes, count - r * register_lanes, fill); });
  }
  template <class Number>
  ILAW_KIT_INLINE void store(V a, Number* p) const {
    if constexpr (lanes_of<V> == 1)
      *p = static_cast<Number>(a);
    else
      for (int r = 0; r < V::size / register_lanes; ++r)
        put_some(a.v[r], p + r * register_lanes, count - r * register_lanes);
  }
  ILAW_KIT_INLINE void store_bytes(V a, std::uint8_t* p) const {
    for (int k = 0; k < count; ++k) p[k] = static_cast<std::uint8_t>(lane_of(a, k));
  }
  ILAW_KIT_INLINE unsigned own(unsigned bits) const { return bits & ((1U << count) - 1); }
};

// Rows of N numbers, N of 2, 3, 4 and 6, from p on. found: times all numbers read, each in some lane; so columns that
// nobody reads are never made.
template <int N, class V, class Number, class Lanes>
ILAW_KIT_INLINE void load_rows(V (&to)[N], const Number* p, Lanes l, double fill, V& found) {
  if constexpr (lanes_of<V> == 1) {
    for (int c = 0; c < N; ++c) {
      to[c] = static_cast<double>(p[c]);
      found = found * to[c];
    }
  } else {
#pragma GCC unroll 4
    for (int r = 0; r < V::size / register_lanes; ++r) {
      const Number* const q = p + N * register_lanes * r;
      one in[N];
#pragma GCC unroll 8
      for (int c = 0; c < N; ++c) {
        in[c] = l.get(q + c * register_lanes, N * (l.count - register_lanes * r) - c * register_lanes, fill);
        found.v[r] = found.v[r] * in[c];
      }
      if constexpr (N == 2) {
        to[0].v[r] = every_second<0>(in[0], in[1], each_lane);
        to[1].v[r] = every_second<1>(in[0], in[1], each_lane);
      } else if constexpr (N == 3) {
        to[0].v[r] = column_of_three<0>(in[0], in[1], in[2], each_lane);
        to[1].v[r] = column_of_three<1>(in[0], in[1], in[2], each_lane);
        to[2].v[r] = column_of_three<2>(in[0], in[1], in[2], each_lane);
      } else if constexpr (N == 4) {
        const one a = every_second<0>(in[0], in[1], each_lane), b = every_second<1>(in[0], in[1], each_lane);
        const one c = every_second<0>(in[2], in[3], each_lane), d = every_second<1>(in[2], in[3], each_lane);
        to[0].v[r] = every_second<0>(a, c, each_lane);
        to[1].v[r] = every_second<0>(b, d, each_lane);
        to[2].v[r] = every_second<1>(a, c, each_lane);
        to[3].v[r] = every_second<1>(b, d, each_lane);
      } else {
        const one p0 = pairs_of_three<0>(in[0], in[1], in[2], each_lane), q0 = pairs_of_three<0>(in[3], in[4], in[5], each_lane);
        const one p1 = pairs_of_three<1>(in[0], in[1], in[2], each_lane), q1 = pairs_of_three<1>(in[3], in[4], in[5], each_lane);
        const one p2 = pairs_of_three<2>(in[0], in[1], in[2], each_lane), q2 = pairs_of_three<2>(in[3], in[4], in[5], each_lane);
        to[0].v[r] = column_of_six<0>(p0, q0, each_lane);
        to[1].v[r] = column_of_six<1>(p0, q0, each_lane);
        to[2].v[r] = column_of_six<2>(p1, q1, each_lane);
        to[3].v[r] = column_of_six<3>(p1, q1, each_lane);
        to[4].v[r] = column_of_six<4>(p2, q2, each_lane);
        to[5].v[r] = column_of_six<5>(p2, q2, each_lane);
      }
    }
  }
}
// Floats are turned while they are narrow.
template <class V>
ILAW_KIT_INLINE void load_rows(V (&to)[3], const float* p, all_lanes<V>, double, V& found)
  requires(lanes_of<V> > 1)
{
#pragma GCC unroll 4
  for (int r = 0; r < V::size / register_lanes; ++r) {
    const float* const q = p + 3 * register_lanes * r;
    const one_floats a = floats_at(q), b = floats_at(q + register_lanes), c = floats_at(q + 2 * register_lanes);
    to[0].v[r] = __builtin_convertvector(column_of_three<0>(a, b, c, each_lane), one);
    to[1].v[r] = __builtin_convertvector(column_of_three<1>(a, b, c, each_lane), one);
    to[2].v[r] = __builtin_convertvector(column_of_three<2>(a, b, c, each_lane), one);
    found.v[r] = found.v[r] * to[0].v[r] * to[1].v[r] * to[2].v[r];
  }
}
template <int N, class V, class Number, class Lanes>
ILAW_KIT_INLINE void store_rows(const V (&a)[N], Number* p, Lanes l) {
  if constexpr (lanes_of<V> == 1) {
    for (int c = 0; c < N; ++c) p[c] = static_cast<Number>(a[c]);
  } else {
#pragma GCC unroll 4
    for (int r = 0; r < V::size / register_lanes; ++r) {
      one out[N];
      if constexpr (N == 2) {
        out[0] = zipped<0>(a[0].v[r], a[1].v[r], each_lane);
        out[1] = zipped<1>(a[0].v[r], a[1].v[r], each_lane);
      } else if constexpr (N == 3) {
        const one u = moved_to_rows<0>(a[0].v[r], each_lane), v = moved_to_rows<1>(a[1].v[r], each_lane),
                  w = moved_to_rows<2>(a[2].v[r], each_lane);
        out[0] = row_of_three<0>(u, v, w, each_lane);
        out[1] = row_of_three<1>(u, v, w, each_lane);
        out[2] = row_of_three<2>(u, v, w, each_lane);
      } else {
        static_assert(N == 4);
        const one e = zipped<0>(a[0].v[r], a[2].v[r], each_lane), f = zipped<0>(a[1].v[r], a[3].v[r], each_lane);
        const one g = zipped<1>(a[0].v[r], a[2].v[r], each_lane), h = zipped<1>(a[1].v[r], a[3].v[r], each_lane);
        out[0] = zipped<0>(e, f, each_lane);
        out[1] = zipped<1>(e, f, each_lane);
        out[2] = zipped<0>(g, h, each_lane);
        out[3] = zipped<1>(g, h, each_lane);
      }
      Number* const q = p + N * register_lanes * r;
#pragma GCC unroll 8
      for (int c = 0; c < N; ++c)
        l.put(out[c], q + c * register_lanes, N * (l.count - register_lanes * r) - c * register_lanes);
    }
  }
}
template <class V>
ILAW_KIT_INLINE void store_rows(const V (&a)[3], float* p, all_lanes<V>)
  requires(lanes_of<V> > 1)
{
#pragma GCC unroll 4
  for (int r = 0; r < V::size / register_lanes; ++r) {
    const auto narrow = [&](int c) ILAW_KIT_LAMBDA { return __builtin_convertvector(a[c].v[r], one_floats); };
    const one_floats u = moved_to_rows<0>(narrow(0), each_lane), v = moved_to_rows<1>(narrow(1), each_lane),
                     w = moved_to_rows<2>(narrow(2), each_lane);
    const one_floats x = row_of_three<0>(u, v, w, each_lane), y = row_of_three<1>(u, v, w, each_lane),
                     z = row_of_three<2>(u, v, w, each_lane);
    float* const q = p + 3 * register_lanes * r;
    __builtin_memcpy(q, &x, sizeof x);
    __builtin_memcpy(q + register_lanes, &y, sizeof y);
    __builtin_memcpy(q + 2 * register_lanes, &z, sizeof z);
  }
}

// A vector of one to three components; those beyond the dimension are zero. Filled by reference in both arms: a struct
// that comes through a branch goes through memory.
template <class V, class Number, class Lanes>
ILAW_KIT_INLINE void load_vector(axis<V>& to, const array<Number>& a, std::int64_t i, Lanes l, V& found,
                                 double fill = 0.0) {
  if (a.rows && a.count == 3) {
    V c[3];
    load_rows(c, a.at + 3 * i, l, fill, found);
    to.x = c[0];
    to.y = c[1];
    to.z = c[2];
  } else if (a.count == 3) {
    to.x = l.load(a.at + i, fill);
    to.y = l.load(a.at + a.component + i, fill);
    to.z = l.load(a.at + 2 * a.component + i, fill);
    found = found * to.x * to.y * to.z;
  } else {
    to.z = 0.0;
    if (a.rows) {
      V c[2];
      load_rows(c, a.at + 2 * i, l, fill, found);
      to.x = c[0];
      to.y = c[1];
    } else {
      to.x = l.load(a.at + i, fill);
      to.y = 0.0;
      if (a.count > 1) to.y = l.load(a.at + a.component + i, fill);
      found = found * to.x * to.y;
    }
  }
}
template <class V, class Number, class Lanes>
ILAW_KIT_INLINE void store_vector(axis<V> a, const array<Number>& to, std::int64_t i, Lanes l) {
  if (to.rows && to.count == 3) {
    const V c[3] = {a.x, a.y, a.z};
    store_rows(c, to.at + 3 * i, l);
  } else if (to.rows && to.count == 2) {
    const V c[2] = {a.x, a.y};
    store_rows(c, to.at + 2 * i, l);
  } else {
    l.store(a.x, to.at + i);
    if (to.count > 1) l.store(a.y, to.at + to.component + i);
    if (to.count > 2) l.store(a.z, to.at + 2 * to.component + i);
  }
}

// N numbers that a law remembers: entry e of the host's state is numbers[e].
template <int N, class V, class Number, class Lanes>
ILAW_KIT_INLINE void load_numbers(V (&to)[N], const array<Number>& a, std::int64_t i, Lanes l) {
  if constexpr (N == 2 || N == 3 || N == 4) {
    if (a.rows) {
      V unused = 0.0;
      load_rows(to, a.at + N * i, l, 0.0, unused);
      return;
    }
  }
#pragma GCC unroll 16
  for (int c = 0; c < N; ++c) to[c] = l.load(a.at + c * a.component + i);
}
template <int N, class V, class Number, class Lanes>
ILAW_KIT_INLINE void store_numbers(const V (&a)[N], const array<Number>& to, std::int64_t i, Lanes l) {
  if constexpr (N == 2 || N == 3 || N == 4) {
    if (to.rows) return store_rows(a, to.at + N * i, l);
  }
#pragma GCC unroll 16
  for (int c = 0; c < N; ++c) l.store(a[c], to.at + c * to.component + i);
}

}  // namespace ilaw::kit::detail
