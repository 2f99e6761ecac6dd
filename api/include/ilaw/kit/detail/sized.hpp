// sized.hpp - structs that pass between files compiled with different minor versions of the header.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/ilaw.h>
#include <ilaw/kit/detail/level.hpp>

#include <cstdint>
#include <cstring>

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

// Size that a struct had in version 1.0: nobody can have filled less of it.
template <class Struct>
inline constexpr std::uint32_t least_size = 0;
template <>
inline constexpr std::uint32_t least_size<ilaw_argument> = ILAW_ARGUMENT_SIZE_1_0;
template <>
inline constexpr std::uint32_t least_size<ilaw_setup> = ILAW_SETUP_SIZE_1_0;
template <>
inline constexpr std::uint32_t least_size<ilaw_instance_info> = ILAW_INSTANCE_INFO_SIZE_1_0;
template <>
inline constexpr std::uint32_t least_size<ilaw_batch> = ILAW_BATCH_SIZE_1_0;
template <>
inline constexpr std::uint32_t least_size<ilaw_report> = ILAW_REPORT_SIZE_1_0;

template <class Struct>
std::uint32_t size_of(const Struct* given) {
  std::uint32_t size = 0;
  if (given) std::memcpy(&size, given, sizeof size);
  return size;
}

// Whether a struct is there, and all of it that version 1.0 has.
template <class Struct>
bool is_complete(const Struct* given) {
  static_assert(least_size<Struct> > 0);
  return size_of(given) >= least_size<Struct>;
}

template <class Struct>
std::uint32_t common_size(const Struct* given) {
  const std::uint32_t size = size_of(given);
  return size < sizeof(Struct) ? size : std::uint32_t{sizeof(Struct)};
}

// What a writer of any minor version filled, as the struct of this one: what it did not know is zero.
template <class Struct>
Struct read_sized(const Struct* given) {
  Struct known{};
  std::memcpy(&known, given, common_size(given));
  return known;
}

// The reverse: as much of the struct of this version as a reader of any minor version has room for.
template <class Struct>
void write_sized(Struct* out, Struct value) {
  value.struct_size = size_of(out);
  std::memcpy(out, &value, common_size(out));
}

}  // namespace ilaw::kit
