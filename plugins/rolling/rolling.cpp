// Contact of spheres with friction, rolling and twisting resistance. See rolling.md for the equations.
#include <ilaw/kit.hpp>
#include <ilaw/kit/roots.hpp>

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
      .inputs = reads_gap | reads_v_previous,
      .permissions = may_skip_fresh | may_skip_free,
      .is_isotropic = true};

  static constexpr const char* references[] = {
      "V. Acary, F. Bourrier, 2021, Coulomb friction with rolling resistance as a cone complementarity problem",
      "J.-J. Moreau, 1988, Unilateral contact and dry friction in finite freedom dynamics"};

  static constexpr parameter<rolling> parameters[] = {
      friction_parameter(&rolling::friction)
          .with_doc("Coefficient of friction; inf forbids slip while the contact is pressed.")
          .as_required(),
      {.member = &rolling::rolling_friction,
       .name = "rolling_friction",
       .symbol = "rho",
       .unit = "m",
       .doc =
           "Largest rolling moment over the normal force: a coefficient of rolling friction times a radius.",
       .infinity_allowed = true,
       .needs_spins = true},
      {.member = &rolling::twisting_friction,
       .name = "twisting_friction",
       .symbol = "tau",
       .unit = "m",
       .doc = "Largest moment about the normal over the normal force.",
       .infinity_allowed = true,
       .needs_spins = true},
      restitution_parameter(&rolling::restitution),
      activation_parameter(&rolling::activation)};

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

  // Slip and rolling share a block of the tangent plane, v = v_free + h r - k q and u = u_free - k r + j q,
  // with |r| <= mu r_N against v, |q| <= rho r_N against u. With r = -part (v_free - k q), part = 1/(h +
  // lambda), q is one projection and |r| falls with lambda >= 0: one root, of x = |v_free - k q| = mu
  // r_N/part.
  template <class Node, class Vector>
  status_of<V> roll(Node& node, const contact_problem<Vector>& contact) const {
    const auto& h = node.delassus;
    const V normal = pressing_impulse(h, contact);
    const Vector v = node.v_free.tangential_part(), u = node.spin_free.tangential_part();
    const V most_r = friction_limit(friction, normal), most_q = friction_limit(rolling_friction, normal);
    const V by_h = 1.0 / h.t, stuck = h.t * most_r;  // the largest speed that friction stops
    Vector q{}, slip{};
    V speed = stuck;
    const auto trial = [&](V x) ILAW_KIT_LAMBDA {
      const V part = select(x > stuck, most_r / x, by_h), j = h.j_t - (h.k * part) * h.k;
      const Vector f = u + (h.k * part) * v;
      const V length = f.tangential_length();
      q = f.against(0.0, select(length > most_q * j, most_q / length, 1.0 / j));
      slip = v - h.k * q;
      speed = slip.tangential_length();
      return root_trial<V>{x - speed, 1.0, 1.0, 1.0, V(0.0) != V(0.0)};
    };
    trial(stuck);
    if (const mask_of<V> slips = speed > stuck; any(slips))
      root_between(stuck, V(infinity), select(slips, speed, stuck), slips, trial);
    const mask_of<V> slides = speed > stuck;
    node.impulse = slip.against(normal, select(slides, most_r / speed, by_h));
    node.moment = q;
    const V most_twist = friction_limit(twisting_friction, normal), stops = node.spin_free.n / h.j_n;
    node.moment.n = 0.0 - smaller(larger(stops, -most_twist), most_twist);
    const V part = take_off_positive_work(node, normal * contact.rest.n);
    return select(normal > 0.0, select(slides | (part < sticking_part), status::slip, status::stick),
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
