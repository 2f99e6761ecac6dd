// sized.hpp - structs of other minor versions: a reader takes what the writer wrote, the rest is zero.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/ilaw.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace ilaw::loading {

// Size that ABI 1.0 gave a struct: what every writer of ABI 1 fills, whatever later versions append.
template <class Struct>
inline constexpr std::uint32_t first_size = 0;
template <>
inline constexpr std::uint32_t first_size<ilaw_parameter> = ILAW_PARAMETER_SIZE_1_0;
template <>
inline constexpr std::uint32_t first_size<ilaw_state_variable> = ILAW_STATE_VARIABLE_SIZE_1_0;
template <>
inline constexpr std::uint32_t first_size<ilaw_setup> = ILAW_SETUP_SIZE_1_0;
template <>
inline constexpr std::uint32_t first_size<ilaw_instance_info> = ILAW_INSTANCE_INFO_SIZE_1_0;
template <>
inline constexpr std::uint32_t first_size<ilaw_report> = ILAW_REPORT_SIZE_1_0;
template <>
inline constexpr std::uint32_t first_size<ilaw_law> = ILAW_LAW_SIZE_1_0;
template <>
inline constexpr std::uint32_t first_size<ilaw_plugin> = ILAW_PLUGIN_SIZE_1_0;

// No struct of any version is larger; a larger struct_size was never written.
inline constexpr std::uint32_t largest_size = 4096;

// Whether a writer of ABI 1 can have set this struct_size.
template <class Struct>
bool plausible_size(std::uint32_t struct_size) {
  static_assert(first_size<Struct> != 0, "a struct with struct_size");
  return struct_size >= first_size<Struct> && struct_size <= largest_size;
}

// Copies what the writer wrote and the reader has room for; what the writer did not know becomes zero.
inline void copy_sized(void* to, std::size_t room, const void* from, std::size_t written) {
  const std::size_t common = std::min(room, written);
  std::memcpy(to, from, common);
  std::memset(static_cast<char*>(to) + common, 0, room - common);
}

// A struct that a caller lent for writing: all that follows struct_size becomes zero, which is what members
// stay that its writer does not know. False where struct_size cannot be true.
template <class Struct>
bool cleared(Struct* lent) {
  if (!plausible_size<Struct>(lent->struct_size)) return false;
  constexpr std::size_t head = sizeof lent->struct_size;
  std::memset(reinterpret_cast<char*>(lent) + head, 0, lent->struct_size - head);
  return true;
}

}  // namespace ilaw::loading
