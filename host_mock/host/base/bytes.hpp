// bytes.hpp - values as the bytes of a checkpoint, and back. Reading throws std::runtime_error
// where the bytes cannot be what was written.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <istream>
#include <ostream>
#include <stdexcept>
#include <type_traits>
#include <vector>

namespace ilaw::host {

[[noreturn]] inline void refuse_damaged() { throw std::runtime_error("the checkpoint is damaged"); }

// Whether all bytes of a value mean something, so that equal values are equal bytes.
template <class T>
inline constexpr bool has_no_padding =
    std::has_unique_object_representations_v<T> || std::is_same_v<T, float> || std::is_same_v<T, double>;

// An array whose length both sides know.
template <class T>
void write_array(std::ostream& out, const T* values, std::size_t count) {
  static_assert(has_no_padding<T>);
  out.write(reinterpret_cast<const char*>(values), static_cast<std::streamsize>(count * sizeof(T)));
}

template <class T>
void read_array(std::istream& in, T* values, std::size_t count) {
  static_assert(has_no_padding<T>);
  in.read(reinterpret_cast<char*>(values), static_cast<std::streamsize>(count * sizeof(T)));
  if (!in) refuse_damaged();
}

template <class T>
void write_value(std::ostream& out, const T& value) {
  write_array(out, &value, 1);
}

template <class T>
void read_value(std::istream& in, T& value) {
  read_array(in, &value, 1);
}

// As a sum of doubles: three hold any long double, and have no padding.
inline void write_value(std::ostream& out, long double value) {
  for (int k = 0; k < 3; ++k) {
    const auto part = static_cast<double>(value);
    write_value<double>(out, part);
    value = std::isfinite(part) ? value - part : 0.0L;
  }
}
inline void read_value(std::istream& in, long double& value) {
  value = 0.0L;
  for (int k = 0; k < 3; ++k) {
    double part = 0.0;
    read_value<double>(in, part);
    value += part;
  }
}

// An array with its length before it.
template <class T>
void write_sized(std::ostream& out, const std::vector<T>& values) {
  write_value(out, std::uint64_t{values.size()});
  write_array(out, values.data(), values.size());
}

template <class T>
std::vector<T> read_sized(std::istream& in, std::uint64_t most) {
  std::uint64_t size = 0;
  read_value(in, size);
  if (size > most) refuse_damaged();
  std::vector<T> values(size);
  read_array(in, values.data(), values.size());
  return values;
}

}  // namespace ilaw::host
