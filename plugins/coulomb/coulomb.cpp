// Contact with dry friction. See coulomb.md for the equations.
#include <ilaw/kit.hpp>

namespace {

using namespace ilaw::kit;

template <class V>
struct coulomb : friction_solver<V> {
  V friction;
  V kinetic_friction;
  V decay;
  V friction_2;
  V restitution;
  V tangential_restitution;
  double activation;
  V heat_partition;
  V wear_coefficient;

  static constexpr law_card card{
      .id = "coulomb",
      .title = "Unilateral contact with dry friction",
      .doc =
          "Signorini-Moreau contact with Coulomb friction: the tangential impulse stays within the friction cone, "
          "circular or elliptical, and dissipates at most. Exact for any symmetric positive definite H.",
      .inputs = reads_gap | reads_v_previous | reads_v_smooth,
      .permissions = may_skip_fresh | may_skip_free,
      .is_isotropic = true};

  static constexpr const char* references[] = {
      "J.-J. Moreau, 1988, Unilateral contact and dry friction in finite freedom dynamics",
      ("G. Daviet, F. Bertails-Descoubes, L. Boissieux, 2011, A hybrid iterative solver for robustly capturing "
       "Coulomb friction in hair dynamics")};

  static constexpr parameter<coulomb> parameters[] = {
      friction_parameter(&coulomb::friction)
          .with_doc("Coefficient of friction; inf forbids slip while the contact is pressed.")
          .as_required(),
      {.member = &coulomb::kinetic_friction,
       .name = "kinetic_friction",
       .symbol = "mu_k",
       .doc =
           "Coefficient that friction falls to with the slip speed; above friction, and so by default, there is "
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
      activation_parameter(&coulomb::activation),
      heat_partition_parameter(&coulomb::heat_partition),
      wear_coefficient_parameter(&coulomb::wear_coefficient)};

  std::uint32_t inputs() const { return inputs_of_contact(card.inputs, restitution, activation); }
  bool tells_tangents_apart() const { return (friction_2 != infinity) & (friction_2 != friction); }
  bool asks() const { return tells_tangents_apart(); }

  // One coefficient, and H = diag(h_N, h_T, h_T).
  template <class Node>
  status_of<V> step(Node& node) const requires is_transverse<Node> {
    return apply_isotropic_friction(node, contact(node), fallen(node, friction));
  }

  // Any H, and a coefficient along each tangent.
  template <class Node>
  asked<V> ask(Node& node, friction_problem<V>& open) const requires has_tangents<Node> {
    const V second = select(friction_2 == infinity, friction, friction_2);
    return ask_friction(node, contact(node), fallen(node, friction), fallen(node, second), open);
  }

 private:
  template <class Node>
  auto contact(const Node& node) const {
    return contact_problem_of(contact_at(node, restitution, activation), node.v_free, node.v_previous,
                              tangential_restitution);
  }

  // mu_k + (mu - mu_k) exp(-beta |v_T|), where mu_k < mu; an infinite mu falls only as a whole.
  template <class Node>
  V fallen(const Node& node, V mu) const {
    if (!any(kinetic_friction < mu)) return mu;
    const V fall = zero_unless(has_slipped(node), decay * node.v_previous.tangential_length());
    const V left = exp(-fall), kinetic = smaller(kinetic_friction, mu);
    const V partly = select((kinetic < mu) & (left < 1.0), kinetic + (mu - kinetic) * left, mu);
    return select(left == 0.0, kinetic, partly);
  }
};

}  // namespace

ILAW_PLUGIN("coulomb", "1.0.0", "ilaw", "BSD-3-Clause", coulomb)
