// sized.hpp - structs of ilaw.h that pass between files compiled with different minor versions: whoever reads
// takes what the writer wrote, and the rest is zero; whoever writes writes no byte beyond the reader's room.
// The kit, the loader and C++ hosts of any sort use this one.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/ilaw.h>

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace ilaw::sized {

// Size that ABI 1.0 gave a struct: what every writer of ABI 1 fills, whatever later versions append.
template <class Struct>
inline constexpr std::uint32_t least = 0;
template <>
inline constexpr std::uint32_t least<ilaw_parameter> = ILAW_PARAMETER_SIZE_1_0;
template <>
inline constexpr std::uint32_t least<ilaw_state_variable> = ILAW_STATE_VARIABLE_SIZE_1_0;
template <>
inline constexpr std::uint32_t least<ilaw_amount> = ILAW_AMOUNT_SIZE_1_0;
template <>
inline constexpr std::uint32_t least<ilaw_axis> = ILAW_AXIS_SIZE_1_0;
template <>
inline constexpr std::uint32_t least<ilaw_argument> = ILAW_ARGUMENT_SIZE_1_0;
template <>
inline constexpr std::uint32_t least<ilaw_setup> = ILAW_SETUP_SIZE_1_0;
template <>
inline constexpr std::uint32_t least<ilaw_instance_info> = ILAW_INSTANCE_INFO_SIZE_1_0;
template <>
inline constexpr std::uint32_t least<ilaw_batch> = ILAW_BATCH_SIZE_1_0;
template <>
inline constexpr std::uint32_t least<ilaw_report> = ILAW_REPORT_SIZE_1_0;
template <>
inline constexpr std::uint32_t least<ilaw_law> = ILAW_LAW_SIZE_1_0;
template <>
inline constexpr std::uint32_t least<ilaw_plugin> = ILAW_PLUGIN_SIZE_1_0;

// No struct of any version is larger; a larger struct_size was never written.
inline constexpr std::uint32_t most = 4096;

// The size that a struct states in its first member; 0 for a null pointer.
template <class Struct>
std::uint32_t size_of(const Struct* given) {
  std::uint32_t size = 0;
  if (given) std::memcpy(&size, given, sizeof size);
  return size;
}

// Whether a writer of ABI 1 can have set this struct_size.
template <class Struct>
constexpr bool is_plausible(std::uint32_t struct_size) {
  static_assert(least<Struct> != 0, "a struct with struct_size");
  return struct_size >= least<Struct> && struct_size <= most;
}

// Whether a struct is there, and all of it that version 1.0 has.
template <class Struct>
bool is_complete(const Struct* given) {
  return is_plausible<Struct>(size_of(given));
}

// Copies what the writer wrote and the reader has room for; what the writer did not know becomes zero.
inline void copy(void* to, std::size_t room, const void* from, std::size_t written) {
  const std::size_t common = room < written ? room : written;
  std::memcpy(to, from, common);
  std::memset(static_cast<char*>(to) + common, 0, room - common);
}

// A struct that a writer of any minor version filled, as the struct of this one.
template <class Struct>
Struct read(const Struct* given) {
  Struct known;
  copy(&known, sizeof known, given, size_of(given));
  return known;
}

// The reverse: as much of the struct of this version as a reader of any minor version has room for.
template <class Struct>
void write(Struct* out, Struct value) {
  value.struct_size = size_of(out);
  std::memcpy(out, &value, value.struct_size < sizeof value ? value.struct_size : sizeof value);
}

// A struct that a caller lent for writing: all that follows struct_size becomes zero, which is what members
// stay that its writer does not know. False where struct_size cannot be true.
template <class Struct>
bool cleared(Struct* lent) {
  if (!is_complete(lent)) return false;
  constexpr std::size_t head = sizeof lent->struct_size;
  std::memset(reinterpret_cast<char*>(lent) + head, 0, size_of(lent) - head);
  return true;
}

}  // namespace ilaw::sized
