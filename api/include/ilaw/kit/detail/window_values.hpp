// window_values.hpp - where the numbers of windows (window.hpp) stand: those of a node side by side, or those
// of the nodes. Both have the same members, on the numbers k, k + 1, k + 2 of each window, a vector.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/load_store.hpp>
#include <ilaw/kit/vector.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// Number k of the node in lane i stands at first[k * stride + i]; V = double: of one node.
template <class V>
struct window_columns {
  using number = V;
  double* first;
  std::int64_t stride;

  ILAW_KIT_INLINE V number_at(std::int64_t k) const { return load<V>(first + k * stride); }
  ILAW_KIT_INLINE vector<V> vector_at(std::int64_t k) const {
    return {number_at(k), number_at(k + 1), number_at(k + 2)};
  }
  // A linear function of vectors, the same in all lanes. It is given vectors as it likes to read them.
  struct values {
    const window_columns& own;
    ILAW_KIT_INLINE vector<V> operator()(std::int64_t k) const { return own.vector_at(k); }
    ILAW_KIT_INLINE vector<V> zero() const { return {}; }
  };
  template <class F>
  ILAW_KIT_INLINE vector<V> linear(F f) const {
    return f(values{*this});
  }

  ILAW_KIT_INLINE void put_number(mask_of<V> where, std::int64_t k, V x) const {
    store(select(where, x, number_at(k)), first + k * stride);
  }
  ILAW_KIT_INLINE void put(mask_of<V> where, std::int64_t k, vector<V> a) const {
    put_number(where, k, a.n);
    put_number(where, k + 1, a.t1);
    put_number(where, k + 2, a.t2);
  }
  ILAW_KIT_INLINE void add(mask_of<V> where, std::int64_t k, vector<V> a) const {
    put(where, k, vector_at(k) + a);
  }
};

// The windows of the nodes in the lanes of a pack begin anywhere; stride: between the numbers of a node.
struct window_rows {
  using number = pack;
  using mask = mask_of<pack>;
  double* first[register_lanes];
  std::int64_t stride;

  // A vector behind one number that does not count, which stands before it in memory.
  using row = double __attribute__((vector_size(32)));
  struct values {
    const double* first;
    std::int64_t stride;

    ILAW_KIT_INLINE row operator()(std::int64_t k) const {
      row r;
      if (stride == 1 && k > 0) {
        __builtin_memcpy(&r, first + k - 1, sizeof r);
      } else {
        const double* const at = first + k * stride;
        r = row{0.0, at[0], at[stride], at[2 * stride]};
      }
      return r;
    }
    ILAW_KIT_INLINE row zero() const { return row{}; }
  };

  template <int... K>
  ILAW_KIT_INLINE pack number_at(std::int64_t k, std::integer_sequence<int, K...>) const {
    return pack::each([&](int) ILAW_KIT_LAMBDA { return one{first[K][k * stride]...}; });
  }
  ILAW_KIT_INLINE pack number_at(std::int64_t k) const { return number_at(k, each_lane); }
  template <class F>
  ILAW_KIT_INLINE vector<pack> linear(F f) const {
    row rows[register_lanes];
#pragma GCC unroll 8
    for (int lane = 0; lane < register_lanes; ++lane) rows[lane] = f(values{first[lane], stride});
    return to_lanes(rows, each_lane);
  }
  ILAW_KIT_INLINE vector<pack> vector_at(std::int64_t k) const {
    return linear([&](const values& value) ILAW_KIT_LAMBDA { return value(k); });
  }
  ILAW_KIT_INLINE void put_number(mask where, std::int64_t k, double x) const {
    const unsigned lanes = mask_bits(where);
    for (int lane = 0; lane < register_lanes; ++lane)
      if (lanes >> lane & 1) first[lane][k * stride] = x;
  }
  ILAW_KIT_INLINE void put(mask where, std::int64_t k, vector<pack> a) const {
    const unsigned lanes = mask_bits(where);
    row rows[register_lanes];
    to_rows(a, 0.0, rows);
#pragma GCC unroll 8
    for (int lane = 0; lane < register_lanes; ++lane)
      if (lanes >> lane & 1) {
        double* const at = first[lane] + k * stride;
        at[0] = rows[lane][1];
        at[stride] = rows[lane][2];
        at[2 * stride] = rows[lane][3];
      }
  }
  // Elsewhere -0 is added, which changes no number.
  ILAW_KIT_INLINE void add(mask where, std::int64_t k, vector<pack> a) const {
    if (stride != 1) return put(where, k, vector_at(k) + a);
    row rows[register_lanes];
    to_rows(select(where, a, vector<pack>{-0.0, -0.0, -0.0}), -0.0, rows);
#pragma GCC unroll 8
    for (int lane = 0; lane < register_lanes; ++lane) {
      const row sum = values{first[lane], 1}(k) + rows[lane];
      __builtin_memcpy(first[lane] + k - 1, &sum, sizeof sum);
    }
  }

 private:
  // Four rows fill four registers, half a row or several each, and come out as columns; and back.
  template <int... K, class One = one>
  ILAW_KIT_INLINE static vector<pack> to_lanes(const row (&rows)[register_lanes],
                                               std::integer_sequence<int, K...>) {
    One in[4];
#pragma GCC unroll 4
    for (int c = 0; c < 4; ++c) {
      if constexpr (register_lanes == 8)
        in[c] = __builtin_shufflevector(rows[2 * c], rows[2 * c + 1], K...);
      else if constexpr (register_lanes == 4)
        in[c] = rows[c];
      else
        in[c] = One{rows[c / 2][c % 2 * 2], rows[c / 2][c % 2 * 2 + 1]};
    }
    One out[4];
    to_columns(in, out);
    const auto wide = [](one v)
                          ILAW_KIT_LAMBDA { return pack::each([&](int) ILAW_KIT_LAMBDA { return v; }); };
    return {wide(out[1]), wide(out[2]), wide(out[3])};
  }
  template <class One = one>
  ILAW_KIT_INLINE static void to_rows(vector<pack> a, double before, row (&rows)[register_lanes]) {
    const One in[4] = {before - one{}, a.n.v[0], a.t1.v[0], a.t2.v[0]};
    One out[4];
    detail::to_rows(in, out);
#pragma GCC unroll 8
    for (int lane = 0; lane < register_lanes; ++lane) {
      if constexpr (register_lanes == 8)
        rows[lane] = lane % 2 == 0 ? __builtin_shufflevector(out[lane / 2], out[lane / 2], 0, 1, 2, 3)
                                   : __builtin_shufflevector(out[lane / 2], out[lane / 2], 4, 5, 6, 7);
      else if constexpr (register_lanes == 4)
        rows[lane] = out[lane];
      else
        rows[lane] = row{out[2 * lane][0], out[2 * lane][1], out[2 * lane + 1][0], out[2 * lane + 1][1]};
    }
  }
};

}  // namespace ilaw::kit::detail
