// Signorini-Moreau contact with Newton restitution. See contact.md for the equations.
#include <ilaw/kit.hpp>

namespace {

using namespace ilaw::kit;

template <class V>
struct contact {
  V restitution;
  double activation;

  static constexpr law_card card{
      .id = "contact",
      .title = "Unilateral contact with restitution",
      .doc =
          "Signorini-Moreau contact without friction: open nodes get no impulse, closed ones are pushed so that "
          "the normal velocity after the step is at least -e times the one before.",
      .inputs = reads_gap | reads_v_previous | reads_v_smooth,
      .permissions = may_skip_fresh | may_skip_free,
      .is_isotropic = true};

  static constexpr const char* references[] = {
      "J.-J. Moreau, 1988, Unilateral contact and dry friction in finite freedom dynamics",
      "D. Doyen, A. Ern, S. Piperno, 2011, Time-integration schemes for the finite element dynamic Signorini "
      "problem"};

  static constexpr parameter<contact> parameters[] = {restitution_parameter(&contact::restitution),
                                                      activation_parameter(&contact::activation)};

  std::uint32_t inputs() const { return inputs_of_contact(card.inputs, restitution, activation); }

  template <class Node>
  status_of<V> step(Node& node) const {
    const contact_condition<V> condition = contact_at(node, restitution, activation);
    const V pressing = positive_part(-condition.excess / node.delassus.normal());
    node.impulse.n = zero_unless(condition.slack <= 0.0, pressing);
    return select(node.impulse.n > 0.0, status::closed, status::free);
  }
};

}  // namespace

ILAW_PLUGIN("contact", "1.0.0", "ilaw", "BSD-3-Clause", contact)
