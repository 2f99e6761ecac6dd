// Elastic grains that adhere, and rub by Mindlin's spring. See grain.md for the equations.
#include "contact_circle.hpp"

#include <ilaw/kit/friction.hpp>
#include <ilaw/kit/heat.hpp>
#include <ilaw/kit/plugin.hpp>

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
  V heat_partition;
  V wear_coefficient;

  static constexpr law_card card{
      .id = "grain",
      .title = "Elastic grains with adhesion and friction",
      .doc =
          "Hertz's contact of spheres with the adhesion of JKR or DMT, viscosity, and Mindlin's tangential "
          "spring; implicit, so that no stiffness limits the step. H of spheres.",
      .delassus_forms = ILAW_DELASSUS_SCALAR | ILAW_DELASSUS_TRANSVERSE,
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
  struct answer {
    V growth;
  };
  template <class Node>
  asked<V> ask(Node& node, problem& p) const {
    p = problem_of(node);
    const mask_of<V> held = is_held(node), breaks = held & p.breaks();
    const mask_of<V> arrives = (!held) & !is_out_of_reach(node) & (p.apart + p.travel < 0.0);
    return {(held & !breaks) | arrives,
            give(node, p, zero_unless(breaks, p.force_of_break()), V(0.0), breaks)};
  }
  mask_of<V> solve(const problem& p, answer& a) const {
    a.growth = p.solve();
    return !(absolute(a.growth) < infinity);
  }
  void solve_scalar(const problem& p, answer& a) const { a.growth = p.solve(); }
  template <class Node>
  status_of<V> finish(Node& node, const answer& a) const {
    const problem p = problem_of(node);
    return give(node, p, p.by(a.growth).force, p.grown + a.growth, p.apart < 0.0);
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
  // The normal force in units of E R^2, and how much more than at first touch z is, 0 where there is no
  // contact.
  template <class Node>
  status_of<V> give(Node& node, const problem& p, V force, V grown, mask_of<V> breaks) const {
    const V h = node.velocity_step, unit = modulus * radius * radius, size = unit * radius;
    const V stiffness_before = 8.0 * shear_modulus * circle_of(node), touch = p.scale.touch;
    const vector<V> before = node.state.spring;
    const mask_of<V> adheres = adhesion_energy > 0.0, touches = grown != 0.0;
    node.impulse = {h * unit * force, 0.0, 0.0};
    node.state.growth = radius * (grown * (grown + 2.0 * touch));
    mask_of<V> slides = radius < 0.0;
    V stiffness = 0.0;
    vector<V> spring{};
    if (any(friction > 0.0)) {
      stiffness = 8.0 * shear_modulus * circle_of(node);
      // A spring that grows stiffer keeps its force, one that grows softer its length: neither makes energy.
      const V kept = select(stiffness > stiffness_before, stiffness_before / stiffness, V(1.0));
      spring = zero_unless(touches & (friction > 0.0), kept * before);
      slides = rub_on(node, h * unit * (force + 2.0 * p.scale.pull), stiffness, spring);
    }
    node.state.spring = {spring.t1, spring.t2};
    if (node.wants_energy) {
      const V old = p.scale.energy(p.grown), now = p.scale.energy(grown);
      const V lost = zero_unless(breaks, p.scale.lost);
      const V strained = 0.5 * stiffness * tangential_product(spring, spring);
      node.normal_gain = size * (select(breaks, lost, now) - old);
      node.rupture = size * lost;
      node.tangential_gain = strained - 0.5 * stiffness_before * tangential_product(before, before);
      node.stored = size * now + strained;
    }
    const status_of<V> rubbed =
        select(friction > 0.0, select(slides, status::slip, status::stick), status::closed);
    const status_of<V> touching = select(touches | (node.impulse.n > 0.0), rubbed, status::free);
    return select(adheres, select(breaks, status::broken, select(touches, status::bonded, status::free)),
                  touching);
  }
  // Mindlin's spring over the step, at most friction times the pressure; says where it slips.
  template <class Node>
  mask_of<V> rub_on(Node& node, V pressure, V stiffness, vector<V>& spring) const {
    const V h = node.velocity_step, rate = h * stiffness, h_t = node.delassus.tangential();
    const mask_of<V> acts = rate >= std::numeric_limits<double>::min();
    const V normal = node.impulse.n, resistance = h_t + zero_unless(acts, 4.0 / (h * rate));
    const vector<V> q = node.v_free + node.v_previous + (4.0 / h) * spring;
    const auto found = rub(resistance, zero_unless(acts, positive_part(pressure)),
                           q.scaled_tangential_length(), V(0.0), V(0.0), friction);
    node.impulse = q.against(normal, zero_unless(acts, found.factor));
    const mask_of<V> slides = acts & (found.status == status::slip);
    const vector<V> v = node.v_free + node.delassus.times(node.impulse);
    const vector<V> moved = spring + (0.5 * h) * (node.v_previous + v);
    const V most = friction_limit(friction, pressure) / rate, length = moved.tangential_length();
    spring = zero_unless(acts, select(slides & (length > most), most / length, V(1.0)) * moved);
    spring.n = 0.0;
    return slides;
  }
};

}  // namespace

ILAW_PLUGIN("grain", "1.0.0", "ilaw", "BSD-3-Clause", grain)
