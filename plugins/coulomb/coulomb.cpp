// Contact with dry friction. See coulomb.md for the equations.
#include <ilaw/kit.hpp>

namespace {

using namespace ilaw::kit;

// A slip below this part of the free one is the rounding of a contact that stuck.
constexpr double at_rest = 0x1p-26;

struct coulomb : friction_in_packs {
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
      .capabilities = can_rest,
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

  bool falls() const { return (kinetic_friction < friction) | (kinetic_friction < second()); }
  bool tells_tangents_apart() const { return (friction_2 != infinity) & (friction_2 != friction); }

  // What is not asked is free.
  static constexpr bool answers_every_node = true;
  static constexpr bool skips_out_of_reach = true;

  // One coefficient at all speeds, or one of each tangent, or one that falls: what keeps their loops free of
  // all that follows.
  struct plain;
  struct elliptical;
  struct falling;
  template <class Run>
  void in_form(Run run) const;
  using form_of_nodes = plain;
  using form_of_floats = plain;
  bool has_form_of_nodes() const {
    // Joined as numbers: of truths the loop that asks this would make branches.
    const double falls_to = kinetic_friction < friction ? 1.0 : 0.0;
    const double apart = absolute(second() - friction) > 0.0 ? 1.0 : 0.0;
    return falls_to + apart == 0.0;
  }

  // Nodes whose tangents have no name cannot tell them apart: for them one coefficient is all.
  template <class Node>
  void step(Node& node) const requires(!has_tangents<Node>) {
    apply_isotropic_friction(node, contact(node), fallen(friction, left(node)));
  }
  template <class Node>
  bool asks(Node& node, friction_problem<double>& open) const requires has_tangents<Node> {
    const double part = left(node);
    return ask_friction(node, contact(node), fallen(friction, part), fallen(second(), part), open);
  }

 private:
  double second() const { return friction_2 == infinity ? friction : friction_2; }

  // What the slip speed leaves of the fall.
  template <class Node>
  double left(const Node& node) const {
    const double speed = node.v_previous.tangential_length();
    const auto free = node.v_free.scaled_tangential_length();
    const double scaled = free.down * speed;
    const bool slipped = scaled * scaled > at_rest * at_rest * free.square;
    const double way = slipped ? decay * speed : 0.0;
    return exp(-way);
  }

  // Each coefficient falls to the kinetic one where that is smaller; an infinite one falls only as a whole.
  double fallen(double coefficient, double part) const {
    const double kinetic = smaller(kinetic_friction, coefficient);
    const bool falls_partly = (kinetic < coefficient) & (part < 1.0);
    const double partly = falls_partly ? kinetic + (coefficient - kinetic) * part : coefficient;
    return part == 0.0 ? kinetic : partly;
  }

  template <class Node>
  auto contact(const Node& node) const {
    return contact_problem_of(contact_at(node, restitution, activation), node.v_free, node.v_previous,
                              tangential_restitution);
  }
};

struct coulomb::plain : coulomb {
  // What most contacts are: the usual one then has a shorter step.
  struct inelastic;
  using form_of_try = inelastic;
  bool has_form_of_try() const { return restitution == 0.0 && tangential_restitution == 0.0; }

  template <class Node>
  void step(Node& node) const requires has_transverse_delassus<Node> {
    apply_isotropic_friction(node, contact(node), friction);
  }
  template <class Node>
  bool try_step(Node& node) const requires has_transverse_delassus<Node> {
    return try_isotropic_friction(node, contact(node), friction);
  }
  template <class Node>
  bool asks(Node& node, friction_problem<double>& open) const requires(!has_transverse_delassus<Node>) {
    return ask_friction(node, contact(node), friction, open);
  }
};

struct coulomb::plain::inelastic : plain {
  template <class Node>
  bool try_step(Node& node) const requires has_transverse_delassus<Node> {
    const contact_condition condition = inelastic_contact_at(node, activation);
    return try_isotropic_friction(node, contact_problem_of(condition, node.v_free, node.v_previous),
                                  friction);
  }
};

struct coulomb::elliptical : coulomb {
  template <class Node>
  void step(Node& node) const requires(!has_tangents<Node>) {
    apply_isotropic_friction(node, contact(node), friction);
  }
  template <class Node>
  bool asks(Node& node, friction_problem<double>& open) const requires has_tangents<Node> {
    return ask_friction(node, contact(node), friction, second(), open);
  }
};

struct coulomb::falling : coulomb {
  static constexpr bool takes_two_packs = true;
  template <class Node>
  void step(Node& node) const requires has_transverse_delassus<Node> {
    apply_isotropic_friction(node, contact(node), fallen(friction, left(node)));
  }
  template <class Node>
  bool try_step(Node& node) const requires has_transverse_delassus<Node> {
    return try_isotropic_friction(node, contact(node), fallen(friction, left(node)));
  }
  template <class Node>
  bool asks(Node& node, friction_problem<double>& open) const requires(!has_transverse_delassus<Node>) {
    const double fallen_to = fallen(friction, left(node));
    return ask_friction(node, contact(node), fallen_to, open);
  }
};

template <class Run>
void coulomb::in_form(Run run) const {
  if (tells_tangents_apart() && falls())
    run(*this);
  else if (tells_tangents_apart())
    run(elliptical{*this});
  else if (falls())
    run(falling{*this});
  else
    run(plain{*this});
}

}  // namespace

ILAW_PLUGIN("coulomb", "1.0.0", "ilaw", "BSD-3-Clause", coulomb)
