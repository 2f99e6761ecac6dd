// Contact and friction with impacts at their instants within the step. See impact.md for the equations.
#include "two_impulses.hpp"

#include <ilaw/kit.hpp>

namespace {

using namespace ilaw::kit;
using namespace impact_law;

template <class V>
struct impact {
  V restitution;
  V friction;
  V kinetic_friction;
  V heat_partition;
  V wear_coefficient;

  static constexpr law_card card{
      .id = "impact",
      .title = "Contact, restitution and dry friction of second order through impacts",
      .doc =
          "Unilateral contact whose impact is found at its instant within the step; its impulse acts in two parts, "
          "in this step and in the next. With Coulomb friction, whose onset of slip is found as well.",
      .inputs = reads_gap | reads_v_previous | reads_v_smooth,
      .capabilities = can_store_energy,
      .permissions = may_skip_fresh | may_skip_free,
      .is_isotropic = true};

  static constexpr const char* references[] = {
      "J.-J. Moreau, 1988, Unilateral contact and dry friction in finite freedom dynamics",
      "this project, docs/theory/resolved_impact.md"};

  static constexpr parameter<impact> parameters[] = {
      restitution_parameter(&impact::restitution),
      friction_parameter(&impact::friction)
          .with_doc("Coefficient of friction; inf forbids slip while the contact is pressed, 0: none."),
      {.member = &impact::kinetic_friction,
       .name = "kinetic_friction",
       .symbol = "mu_k",
       .doc = "Coefficient while it slips; above friction, and so by default, it is friction.",
       .default_value = infinity,
       .infinity_allowed = true},
      heat_partition_parameter(&impact::heat_partition),
      wear_coefficient_parameter(&impact::wear_coefficient)};

  struct state {
    V work, ratio;
  };
  static constexpr state_variable<state> state_variables[] = {
      {.member = &state::work,
       .name = "waiting_work",
       .unit = "J",
       .doc = "Work that the impact of the last step leaves to the impulse of the next one; 0: none."},
      {.member = &state::ratio,
       .name = "stick_ratio",
       .doc = "Impulse that held the node in the last step over its limit; 0: it was not held.",
       .minimum = 0.0,
       .maximum = 1.0}};

  // With friction H is diag(h_N, h_T, h_T).
  template <class Node>
  status_of<V> step(Node& node) const {
    if constexpr (!is_transverse<Node>)
      node.refuse((friction > 0.0) & is_anisotropic(node.delassus), refusal::unserved_delassus);
    const two_impulses<V> found = resolve_impact(node, restitution, node.state.work);
    if (node.wants_energy) {
      node.stored = positive_part(found.work);
      node.normal_gain = node.stored - positive_part(node.state.work);
    }
    node.state.work = found.work;
    status_of<V> pressed = status::closed;
    if (any(friction > 0.0)) {
      const V kinetic = smaller(kinetic_friction, friction),
              now = select(has_slipped(node), kinetic, friction);
      V ratio = node.state.ratio;
      const status_of<V> rubbed = apply_friction(node, found, restitution, now, kinetic, ratio);
      node.state.ratio = select(friction > 0.0, ratio, node.state.ratio);
      pressed = select(friction > 0.0, rubbed, pressed);
    }
    node.impulse.n = found.impulse;
    return select(found.impulse > 0.0, pressed, status::free);
  }
};

}  // namespace

ILAW_PLUGIN("impact", "1.0.0", "ilaw", "BSD-3-Clause", impact)
