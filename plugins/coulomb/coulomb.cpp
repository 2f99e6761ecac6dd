// Contact with dry friction. See coulomb.md for the equations.
#include <ilaw/kit.hpp>
#include <ilaw/kit/resolved_impact.hpp>

namespace {

using namespace ilaw::kit;

// A slip below this part of the free one is the rounding of a contact that stuck.
constexpr double at_rest = 0x1p-26;

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
      .capabilities = can_store_energy,
      .permissions = may_skip_fresh | may_skip_free,
      .is_isotropic = true};

  static constexpr const char* references[] = {
      "J.-J. Moreau, 1988, Unilateral contact and dry friction in finite freedom dynamics",
      "G. de Saxce, Z.-Q. Feng, 1991, New inequality and functional for contact with friction",
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
      resolving_activation_parameter(&coulomb::activation),
      heat_partition_parameter(&coulomb::heat_partition),
      wear_coefficient_parameter(&coulomb::wear_coefficient)};

  // Only where activation is resolved.
  struct state {
    V work, ratio;
  };
  static constexpr state_variable<state> state_variables[] = {
      waiting_work_variable(&state::work),
      {.member = &state::ratio,
       .name = "stick_ratio",
       .doc = "Impulse that held the node in the last step over its limit; 0: it was not held.",
       .minimum = 0.0,
       .maximum = 1.0}};
  std::uint32_t inputs() const { return inputs_of_contact(card.inputs, restitution, activation); }
  bool remembers() const { return activation == resolved; }
  std::uint32_t capabilities() const { return remembers() ? can_store_energy : 0; }

  const char* conflict() const {
    if (activation != resolved) return nullptr;
    if (tells_tangents_apart()) return "'activation' resolved has one coefficient: no 'friction_2'";
    if ((kinetic_friction < friction) & (decay < infinity))
      return "'activation' resolved has 'kinetic_friction' at once: no 'decay'";
    if (tangential_restitution != 0.0) return "'activation' resolved has no 'tangential_restitution'";
    return nullptr;
  }

  bool tells_tangents_apart() const { return (friction_2 != infinity) & (friction_2 != friction); }
  bool asks() const { return tells_tangents_apart(); }

  // One coefficient, and H = diag(h_N, h_T, h_T).
  template <class Node>
  status_of<V> step(Node& node) const requires is_transverse<Node> {
    if constexpr (has_memory<Node>) return resolved_step(node);
    return apply_isotropic_friction(node, contact(node), fallen(node, friction));
  }

  // Any H, and a coefficient along each tangent.
  template <class Node>
  asked<V> ask(Node& node, friction_problem<V>& open) const
      requires(has_tangents<Node> && !(has_memory<Node> && is_transverse<Node>)) {
    if constexpr (has_memory<Node>) {
      open = {};
      node.refuse(is_anisotropic(node.delassus), refusal::unserved_delassus);
      return {V(0.0) != V(0.0), resolved_step(node)};
    }
    const V second = select(friction_2 == infinity, friction, friction_2);
    return ask_friction(node, contact(node), fallen(node, friction), fallen(node, second), open);
  }

 private:
  template <class Node>
  status_of<V> resolved_step(Node& node) const {
    const resolved_impact<V> impact = resolve_impact(node, restitution, node.state.work);
    if (node.wants_energy) {
      node.stored = positive_part(impact.work);
      node.normal_gain = node.stored - positive_part(node.state.work);
    }
    node.state.work = impact.work;
    return apply_resolved_friction(node, impact, restitution, fallen(node, friction),
                                   smaller(kinetic_friction, friction), node.state.ratio);
  }
  template <class Node>
  auto contact(const Node& node) const {
    return contact_problem_of(contact_at(node, restitution, activation), node.v_free, node.v_previous,
                              tangential_restitution);
  }

  // mu_k + (mu - mu_k) exp(-beta |v_T|), where mu_k < mu; an infinite mu falls only as a whole.
  template <class Node>
  V fallen(const Node& node, V mu) const {
    if (!any(kinetic_friction < mu)) return mu;
    const V speed = node.v_previous.tangential_length();
    const auto free = node.v_free.scaled_tangential_length();
    const V scaled = free.down * speed;
    const auto slipped = scaled * scaled > at_rest * at_rest * free.square;
    const V left = exp(-zero_unless(slipped, decay * speed)), kinetic = smaller(kinetic_friction, mu);
    const V partly = select((kinetic < mu) & (left < 1.0), kinetic + (mu - kinetic) * left, mu);
    return select(left == 0.0, kinetic, partly);
  }
};

}  // namespace

ILAW_PLUGIN("coulomb", "1.0.0", "ilaw", "BSD-3-Clause", coulomb)
