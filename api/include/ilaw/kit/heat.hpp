// heat.hpp - heat and wear of what slides. A law whose parameters have the members heat_partition and
// wear_coefficient gives three amounts after its own, which the kit computes where a host asks for them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/law.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

template <class Law>
constexpr parameter<Law> heat_partition_parameter(typename number_of_law<Law>::type Law::*member) {
  return {.member = member,
          .name = "heat_partition",
          .symbol = "eta",
          .doc = "Part of the frictional heat that flows into the body; the rest flows into its counterpart.",
          .default_value = 0.5,
          .maximum = 1.0};
}
template <class Law>
constexpr parameter<Law> wear_coefficient_parameter(typename number_of_law<Law>::type Law::*member) {
  return {.member = member,
          .name = "wear_coefficient",
          .symbol = "k_w",
          .unit = "m^2/N",
          .doc = "Depth taken off per pressure and slip (Archard 1953)."};
}

namespace detail {

inline constexpr amount_card heat_amounts[] = {
    {.name = "heat", .unit = "J", .doc = "Frictional heat of the step into the body."},
    {.name = "counterpart_heat", .unit = "J", .doc = "The same into the counterpart."},
    {.name = "wear", .unit = "m", .doc = "Depth taken off in the step: k_w p |v_T| h."}};

}  // namespace detail

}  // namespace ilaw::kit
