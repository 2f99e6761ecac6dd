// Contact with dry friction. See coulomb.md for the equations.
#include <ilaw/kit.hpp>

namespace {

using namespace ilaw::kit;

// A slip below this part of the free one is the rounding of a contact that stuck.
constexpr double at_rest = 0x1p-26;

struct coulomb {
  double friction;
  double kinetic_friction;
  double decay;
  double friction_2;
  double restitution;
  double tangential_restitution;
  double activation;

  static constexpr law_card card{
      .id = "coulomb",
      .title = "Unilateral contact with dry friction",
      .doc =
          "Signorini-Moreau contact with Coulomb friction: the tangential impulse stays within the friction "
          "cone, circular or elliptical, and dissipates at most. Exact for any symmetric positive definite "
          "H.",
      .inputs = reads_gap | reads_v_previous,
      .capabilities = ILAW_CAN_REST,
      .names_tangents = false};

  static constexpr const char* references[] = {
      "J.-J. Moreau, 1988, Unilateral contact and dry friction in finite freedom dynamics",
      "G. de Saxce, Z.-Q. Feng, 1991, New inequality and functional for contact with friction",
      "G. Daviet, F. Bertails-Descoubes, L. Boissieux, 2011, A hybrid iterative solver for robustly "
      "capturing "
      "Coulomb friction in hair dynamics"};

  static constexpr parameter<coulomb> parameters[] = {
      friction_parameter(&coulomb::friction)
          .with_doc("Coefficient of friction; inf forbids slip while the contact is pressed.")
          .as_required(),
      {.member = &coulomb::kinetic_friction,
       .name = "kinetic_friction",
       .symbol = "mu_k",
       .doc = "Coefficient that friction falls to with the slip speed; above friction, and so by default, "
              "there is "
              "no fall.",
       .default_value = infinity,
       .infinity_allowed = true},
      {.member = &coulomb::decay,
       .name = "decay",
       .symbol = "beta",
       .unit = "s/m",
       .doc = "Rate of this fall: mu_k + (mu - mu_k) exp(-beta |v_T|); inf: at once with any slip.",
       .default_value = infinity,
       .infinity_allowed = true},
      {.member = &coulomb::friction_2,
       .name = "friction_2",
       .symbol = "mu_2",
       .doc = "Coefficient along the second tangent, friction being the first's; inf: the same as friction.",
       .default_value = infinity,
       .infinity_allowed = true},
      restitution_parameter(&coulomb::restitution),
      {.member = &coulomb::tangential_restitution,
       .name = "tangential_restitution",
       .symbol = "e_T",
       .doc = "Part of the tangential velocity before the step that a sticking contact reverses.",
       .maximum = 1.0},
      activation_parameter(&coulomb::activation)};

  bool falls() const { return kinetic_friction < friction || kinetic_friction < second(); }
  bool tells_tangents_apart() const { return friction_2 != infinity && friction_2 != friction; }

  // One coefficient at all speeds, which keeps the loop of the common case free of all that follows.
  struct plain;
  template <class Run>
  void in_form(Run run) const;

  template <class Node>
  void step(Node& node) const {
    const double speed = node.v_previous.tangential_length();
    const bool slipped = speed > at_rest * node.v_free.tangential_length();
    const double left = slipped ? exp(-decay * speed) : 1.0;  // of the fall
    apply_contact_friction(node, problem(node), fallen(friction, left), fallen(second(), left));
  }

 private:
  double second() const { return friction_2 == infinity ? friction : friction_2; }

  // Each coefficient falls to the kinetic one where that is smaller; an infinite one falls only as a whole.
  double fallen(double coefficient, double left) const {
    const double kinetic = smaller(kinetic_friction, coefficient);
    if (left == 0.0) return kinetic;
    return kinetic < coefficient && left < 1.0 ? kinetic + (coefficient - kinetic) * left : coefficient;
  }

  template <class Node>
  auto problem(const Node& node) const {
    return contact_problem_of(contact_at(node, restitution, activation), node.v_free, node.v_previous,
                              tangential_restitution);
  }
};

struct coulomb::plain : coulomb {
  template <class Node>
  void step(Node& node) const {
    apply_contact_friction(node, problem(node), friction);
  }
};

template <class Run>
void coulomb::in_form(Run run) const {
  if (falls() || tells_tangents_apart())
    run(*this);
  else
    run(plain{*this});
}

}  // namespace

ILAW_PLUGIN("coulomb", "1.0.0", "ilaw", "BSD-3-Clause", coulomb)
