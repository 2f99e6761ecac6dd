// kernel.hpp - the loop over packs of nodes: load, step, check, store. One per law, number type of the host, form of H
// and frame; layouts, dimensions, outputs and parameters per node are branches that all nodes of a batch share.
//
// A pack with a bad node writes nothing and is done again by a cold function, which also does the last, unfilled pack
// and finds the reason.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/frame.hpp>
#include <ilaw/kit/detail/parameters.hpp>
#include <ilaw/kit/node.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// ---- checks -------------------------------------------------------------------------------------------------------------

// Finds bad lanes: a product of all numbers that must be finite, zero where they are. Careful: and why.
template <class V, bool Careful>
struct checks {
  V found = 0.0;

  ILAW_KIT_INLINE void finite(V x, reason) { found = found * x; }
  template <class Vector>
  ILAW_KIT_INLINE void finite_vector(Vector a, reason, bool /*of_frame*/ = false) {
    found = residual(a, found);
  }
  ILAW_KIT_INLINE void require(mask_of<V> good, reason) { found = nan_unless(good, found); }
  ILAW_KIT_INLINE void frame(mask_of<V>) {}
  ILAW_KIT_INLINE mask_of<V> bad() const { return !(found == 0.0); }
};
template <class V>
struct checks<V, true> {
  V code = 0.0;
  mask_of<V> framed = V(0.0) == V(0.0);

  ILAW_KIT_INLINE void require(mask_of<V> good, reason why) {
    code = select((code == 0.0) & (!good), V(static_cast<double>(why)), code);
  }
  ILAW_KIT_INLINE void finite(V x, reason why) { require(0.0 * x == 0.0, why); }
  // A vector that was turned by a frame that is none says nothing.
  template <class Vector>
  ILAW_KIT_INLINE void finite_vector(Vector a, reason why, bool of_frame = false) {
    const auto good = residual(a, V(0.0)) == 0.0;
    require(of_frame ? good | !framed : good, why);
  }
  ILAW_KIT_INLINE void frame(mask_of<V> good) { framed = good; }
  ILAW_KIT_INLINE mask_of<V> bad() const { return code != 0.0; }
};

// ---- parameters -----------------------------------------------------------------------------------------------------------

template <class Law, class V>
struct law_on;
template <template <class> class L, class Old, class V>
struct law_on<L<Old>, V> {
  using type = L<V>;
};
template <class Law, class V>
using law_on_t = typename law_on<Law, V>::type;

// The law with the same values in all lanes.
template <class V, class Law, std::size_t... K>
ILAW_KIT_INLINE law_on_t<Law, V> broadcast(const Law& law, std::index_sequence<K...>) {
  using Wide = law_on_t<Law, V>;
  Wide wide;
  (Wide::parameters[K].member.set(wide, Law::parameters[K].member.get(law)), ...);
  return wide;
}
template <class V, class Law>
ILAW_KIT_INLINE law_on_t<Law, V> broadcast(const Law& law) {
  if constexpr (std::is_same_v<V, double>)
    return law;
  else
    return broadcast<V>(law, std::make_index_sequence<static_cast<std::size_t>(parameter_count<Law>)>{});
}

template <class Law>
constexpr parameter_range range_of(const parameter<Law>& p) {
  return parameter_range(p.minimum, p.minimum_excluded, p.maximum, p.infinity_allowed);
}

// The parameters of the nodes of a pack. Where one is out of range or several do not go together, the law stays as it
// was, so that no step need stand it; returns which nodes are good.
template <class Wide, class Law, class Number, class Lanes>
ILAW_KIT_INLINE auto take_parameters(Wide& own, const Law& law, const view<Number>& b, std::int64_t i, Lanes l) {
  using V = typename number_of_law<Wide>::type;
  mask_of<V> good = V(0.0) == V(0.0);
  for (int k = 0; k < parameter_count<Law>; ++k)
    if (Wide::parameters[k].member.may_vary() && b.parameters[k]) {
      const V given = l.load(b.parameters[k] + i, Law::parameters[k].member.get(law));
      good = good & range_of(Wide::parameters[k]).has(given);
      Wide::parameters[k].member.varying_in(own) = given;
    }
  if constexpr (requires { law.conflict(); }) {
    unsigned fit = 0;
    for (int lane = 0; lane < l.count; ++lane) {
      Law here = law;
      for (int k = 0; k < parameter_count<Law>; ++k)
        if (Wide::parameters[k].member.may_vary() && b.parameters[k])
          Law::parameters[k].member.set(here, lane_of(Wide::parameters[k].member.varying_in(own), lane));
      fit |= here.conflict() ? 0U : 1U << lane;
    }
    good = good & mask_from<V>(fit | (~0U << l.count));
  }
  if (any(!good))
    for (int k = 0; k < parameter_count<Law>; ++k)
      if (Wide::parameters[k].member.may_vary() && b.parameters[k]) {
        V& value = Wide::parameters[k].member.varying_in(own);
        value = select(good, value, V(Law::parameters[k].member.get(law)));
      }
  return good;
}

// ---- the state of a node, as an array of numbers ------------------------------------------------------------------------

template <class V, class State>
ILAW_KIT_INLINE V& number_in(State& state, int k) {
  return reinterpret_cast<V*>(&state)[k];
}
template <class V, class State>
ILAW_KIT_INLINE const V& number_in(const State& state, int k) {
  return reinterpret_cast<const V*>(&state)[k];
}

// ---- a pack from end to end ---------------------------------------------------------------------------------------------

template <class Law, class V, class Number, template <class> class Frame, template <class> class Delassus>
struct kernel {
  using Wide = law_on_t<Law, V>;
  using frame_type = Frame<V>;
  using vector_type = typename frame_type::vector_type;
  using H = Delassus<V>;
  using node_type = node<Wide, vector_type, H>;
  using view_type = view<Number>;
  using mask = mask_of<V>;
  static constexpr int width = lanes_of<V>, states = state_numbers<Law>;
  static constexpr bool may_pull = (Law::card.capabilities & ILAW_CAN_ADHERE) != 0;
  static constexpr bool stays_in_reach = (Law::card.permissions & ILAW_MAY_SKIP_FRESH) != 0 && !has_history<Law> &&
                                         !has_state<Law> && reads<Law>(reads_gap);
  static constexpr bool can_carry = frame_type::has_axes && (has_history<Law> || has_vector_state<Law>());

  // ---- load

  struct loaded {
    frame_type frame;
    axis<V> free;        // v_free in the axes of the batch
    mask motion_known;   // v_previous, for energies
    node_type node;
  };

  template <class Lanes, class Checks>
  ILAW_KIT_INLINE static void load_frame(frame_type& f, const view_type& b, std::int64_t i, Lanes l, Checks& c,
                                         mask& framed) {
    if constexpr (frame_type::has_normal) {
      V unused = 0.0;
      load_vector(f.n, b.normal, i, l, unused, unit_component);
      c.require(is_unit(f.n), reason_normal);
    }
    if constexpr (frame_type::has_axes) {
      if (b.tangents_from == tangents::of_plane) {
        f.turn_in_plane(b.dimension);
      } else if (b.tangents_from == tangents::chosen) {
        f.t1 = any_tangent(f.n);
      } else if (b.tangents_from == tangents::given) {
        V unused = 0.0;
        load_vector(f.t1, b.tangent, i, l, unused);
        framed = is_unit(f.t1) & are_orthogonal(f.n, f.t1);
        if constexpr (!Lanes::are_all) framed = framed | !mask_from<V>(l.own(~0U));
        c.require(framed, reason_tangent);
      } else {
        V before[6];
        load_numbers(before, b.frame_in, i, l);
        const axis<V> n{before[0], before[1], before[2]}, t{before[3], before[4], before[5]};
        framed = is_unit(n) & is_unit(t) & are_orthogonal(n, t);
        if constexpr (!Lanes::are_all) framed = framed | !mask_from<V>(l.own(~0U));
        f.t1 = transported_tangent(n, t, f.n);
      }
      f.t2 = cross(f.n, f.t1);
    }
  }

  template <class Lanes>
  ILAW_KIT_INLINE static V load_scalar(const Number* at, std::int64_t i, Lanes l, double fill) {
    return l.load(at + i, fill);
  }

  template <class Lanes>
  ILAW_KIT_INLINE static void load_delassus(transverse<V>& h, const view_type& b, std::int64_t i, Lanes l) {
    const auto& a = b.delassus;
    if (b.is_scalar) {
      h.n = l.load(a.at + i, 1.0);
      h.t = h.n;
    } else if (a.rows) {
      V c[2], unused = 0.0;
      load_rows(c, a.at + 2 * i, l, 1.0, unused);
      h.n = c[0];
      h.t = c[1];
    } else {
      h.n = l.load(a.at + i, 1.0);
      h.t = l.load(a.at + a.component + i, 1.0);
    }
  }
  // Diagonal with three entries, or full with six; of short blocks always all six.
  template <class Lanes>
  ILAW_KIT_INLINE static void load_delassus(full<V>& h, const view_type& b, std::int64_t i, Lanes l) {
    const auto& a = b.delassus;
    if (a.count == 6) {
      if (a.rows) {
        V c[6], unused = 0.0;
        load_rows(c, a.at + 6 * i, l, 0.0, unused);
        h.nn = c[0], h.t11 = c[1], h.t22 = c[2], h.n1 = c[3], h.n2 = c[4], h.t12 = c[5];
      } else {
        h.nn = l.load(a.at + i, 1.0);
        h.t11 = l.load(a.at + a.component + i, 1.0);
        h.t22 = l.load(a.at + 2 * a.component + i, 1.0);
        h.n1 = l.load(a.at + 3 * a.component + i);
        h.n2 = l.load(a.at + 4 * a.component + i);
        h.t12 = l.load(a.at + 5 * a.component + i);
      }
    } else {
      axis<V> d;
      V unused = 0.0;
      load_vector(d, a, i, l, unused, 1.0);
      h.nn = d.x, h.t11 = d.y, h.t22 = d.z;
      h.n1 = 0.0, h.n2 = 0.0, h.t12 = 0.0;
    }
    if constexpr (!Lanes::are_all) {  // the unit matrix where there is no node
      const mask there = mask_from<V>(l.own(~0U));
      h.nn = select(there, h.nn, 1.0), h.t11 = select(there, h.t11, 1.0), h.t22 = select(there, h.t22, 1.0);
      h.n1 = zero_unless(there, h.n1), h.n2 = zero_unless(there, h.n2), h.t12 = zero_unless(there, h.t12);
    }
  }

  // Where the law reads no v_previous it is there for energies alone: finite always, turned or not.
  template <class Lanes>
  ILAW_KIT_INLINE static void load_previous(vector_type& to, mask& known, const view_type& b, const frame_type& frame,
                                            std::int64_t i, Lanes l, V& found) {
    if (!b.v_previous.at) {
      to = {};
      return;
    }
    axis<V> a;
    load_vector(a, b.v_previous, i, l, found);
    if (!b.reads_previous) {
      constexpr double guard = 4.0;
      known = residual(a, V(0.0)) == 0.0;
      const axis<V> wide{guard * a.x, guard * a.y, guard * a.z};
      const mask good = residual(wide, V(0.0)) == 0.0;
      a = {zero_unless(good, a.x), zero_unless(good, a.y), zero_unless(good, a.z)};
    }
    to = frame.to_local(a);
  }

  template <class Lanes, class Checks>
  ILAW_KIT_INLINE static loaded load(const prepared_t<Wide>& prepared, const view_type& b, std::int64_t i, Lanes l,
                                     Checks& c) {
    constexpr bool careful = !Lanes::are_all;
    frame_type frame;
    mask framed = V(0.0) == V(0.0), known = framed;
    load_frame(frame, b, i, l, c, framed);
    c.frame(framed);
    V numbers = 0.0;  // a product of all of a row, whichever lane they belong to
    axis<V> free;
    load_vector(free, b.v_free, i, l, numbers);
    vector_type v_free = frame.to_local(free), v_previous{};
    if constexpr (frame_type::turns) v_free.n = v_free.n + 0.0;
    V unread = 0.0;
    if constexpr (reads<Law>(reads_v_previous))
      load_previous(v_previous, known, b, frame, i, l, b.reads_previous ? numbers : unread);
    H h;
    load_delassus(h, b, i, l);
    h = frame.to_local(h, b.dimension);
    V gap = 0.0, area = 0.0;
    if constexpr (reads<Law>(reads_gap)) {
      if (b.gap) {
        gap = load_scalar(b.gap, i, l, 1.0);
        if (b.gap_offset) gap = gap - load_scalar(b.gap_offset, i, l, 0.0);
      }
    }
    if constexpr (reads<Law>(reads_area))
      if (b.area) area = load_scalar(b.area, i, l, 1.0);

    if constexpr (careful || frame_type::turns)
      c.finite_vector(v_free, reason_v_free, true);
    else
      c.finite(numbers, reason_v_free);
    c.require(h.is_definite(), reason_delassus);
    if constexpr (reads<Law>(reads_gap)) c.finite(gap, reason_gap);
    if constexpr (reads<Law>(reads_v_previous) && (careful || frame_type::turns))
      c.finite_vector(v_previous, reason_v_previous, true);
    if constexpr (reads<Law>(reads_area)) {
      c.finite(area, reason_area);
      c.require(area >= 0.0, reason_area);
    }
    if constexpr (frame_type::has_axes)
      if (b.tangents_from == tangents::carried) c.require(framed, reason_frame);
    return {.frame = frame,
            .free = free,
            .motion_known = known,
            .node = {.time = b.step.time,
                     .velocity_step = b.step.velocity_step,
                     .position_step = b.step.position_step,
                     .per_position_step = b.step.per_position_step,
                     .wants_energy = b.energy.at != nullptr,
                     .prepared = prepared,
                     .v_free = v_free,
                     .v_previous = declared<reads_v_previous>(v_previous),
                     .delassus = h,
                     .gap = declared<reads_gap>(gap),
                     .area = declared<reads_area>(area)}};
  }
  template <std::uint32_t Input, class T>
  ILAW_KIT_INLINE static auto declared(T value) {
    if constexpr (reads<Law>(Input))
      return value;
    else if constexpr (Input == reads_v_previous)
      return undeclared_vector<vector_type>{};
    else
      return undeclared_input<V, Input>{};
  }

  template <class Lanes>
  ILAW_KIT_INLINE static void load_state(state_t<Wide>& state, const view_type& b, std::int64_t i, Lanes l) {
    if constexpr (states > 0) {
      V entries[states];
      load_numbers(entries, b.state_in, i, l);
      to_struct(state, entries, std::make_index_sequence<static_cast<std::size_t>(states)>{});
    }
  }
  // In space; the walk brings states of fewer dimensions to the same order, with zeros.
  template <std::size_t... K>
  ILAW_KIT_INLINE static void to_struct(state_t<Wide>& state, const V (&entries)[states + (states == 0)],
                                        std::index_sequence<K...>) {
    ((number_in<V>(state, static_cast<int>(K)) = entries[state_entry<Law>(static_cast<int>(K), 3)]), ...);
  }
  template <std::size_t... K>
  ILAW_KIT_INLINE static void from_struct(V (&entries)[states + (states == 0)], const state_t<Wide>& state,
                                          std::index_sequence<K...>) {
    ((entries[state_entry<Law>(static_cast<int>(K), 3)] = number_in<V>(state, static_cast<int>(K))), ...);
  }

  template <std::size_t Variable, class Checks>
  ILAW_KIT_INLINE static void check_range(const state_t<Wide>& state, Checks& c) {
    constexpr const auto& v = Law::state_variables[Variable];
    if constexpr (v.has_range())
      c.require(v.may_be(number_in<V>(state, state_places<Law>[Variable])),
                static_cast<reason>(reason_of_first_variable + static_cast<int>(Variable)));
  }
  template <class Checks, std::size_t... K>
  ILAW_KIT_INLINE static void check_ranges(const state_t<Wide>& state, Checks& c, std::index_sequence<K...>) {
    (check_range<K>(state, c), ...);
  }
  template <class Checks>
  ILAW_KIT_INLINE static void check_finite(const state_t<Wide>& state, Checks& c, reason why) {
#pragma GCC unroll 32
    for (int k = 0; k < states; ++k) c.finite(number_in<V>(state, k), why);
  }
  template <class Lanes, class Checks>
  ILAW_KIT_INLINE static void take_state(node_type& n, const view_type& b, std::int64_t i, Lanes l, Checks& c) {
    if constexpr (states > 0) {
      load_state(n.state, b, i, l);
      check_finite(n.state, c, reason_state);
      check_ranges(n.state, c, std::make_index_sequence<std::size(Law::state_variables)>{});
    }
    if constexpr (has_window<Law>) {
      if (b.windows) {
        n.earlier = {l.load(b.windows->earlier[0] + i), l.load(b.windows->earlier[1] + i),
                     l.load(b.windows->earlier[2] + i)};
        n.refused = l.load(b.windows->refused + i);
      }
    } else if constexpr (has_history<Law>) {
      n.history = history_of(b, i);
    }
  }
  static history_values history_of(const view_type& b, std::int64_t i) {
    return {b.history + (b.nodes ? b.nodes[i] : i) * b.history_node_stride, b.history_component_stride};
  }

  // ---- check the result

  static mask is_infinite(vector<V> a) {
    return (absolute(a.n) == infinity) | (absolute(a.t1) == infinity) | (absolute(a.t2) == infinity);
  }
  static mask is_infinite(projected<V> a) {
    return (absolute(a.n) == infinity) | (absolute(a.x) + absolute(a.y) + absolute(a.z) == infinity);
  }
  template <class Checks>
  ILAW_KIT_INLINE static void check_result(const node_type& n, const view_type& b, Checks& c) {
    const V size = sum_of_sizes(n.impulse);
    if constexpr (std::is_same_v<Checks, checks<V, true>>) {
      for (int k = 1; k <= 4; ++k)
        c.require(n.refused != static_cast<double>(k), static_cast<reason>(reason_several_solutions + k - 1));
      c.require((size == size) | is_infinite(n.impulse), reason_not_a_number);
    } else {
      c.require(n.refused == 0.0, reason_overflow);
    }
    c.finite(b.impulse_guard * size, reason_overflow);
    if constexpr (states > 0) check_finite(n.state, c, reason_overflow);
    if constexpr (!may_pull) c.require(!(n.impulse.n < 0.0), reason_pull);
    if constexpr (stays_in_reach) c.require(!(is_out_of_reach(n) & (size > 0.0)), reason_reach);
  }

  // ---- store

  // Energy split of ilaw.h from the work of the impulse, -r.(v^- + v)/2 less what was stored of it, normal and
  // tangential part apart. Where H couples them one may be negative, and is then taken off the other, so that both are
  // dissipations and their sum stays the work.
  template <class Lanes>
  ILAW_KIT_INLINE static void store_energy(const loaded& p, const view_type& b, std::int64_t i, Lanes l, vector_type v,
                                           status_of<V> status, mask accepted) {
    const node_type& n = p.node;
    vector_type previous{};
    mask known = accepted & p.motion_known;
    if constexpr (reads<Law>(reads_v_previous)) {
      previous = n.v_previous;
    } else if (b.v_previous.at) {
      axis<V> a;
      V unused = 0.0;
      load_vector(a, b.v_previous, i, l, unused);
      known = known & (residual(a, V(0.0)) == 0.0);
      previous = p.frame.to_local(a);
      previous = zero_unless(residual(previous, V(0.0)) == 0.0, previous);
    }
    const vector_type mean = previous + v;
    const V along_normal = -0.5 * normal_product(n.impulse, mean) - n.normal_gain;
    const V along_tangents = -0.5 * tangential_product(n.impulse, mean) - n.tangential_gain;
    const V normal = positive_part(along_normal + smaller(along_tangents, 0.0));
    const V tangential = positive_part(along_tangents + smaller(along_normal, 0.0));
    const mask broken = status == status::broken;
    const V rupture = zero_unless(broken, normal + tangential) + n.rupture;
    const V stored = select(0.0 * n.stored == 0.0, n.stored, V(infinity));  // its terms overflow
    const V parts[ILAW_ENERGY_COUNT] = {zero_unless(known & !broken, tangential), zero_unless(known & !broken, normal),
                                        zero_unless(known, rupture), zero_unless(accepted, stored)};
    store_numbers(parts, b.energy, i, l);
  }

  template <class Lanes>
  ILAW_KIT_INLINE static void store_state(const node_type& n, const view_type& b, std::int64_t i, Lanes l,
                                          mask accepted) {
    if constexpr (states > 0) {
      V entries[states];
      from_struct(entries, n.state, std::make_index_sequence<static_cast<std::size_t>(states)>{});
      if constexpr (!Lanes::are_all) {
        V before[states];
        load_numbers(before, b.state_in, i, l);
        for (int k = 0; k < states; ++k) entries[k] = select(accepted, entries[k], before[k]);
      }
      store_numbers(entries, b.state_out, i, l);
    }
  }

  // The frame of an accepted step becomes the one to carry on from, unless the step left all as it was: a frame that
  // moved on alone would make skipping such a node, which its host may do out of reach, another motion.
  template <class Lanes>
  ILAW_KIT_INLINE static void store_frame(const loaded& p, const view_type& b, std::int64_t i, Lanes l,
                                          status_of<V> status, mask accepted) {
    if constexpr (can_carry) {
      if (b.tangents_from != tangents::carried) return;
      using bits = bits_of<V>;
      mask changed = !(sum_of_sizes(p.node.impulse) + status.code() == 0.0);
      if constexpr (reads<Law>(reads_gap)) changed = changed | !is_out_of_reach(p.node);
      if constexpr (states > 0) {
        state_t<Wide> before;
        load_state(before, b, i, l);
#pragma GCC unroll 32
        for (int k = 0; k < states; ++k) {
          const auto x = bits::in(number_in<V>(before, k)), y = bits::in(number_in<V>(p.node.state, k));
          changed = changed | differ(x, y);
        }
      }
      const mask moves = accepted & (changed | mask_from<V>(b.frame_follows ? ~0U : 0U));
      const V now[6] = {p.frame.n.x, p.frame.n.y, p.frame.n.z, p.frame.t1.x, p.frame.t1.y, p.frame.t1.z};
      V next[6];
      load_numbers(next, b.frame_in, i, l);
#pragma GCC unroll 6
      for (int k = 0; k < 6; ++k) next[k] = select(moves, now[k], next[k]);
      store_numbers(next, b.frame_out, i, l);
    }
  }
  ILAW_KIT_INLINE static bool differ(std::uint64_t a, std::uint64_t b) { return a != b; }
  template <class Bits>
  ILAW_KIT_INLINE static mask differ(Bits a, Bits b) {
    return mask::each([&](int r) ILAW_KIT_LAMBDA { return are_different(a.b[r], b.b[r]); });
  }

  // Windows are written after their block, histories here.
  template <class Lanes>
  ILAW_KIT_INLINE static void store_history(const Wide& law, const loaded& p, const view_type& b, std::int64_t i,
                                            Lanes l, status_of<V> status, mask accepted) {
    if constexpr (has_window<Law>) {
      if (!b.windows) return;
      l.store(p.node.impulse.n, b.windows->impulse[0] + i);
      l.store(p.node.impulse.t1, b.windows->impulse[1] + i);
      l.store(p.node.impulse.t2, b.windows->impulse[2] + i);
      mask adds = V(0.0) != V(0.0), clears = adds;
#pragma GCC unroll 8
      for (ilaw_status s = ILAW_FREE; s <= ILAW_HEALED; ++s) {
        const mask is = status.code() == V(s);
        if (Law::adds_to_window(s)) adds = adds | is;
        if (Law::clears_window(s)) clears = clears | is;
      }
      l.store(zero_unless(accepted & adds, V(1.0)), b.windows->adds + i);
      l.store(zero_unless(accepted & clears, V(1.0)), b.windows->clears + i);
    } else if constexpr (has_history<Law>) {
      if (accepted) law.record(p.node, history_of(b, i));
    }
  }

  template <class Lanes>
  ILAW_KIT_INLINE static void store(const Wide& law, const loaded& p, const view_type& b, std::int64_t i, Lanes l,
                                    status_of<V> status, mask accepted) {
    constexpr bool careful = !Lanes::are_all;
    const node_type& n = p.node;
    axis<V> r = p.frame.to_global(n.impulse);
    if constexpr (careful) r = select(accepted, r, axis<V>{0.0, 0.0, 0.0});
    store_vector(r, b.impulse, i, l);
    store_history(law, p, b, i, l, status, accepted);
    store_frame(p, b, i, l, status, accepted);
    if (b.moves) {
      const vector_type v = n.v_free + n.delassus.times(n.impulse);
      if (b.velocity.at) {
        axis<V> out = p.frame.to_global(v);
        if constexpr (careful) out = select(accepted, out, p.free);
        store_vector(out, b.velocity, i, l);
      }
      if (b.energy.at) store_energy(p, b, i, l, v, status, accepted);
      if (b.status) {
        V code = status.code();
        if constexpr (careful) code = select(accepted, code, V(double{ILAW_BAD_INPUT}));
        l.store_bytes(code, b.status + i);
      }
      if constexpr (has_amounts<Law>)
        for (int k = 0; k < amount_count<Law>; ++k)
          if (b.amounts[k]) l.store(zero_unless(accepted, n.amounts[k]), b.amounts[k] + i);
    }
    store_state(n, b, i, l, accepted);
  }

  // ---- the stable step

  // Where it depends on H alone and falls with either entry, the largest entries of all nodes decide.
  static constexpr bool by_delassus =
      requires(const Law& law) { law.stable_velocity_step(1.0, 1.0); };
  static constexpr bool by_node = requires(const Wide& law, const node_type& n) { law.stable_velocity_step(n); };
  struct limit {
    V least = infinity, most_normal = 0.0, most_tangential = 0.0;
  };
  ILAW_KIT_INLINE static V largest_tangential(const transverse<V>& h) { return h.t; }
  ILAW_KIT_INLINE static V largest_tangential(const full<V>& h) {
    const V mean = 0.5 * (h.t11 + h.t22), half = 0.5 * (h.t11 - h.t22);
    return mean + length(half, h.t12);
  }
  ILAW_KIT_INLINE static void add_limit(limit& found, const Wide& law, const node_type& n, const view_type& b,
                                        mask good) {
    if constexpr (by_delassus) {
      const V normal = n.delassus.normal(), tangential = largest_tangential(n.delassus);
      if (b.varying) {
        found.least = smaller(select(good, law.stable_velocity_step(normal, tangential), V(infinity)), found.least);
      } else {
        found.most_normal = larger(zero_unless(good, normal), found.most_normal);
        found.most_tangential = larger(zero_unless(good, tangential), found.most_tangential);
      }
    } else if constexpr (by_node) {
      found.least = smaller(select(good, law.stable_velocity_step(n), V(infinity)), found.least);
    }
  }
  static void give_limit(const limit& found, const Law& law, tally& all) {
    double least = infinity, normal = 0.0, tangential = 0.0;
    for (int k = 0; k < width; ++k) {
      least = smaller(lane_of(found.least, k), least);
      normal = larger(lane_of(found.most_normal, k), normal);
      tangential = larger(lane_of(found.most_tangential, k), tangential);
    }
    if constexpr (by_delassus)
      if (normal > 0.0) least = smaller(law.stable_velocity_step(normal, tangential), least);
    all.stable_velocity_step = smaller(least, all.stable_velocity_step);
  }

  // ---- bad nodes

  template <class Lanes>
  static void add_bad(tally& found, const checks<V, true>& c, std::int64_t i, Lanes l) {
    const unsigned bad = l.own(mask_bits(c.bad()));
    if (!bad) return;
    const int first = __builtin_ctz(bad);
    if (found.bad_count == 0) {
      found.first_bad_node = i + first;
      found.reason = static_cast<int>(lane_of(c.code, first));
    }
    found.bad_count += __builtin_popcount(bad);
  }

  // ---- laws in closed form

  // One pack. False: it has a bad node and was not written.
  template <class Lanes>
  ILAW_KIT_INLINE static bool run_pack(const Wide& law, const prepared_t<Wide>& prepared, const view_type& b,
                                       std::int64_t i, Lanes l, mask good_parameters, tally& found, limit& limits) {
    constexpr bool careful = !Lanes::are_all;
    checks<V, careful> c;
    if constexpr (careful) c.require(good_parameters, reason_parameter);
    loaded p = load(prepared, b, i, l, c);
    take_state(p.node, b, i, l, c);
    const status_of<V> status = law.step(p.node);
    check_result(p.node, b, c);
    const mask bad = c.bad();
    if constexpr (!careful)
      if (any(bad)) [[unlikely]]
        return false;
    store(law, p, b, i, l, status, !bad);
    if constexpr (careful)
      add_limit(limits, law, p.node, b, mask_from<V>(l.own(~0U)) & !bad);
    else
      add_limit(limits, law, p.node, b, !bad);
    if constexpr (careful) add_bad(found, c, i, l);
    return true;
  }
  [[gnu::noinline, gnu::cold]] static void run_carefully(const Law& given, const view_type& b, std::int64_t i,
                                                         tally& found, limit& limits) {
    const some_lanes<V> left{static_cast<int>(b.count - i < width ? b.count - i : width)};
    Wide law = broadcast<V>(given);
    mask good = V(0.0) == V(0.0);
    if (b.varying) good = take_parameters(law, given, b, i, left);
    const auto prepared = kit::prepared(law, b.step);
    run_pack(law, prepared, b, i, left, good, found, limits);
  }
  [[gnu::noinline, gnu::flatten]] static void run(const void* opaque, const view_type& all, tally& found) {
    const Law& given = *static_cast<const Law*>(opaque);
    const view_type b = all;
    Wide law = broadcast<V>(given);
    auto prepared = kit::prepared(law, b.step);
    limit limits;
    mask good = V(0.0) == V(0.0);
    std::int64_t i = 0;
    for (; i + width <= b.count; i += width) {
      if (b.varying) [[unlikely]] {
        good = take_parameters(law, given, b, i, all_lanes<V>());
        if constexpr (requires { law.prepare(b.step); }) refresh(prepared, kit::prepared(law, b.step));
      }
      if (b.in_memory) prefetch(b, i + prefetch_distance, width);
      if ((b.varying && any(!good)) || !run_pack(law, prepared, b, i, all_lanes<V>(), good, found, limits))
        [[unlikely]] run_carefully(given, b, i, found, limits);
    }
    if (i < b.count) run_carefully(given, b, i, found, limits);
    if constexpr (width == 1) found.by_scalar_fallback += b.count;
    give_limit(limits, given, found);
  }
  template <class Prepared>
  ILAW_KIT_INLINE static void refresh(Prepared& to, const Prepared& from) {
    __builtin_memcpy(static_cast<void*>(&to), &from, sizeof to);
  }
};

}  // namespace ilaw::kit::detail
