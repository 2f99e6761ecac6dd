// Signorini-Moreau contact with Newton restitution. See contact.md for the equations.
#include <ilaw/kit.hpp>

namespace {

using namespace ilaw::kit;

struct contact {
  double restitution;
  double activation;

  static constexpr law_card card{
      .id = "contact",
      .title = "Unilateral contact with restitution",
      .doc =
          "Signorini-Moreau contact without friction: open nodes get no impulse, closed ones are pushed so "
          "that "
          "the normal velocity after the step is at least -e times the one before.",
      .inputs = reads_gap | reads_v_previous,
      .capabilities = can_rest,
      .names_tangents = false};

  static constexpr const char* references[] = {
      "J.-J. Moreau, 1988, Unilateral contact and dry friction in finite freedom dynamics",
      "D. Doyen, A. Ern, S. Piperno, 2011, Time-integration schemes for the finite element dynamic Signorini "
      "problem"};

  static constexpr parameter<contact> parameters[] = {restitution_parameter(&contact::restitution),
                                                      activation_parameter(&contact::activation)};

  static constexpr bool skips_out_of_reach = true;
  using form_of_floats = contact;

  template <class Node>
  void step(Node& node) const {
    const contact_condition condition = contact_at(node, restitution, activation);
    const double normal =
        condition.slack <= 0.0 ? positive_part(-condition.excess / node.delassus.normal()) : 0.0;
    node.impulse.n = normal;
    node.status = normal > 0.0 ? status::closed : status::free;
  }
};

}  // namespace

ILAW_PLUGIN("contact", "1.0.0", "ilaw", "BSD-3-Clause", contact)
