// interleaving.hpp - which batches are worked on where they are, in (3,n) arrays and, if they hold floats, in
// columns: nothing of their vectors is copied, and a core computes one node while it waits for the lines of
// others.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/instance.hpp>
#include <ilaw/kit/detail/one_step.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

template <class Law>
inline constexpr bool in_space = (Law::card.dimensions & ILAW_DIMENSION_3) != 0;

// Whether no more is asked than the kernels of such arrays give: impulses, or velocities and statuses
// besides.
template <class Law>
bool asks_little(const ilaw_kit_batch& b) {
  if (b.energy.values) return false;
  return b.velocity.values ? always_reads_previous<Law> : !b.status;
}
// Whether the vectors that a kernel may read and write in place stand as a layout has them.
template <class Layout, class Law>
bool stand_in(const instance<Law>& made, const ilaw_kit_batch& b) {
  const auto may_be = [](const auto& a) { return !a.values || Layout::has(a); };
  return made.dimension == 3 && !b.index && !b.index64 && holds_floats(b) == is_of_floats<Layout> &&
         Layout::has(b.v_free) && Layout::has(b.impulse) && may_be(b.v_previous) && may_be(b.velocity) &&
         (made.frame == ILAW_FRAME_LOCAL || Layout::has(b.normal));
}
// A state of a few numbers and nothing else may stay in its rows: of longer ones compilers make no vector
// code, and where H has more than two numbers it is copied in any case.
template <class Law, class Delassus>
inline constexpr bool may_have_state_rows = [] {
  if constexpr (has_state<Law> && std::is_same_v<Delassus, transverse_delassus>)
    return row_of_state<Law> > 1 && row_of_state<Law> <= 4;
  return false;
}();
template <class Law>
bool state_stands_in_rows(const instance<Law>& made, const ilaw_kit_batch& b) {
  constexpr int numbers = row_of_state<Law>;
  const auto are_rows = [](const auto& a) { return a.node_stride == numbers && a.component_stride == 1; };
  return made.state_size == numbers && b.state_in.values && are_rows(b.state_in) && are_rows(b.state_out);
}
// Of floats nothing is copied: numbers of the nodes one after another.
inline bool are_scalars_in_columns(const ilaw_kit_batch& b) {
  const auto may_be = [](const auto& a) { return !a.values || a.node_stride == 1; };
  return may_be(b.delassus) && may_be(b.gap) && may_be(b.gap_offset) && may_be(b.area);
}
// For which laws they are worth their loops. One that asks first reads its nodes several times, which columns
// serve better where H leaves much to solve.
template <class Law, class Delassus, class Frame>
inline constexpr bool may_interleave =
    in_space<Law> && !is_for_old_processors && !std::is_same_v<Frame, stored_frame> &&
    (std::is_same_v<Delassus, transverse_delassus> || !asks_first<Law, node_in<Law, Delassus, Frame>>);

// Floats stay where they are in one form of a law, the one that it names for them, and with an H of two
// numbers at most: every loop more is compiled for two layouts, two frames and each instruction set.
template <class Law, class Delassus, class Frame>
concept may_stay_floats = requires {
  typename Law::form_of_floats;
}
&&may_interleave<Law, Delassus, Frame>&& std::is_same_v<Delassus, transverse_delassus> &&
    !asks_first<typename Law::form_of_floats, node_in<Law, Delassus, Frame>>;
template <class Law>
bool has_form_of_floats(const Law& law) {
  bool has = false;
  in_its_form(law,
              [&has]<class Form>(const Form&) { has = std::is_same_v<Form, typename Law::form_of_floats>; });
  return has;
}

// Whether the form of a law asks its nodes first, and so goes through them several times.
template <class Delassus, class Frame, class Law>
bool is_asked_first(const Law& law) {
  bool is = false;
  in_its_form(law, [&is]<class Form>(const Form&) { is = asks_first<Form, node_in<Law, Delassus, Frame>>; });
  return is;
}

// Which forms have a loop: one whose inputs always have v_previous has none without it.
template <class Form>
concept needs_previous = Form::needs_previous;
template <class Law, class Form, class Layout, scope Scope>
constexpr bool is_run() {
  if constexpr (is_of_floats<Layout>)
    if constexpr (!std::is_same_v<Form, typename Law::form_of_floats>) return false;
  return Scope != scope::impulse || !needs_previous<Form>;
}

}  // namespace ilaw::kit::detail
