// gathered.hpp - a node whose bond has an equation to solve, as numbers side by side: as it comes in and as
// it leaves.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit.hpp>

namespace cohesive_law {
inline namespace ILAW_KIT_LEVEL {

using namespace ilaw::kit;

template <class V>
struct gathered {
  V h[6], v_free[3], v_previous[3], gap, area, damage, position[3], opening[3], velocity_step, position_step;
};
template <class V>
struct solved {
  V impulse[3], damage, position[3], opening[3], stored, normal_gain, tangential_gain, rupture, status,
      refused;
};

inline void keep(vector a, double (&kept)[3]) {
  kept[0] = a.n;
  kept[1] = a.t1;
  kept[2] = a.t2;
}
inline vector kept(const double (&a)[3]) { return {a[0], a[1], a[2]}; }

// Number by number: loops in which structs are copied do not vectorise.
template <class Node>
void gather(const Node& node, gathered<double>& g) {
  local_coulomb same;
  fill(same, node.delassus);
  for (int k = 0; k < 6; ++k) g.h[k] = same.h[k];
  keep(node.v_free, g.v_free);
  keep(node.v_previous, g.v_previous);
  g.gap = node.gap;
  g.area = node.area;
  g.damage = node.state.damage;
  keep(node.state.position, g.position);
  keep(node.state.opening, g.opening);
  g.velocity_step = node.velocity_step;
  g.position_step = node.position_step;
}

// One form of node for all, so that what is long is compiled once.
template <class State>
node<full_delassus, State> node_of(const gathered<double>& g) {
  return {.time = 0.0,  // no law of time
          .velocity_step = g.velocity_step,
          .position_step = g.position_step,
          .v_free = kept(g.v_free),
          .v_previous = kept(g.v_previous),
          .delassus = full_delassus::from(g.h),
          .gap = g.gap,
          .area = g.area,
          .history = {},
          .impulse = {},
          .state = {g.damage, kept(g.position), kept(g.opening)}};
}

// The answer where the bond stays as it was.
template <class V>
void leave_bond(const gathered<V>& g, const V (&impulse)[3], V status, mask_of<V> where, solved<V>& s) {
  for (int k = 0; k < 3; ++k) {
    s.impulse[k] = select(where, impulse[k], s.impulse[k]);
    s.position[k] = select(where, g.position[k], s.position[k]);
    s.opening[k] = select(where, g.opening[k], s.opening[k]);
  }
  s.damage = select(where, g.damage, s.damage);
  for (V* energy : {&s.stored, &s.normal_gain, &s.tangential_gain, &s.rupture})
    *energy = select(where, 0.0, *energy);
  s.status = select(where, status, s.status);
}

// Another answer, where it is one.
template <class V>
void choose_answer(mask_of<V> where, const solved<V>& other, solved<V>& s) {
  for (int k = 0; k < 3; ++k) {
    s.impulse[k] = select(where, other.impulse[k], s.impulse[k]);
    s.position[k] = select(where, other.position[k], s.position[k]);
    s.opening[k] = select(where, other.opening[k], s.opening[k]);
  }
  for (const auto member :
       {&solved<V>::damage, &solved<V>::stored, &solved<V>::normal_gain, &solved<V>::tangential_gain,
        &solved<V>::rupture, &solved<V>::status, &solved<V>::refused})
    s.*member = select(where, other.*member, s.*member);
}

template <class Node>
void leave(const Node& node, solved<double>& s) {
  keep(node.impulse, s.impulse);
  s.damage = node.state.damage;
  keep(node.state.position, s.position);
  keep(node.state.opening, s.opening);
  s.stored = node.stored;
  s.normal_gain = node.normal_gain;
  s.tangential_gain = node.tangential_gain;
  s.rupture = node.rupture;
  s.status = node.status;
  s.refused = node.refused;
}
template <class Node>
void give(Node& node, const solved<double>& s) {
  node.impulse = kept(s.impulse);
  node.state.damage = s.damage;
  node.state.position = kept(s.position);
  node.state.opening = kept(s.opening);
  node.stored = s.stored;
  node.normal_gain = s.normal_gain;
  node.tangential_gain = s.tangential_gain;
  node.rupture = s.rupture;
  node.status = s.status;
  node.refused = s.refused;
}

}  // namespace ILAW_KIT_LEVEL
}  // namespace cohesive_law
