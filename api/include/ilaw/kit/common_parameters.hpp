// common_parameters.hpp - what several laws declare alike: parameters and the history of a window. A law that
// differs in a detail says so after it: friction_parameter(&coulomb::friction).as_required().
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/contact.hpp>
#include <ilaw/kit/declare.hpp>

#include <cstdint>
#include <iterator>

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

template <class Law>
constexpr parameter<Law> restitution_parameter(double Law::*member) {
  return {.member = member,
          .name = "restitution",
          .symbol = "e",
          .doc = "Newton's coefficient: normal velocity after an impact over the one before, reversed.",
          .maximum = 1.0};
}

template <class Law>
constexpr parameter<Law> activation_parameter(double Law::*member) {
  return {
      .member = member,
      .name = "activation",
      .doc = "moreau: acts where the gap is closed; predictive: acts where the next gap would be negative.",
      .default_value = predictive,
      .choices = activation_choices,
      .choice_count = static_cast<std::uint32_t>(std::size(activation_choices))};
}

template <class Law>
constexpr parameter<Law> friction_parameter(double Law::*member) {
  return {.member = member,
          .name = "friction",
          .symbol = "mu",
          .doc = "Coefficient of friction.",
          .infinity_allowed = true};
}

// Duration and number of buckets of a window; see window.hpp.
template <class Law>
constexpr parameter<Law> memory_parameter(double Law::*member) {
  return {.member = member,
          .name = "memory",
          .symbol = "tau_Y",
          .unit = "s",
          .doc = "Duration over which impulses are summed; 0: the step's own impulse alone.",
          .infinity_allowed = true,
          .fixed = true};
}

template <class Law>
constexpr parameter<Law> buckets_parameter(double Law::*member) {
  return {.member = member,
          .name = "buckets",
          .symbol = "B",
          .doc = "Buckets of the window, which is of third order in their width memory/B.",
          .default_value = 16.0,
          .minimum = 1.0,
          .maximum = 4096.0,
          .whole = true,
          .fixed = true};
}

inline constexpr history_card window_variable{
    .name = "window", .unit = "N.s", .doc = "Impulses of the last memory.", .internal = true};

}  // namespace ilaw::kit
