// rows.hpp - takes rows of a few numbers, one row per node, apart into columns, and puts columns together to
// rows. Doubles are moved by whole vectors, each of which is read and written once: of such loops compilers
// read every vector once per column, and where rows are not aligned each reading touches two lines.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/pack.hpp>

#include <type_traits>
#include <utility>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

using lanes = registers<double>::one;
inline constexpr auto each_lane = std::make_integer_sequence<int, register_size>{};

inline lanes lanes_at(const double* values) {
  lanes v;
  __builtin_memcpy(&v, values, sizeof v);
  return v;
}
// The same where it is used more than once: GCC would read it again each time.
inline lanes kept_lanes_at(const double* values) {
  lanes v = lanes_at(values);
#if defined(__GNUC__) && defined(__x86_64__)
  asm("" : "+v"(v));
#endif
  return v;
}
inline void put_lanes(lanes v, double* values) { __builtin_memcpy(values, &v, sizeof v); }

// Three vectors a, b, c of rows of so many numbers: in each lane one of them, and one alone, has a number of
// the group, which is one column of rows of three, or two of rows of six. So they are chosen without being
// moved, which costs processors less than moving them, and are moved together.
template <int Numbers, int Group>
constexpr int holder_of(int lane) {
  int vector = 0;
  while ((vector * register_size + lane) % Numbers / (Numbers / 3) != Group) ++vector;
  return vector;
}
template <int Numbers, int Group, int... K>
lanes chosen_lanes(lanes a, lanes b, lanes c, std::integer_sequence<int, K...> /*lanes*/) {
  const lanes found =
      __builtin_shufflevector(a, b, (holder_of<Numbers, Group>(K) == 1 ? K + register_size : K)...);
  return __builtin_shufflevector(found, c, (holder_of<Numbers, Group>(K) == 2 ? K + register_size : K)...);
}

// Three vectors, read once each.
struct vectors_of_rows {
  lanes a, b, c;

  explicit vectors_of_rows(const double* rows)
      : a(kept_lanes_at(rows)),
        b(kept_lanes_at(rows + register_size)),
        c(kept_lanes_at(rows + 2 * register_size)) {}
  // Of as many rows of three as there are lanes.
  template <int Column>
  lanes column() const {
    return whole_column<Column>(chosen_lanes<3, Column>(a, b, c, each_lane), each_lane);
  }
  // Of half as many rows of six: two columns, side by side.
  template <int Pair>
  lanes pair() const {
    return chosen_lanes<6, Pair>(a, b, c, each_lane);
  }

 private:
  template <int Column, int... K>
  static lanes whole_column(lanes found, std::integer_sequence<int, K...> /*lanes*/) {
    return __builtin_shufflevector(found, found, (3 * K + Column) % register_size...);
  }
};

// Column c of as many rows of two as there are lanes.
template <int Column, int... K>
lanes column_of(lanes first, lanes second, std::integer_sequence<int, K...> /*lanes*/) {
  return __builtin_shufflevector(first, second, 2 * K + Column...);
}
// The same of rows of six, from the pairs in which it is.
template <int Column, int... K>
lanes column_of_six(lanes low, lanes high, std::integer_sequence<int, K...> /*lanes*/) {
  constexpr int half = register_size / 2;
  return __builtin_shufflevector(low, high,
                                 (K / half * register_size + (6 * (K % half) + Column) % register_size)...);
}

// The way back for rows of three: column c with its numbers in the lanes in which they stand in the rows.
template <int Column>
constexpr int row_in_lane(int lane) {
  int row = 0;
  while ((3 * row + Column) % register_size != lane) ++row;
  return row;
}
template <int Column, int... K>
lanes moved_to_rows(lanes column, std::integer_sequence<int, K...> /*lanes*/) {
  return __builtin_shufflevector(column, column, row_in_lane<Column>(K)...);
}
// Vector v of the rows, from its columns as they were moved.
template <int Vector, int... K>
lanes row_of(lanes a, lanes b, lanes c, std::integer_sequence<int, K...> /*lanes*/) {
  constexpr int from = Vector * register_size;
  const lanes found = __builtin_shufflevector(a, b, ((from + K) % 3 == 1 ? K + register_size : K)...);
  return __builtin_shufflevector(found, c, ((from + K) % 3 == 2 ? K + register_size : K)...);
}

// Longer rows are turned into columns, and columns into rows, square by square; the last two squares of a row
// may overlap.
inline constexpr int square_size = register_size < 4 ? register_size : 4;
struct square {
  using line = double __attribute__((vector_size(8 * square_size)));
  line lines[square_size];

  // at(k): where line k stands. Unrolled, or GCC keeps the lines in memory, in halves.
  template <class At>
  [[gnu::always_inline]] static square from(At at) {
    square s;
#pragma GCC unroll 4
    for (int k = 0; k < square_size; ++k) __builtin_memcpy(&s.lines[k], at(k), sizeof(line));
    return s;
  }
  template <class At>
  [[gnu::always_inline]] void put(At at) const {
#pragma GCC unroll 4
    for (int k = 0; k < square_size; ++k) __builtin_memcpy(at(k), &lines[k], sizeof(line));
  }
  square turned() const {
#ifdef __AVX__
    const line a = __builtin_shufflevector(lines[0], lines[1], 0, 4, 2, 6),
               b = __builtin_shufflevector(lines[0], lines[1], 1, 5, 3, 7),
               c = __builtin_shufflevector(lines[2], lines[3], 0, 4, 2, 6),
               d = __builtin_shufflevector(lines[2], lines[3], 1, 5, 3, 7);
    return {{__builtin_shufflevector(a, c, 0, 1, 4, 5), __builtin_shufflevector(b, d, 0, 1, 4, 5),
             __builtin_shufflevector(a, c, 2, 3, 6, 7), __builtin_shufflevector(b, d, 2, 3, 6, 7)}};
#else
    return {{__builtin_shufflevector(lines[0], lines[1], 0, 2),
             __builtin_shufflevector(lines[0], lines[1], 1, 3)}};
#endif
  }
};

// turn(i, c): what is done at the square whose first row and column these are. Returns how many rows had one.
template <class Turn>
int for_each_square(int rows, int numbers, Turn turn) {
  int i = 0;
  for (; i + square_size <= rows; i += square_size)
    for (int c = 0; c < numbers; c += square_size)
      turn(i, c + square_size <= numbers ? c : numbers - square_size);
  return i;
}
// Rows of so many numbers, from one to the next a stride. column(c): where column c begins.
inline bool are_long(int numbers) { return numbers >= square_size; }
template <class Column>
void separate_rows_of(const double* values, std::int64_t stride, int numbers, int count, Column column) {
  int i = for_each_square(count, numbers, [&](int first, int c) {
    const double* const corner = values + first * stride + c;
    square::from([&](int k) { return corner + k * stride; }).turned().put([&](int k) {
      return column(c + k) + first;
    });
  });
  for (; i < count; ++i)
    for (int c = 0; c < numbers; ++c) column(c)[i] = values[i * stride + c];
}
inline void join_rows_of(double* const* columns, int numbers, int count, double* values,
                         std::int64_t stride) {
  int i = for_each_square(count, numbers, [&](int first, int c) {
    double* const corner = values + first * stride + c;
    square::from([&](int k) { return columns[c + k] + first; }).turned().put([&](int k) {
      return corner + k * stride;
    });
  });
  for (; i < count; ++i)
    for (int c = 0; c < numbers; ++c) values[i * stride + c] = columns[c][i];
}

// Rows of four behind each other take half of the time where compilers know it.
template <class Column>
void separate_rows(const double* values, std::int64_t stride, int numbers, int count, Column column) {
  if (numbers == 4 && stride == 4) return separate_rows_of(values, 4, 4, count, column);
  separate_rows_of(values, stride, numbers, count, column);
}
inline void join_rows(double* const* columns, int numbers, int count, double* values, std::int64_t stride) {
  if (numbers == 4 && stride == 4) return join_rows_of(columns, 4, count, values, 4);
  join_rows_of(columns, numbers, count, values, stride);
}

template <class Number>
void separate_pairs(const Number* __restrict__ values, int first, int count, double* __restrict__ a,
                    double* __restrict__ b) {
#pragma omp simd
  for (int i = first; i < count; ++i) {
    a[i] = values[2 * i];
    b[i] = values[2 * i + 1];
  }
}
template <class Number>
void separate_pairs(const Number* values, int count, double* a, double* b) {
  int i = 0;
  if constexpr (std::is_same_v<Number, double>)
    for (; i + register_size <= count; i += register_size) {
      const lanes u = lanes_at(values + 2 * i), v = lanes_at(values + 2 * i + register_size);
      put_lanes(column_of<0>(u, v, each_lane), a + i);
      put_lanes(column_of<1>(u, v, each_lane), b + i);
    }
  separate_pairs(values, i, count, a, b);
}

template <class Number>
void separate_triples(const Number* __restrict__ values, int first, int count, double* __restrict__ a,
                      double* __restrict__ b, double* __restrict__ c) {
#pragma omp simd
  for (int i = first; i < count; ++i) {
    a[i] = values[3 * i];
    b[i] = values[3 * i + 1];
    c[i] = values[3 * i + 2];
  }
}
template <class Number>
void separate_triples(const Number* values, int count, double* a, double* b, double* c) {
  int i = 0;
  if constexpr (std::is_same_v<Number, double>)
    for (; i + register_size <= count; i += register_size) {
      const vectors_of_rows rows(values + 3 * i);
      put_lanes(rows.column<0>(), a + i);
      put_lanes(rows.column<1>(), b + i);
      put_lanes(rows.column<2>(), c + i);
    }
  separate_triples(values, i, count, a, b, c);
}

template <class Number>
void interleave(const double* __restrict__ a, const double* __restrict__ b, const double* __restrict__ c,
                int first, int count, Number* __restrict__ values) {
#pragma omp simd
  for (int i = first; i < count; ++i) {
    values[3 * i] = static_cast<Number>(a[i]);
    values[3 * i + 1] = static_cast<Number>(b[i]);
    values[3 * i + 2] = static_cast<Number>(c[i]);
  }
}
template <class Number>
void interleave(double* const* components, int count, Number* values) {
  const double *a = components[0], *b = components[1], *c = components[2];
  int i = 0;
  if constexpr (std::is_same_v<Number, double>)
    for (; i + register_size <= count; i += register_size) {
      const lanes u = moved_to_rows<0>(lanes_at(a + i), each_lane),
                  v = moved_to_rows<1>(lanes_at(b + i), each_lane),
                  w = moved_to_rows<2>(lanes_at(c + i), each_lane);
      double* rows = values + 3 * i;
      put_lanes(row_of<0>(u, v, w, each_lane), rows);
      put_lanes(row_of<1>(u, v, w, each_lane), rows + register_size);
      put_lanes(row_of<2>(u, v, w, each_lane), rows + 2 * register_size);
    }
  interleave(a, b, c, i, count, values);
}

}  // namespace ilaw::kit::detail
