// Contact with dry friction. See coulomb.md for the equations.
#include <ilaw/kit.hpp>

namespace {

using namespace ilaw::kit;

struct coulomb {
  double friction;
  double restitution;
  double tangential_restitution;
  double activation;

  static constexpr law_card card{
      .id = "coulomb",
      .title = "Unilateral contact with dry friction",
      .doc =
          "Signorini-Moreau contact with Coulomb friction: the tangential impulse stays within the friction "
          "cone and "
          "opposes slip. Exact closed form for an H that is isotropic in the tangent plane.",
      .inputs = reads_gap | reads_v_previous,
      .names_tangents = false};

  static constexpr const char* references[] = {
      "J.-J. Moreau, 1988, Unilateral contact and dry friction in finite freedom dynamics",
      "G. de Saxce, Z.-Q. Feng, 1991, New inequality and functional for contact with friction"};

  static constexpr parameter<coulomb> parameters[] = {
      {.member = &coulomb::friction,
       .name = "friction",
       .symbol = "mu",
       .doc = "Coefficient of friction; inf forbids slip while the contact is pressed.",
       .required = true,
       .infinity_allowed = true},
      {.member = &coulomb::restitution,
       .name = "restitution",
       .symbol = "e",
       .doc = "Newton's coefficient: normal velocity after an impact over the one before, reversed.",
       .maximum = 1.0},
      {.member = &coulomb::tangential_restitution,
       .name = "tangential_restitution",
       .symbol = "e_T",
       .doc = "Part of the tangential velocity before the step that a sticking contact reverses.",
       .maximum = 1.0},
      {.member = &coulomb::activation,
       .name = "activation",
       .doc = "moreau: acts where the gap is closed; predictive: acts where the next gap would be negative.",
       .choices = activation_choices,
       .choice_count = 2}};

  std::uint32_t inputs() const {
    return reads_gap | (restitution > 0.0 || tangential_restitution > 0.0 ? reads_v_previous : 0U);
  }

  template <class Node>
  void step(Node& node) const {
    const contact_condition contact = contact_at(node, restitution, activation);
    auto q = node.v_free + tangential_restitution * node.v_previous;
    q.n = contact.excess;
    apply_contact_friction(node, contact.slack, q, friction);
  }
};

}  // namespace

ILAW_PLUGIN("coulomb", "1.0.0", "ilaw", "BSD-3-Clause", coulomb)
