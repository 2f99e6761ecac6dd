// sizes.hpp - the structs of coupled.h among those that grow (ilaw/sized.hpp).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/coupled.h>
#include <ilaw/sized.hpp>

namespace ilaw::sized {

template <>
inline constexpr std::uint32_t least<ilaw_bodies> = ILAW_BODIES_SIZE_1_0;
template <>
inline constexpr std::uint32_t least<ilaw_contacts> = ILAW_CONTACTS_SIZE_1_0;
template <>
inline constexpr std::uint32_t least<ilaw_threads> = ILAW_THREADS_SIZE_1_0;
template <>
inline constexpr std::uint32_t least<ilaw_exchange> = ILAW_EXCHANGE_SIZE_1_0;
template <>
inline constexpr std::uint32_t least<ilaw_coupled_options> = ILAW_COUPLED_OPTIONS_SIZE_1_0;
template <>
inline constexpr std::uint32_t least<ilaw_coupled_report> = ILAW_COUPLED_REPORT_SIZE_1_0;

}  // namespace ilaw::sized
