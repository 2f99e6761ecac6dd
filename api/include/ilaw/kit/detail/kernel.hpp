// kernel.hpp - the loop over packs of nodes: load, step, check, store. One per law, form of H and frame, and
// one for floats; layouts, dimensions, outputs and parameters per node are branches that all nodes of a batch
// share.
//
// A pack with a bad node writes nothing. Its nodes are done again by the careful kernel, the same on packs of
// one lane, which finds the reason and also does the last, unfilled pack. One per law and form of H serves
// all axes and levels.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/frame.hpp>
#include <ilaw/kit/detail/view.hpp>
#include <ilaw/kit/law.hpp>
#include <ilaw/kit/node.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// ---- a law whose members are packs

// Whether kernels may work from the normal alone: no tangent named, and no vector remembered, which would
// need tangents to be written in.
template <class Law>
inline constexpr bool needs_no_tangents =
    Law::card.is_isotropic && !has_window<Law> && !has_vector_state<Law>();

template <class Law>
inline constexpr bool serves_transverse = (Law::card.delassus_forms &
                                           (ILAW_DELASSUS_SCALAR | ILAW_DELASSUS_TRANSVERSE)) != 0;
template <class Law>
inline constexpr bool serves_spins = (Law::card.delassus_forms & with_spins) != 0;
template <class Law>
inline constexpr bool serves_full = (Law::card.delassus_forms &
                                     (ILAW_DELASSUS_DIAGONAL | ILAW_DELASSUS_FULL)) != 0;

template <class Law, class Node>
concept can_ask = requires(const Law& law, Node& n, typename Law::problem& p) {
  law.ask(n, p);
};

template <class Law>
concept can_be_asked = requires(const Law& law) {
  law.asks();
}
|| requires(const Law& law) { law.asks(true); };
template <class Law, class Node>
concept can_choose = can_be_asked<Law> && requires(const Law& law, Node& n) {
  law.step(n);
};

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

// Tables over fields, lane by lane.
template <class Wide, class View>
[[gnu::noinline]] void look_up(Wide& own, const View& b) {
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
template <class Wide, class Law, class View>
[[gnu::noinline]] auto take_parameters(Wide& own, const Law& law, const View& b, std::int64_t i) {
  using V = typename number_of_law<Wide>::type;
  mask_of<V> good = all<V>();
  for (int k = 0; k < parameter_count<Law>; ++k)
    if (Wide::parameters[k].member.may_vary() && b.parameters[k]) {
      const V given = load<V>(b.parameters[k] + i);
      good = good & Wide::parameters[k].range().has(given);
      Wide::parameters[k].member.varying_in(own) = given;
    }
  if (b.tables) look_up(own, b);
  int varying[parameter_count<Law>], count = 0;
  for (int k = 0; k < parameter_count<Law>; ++k)
    if (Wide::parameters[k].member.may_vary() && b.varies(k)) varying[count++] = k;
  if constexpr (requires { law.conflict(); }) {
    unsigned fit = 0;
    Law here = law;
    for (int lane = 0; lane < lanes_of<V>; ++lane) {
      for (int j = 0; j < count; ++j)
        Law::parameters[varying[j]].member.set(
            here, lane_of(Wide::parameters[varying[j]].member.varying_in(own), lane));
      fit |= here.conflict() ? 0U : 1U << lane;
    }
    good = good & mask_from<V>(fit);
  }
  if (any(!good))
    for (int j = 0; j < count; ++j) {
      V& value = Wide::parameters[varying[j]].member.varying_in(own);
      value = select(good, value, V(Law::parameters[varying[j]].member.get(law)));
    }
  return good;
}

// ---- what few laws give beside impulse, state and energy

// The smallest stable step of the good nodes.
template <class Law, class Node, class V>
ILAW_KIT_INLINE void add_stable_step(V& least, const Law& law, const Node& n, mask_of<V> good) {
  if constexpr (requires { law.stable_velocity_step(n); })
    least = smaller(select(good, law.stable_velocity_step(n), V(infinity)), least);
}
template <class V>
void collect_stable_step(V least, tally& all) {
  for (int k = 0; k < lanes_of<V>; ++k)
    all.stable_velocity_step = smaller(lane_of(least, k), all.stable_velocity_step);
}

// Heat and wear of a step. friction is what it dissipated, so that friction/|r_T| is the mean speed of slip
// where friction alone gives r_T (is_free: of bonds). Apart from the loop, which rarely needs it. first: the
// place of heat among the amounts.
template <class V, class Vector, class View>
ILAW_KIT_APART void store_heat(const View& b, std::int64_t i, int first, V friction, Vector impulse,
                               Vector twice_mean, V partition, V coefficient, mask_of<V> is_free) {
  const V rubs = impulse.tangential_length(), rest = 1.0 - partition;
  const V speed = select(is_free & (rubs > 0.0), friction / rubs, 0.5 * twice_mean.tangential_length());
  const V area = b.area.at ? load<V>(b.area.at + i) : V(0.0);
  const V depth = coefficient * (impulse.n / area);  // per slip
  const mask_of<V> wears = (depth > 0.0) & (area > 0.0) & (speed > 0.0);
  const V amounts[heat_amount_count] = {zero_unless(partition > 0.0, partition * friction),
                                        zero_unless(rest > 0.0, rest * friction),
                                        zero_unless(wears, depth * speed)};
  for (int k = 0; k < heat_amount_count; ++k)
    if (b.amounts[first + k]) detail::store(amounts[k], b.amounts[first + k] + i);
}

// ---- a pack from end to end

template <class Law, class V, class View, template <class> class Frame, template <class> class Delassus>
struct kernel {
  using Wide = law_on_t<Law, V>;
  using frame_type = Frame<V>;
  using vector_type = typename frame_type::vector_type;
  using H = Delassus<V>;
  using state_type = state_t<Wide>;
  using node_type = node<Wide, vector_type, H>;
  using spin_type = typename node_type::spin_type;
  static constexpr bool spins = has_spins<node_type>;
  using view_type = View;
  using mask = mask_of<V>;
  static constexpr bool careful = lanes_of<V> == 1;
  using checks_type = checks<V, careful>;
  static constexpr bool is_projected = std::is_same_v<frame_type, normal_frame<V>>;
  using careful_kernel =
      std::conditional_t<is_projected, kernel<Law, pack_of_one, View, normal_frame, Delassus>,
                         kernel<Law, pack_of_one, View, either_frame, Delassus>>;
  static constexpr int width = lanes_of<V>, states = state_numbers<Law>;
  static constexpr bool may_pull = (Law::card.capabilities & ILAW_CAN_ADHERE) != 0;
  static constexpr bool stays_in_reach = (Law::card.permissions & ILAW_MAY_SKIP_FRESH) != 0 &&
                                         !has_window<Law> && !has_state<Law> && reads<Law>(reads_gap);
  static constexpr bool can_carry = frame_type::has_axes && (has_window<Law> || has_vector_state<Law>());

  // ---- load

  struct loaded {
    frame_type frame;
    axis<V> free;  // v_free in the axes of the batch
    std::conditional_t<spins, axis<V>, spinless> free_spin;
    mask motion_known;  // v_previous, for energies
    node_type node;
  };

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
    mask framed = all<V>(), known = framed;
    load_frame(frame, b, i, c, framed);
    c.frame(framed);
    V numbers = 0.0;  // a product of all of a row, whichever lane they belong to
    axis<V> free;
    load_vector(free, b.v_free, i, numbers);
    vector_type v_free = frame.to_local(free), v_previous{};
    if constexpr (frame_type::turns)
      if (frame.turns_now()) v_free.n = v_free.n + 0.0;
    const auto turned = [&](axis<V> a) ILAW_KIT_LAMBDA { return frame.to_local(a); };
    vector_type v_smooth = v_free;
    if constexpr (reads<Law>(reads_v_smooth)) {
      if (b.v_smooth.at) {
        axis<V> smooth;
        load_vector(smooth, b.v_smooth, i, numbers);
        v_smooth = turned(smooth);
      }
    }
    if constexpr (reads<Law>(reads_v_previous))
      load_previous(v_previous, known, b, b.v_previous, turned, i, numbers);
    std::conditional_t<spins, axis<V>, spinless> free_spin;
    spin_type spin_free{}, spin_previous{};
    if constexpr (spins) {
      const auto turned_spin = [&](axis<V> a) ILAW_KIT_LAMBDA { return spin_to_local(frame, a); };
      load_vector(free_spin, b.spin_free, i, numbers);
      spin_free = turned_spin(free_spin);
      load_previous(spin_previous, known, b, b.spin_previous, turned_spin, i, numbers);
    }
    H h;
    load_delassus(h, b, i);
    h = frame.to_local(h, b.dimension);
    V gap = 0.0, area = 0.0;
    if constexpr (reads<Law>(reads_gap)) {
      if (b.gap.at) {
        gap = load<V>(b.gap.at + i);
        if (b.gap_offset.at) gap = gap - load<V>(b.gap_offset.at + i);
      }
    }
    if constexpr (reads<Law>(reads_area))
      if (b.area.at) area = load<V>(b.area.at + i);

    if constexpr (careful || frame_type::turns)
      c.finite_vector(v_free, reason_v_free, true);
    else
      c.finite(numbers, reason_v_free);
    if (!is_checked) c.require(h.is_definite(), reason_delassus);
    if constexpr (reads<Law>(reads_v_smooth) && (careful || frame_type::turns))
      c.finite_vector(v_smooth, reason_v_smooth, true);
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
            .node = {{.time = b.step.time,
                      .velocity_step = b.step.velocity_step,
                      .position_step = b.step.position_step,
                      .per_position_step = b.step.per_position_step,
                      .wants_energy = wants_energy(b),
                      .is_coupled = is_coupled(b),
                      .of_bonds = b.of_bonds,
                      .prepared = prepared,
                      .v_free = v_free,
                      .v_smooth = declared<reads_v_smooth>(v_smooth),
                      .v_previous = declared<reads_v_previous>(v_previous),
                      .delassus = h,
                      .gap = declared<reads_gap>(gap),
                      .area = declared<reads_area>(area),
                      .spin_free = spin_free,
                      .spin_previous = spin_previous},
                     {}}};
  }
  template <std::uint32_t Input, class T>
  ILAW_KIT_INLINE static auto declared(T value) {
    if constexpr (reads<Law>(Input))
      return value;
    else if constexpr (std::is_same_v<T, vector_type>)
      return undeclared_vector<vector_type, Input>{};
    else
      return undeclared_input<V, Input>{};
  }

  ILAW_KIT_INLINE static void load_state(state_type& state, const view_type& b, std::int64_t i) {
    if constexpr (states > 0) {
      V entries[states];
      load_numbers(entries, b.state_in, i);
      to_struct<Law>(state, entries, std::make_index_sequence<static_cast<std::size_t>(states)>{});
    }
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
    }
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

  ILAW_KIT_INLINE static bool is_coupled(const view_type& b) {
    return reads<Law>(reads_v_smooth) && b.v_smooth.at;
  }
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
                   zero_unless(known, n.impulse), mean, law.heat_partition, n.rubbing * law.wear_coefficient,
                   n.rubbing == 1.0);
    if (b.energy.at) store_numbers(parts, b.energy, i);
  }

  ILAW_KIT_INLINE static void store_state(const node_type& n, const view_type& b, std::int64_t i,
                                          mask accepted) {
    if constexpr (states > 0) {
      V entries[states];
      from_struct<Law>(entries, n.state, std::make_index_sequence<static_cast<std::size_t>(states)>{});
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
  // motion. Whether v_smooth reaches the surface does not count: with other parameters the law may not ask
  // for it, and a value per node must give the bits of the constant.
  ILAW_KIT_INLINE static void store_frame(const loaded& p, const view_type& b, std::int64_t i,
                                          status_of<V> status, mask accepted) {
    if constexpr (can_carry) {
      if (b.tangents_from != tangents::carried) return;
      mask changed = !(sum_of_sizes(p.node.impulse) + status.code() == 0.0);
      if constexpr (reads<Law>(reads_gap)) {
        const V next = p.node.gap + p.node.position_step * p.node.v_free.n;
        changed = changed | !((p.node.gap > 0.0) & (next > 0.0));
      }
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

  // Windows are written after their block.
  ILAW_KIT_INLINE static void store_window(const loaded& p, const view_type& b, std::int64_t i,
                                           status_of<V> status, mask accepted) {
    if constexpr (has_window<Law>) {
      if (!b.earlier[0]) return;
      detail::store(p.node.impulse.n, b.given[0] + i);
      detail::store(p.node.impulse.t1, b.given[1] + i);
      detail::store(p.node.impulse.t2, b.given[2] + i);
      mask adds = none<V>(), clears = adds;
#pragma GCC unroll 8
      for (ilaw_status s = ILAW_FREE; s <= ILAW_HEALED; ++s) {
        const mask is = status.code() == V(s);
        if (Law::adds_to_window(s)) adds = adds | is;
        if (Law::clears_window(s)) clears = clears | is;
      }
      detail::store(zero_unless(accepted & adds, V(1.0)), b.adds + i);
      detail::store(zero_unless(accepted & clears, V(1.0)), b.clears + i);
    }
  }

  // A spin or moment, in the axes of the batch; `bad` where the node is not accepted.
  template <class Array>
  ILAW_KIT_INLINE static void store_spin(const frame_type& frame, vector_type own, axis<V> bad,
                                         const Array& to, std::int64_t i, mask accepted) {
    axis<V> out = spin_to_global(frame, own);
    if constexpr (careful) out = select(accepted, out, bad);
    store_vector(out, to, i);
  }

  ILAW_KIT_INLINE static void store_pack(const Wide& law, const loaded& p, const view_type& b, std::int64_t i,
                                         status_of<V> status, mask accepted) {
    const node_type& n = p.node;
    axis<V> r = p.frame.to_global(n.impulse);
    if constexpr (careful) r = select(accepted, r, axis<V>{0.0, 0.0, 0.0});
    store_vector(r, b.impulse, i);
    store_window(p, b, i, status, accepted);
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

  // ---- bad nodes

  static void add_bad(tally& found, const checks_type& c, std::int64_t i) {
    if (!any(c.bad())) return;
    if (found.bad_count++ > 0) return;
    found.first_bad_node = i;
    found.reason = static_cast<int>(lane_of(c.code, 0));
  }

  // ---- laws in closed form

  // One pack. False: it has a bad node and was not written.
  ILAW_KIT_INLINE static bool run_pack(const Wide& law, const prepared_t<Wide>& prepared, const view_type& b,
                                       std::int64_t i, checks_type c, tally& found, V& stable_step) {
    loaded p = load_pack(prepared, b, i, c);
    take_state(p.node, b, i, c);
    const status_of<V> status = law.step(p.node);
    check_result(p.node, b, c);
    const mask bad = c.bad();
    if constexpr (!careful)
      if (any(bad)) [[unlikely]]
        return false;
    store_pack(law, p, b, i, status, !bad);
    add_stable_step(stable_step, law, p.node, !bad);
    if constexpr (careful) add_bad(found, c, i);
    return true;
  }
  // An ilaw_kit_loop.
  [[gnu::noinline, gnu::flatten]] static void run(const void* opaque, const void* view, void* findings) {
    const Law& given = *static_cast<const Law*>(opaque);
    const view_type b = *static_cast<const view_type*>(view);
    auto& found = *static_cast<tally*>(findings);
    std::int64_t i = 0;
    if constexpr (!ILAW_KIT_IS_SPARE) {
      V stable_step = infinity;
      Wide law = broadcast<V>(given);
      auto prepared = kit::prepared(law, b.step);
      const int is_special = b.varying + b.in_memory;
      for (; i + width <= b.count; i += width) {
        bool is_usual = true;
        if (is_special) [[unlikely]]
          is_usual = get_ready(law, prepared, given, b, i);
        if (!is_usual || !run_pack(law, prepared, b, i, checks_type(), found, stable_step)) [[unlikely]]
          b.careful(opaque, view, i, width, &found, nullptr);
      }
      collect_stable_step(stable_step, found);
    }
    if (i < b.count) b.careful(opaque, view, i, b.count - i, &found, nullptr);
  }
  // A careful_function.
  [[gnu::noinline, gnu::cold, gnu::flatten]] static void run_nodes(const void* opaque, const void* view,
                                                                   std::int64_t first, std::int64_t count,
                                                                   void* found, void* /*problems*/) {
    run_each<kernel>(opaque, view, first, count, found);
  }
  // Kernel: this one, or a solver_kernel, with what its run_pack needs besides.
  template <class Kernel, class... Own>
  ILAW_KIT_INLINE static void run_each(const void* opaque, const void* view, std::int64_t first,
                                       std::int64_t count, void* findings, Own&... own) {
    const Law& given = *static_cast<const Law*>(opaque);
    const auto& b = *static_cast<const view_type*>(view);
    auto& found = *static_cast<tally*>(findings);
    Wide law = broadcast<V>(given);
    auto prepared = kit::prepared(law, b.step);
    V stable_step = infinity;
    for (std::int64_t i = first; i < first + count; ++i) {
      checks_type c;
      if (b.varying) c.require(take_own(law, prepared, given, b, i), reason_parameter);
      Kernel::run_pack(law, prepared, b, i, c, found, stable_step, own...);
    }
    collect_stable_step(stable_step, found);
  }

  // ---- before a pack

  // Asks for the arrays of a later pack where no cache holds them, and reads the parameters of this one.
  // False: some node's are bad.
  template <class Prepared>
  ILAW_KIT_INLINE static bool get_ready(Wide& law, Prepared& prepared, const Law& given, const view_type& b,
                                        std::int64_t i) {
    if constexpr (std::is_same_v<typename View::value, double>)
      if (b.in_memory) prefetch(b, i + prefetch_distance, width);
    return !b.varying || !any(!take_own(law, prepared, given, b, i));
  }
  // The parameters of the nodes, apart from the law that the loop has in registers. Returns which are good.
  template <class Prepared>
  ILAW_KIT_INLINE static mask take_own(Wide& law, Prepared& prepared, const Law& given, const view_type& b,
                                       std::int64_t i) {
    Wide own = law;
    const mask good = take_parameters(own, given, b, i);
    law = own;
    if constexpr (requires { law.prepare(b.step); }) refresh(prepared, kit::prepared(law, b.step));
    return good;
  }
  template <class Prepared>
  ILAW_KIT_INLINE static void refresh(Prepared& to, const Prepared& from) {
    __builtin_memcpy(static_cast<void*>(&to), &from, sizeof to);
  }
};

}  // namespace ilaw::kit::detail
