// Elastic grains that adhere, rub by Mindlin's spring, and resist rolling. See grain.md for the equations.
#include "contact_circle.hpp"

#include <ilaw/kit/law.hpp>
#include <ilaw/kit/plugin.hpp>
#include <ilaw/kit/rolling.hpp>
#include <ilaw/kit/tangential_spring.hpp>

namespace {

using namespace ilaw::kit;
using namespace grain_law;

constexpr const char* adhesion_choices[] = {"jkr", "dmt"};
constexpr double jkr = 0.0;

template <class V>
struct grain {
  V radius;
  V modulus;
  V adhesion_energy;
  double adhesion;
  V viscous_time;
  V friction;
  V shear_modulus;
  V rolling_friction;
  V twisting_friction;
  V heat_partition;
  V wear_coefficient;

  static constexpr law_card card{
      .id = "grain",
      .title = "Elastic grains with adhesion, friction and rolling resistance",
      .doc =
          "Hertz's contact of spheres with the adhesion of JKR or DMT, viscosity, Mindlin's tangential spring, and "
          "moments that resist rolling and twisting; implicit, so that no stiffness limits the step. H of "
          "spheres, with or without spins.",
      .delassus_forms = ILAW_DELASSUS_SCALAR | ILAW_DELASSUS_TRANSVERSE | with_spins,
      .inputs = reads_gap | reads_v_previous,
      .capabilities = can_adhere | can_store_energy,
      .permissions = may_skip_fresh | may_skip_free,
      .gives_rupture = true};

  static constexpr const char* references[] = {
      "K. L. Johnson, K. Kendall, A. D. Roberts, 1971, Surface energy and the contact of elastic solids",
      "B. V. Derjaguin, V. M. Muller, Y. P. Toporov, 1975, Effect of contact deformations on adhesion",
      "R. D. Mindlin, 1949, Compliance of elastic bodies in contact",
      "N. V. Brilliantov, F. Spahn, J.-M. Hertzsch, T. Poeschel, 1996, Model for collisions in granular gases"};

  static constexpr parameter<grain> parameters[] = {
      {.member = &grain::radius,
       .name = "radius",
       .symbol = "R",
       .unit = "m",
       .doc = "1/R = 1/R_1 + 1/R_2 of the two grains.",
       .required = true,
       .minimum_excluded = true},
      {.member = &grain::modulus,
       .name = "modulus",
       .symbol = "E",
       .unit = "Pa",
       .doc = "1/E = (1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2.",
       .required = true,
       .minimum_excluded = true},
      {.member = &grain::adhesion_energy,
       .name = "adhesion_energy",
       .symbol = "w",
       .unit = "J/m^2",
       .doc = "Energy that parts the surfaces, per area."},
      {.member = &grain::adhesion,
       .name = "adhesion",
       .doc = "jkr: soft grains, whose neck breaks late; dmt: stiff grains, which part where they touched.",
       .choices = adhesion_choices},
      {.member = &grain::viscous_time,
       .name = "viscous_time",
       .symbol = "A",
       .unit = "s",
       .doc = "Viscous force over the elastic stiffness and the speed."},
      friction_parameter(&grain::friction),
      {.member = &grain::shear_modulus,
       .name = "shear_modulus",
       .symbol = "G",
       .unit = "Pa",
       .doc = "1/G = (2 - nu_1)/G_1 + (2 - nu_2)/G_2; needed with friction."},
      rolling_friction_parameter(&grain::rolling_friction),
      twisting_friction_parameter(&grain::twisting_friction),
      heat_partition_parameter(&grain::heat_partition),
      wear_coefficient_parameter(&grain::wear_coefficient)};

  struct state {
    V growth;
    tangential_vector<V> spring;
  };
  static constexpr state_variable<state> state_variables[] = {
      {&state::growth, "growth", "m",
       "Radius of the circle of contact, less that when the surfaces met; 0: no contact."},
      {&state::spring, "spring", "m", "Elastic part of the slip."}};

  const char* conflict() const {
    return friction > 0.0 && !(shear_modulus > 0.0)
               ? "parameter 'shear_modulus' must be above 0 with 'friction'"
               : nullptr;
  }

  // The scales of adhesion, in units of R and E.
  adhesion_scale<V> prepare(const step_sizes& /*step*/) const {
    constexpr double two_pi = 6.283185307179586;
    const V square = two_pi * adhesion_energy / (modulus * radius);
    return adhesion == jkr ? adhesion_scale<V>::jkr(square) : adhesion_scale<V>::dmt(square);
  }

  using problem = circle_step<V>;
  // The normal force in units of E R^2, and z less that at first touch before and after the step: 0 where
  // there is no contact.
  struct answer {
    V force, before, after;
  };
  template <class Node>
  asked<V> ask(Node& node, problem& p) const {
    p = problem_of(node);
    const mask_of<V> held = is_held(node), breaks = held & p.breaks();
    const mask_of<V> arrives = (!held) & !is_out_of_reach(node) & (p.apart + p.travel < 0.0);
    const answer parted{zero_unless(breaks, p.force_of_break()), p.grown, V(0.0)};
    return {(held & !breaks) | arrives, give(node, parted, breaks)};
  }
  mask_of<V> solve(const problem& p, answer& a) const {
    const V growth = p.solve();
    a = {p.force_of(p.by(growth)), p.grown, p.grown + growth};
    return !(absolute(growth) < infinity);
  }
  void solve_scalar(const problem& p, answer& a) const { solve(p, a); }
  template <class Node>
  status_of<V> finish(Node& node, const answer& a) const {
    return give(node, a, none<V>());
  }

 private:
  template <class Node>
  mask_of<V> is_held(const Node& node) const {
    return node.state.growth != 0.0;
  }
  // The radius of the circle before the step, never below the least: parameters may have changed.
  template <class Node>
  V circle_of(const Node& node) const {
    const adhesion_scale<V>& scale = node.prepared;
    const V circle = radius * (scale.touch * scale.touch) + node.state.growth;
    return zero_unless(is_held(node), larger(circle, radius * (scale.least * scale.least)));
  }
  template <class Node>
  problem problem_of(const Node& node) const {
    const V h = node.velocity_step, half_way = 0.5 * h / radius;
    const adhesion_scale<V>& scale = node.prepared;
    const V z = square_root(circle_of(node) / radius), least = scale.least - scale.touch;
    const V grown = larger(node.state.growth / radius / (z + scale.touch), least);
    const V gap = node.gap - 0.5 * node.position_step * node.v_previous.n;
    const mask_of<V> held = is_held(node);
    return {.scale = scale,
            .grown = zero_unless(held, grown),
            .apart = zero_unless(!held, positive_part(gap / radius)),
            .travel = half_way * (node.v_previous.n + node.v_free.n),
            .give = half_way * h * node.delassus.normal() * modulus * radius * radius,
            .viscosity = 2.0 * viscous_time / h};
  }
  template <class Node>
  status_of<V> give(Node& node, const answer& a, mask_of<V> breaks) const {
    const V h = node.velocity_step, unit = modulus * radius * radius, size = unit * radius;
    const adhesion_scale<V>& scale = node.prepared;
    const V stiffness_before = 8.0 * shear_modulus * circle_of(node);
    const vector<V> before = node.state.spring;
    const mask_of<V> adheres = adhesion_energy > 0.0, touches = a.after != 0.0;
    node.impulse = {h * unit * a.force, 0.0, 0.0};
    node.state.growth = radius * (a.after * (a.after + 2.0 * scale.touch));
    const V stiffness = zero_unless(friction > 0.0, 8.0 * shear_modulus * circle_of(node));
    const V pressure = positive_part(zero_unless(touches, h * unit * (a.force + 2.0 * scale.pull)));
    const mask_of<V> slides = rub_on(node, pressure, stiffness_before, stiffness);
    if (node.wants_energy) {
      const V old = scale.energy(a.before), now = scale.energy(a.after);
      const V lost = zero_unless(breaks, scale.lost);
      const vector<V> spring = node.state.spring;
      const V strained = 0.5 * stiffness * tangential_product(spring, spring);
      node.normal_gain = size * (select(breaks, lost, now) - old);
      node.rupture = zero_unless(lost > 0.0, size * lost);
      node.tangential_gain = strained - 0.5 * stiffness_before * tangential_product(before, before);
      node.stored = size * now + strained;
    }
    const status_of<V> rubbed =
        select(friction > 0.0, select(slides, status::slip, status::stick), status::closed);
    const status_of<V> touching = select(touches | (node.impulse.n > 0.0), rubbed, status::free);
    return select(adheres, select(breaks, status::broken, select(touches, status::bonded, status::free)),
                  touching);
  }
  // Tangential impulse, moment and Mindlin's spring after the step; says where the node slips.
  template <class Node>
  mask_of<V> rub_on(Node& node, V pressure, V stiffness_before, V stiffness) const {
    using mindlin = tangential_spring<V>;
    const double h = node.velocity_step;
    const mask_of<V> acts = (friction > 0.0) & mindlin::counts(h, stiffness);
    if constexpr (!has_spins<Node>)
      if (!any(acts)) {
        node.state.spring = {};
        return acts;
      }
    const mindlin tangent(h, stiffness, acts, acts);
    // A spring that grows stiffer keeps its force, one that grows softer its length: neither makes energy.
    const V kept = select(stiffness > stiffness_before, stiffness_before / stiffness, V(1.0));
    const vector<V> before = node.state.spring, spring = zero_unless(acts, kept * before);
    const V rubbed = zero_unless(acts, pressure);
    mask_of<V> slides = acts;
    vector<V> v;
    if constexpr (has_spins<Node>) {
      slides = acts & roll(node, tangent, spring, rubbed, pressure);
      v = node.v_free + node.delassus.times(node.impulse, node.moment);
    } else {
      slides = acts & tangent.rub(node, node.impulse.n, spring, rubbed, friction);
      v = node.v_free + node.delassus.times(node.impulse);
    }
    const vector<V> next =
        tangent.strained(spring, node.impulse, node.v_previous + v, node.delassus.tangential(),
                         friction_limit(friction, pressure), slides, acts);
    node.state.spring = {next.t1, next.t2};
    return slides;
  }
  // H couples friction on the spring and rolling; twisting stands alone.
  template <class Node>
  mask_of<V> roll(Node& node, const tangential_spring<V>& tangent, vector<V> spring, V rubbed,
                  V pressure) const {
    const auto& h = node.delassus;
    const auto found = solve_rolling<V, vector<V>>(
        {h.t + tangent.softness, h.k, h.j_t, tangent.slip(node, spring, 0.0).tangential_part(),
         node.spin_free.tangential_part(), friction_limit(friction, rubbed),
         friction_limit(rolling_friction, pressure)},
        motion_to_resist<V, vector<V>>(node.spin_previous));
    node.impulse = found.slip.against(node.impulse.n, found.factor);
    node.moment = found.q;
    node.moment.n = twisting_moment(spin_to_resist(node.spin_free.n, node.spin_previous.n), h.j_n,
                                    friction_limit(twisting_friction, pressure));
    return found.slides;
  }
};

}  // namespace

ILAW_PLUGIN("grain", "1.0.0", "ilaw", "BSD-3-Clause", grain)
