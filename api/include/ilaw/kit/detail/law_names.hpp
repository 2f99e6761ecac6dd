// law_names.hpp - which names a law has: those that the kit calls, and misspelt ones, with the line that says
// how they are spelt.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/law.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// names_x<Law>: whether a law has a member x of any kind; two of a name are ambiguous.
#define ILAW_KIT_NAME(name)                        \
  struct other_##name {                            \
    int name;                                      \
  };                                               \
  template <class Law>                             \
  struct with_##name : Law, other_##name {};       \
  template <class Law>                             \
  inline constexpr bool names_##name = !requires { \
    &with_##name<Law>::name;                       \
  }
// And a name that the kit does not know, written for one that it does.
#define ILAW_KIT_SPELLING(wrong, right)                                     \
  ILAW_KIT_NAME(wrong);                                                     \
  template <class Law>                                                      \
  constexpr bool spells_##wrong() {                                         \
    constexpr bool is_right = !names_##wrong<Law>;                          \
    static_assert(is_right, "the kit calls no '" #wrong "': write " right); \
    return is_right;                                                        \
  }

// Every name that a law may define (law.hpp says what for), and how often it is missed.
// clang-format off
ILAW_KIT_NAME(card); ILAW_KIT_NAME(references); ILAW_KIT_NAME(parameters); ILAW_KIT_NAME(state);
ILAW_KIT_NAME(state_variables); ILAW_KIT_NAME(history); ILAW_KIT_NAME(amounts); ILAW_KIT_NAME(step);
ILAW_KIT_NAME(problem); ILAW_KIT_NAME(answer); ILAW_KIT_NAME(ask); ILAW_KIT_NAME(solve);
ILAW_KIT_NAME(solve_scalar); ILAW_KIT_NAME(finish); ILAW_KIT_NAME(asks);
ILAW_KIT_NAME(prepare); ILAW_KIT_NAME(initialise); ILAW_KIT_NAME(conflict); ILAW_KIT_NAME(inputs);
ILAW_KIT_NAME(capabilities); ILAW_KIT_NAME(permissions); ILAW_KIT_NAME(tells_tangents_apart);
ILAW_KIT_NAME(stable_velocity_step); ILAW_KIT_NAME(window); ILAW_KIT_NAME(adds_to_window); ILAW_KIT_NAME(clears_window);
ILAW_KIT_NAME(extension);

#define ILAW_KIT_SPELLINGS(spelling) \
  spelling(params, "'parameters'") spelling(state_variable, "'state_variables'") \
  spelling(initialize, "'initialise'") spelling(init, "'initialise'") \
  spelling(do_step, "'step'") spelling(prepared, "'prepare'") \
  spelling(stable_step, "'stable_velocity_step'") \
  spelling(is_isotropic, ".is_isotropic = true in the card")
// clang-format on
ILAW_KIT_SPELLINGS(ILAW_KIT_SPELLING)

// All of them, whatever the first one says.
template <class Law>
constexpr bool spells_rightly() {
#define ILAW_KIT_SPELLED(wrong, right) &spells_##wrong<Law>()
  return true ILAW_KIT_SPELLINGS(ILAW_KIT_SPELLED);
#undef ILAW_KIT_SPELLED
}
#undef ILAW_KIT_NAME
#undef ILAW_KIT_SPELLING
#undef ILAW_KIT_SPELLINGS

}  // namespace ilaw::kit::detail
