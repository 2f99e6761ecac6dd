// Bilateral bond that may break by the impulses of a window, and is then contact. See tie.md.
#include <ilaw/kit.hpp>
#include <ilaw/kit/rigid_bond.hpp>
#include <ilaw/kit/window.hpp>

namespace {

using namespace ilaw::kit;

// A pull exactly at the limit holds, whatever the rounding of its windowed sum.
constexpr double at_the_limit = 1.0 + window_slack;

template <class V>
struct tie {
  V strength;
  V force;
  double duration;  // of the window
  double buckets;

  static constexpr law_card card{
      .id = "tie",
      .title = "Bilateral bond, breakable (spot weld)",
      .doc =
          "Keeps the node at rest relative to the obstacle, in all directions and for any H. Where a strength or a force "
          "is given, the bond breaks for good when the impulses of the last memory exceed it in pull and shear "
          "together; frictionless contact is left.",
      .inputs = reads_gap | reads_v_previous | reads_area,
      .capabilities = can_adhere | can_hold_bonds,
      .permissions = may_skip_free,
      .state_version = 2};

  static constexpr const char* references[] = {
      "J.-J. Moreau, 1988, Unilateral contact and dry friction in finite freedom dynamics"};

  static constexpr parameter<tie> parameters[] = {
      {.member = &tie::strength,
       .name = "strength",
       .symbol = "R_Y",
       .unit = "N.s/m^2",
       .doc = "Impulse per area, over the memory, that the bond can carry in pull and shear.",
       .default_value = infinity,
       .infinity_allowed = true},
      {.member = &tie::force,
       .name = "force",
       .symbol = "F_Y",
       .unit = "N",
       .doc = "Mean force over the memory that the bond of one node can carry, whatever its area.",
       .default_value = infinity,
       .infinity_allowed = true},
      memory_parameter(&tie::duration),
      buckets_parameter(&tie::buckets)};

  struct state {
    V broken;
  };
  static constexpr state_variable<state> state_variables[] = {{.member = &state::broken,
                                                               .name = "broken",
                                                               .doc = "1 once the bond has broken, else 0.",
                                                               .minimum = 0.0,
                                                               .maximum = 1.0,
                                                               .whole = true}};

  // A broken bond needs no window any more.
  static constexpr history_card history = window_variable;
  window_size window() const { return {duration, buckets}; }
  static constexpr bool adds_to_window(ilaw_status s) { return s == ILAW_BONDED; }
  static constexpr bool clears_window(ilaw_status s) { return s == ILAW_BROKEN; }

  const char* conflict() const {
    if (force < infinity && strength < infinity)
      return "parameters 'strength' and 'force' are two limits, expected one of them";
    if (force < infinity && !(duration > 0.0 && duration < infinity))
      return "parameter 'force' is a mean over 'memory', which must be above 0 and finite";
    return nullptr;
  }
  std::uint32_t capabilities() const {
    return strength < infinity || force < infinity ? card.capabilities : std::uint32_t{can_adhere};
  }
  std::uint32_t inputs() const {
    if (strength < infinity) return card.inputs;
    return force < infinity ? reads_gap | reads_v_previous : reads_v_previous;
  }

  template <class Node>
  status_of<V> step(Node& node) const {
    const vector<V> trial = stopping_impulse(node.delassus, node.v_free, node.v_previous);
    const V broken = node.state.broken;
    const mask_of<V> bonded = broken == 0.0;
    const mask_of<V> holds = bond_holds(node, bonded, [&]() ILAW_KIT_LAMBDA -> mask_of<V> {
      return any((strength < infinity) | (force < infinity)) ? !overloads(node, trial) : bonded;
    });
    V normal = 0.0;
    if (any(!holds)) normal = pressing_impulse(node.delassus, contact_without_bond(node, node.v_free));
    node.impulse = select(holds, trial, vector<V>{normal});
    node.state.broken = select(holds, broken, V(1.0));
    const status_of<V> touches = select(normal > 0.0, status::closed, status::free);
    return select(holds, status_of<V>(status::bonded), select(bonded, status_of<V>(status::broken), touches));
  }

 private:
  // sqrt(<-S_N>^2 + |S_T|^2) > R_Y A or F_Y tau_Y. A limit that is not a number: inf, and no area is read.
  template <class Node>
  mask_of<V> overloads(const Node& node, vector<V> trial) const {
    const V limit = select(force < infinity, force * duration, strength * node.area) * at_the_limit;
    const vector<V> sum = node.earlier + trial;
    const scaled_length<V> load = scaled_length_of(positive_part(-sum.n), sum.t1, sum.t2);
    return load.square > (load.down * limit) * (load.down * limit);
  }
};

}  // namespace

ILAW_PLUGIN("tie", "1.0.0", "ilaw", "BSD-3-Clause", tie)
