// kernel.hpp - the loop over packs of nodes: load, step, check, store. One per law, number type of the host,
// form of H and frame; layouts, dimensions, outputs and parameters per node are branches that all nodes of a
// batch share.
//
// A pack with a bad node writes nothing. It is copied to columns of doubles and done again by the careful
// kernel, which finds the reason and also does the last, unfilled pack: one per law and form of H, whatever
// the layout and the axes.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/frame.hpp>
#include <ilaw/kit/detail/parameter_range.hpp>
#include <ilaw/kit/heat.hpp>
#include <ilaw/kit/node.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// ---- checks

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

// ---- parameters

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
  (Wide::parameters[K].member.copy(wide, Law::parameters[K].member, law), ...);
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

// Tables over fields, lane by lane.
template <class Wide, class Number>
[[gnu::noinline]] void look_up(Wide& own, const view<Number>& b) {
  using V = typename number_of_law<Wide>::type;
  for (int k = 0; k < parameter_count<Wide>; ++k) {
    const table& t = b.tables[k];
    if (!t.per_node || !Wide::parameters[k].member.may_vary()) continue;
    double found[lanes_of<V>];
    for (int lane = 0; lane < lanes_of<V>; ++lane) {
      double place[3] = {};
      for (int a = 0; a < t.axis_count; ++a)
        place[a] = t.source[a] == table::time
                       ? b.step.time
                       : lane_of(Wide::parameters[t.source[a]].member.varying_in(own), lane);
      found[lane] = t.at(place);
    }
    __builtin_memcpy(static_cast<void*>(&Wide::parameters[k].member.varying_in(own)), found, sizeof found);
  }
}

// The parameters of the nodes of a pack. Where one is out of range or several do not go together, the law
// stays as it was, so that no step need stand it; returns which nodes are good.
template <class Wide, class Law, class Number>
[[gnu::noinline]] auto take_parameters(Wide& own, const Law& law, const view<Number>& b, std::int64_t i) {
  using V = typename number_of_law<Wide>::type;
  mask_of<V> good = V(0.0) == V(0.0);
  for (int k = 0; k < parameter_count<Law>; ++k)
    if (Wide::parameters[k].member.may_vary() && b.parameters[k]) {
      const V given = load<V>(b.parameters[k] + i);
      good = good & range_of(Wide::parameters[k]).has(given);
      Wide::parameters[k].member.varying_in(own) = given;
    }
  if (b.tables) look_up(own, b);
  if constexpr (requires { law.conflict(); }) {
    unsigned fit = 0;
    for (int lane = 0; lane < lanes_of<V>; ++lane) {
      Law here = law;
      for (int k = 0; k < parameter_count<Law>; ++k)
        if (Wide::parameters[k].member.may_vary() && b.varies(k))
          Law::parameters[k].member.set(here, lane_of(Wide::parameters[k].member.varying_in(own), lane));
      fit |= here.conflict() ? 0U : 1U << lane;
    }
    good = good & mask_from<V>(fit);
  }
  if (any(!good))
    for (int k = 0; k < parameter_count<Law>; ++k)
      if (Wide::parameters[k].member.may_vary() && b.varies(k)) {
        V& value = Wide::parameters[k].member.varying_in(own);
        value = select(good, value, V(Law::parameters[k].member.get(law)));
      }
  return good;
}

// ---- H of any form

// Diagonal with three entries, or full with six; of copies always all six.
template <class V, class Array>
ILAW_KIT_INLINE void load_symmetric(full<V>& h, const Array& a, std::int64_t i) {
  if (a.count == 6) {
    if (a.rows) {
      V c[6], unused = 0.0;
      load_rows(c, a.at + 6 * i, unused);
      h.nn = c[0], h.t11 = c[1], h.t22 = c[2], h.n1 = c[3], h.n2 = c[4], h.t12 = c[5];
    } else {
      h.nn = load<V>(a.at + i);
      h.t11 = load<V>(a.at + a.component + i);
      h.t22 = load<V>(a.at + 2 * a.component + i);
      h.n1 = load<V>(a.at + 3 * a.component + i);
      h.n2 = load<V>(a.at + 4 * a.component + i);
      h.t12 = load<V>(a.at + 5 * a.component + i);
    }
  } else {
    axis<V> d;
    V unused = 0.0;
    load_vector(d, a, i, unused);
    h.nn = d.x, h.t11 = d.y, h.t22 = d.z;
    h.n1 = 0.0, h.n2 = 0.0, h.t12 = 0.0;
  }
}

// ---- the state of a node, as an array of numbers

template <class V, class State>
ILAW_KIT_INLINE V& number_in(State& state, int k) {
  return reinterpret_cast<V*>(&state)[k];
}
template <class V, class State>
ILAW_KIT_INLINE const V& number_in(const State& state, int k) {
  return reinterpret_cast<const V*>(&state)[k];
}

// ---- the stable step

template <class V>
struct step_limit {
  V least = infinity, most_normal = 0.0, most_tangential = 0.0;
  bool is_by_node = false;
};

// ---- heat and wear

// friction is what it dissipated, so that friction/|r_T| is the mean speed of slip. Apart from the loop,
// which rarely needs it. first: the place of heat among the amounts.
template <class V, class Vector, class Number>
ILAW_KIT_APART void store_heat(const view<Number>& b, std::int64_t i, int first, V friction, Vector impulse,
                               Vector twice_mean, V partition, V coefficient) {
  const V rubs = impulse.tangential_length(), rest = 1.0 - partition;
  const V speed = select(rubs > 0.0, friction / rubs, 0.5 * twice_mean.tangential_length());
  const V area = b.area ? load<V>(b.area + i) : V(0.0);
  const V depth = coefficient * (impulse.n / area);  // per slip
  const mask_of<V> wears = (depth > 0.0) & (area > 0.0) & (speed > 0.0);
  const V amounts[heat_amount_count] = {zero_unless(partition > 0.0, partition * friction),
                                        zero_unless(rest > 0.0, rest * friction),
                                        zero_unless(wears, depth * speed)};
  for (int k = 0; k < heat_amount_count; ++k)
    if (b.amounts[first + k]) detail::store(amounts[k], b.amounts[first + k] + i);
}

// ---- a pack from end to end

// Remembers: whether the nodes have the law's state.
template <class Law, class V, class Number, template <class> class Frame, template <class> class Delassus,
          bool Remembers = has_state<Law>>
struct kernel {
  using Wide = law_on_t<Law, V>;
  using frame_type = Frame<V>;
  using vector_type = typename frame_type::vector_type;
  using H = Delassus<V>;
  using state_type = std::conditional_t<Remembers, state_t<Wide>, stateless>;
  using node_type = node<Wide, vector_type, H, state_type>;
  using spin_type = typename node_type::spin_type;
  static constexpr bool spins = has_spins<node_type>;
  using view_type = view<Number>;
  using mask = mask_of<V>;
  using limit = step_limit<V>;
  static constexpr bool careful = view_type::is_careful;
  using checks_type = checks<V, careful>;
  static constexpr bool is_projected = std::is_same_v<frame_type, normal_frame<V>>;
  using careful_kernel =
      std::conditional_t<is_projected, kernel<Law, V, copied, normal_frame, Delassus, Remembers>,
                         kernel<Law, V, copied, either_frame, Delassus, Remembers>>;
  static constexpr int width = lanes_of<V>, states = Remembers ? state_numbers<Law> : 0;
  static constexpr bool may_pull = (Law::card.capabilities & ILAW_CAN_ADHERE) != 0;
  static constexpr bool stays_in_reach = (Law::card.permissions & ILAW_MAY_SKIP_FRESH) != 0 &&
                                         !has_history<Law> && !Remembers && reads<Law>(reads_gap);
  static constexpr bool can_carry = frame_type::has_axes && (has_history<Law> || has_vector_state<Law>());

  // ---- load

  struct loaded {
    frame_type frame;
    axis<V> free;  // v_free in the axes of the batch
    std::conditional_t<spins, axis<V>, spinless> free_spin;
    mask motion_known;  // v_previous, for energies
    node_type node;
  };

  ILAW_KIT_INLINE static void load_frame(frame_type& f, const view_type& b, std::int64_t i, checks_type& c,
                                         mask& framed) {
    if constexpr (requires { f.is_local; }) {
      f.is_local = !b.normal.at;
      if (f.is_local) return;
    }
    if constexpr (frame_type::has_normal) {
      V unused = 0.0;
      load_vector(f.n, b.normal, i, unused);
      c.require(is_unit(f.n), reason_normal);
    }
    if constexpr (frame_type::has_axes) {
      if (b.tangents_from == tangents::of_plane) {
        f.turn_in_plane(b.dimension);
      } else if (b.tangents_from == tangents::chosen) {
        f.t1 = any_tangent(f.n);
      } else if (b.tangents_from == tangents::given) {
        V unused = 0.0;
        load_vector(f.t1, b.tangent, i, unused);
        framed = is_unit(f.t1) & are_orthogonal(f.n, f.t1);
        c.require(framed, reason_tangent);
      } else {
        V before[6];
        load_numbers(before, b.frame_in, i);
        const axis<V> n{before[0], before[1], before[2]}, t{before[3], before[4], before[5]};
        framed = is_unit(n) & is_unit(t) & are_orthogonal(n, t);
        f.t1 = transported_tangent(n, t, f.n);
      }
      f.t2 = cross(f.n, f.t1);
    }
  }

  ILAW_KIT_INLINE static void load_delassus(transverse<V>& h, const view_type& b, std::int64_t i) {
    const auto& a = b.delassus;
    if (b.is_scalar) {
      h.n = load<V>(a.at + i);
      h.t = h.n;
    } else if (a.rows) {
      V c[2], unused = 0.0;
      load_rows(c, a.at + 2 * i, unused);
      h.n = c[0];
      h.t = c[1];
    } else {
      h.n = load<V>(a.at + i);
      h.t = load<V>(a.at + a.component + i);
    }
  }
  ILAW_KIT_INLINE static void load_delassus(full<V>& h, const view_type& b, std::int64_t i) {
    load_symmetric(h, b.delassus, i);
  }
  ILAW_KIT_INLINE static void load_delassus(transverse_spin<V>& h, const view_type& b, std::int64_t i) {
    const auto& a = b.delassus;
    h.n = load<V>(a.at + i);
    h.t = load<V>(a.at + a.component + i);
    h.k = load<V>(a.at + 2 * a.component + i);
    h.j_n = load<V>(a.at + 3 * a.component + i);
    h.j_t = load<V>(a.at + 4 * a.component + i);
  }

  // Where the law reads no v_previous it is there for energies alone: finite always, turned or not.
  template <class Array, class Turn>
  ILAW_KIT_INLINE static void load_previous(vector_type& to, mask& known, const view_type& b,
                                            const Array& from, Turn turned, std::int64_t i, V& found) {
    if (!from.at) {
      to = {};
      return;
    }
    axis<V> a;
    V read = 0.0;
    load_vector(a, from, i, read);
    if (b.reads_previous) {
      found = found + read;
    } else {
      constexpr double guard = 4.0;
      known = known & (residual(a, V(0.0)) == 0.0);
      const axis<V> wide{guard * a.x, guard * a.y, guard * a.z};
      const mask good = residual(wide, V(0.0)) == 0.0;
      a = {zero_unless(good, a.x), zero_unless(good, a.y), zero_unless(good, a.z)};
    }
    to = turned(a);
  }

  // is_checked: H has been found definite before, which takes the longest.
  ILAW_KIT_INLINE static loaded load_pack(const prepared_t<Wide>& prepared, const view_type& b,
                                          std::int64_t i, checks_type& c, bool is_checked = false) {
    frame_type frame;
    mask framed = V(0.0) == V(0.0), known = framed;
    load_frame(frame, b, i, c, framed);
    c.frame(framed);
    V numbers = 0.0;  // a product of all of a row, whichever lane they belong to
    axis<V> free;
    load_vector(free, b.v_free, i, numbers);
    vector_type v_free = frame.to_local(free), v_previous{};
    if constexpr (frame_type::turns)
      if (frame.turns_now()) v_free.n = v_free.n + 0.0;
    const auto turned = [&](axis<V> a) ILAW_KIT_LAMBDA { return frame.to_local(a); };
    if constexpr (reads<Law>(reads_v_previous))
      load_previous(v_previous, known, b, b.v_previous, turned, i, numbers);
    std::conditional_t<spins, axis<V>, spinless> free_spin;
    spin_type spin_free{}, spin_previous{};
    if constexpr (spins) {
      const auto turned_spin = [&](axis<V> a) ILAW_KIT_LAMBDA { return frame.spin_to_local(a); };
      load_vector(free_spin, b.spin_free, i, numbers);
      spin_free = turned_spin(free_spin);
      load_previous(spin_previous, known, b, b.spin_previous, turned_spin, i, numbers);
    }
    H h;
    load_delassus(h, b, i);
    h = frame.to_local(h, b.dimension);
    V gap = 0.0, area = 0.0;
    if constexpr (reads<Law>(reads_gap)) {
      if (b.gap) {
        gap = load<V>(b.gap + i);
        if (b.gap_offset) gap = gap - load<V>(b.gap_offset + i);
      }
    }
    if constexpr (reads<Law>(reads_area))
      if (b.area) area = load<V>(b.area + i);

    if constexpr (careful || frame_type::turns)
      c.finite_vector(v_free, reason_v_free, true);
    else
      c.finite(numbers, reason_v_free);
    if (!is_checked) c.require(h.is_definite(), reason_delassus);
    if constexpr (reads<Law>(reads_gap)) c.finite(gap, reason_gap);
    if constexpr (reads<Law>(reads_v_previous) && (careful || frame_type::turns))
      c.finite_vector(v_previous, reason_v_previous, true);
    if constexpr (spins && (careful || frame_type::turns)) {
      c.finite_vector(spin_free, reason_spin, true);
      c.finite_vector(spin_previous, reason_spin, true);
    }
    if constexpr (reads<Law>(reads_area)) {
      c.finite(area, reason_area);
      c.require(area >= 0.0, reason_area);
    }
    if constexpr (frame_type::has_axes)
      if (b.tangents_from == tangents::carried) c.require(framed, reason_frame);
    return {.frame = frame,
            .free = free,
            .free_spin = free_spin,
            .motion_known = known,
            .node = {.time = b.step.time,
                     .velocity_step = b.step.velocity_step,
                     .position_step = b.step.position_step,
                     .per_position_step = b.step.per_position_step,
                     .wants_energy = wants_energy(b),
                     .prepared = prepared,
                     .v_free = v_free,
                     .v_previous = declared<reads_v_previous>(v_previous),
                     .delassus = h,
                     .gap = declared<reads_gap>(gap),
                     .area = declared<reads_area>(area),
                     .spin_free = spin_free,
                     .spin_previous = spin_previous}};
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

  ILAW_KIT_INLINE static void load_state(state_type& state, const view_type& b, std::int64_t i) {
    if constexpr (states > 0) {
      V entries[states];
      load_numbers(entries, b.state_in, i);
      to_struct(state, entries, std::make_index_sequence<static_cast<std::size_t>(states)>{});
    }
  }
  // In space; the walk brings states of fewer dimensions to the same order, with zeros.
  template <std::size_t... K>
  ILAW_KIT_INLINE static void to_struct(state_type& state, const V (&entries)[states + (states == 0)],
                                        std::index_sequence<K...>) {
    ((number_in<V>(state, static_cast<int>(K)) = entries[state_entry<Law>(static_cast<int>(K), 3)]), ...);
  }
  template <std::size_t... K>
  ILAW_KIT_INLINE static void from_struct(V (&entries)[states + (states == 0)], const state_type& state,
                                          std::index_sequence<K...>) {
    ((entries[state_entry<Law>(static_cast<int>(K), 3)] = number_in<V>(state, static_cast<int>(K))), ...);
  }

  template <std::size_t Variable>
  ILAW_KIT_INLINE static void check_range(const state_type& state, checks_type& c) {
    constexpr const auto& v = Law::state_variables[Variable];
    if constexpr (v.has_range())
      c.require(v.may_be(number_in<V>(state, state_places<Law>[Variable])),
                static_cast<reason>(reason_of_first_variable + static_cast<int>(Variable)));
  }
  template <std::size_t... K>
  ILAW_KIT_INLINE static void check_ranges(const state_type& state, checks_type& c,
                                           std::index_sequence<K...>) {
    (check_range<K>(state, c), ...);
  }
  ILAW_KIT_INLINE static void check_finite(const state_type& state, checks_type& c, reason why) {
#pragma GCC unroll 32
    for (int k = 0; k < states; ++k) c.finite(number_in<V>(state, k), why);
  }
  ILAW_KIT_INLINE static void take_state(node_type& n, const view_type& b, std::int64_t i, checks_type& c) {
    if constexpr (states > 0) {
      load_state(n.state, b, i);
      check_finite(n.state, c, reason_state);
      check_ranges(n.state, c, std::make_index_sequence<std::size(Law::state_variables)>{});
    }
    if constexpr (has_window<Law>) {
      if (b.earlier[0]) {
        n.earlier = {load<V>(b.earlier[0] + i), load<V>(b.earlier[1] + i), load<V>(b.earlier[2] + i)};
        n.refused = load<V>(b.earlier_refused + i);
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
  ILAW_KIT_INLINE static void check_result(const node_type& n, const view_type& b, checks_type& c) {
    V size = sum_of_sizes(n.impulse);
    if constexpr (spins) size = size + sum_of_sizes(n.moment);
    if constexpr (careful) {
      for (int k = 1; k <= 5; ++k)
        c.require(n.refused != static_cast<double>(k), static_cast<reason>(reason_several_solutions + k - 1));
      mask overflows = is_infinite(n.impulse);
      if constexpr (spins) overflows = overflows | is_infinite(n.moment);
      c.require((size == size) | overflows, reason_not_a_number);
    } else {
      c.require(n.refused == 0.0, reason_overflow);
    }
    c.finite(b.impulse_guard * size, reason_overflow);
    if constexpr (states > 0) check_finite(n.state, c, reason_overflow);
    if constexpr (!may_pull) c.require(!(n.impulse.n < 0.0), reason_pull);
    if constexpr (stays_in_reach) c.require(!(is_out_of_reach(n) & (size > 0.0)), reason_reach);
  }

  // ---- store

  ILAW_KIT_INLINE static bool wants_energy(const view_type& b) {
    if constexpr (amount_count < Law >> 0)
      return b.has_balance;
    else
      return b.energy.at != nullptr;
  }

  // Energy split of ilaw.h from the work of the impulse, -r.(v^- + v)/2 less what was stored of it, normal
  // and tangential part apart. Where H couples them one may be negative, and is then taken off the other, so
  // that both are dissipations and their sum stays the work. The work of a moment, twice_spin being twice
  // the mean spin, counts as tangential. With it heat and wear.
  ILAW_KIT_INLINE static void store_energy(const Wide& law, const loaded& p, const view_type& b,
                                           std::int64_t i, vector_type v, spin_type twice_spin,
                                           status_of<V> status, mask accepted) {
    const node_type& n = p.node;
    vector_type previous{};
    mask known = accepted & p.motion_known;
    if constexpr (reads<Law>(reads_v_previous)) {
      previous = n.v_previous;
    } else if (b.v_previous.at) {
      axis<V> a;
      V unused = 0.0;
      load_vector(a, b.v_previous, i, unused);
      known = known & (residual(a, V(0.0)) == 0.0);
      previous = p.frame.to_local(a);
      previous = zero_unless(residual(previous, V(0.0)) == 0.0, previous);
    }
    const vector_type mean = previous + v;
    const V along_normal = -0.5 * normal_product(n.impulse, mean) - n.normal_gain;
    V along_tangents = -0.5 * tangential_product(n.impulse, mean) - n.tangential_gain;
    if constexpr (spins) {
      const V twist = normal_product(n.moment, twice_spin), roll = tangential_product(n.moment, twice_spin);
      along_tangents = along_tangents - 0.5 * (twist + roll);
    }
    const V normal = positive_part(along_normal + smaller(along_tangents, 0.0));
    const V tangential = positive_part(along_tangents + smaller(along_normal, 0.0));
    mask broken = status == status::broken;
    if constexpr (Law::card.gives_rupture) broken = broken & false;
    const V rupture = zero_unless(broken, normal + tangential) + n.rupture;
    const V stored = select(0.0 * n.stored == 0.0, n.stored, V(infinity));  // its terms overflow
    const V parts[ILAW_ENERGY_COUNT] = {zero_unless(known & !broken, tangential),
                                        zero_unless(known & !broken, normal), zero_unless(known, rupture),
                                        zero_unless(accepted, stored)};
    if constexpr (gives_heat<Law>)
      if (b.has_amounts)
        store_heat(b, i, own_amount_count<Law>, zero_unless(!(status == status::free), parts[0]),
                   zero_unless(known, n.impulse), mean, law.heat_partition, law.wear_coefficient);
    if (b.energy.at) store_numbers(parts, b.energy, i);
  }

  ILAW_KIT_INLINE static void store_state(const node_type& n, const view_type& b, std::int64_t i,
                                          mask accepted) {
    if constexpr (states > 0) {
      V entries[states];
      from_struct(entries, n.state, std::make_index_sequence<static_cast<std::size_t>(states)>{});
      if constexpr (careful) {
        V before[states];
        load_numbers(before, b.state_in, i);
#pragma GCC unroll 32
        for (int k = 0; k < states; ++k) entries[k] = select(accepted, entries[k], before[k]);
      }
      store_numbers(entries, b.state_out, i);
    }
  }

  // The frame of an accepted step becomes the one to carry on from, unless the step left all as it was: a
  // frame that moved on alone would make skipping such a node, which its host may do out of reach, another
  // motion.
  ILAW_KIT_INLINE static void store_frame(const loaded& p, const view_type& b, std::int64_t i,
                                          status_of<V> status, mask accepted) {
    if constexpr (can_carry) {
      if (b.tangents_from != tangents::carried) return;
      mask changed = !(sum_of_sizes(p.node.impulse) + status.code() == 0.0);
      if constexpr (reads<Law>(reads_gap)) changed = changed | !is_out_of_reach(p.node);
      if constexpr (states > 0) {
        state_type before;
        load_state(before, b, i);
#pragma GCC unroll 32
        for (int k = 0; k < states; ++k)
          changed = changed | have_other_bits(number_in<V>(before, k), number_in<V>(p.node.state, k));
      }
      const mask moves = accepted & (changed | mask_from<V>(b.frame_follows ? ~0U : 0U));
      const V now[6] = {p.frame.n.x, p.frame.n.y, p.frame.n.z, p.frame.t1.x, p.frame.t1.y, p.frame.t1.z};
      V next[6];
      load_numbers(next, b.frame_in, i);
#pragma GCC unroll 6
      for (int k = 0; k < 6; ++k) next[k] = select(moves, now[k], next[k]);
      store_numbers(next, b.frame_out, i);
    }
  }

  // Windows are written after their block, histories here.
  ILAW_KIT_INLINE static void store_history(const Wide& law, const loaded& p, const view_type& b,
                                            std::int64_t i, status_of<V> status, mask accepted) {
    if constexpr (has_window<Law>) {
      if (!b.earlier[0]) return;
      detail::store(p.node.impulse.n, b.given[0] + i);
      detail::store(p.node.impulse.t1, b.given[1] + i);
      detail::store(p.node.impulse.t2, b.given[2] + i);
      mask adds = V(0.0) != V(0.0), clears = adds;
#pragma GCC unroll 8
      for (ilaw_status s = ILAW_FREE; s <= ILAW_HEALED; ++s) {
        const mask is = status.code() == V(s);
        if (Law::adds_to_window(s)) adds = adds | is;
        if (Law::clears_window(s)) clears = clears | is;
      }
      detail::store(zero_unless(accepted & adds, V(1.0)), b.adds + i);
      detail::store(zero_unless(accepted & clears, V(1.0)), b.clears + i);
    } else if constexpr (has_history<Law>) {
      if (accepted) law.record(p.node, history_of(b, i));
    }
  }

  // A spin or moment, in the axes of the batch; `bad` where the node is not accepted.
  template <class Array>
  ILAW_KIT_INLINE static void store_spin(const frame_type& frame, vector_type own, axis<V> bad,
                                         const Array& to, std::int64_t i, mask accepted) {
    axis<V> out = frame.spin_to_global(own);
    if constexpr (careful) out = select(accepted, out, bad);
    store_vector(out, to, i);
  }

  ILAW_KIT_INLINE static void store_pack(const Wide& law, const loaded& p, const view_type& b, std::int64_t i,
                                         status_of<V> status, mask accepted) {
    const node_type& n = p.node;
    axis<V> r = p.frame.to_global(n.impulse);
    if constexpr (careful) r = select(accepted, r, axis<V>{0.0, 0.0, 0.0});
    store_vector(r, b.impulse, i);
    store_history(law, p, b, i, status, accepted);
    store_frame(p, b, i, status, accepted);
    if constexpr (spins) store_spin(p.frame, n.moment, {0.0, 0.0, 0.0}, b.moment, i, accepted);
    if (b.moves) {
      vector_type v;
      spin_type twice_spin{};
      if constexpr (spins) {
        v = n.v_free + n.delassus.times(n.impulse, n.moment);
        const vector_type spin = n.spin_free + n.delassus.spin_of(n.impulse, n.moment);
        if (b.spin.at) store_spin(p.frame, spin, p.free_spin, b.spin, i, accepted);
        twice_spin = n.spin_previous + spin;
      } else {
        v = n.v_free + n.delassus.times(n.impulse);
      }
      if (b.velocity.at) {
        axis<V> out = p.frame.to_global(v);
        if constexpr (careful) out = select(accepted, out, p.free);
        store_vector(out, b.velocity, i);
      }
      if (wants_energy(b)) store_energy(law, p, b, i, v, twice_spin, status, accepted);
      if (b.status) {
        V code = status.code();
        if constexpr (careful) code = select(accepted, code, V(double{ILAW_BAD_INPUT}));
        store_bytes(code, b.status + i);
      }
      if constexpr (has_amounts<Law>)
        for (int k = 0; k < own_amount_count<Law>; ++k)
          if (b.amounts[k]) detail::store(zero_unless(accepted, n.amounts[k]), b.amounts[k] + i);
    }
    store_state(n, b, i, accepted);
  }

  // ---- the stable step

  // Where it depends on H alone and falls with either entry, the largest entries of all nodes decide.
  static constexpr bool by_delassus = requires(const Law& law) { law.stable_velocity_step(1.0, 1.0); };
  static constexpr bool by_node = requires(const Wide& law, const node_type& n) {
    law.stable_velocity_step(n);
  };
  // Where both forms are given, the one of the node counts where the other gives NaN, and for parameters per
  // node.
  ILAW_KIT_INLINE static void add_limit(limit& found, const Wide& law, const node_type& n, const view_type& b,
                                        mask good) {
    if constexpr (by_node)
      if (!by_delassus || found.is_by_node) {
        found.least = smaller(select(good, law.stable_velocity_step(n), V(infinity)), found.least);
        return;
      }
    if constexpr (by_delassus) {
      const V normal = n.delassus.normal(), tangential = n.delassus.largest_tangential();
      if (b.varying) {
        found.least =
            smaller(select(good, law.stable_velocity_step(normal, tangential), V(infinity)), found.least);
      } else {
        found.most_normal = larger(zero_unless(good, normal), found.most_normal);
        found.most_tangential = larger(zero_unless(good, tangential), found.most_tangential);
      }
    }
  }
  static limit limit_of(const Law& law, const view_type& b) {
    limit made;
    if constexpr (by_delassus && by_node) {
      const double step = law.stable_velocity_step(1.0, 1.0);
      made.is_by_node = b.varying || step != step;
    }
    return made;
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

  // Lanes that are nodes.
  ILAW_KIT_INLINE static mask nodes_of(const view_type& b) {
    if constexpr (careful)
      return mask_from<V>((1U << b.count) - 1);
    else
      return V(0.0) == V(0.0);
  }
  static void add_bad(tally& found, const checks_type& c, mask nodes, std::int64_t i) {
    const unsigned bad = mask_bits(c.bad() & nodes);
    if (!bad) return;
    const int first = __builtin_ctz(bad);
    if (found.bad_count == 0) {
      found.first_bad_node = i + first;
      found.reason = static_cast<int>(lane_of(c.code, first));
    }
    found.bad_count += __builtin_popcount(bad);
  }

  // ---- laws in closed form

  // One pack. False: it has a bad node and was not written. node: which the first of a copied pack is.
  ILAW_KIT_INLINE static bool run_pack(const Wide& law, const prepared_t<Wide>& prepared, const view_type& b,
                                       std::int64_t i, checks_type c, tally& found, limit& limits,
                                       std::int64_t node) {
    loaded p = load_pack(prepared, b, i, c);
    take_state(p.node, b, i, c);
    const status_of<V> status = law.step(p.node);
    check_result(p.node, b, c);
    const mask bad = c.bad();
    if constexpr (!careful)
      if (any(bad)) [[unlikely]]
        return false;
    store_pack(law, p, b, i, status, !bad);
    add_limit(limits, law, p.node, b, nodes_of(b) & !bad);
    if constexpr (careful) add_bad(found, c, nodes_of(b), node);
    return true;
  }
  [[gnu::noinline, gnu::cold, gnu::flatten]] static void run_copy(const Law& given, const view_type& b,
                                                                  std::int64_t node, tally& found,
                                                                  limit& limits) {
    Wide law = broadcast<V>(given);
    checks_type c;
    if (b.varying) c.require(take_parameters(law, given, b, 0), reason_parameter);
    const auto prepared = kit::prepared(law, b.step);
    run_pack(law, prepared, b, 0, c, found, limits, node);
  }
  [[gnu::noinline, gnu::cold]] static void run_carefully(const Law& given, const view_type& b, std::int64_t i,
                                                         tally& found, limit& limits) {
    const pack_copy copy(b, i, width);
    careful_kernel::run_copy(given, copy.pack, i, found, limits);
    copy.give_back(b);
  }
  // All full packs.
  ILAW_KIT_INLINE static void run_fast(const Law& given, const view_type& b, std::int64_t& i, tally& found,
                                       limit& limits) {
    Wide law = broadcast<V>(given);
    auto prepared = kit::prepared(law, b.step);
    const int is_special = b.varying + b.in_memory;
    for (; i + width <= b.count; i += width) {
      bool is_usual = true;
      if (is_special) [[unlikely]]
        is_usual = get_ready(law, prepared, given, b, i);
      if (!is_usual || !run_pack(law, prepared, b, i, checks_type(), found, limits, i)) [[unlikely]]
        run_carefully(given, b, i, found, limits);
    }
  }
  [[gnu::noinline, gnu::flatten]] static void run(const void* opaque, const view_type& all, tally& found) {
    const Law& given = *static_cast<const Law*>(opaque);
    const view_type b = all;
    limit limits = limit_of(given, b);
    std::int64_t i = 0;
    if constexpr (!ILAW_KIT_IS_SPARE) run_fast(given, b, i, found, limits);
    for (; i < b.count; i += width) run_carefully(given, b, i, found, limits);
    if constexpr (width == 1) found.by_scalar_fallback += b.count;
    give_limit(limits, given, found);
  }
  // Asks for the arrays of a later pack where no cache holds them, and reads the parameters of this one,
  // apart from the law that the loop has in registers. False: some node's are bad.
  template <class Prepared>
  ILAW_KIT_INLINE static bool get_ready(Wide& law, Prepared& prepared, const Law& given, const view_type& b,
                                        std::int64_t i) {
    if constexpr (std::is_same_v<Number, double>)
      if (b.in_memory) prefetch(b, i + prefetch_distance, width);
    if (!b.varying) return true;
    Wide own = law;
    const mask good = take_parameters(own, given, b, i);
    law = own;
    if constexpr (requires { law.prepare(b.step); }) refresh(prepared, kit::prepared(law, b.step));
    return !any(!good);
  }
  template <class Prepared>
  ILAW_KIT_INLINE static void refresh(Prepared& to, const Prepared& from) {
    __builtin_memcpy(static_cast<void*>(&to), &from, sizeof to);
  }
};

}  // namespace ilaw::kit::detail
