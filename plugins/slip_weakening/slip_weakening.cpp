// Contact with friction that weakens with the slip. See slip_weakening.md for the equations.
#include <ilaw/kit/changing_friction.hpp>
#include <ilaw/kit/plugin.hpp>

namespace {

using namespace ilaw::kit;

// mu_s - (mu_s - mu_d) min((rest + rate v)/D_c, 1) over the slip speed v after the step.
template <class V>
struct weakening {
  V friction, dynamic, rest, rate, critical_slip;

  coefficient<V> operator()(V v) const {
    const V part = (rest + rate * v) / critical_slip, drop = friction - dynamic;
    const auto weakens = part < 1.0;
    return {select(weakens, friction - drop * part, dynamic),
            zero_unless(weakens, -(drop * rate) / critical_slip)};
  }
};

template <class V>
struct slip_weakening : changing_friction<slip_weakening, weakening, V> {
  V friction;
  V dynamic_friction;
  V critical_slip;
  V initial_slip;
  V restitution;
  double activation;
  V heat_partition;
  V wear_coefficient;

  static constexpr law_card card{
      .id = "slip_weakening",
      .title = "Contact with slip-weakening friction",
      .doc =
          "Signorini-Moreau contact with Coulomb friction whose coefficient falls linearly with the slip, from static "
          "to dynamic over a critical slip. Any H.",
      .inputs = reads_gap | reads_v_previous | reads_v_smooth,
      .permissions = may_skip_fresh | may_skip_free,
      .is_isotropic = true};

  static constexpr const char* references[] = {
      ("Y. Ida, 1972, Cohesive force across the tip of a longitudinal-shear crack and Griffith's specific surface "
       "energy"),
      "D. J. Andrews, 1976, Rupture velocity of plane strain shear cracks",
      "L. A. Dalguer, S. M. Day, 2007, Staggered-grid split-node method for spontaneous rupture simulation"};

  static constexpr parameter<slip_weakening> parameters[] = {
      {.member = &slip_weakening::friction,
       .name = "friction",
       .symbol = "mu_s",
       .doc = "Static coefficient, before any slip.",
       .required = true},
      {.member = &slip_weakening::dynamic_friction,
       .name = "dynamic_friction",
       .symbol = "mu_d",
       .doc = "Coefficient from the critical slip on; above friction there is no fall.",
       .required = true},
      {.member = &slip_weakening::critical_slip,
       .name = "critical_slip",
       .symbol = "D_c",
       .unit = "m",
       .doc = "Slip over which the coefficient falls; inf: it stays static.",
       .required = true,
       .minimum_excluded = true,
       .infinity_allowed = true},
      {.member = &slip_weakening::initial_slip,
       .name = "initial_slip",
       .symbol = "s_0",
       .unit = "m",
       .doc = "Slip at the start."},
      restitution_parameter(&slip_weakening::restitution),
      activation_parameter(&slip_weakening::activation),
      heat_partition_parameter(&slip_weakening::heat_partition),
      wear_coefficient_parameter(&slip_weakening::wear_coefficient)};

  struct state {
    V slip;
  };
  static constexpr state_variable<state> state_variables[] = {
      {.member = &state::slip,
       .name = "slip",
       .unit = "m",
       .doc = "Length of the path slipped while pressed.",
       .minimum = 0.0}};

  template <class Node>
  void initialise(Node& node) const {
    node.state.slip = initial_slip;
  }

  std::uint32_t inputs() const { return inputs_of_contact(card.inputs, restitution, activation); }

  // At the mean slip of the step, s^- + h (|v_T^-| + v)/4.
  template <class Node>
  weakening<V> coefficient_in(const Node& node) const {
    const V quarter = 0.25 * node.velocity_step;
    return {friction, smaller(dynamic_friction, friction),
            node.state.slip + quarter * node.v_previous.tangential_length(), quarter, critical_slip};
  }
  template <class Node>
  void slide(Node& node, V speed) const {
    const auto pressed = node.impulse.n > 0.0;
    const V path = 0.5 * node.velocity_step * (node.v_previous.tangential_length() + speed);
    node.state.slip = node.state.slip + zero_unless(pressed, path);
  }
};

}  // namespace

ILAW_PLUGIN("slip_weakening", "1.0.0", "ilaw", "BSD-3-Clause", slip_weakening)
