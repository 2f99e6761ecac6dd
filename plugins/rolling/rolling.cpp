// Contact of spheres with friction, rolling and twisting resistance. See rolling.md for the equations.
#include <ilaw/kit.hpp>
#include <ilaw/kit/rolling.hpp>

namespace {

using namespace ilaw::kit;

template <class V>
struct rolling : friction_solver<V> {
  V friction;
  V rolling_friction;
  V twisting_friction;
  V restitution;
  double activation;

  static constexpr law_card card{
      .id = "rolling",
      .title = "Contact with friction, rolling and twisting resistance",
      .doc =
          "Contact and Coulomb friction of bodies that spin; moments resist rolling and twisting, up to a length "
          "times the normal impulse, and dissipate at most. For any H without spins, friction alone.",
      .delassus_forms = all_delassus_forms | with_spins,
      .inputs = reads_gap | reads_v_previous | reads_v_smooth,
      .permissions = may_skip_fresh | may_skip_free,
      .is_isotropic = true};

  static constexpr const char* references[] = {
      "V. Acary, F. Bourrier, 2021, Coulomb friction with rolling resistance as a cone complementarity problem",
      "J.-J. Moreau, 1988, Unilateral contact and dry friction in finite freedom dynamics"};

  static constexpr parameter<rolling> parameters[] = {
      friction_parameter(&rolling::friction)
          .with_doc("Coefficient of friction; inf forbids slip while the contact is pressed.")
          .as_required(),
      rolling_friction_parameter(&rolling::rolling_friction),
      twisting_friction_parameter(&rolling::twisting_friction), restitution_parameter(&rolling::restitution),
      activation_parameter(&rolling::activation)};

  std::uint32_t inputs() const { return inputs_of_contact(card.inputs, restitution, activation); }

  template <class Node>
  status_of<V> step(Node& node) const requires is_transverse<Node> {
    if constexpr (has_spins<Node>) return roll(node, contact(node));
    return apply_isotropic_friction(node, contact(node), friction);
  }

  template <class Node>
  asked<V> ask(Node& node, friction_problem<V>& open) const requires(!is_transverse<Node>) {
    return ask_friction(node, contact(node), friction, friction, open);
  }

 private:
  template <class Node>
  auto contact(const Node& node) const {
    return contact_problem_of(contact_at(node, restitution, activation), node.v_free, node.v_previous);
  }

  template <class Node, class Vector>
  status_of<V> roll(Node& node, const contact_problem<Vector>& contact) const {
    const auto& h = node.delassus;
    const V normal = pressing_impulse(h, contact);
    const auto found = solve_rolling<V, Vector>(
        {h.t, h.k, h.j_t, node.v_free.tangential_part(), node.spin_free.tangential_part(),
         friction_limit(friction, normal), friction_limit(rolling_friction, normal)},
        [](Vector u) ILAW_KIT_LAMBDA { return u; });
    node.impulse = found.slip.against(normal, found.factor);
    node.moment = found.q;
    node.moment.n = twisting_moment(node.spin_free.n, h.j_n, friction_limit(twisting_friction, normal));
    const V part = take_off_positive_work(node, normal * contact.rest.n);
    return select(normal > 0.0, select(found.slides | (part < sticking_part), status::slip, status::stick),
                  status::free);
  }

  // The part s <= 1 of friction and moments may act whose work, half of c2 s^2 + c1 s + r_N rest_N, is not
  // positive: less than all where the motion turned round within the step.
  template <class Node>
  static V take_off_positive_work(Node& node, V normal_work) {
    const auto &r = node.impulse, &m = node.moment;
    const auto gain = node.delassus.times(r, m), spin_gain = node.delassus.spin_of(r, m);
    const auto ends = node.v_free + node.v_previous, spin_ends = node.spin_free + node.spin_previous;
    const V c2 = tangential_product(r, gain) + (tangential_product(m, spin_gain) + m.n * spin_gain.n);
    const V c1 = tangential_product(r, ends) + (tangential_product(m, spin_ends) + m.n * spin_ends.n);
    const auto gains = c2 + c1 + normal_work > 0.0;
    if (!any(gains)) return 1.0;
    const fraction<V> root = root_of_work(c2, c1, smaller(normal_work, 0.0));
    const V part =
        select(gains & (root.numerator < root.denominator), root.numerator / root.denominator, 1.0);
    node.impulse = node.impulse.against(node.impulse.n, -part);
    node.moment = part * node.moment;
    return part;
  }
};

}  // namespace

ILAW_PLUGIN("rolling", "1.0.0", "ilaw", "BSD-3-Clause", rolling)
