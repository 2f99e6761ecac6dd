// Contact with rate-and-state friction. See rate_and_state.md for the equations.
#include <ilaw/kit/changing_friction.hpp>
#include <ilaw/kit/plugin.hpp>

namespace {

using namespace ilaw::kit;

constexpr const char* evolution_choices[] = {"aging", "slip"};
constexpr double slip_law = 1.0;

// a asinh(v/(2 v_0) e^level) over the slip speed v after the step.
template <class V>
struct direct_effect {
  V a, reference_speed, level;

  coefficient<V> operator()(V v) const {
    const coefficient<V> c = regularized_logarithm(a, log(v / (2.0 * reference_speed)) + level);
    return {c.value, c.slope / v};
  }
  // The speed at which friction alone stops the node.
  V start(V most, V drag) const {
    const V z = most / (drag * a);
    const V speed = reference_speed * exp(z - level) * (0.0 - exp_minus_one(-2.0 * z));
    return select(speed < most, speed, most);
  }
};

template <class V>
struct rate_and_state : changing_friction<rate_and_state, direct_effect, V> {
  V friction;
  V direct;
  V evolving;
  V reference_speed;
  V critical_slip;
  V initial_state;
  V restitution;
  double evolution;
  double activation;
  V heat_partition;
  V wear_coefficient;

  static constexpr law_card card{
      .id = "rate_and_state",
      .title = "Contact with rate-and-state friction",
      .doc = "Dry contact whose friction depends on the slip speed and on a state of the surface. Any H.",
      .inputs = reads_gap | reads_v_previous | reads_v_smooth,
      .permissions = may_skip_fresh | may_skip_free,
      .is_isotropic = true};

  static constexpr const char* references[] = {
      "J. H. Dieterich, 1979, Modeling of rock friction: 1. Experimental results and constitutive equations",
      "A. Ruina, 1983, Slip instability and state variable friction laws"};

  static constexpr parameter<rate_and_state> parameters[] = {
      {.member = &rate_and_state::friction,
       .name = "reference_friction",
       .symbol = "f_0",
       .doc = "Coefficient of steady slip at the reference speed.",
       .required = true},
      {.member = &rate_and_state::direct,
       .name = "direct_effect",
       .symbol = "a",
       .doc = "Growth of the coefficient with the logarithm of the speed.",
       .required = true,
       .minimum_excluded = true},
      {.member = &rate_and_state::evolving,
       .name = "evolution_effect",
       .symbol = "b",
       .doc = "Growth of the coefficient with the logarithm of the state.",
       .required = true},
      {.member = &rate_and_state::reference_speed,
       .name = "reference_speed",
       .symbol = "v_0",
       .unit = "m/s",
       .doc = "Speed at which friction is given.",
       .required = true,
       .minimum_excluded = true},
      {.member = &rate_and_state::critical_slip,
       .name = "critical_slip",
       .symbol = "D_c",
       .unit = "m",
       .doc = "Slip over which the state is renewed.",
       .required = true,
       .minimum_excluded = true},
      {.member = &rate_and_state::initial_state,
       .name = "initial_state",
       .symbol = "theta_0",
       .unit = "s",
       .doc = "State at the start; 0: that of steady slip at the reference speed, D_c/v_0."},
      restitution_parameter(&rate_and_state::restitution),
      {.member = &rate_and_state::evolution,
       .name = "evolution",
       .doc = "aging: theta' = 1 - v theta/D_c (Dieterich); slip: -(v theta/D_c) ln(v theta/D_c) (Ruina).",
       .choices = evolution_choices},
      activation_parameter(&rate_and_state::activation),
      heat_partition_parameter(&rate_and_state::heat_partition),
      wear_coefficient_parameter(&rate_and_state::wear_coefficient)};

  struct state {
    V theta;
  };
  static constexpr state_variable<state> state_variables[] = {
      {.member = &state::theta, .name = "theta", .unit = "s", .doc = "Age of the contact.", .minimum = 0.0}};

  template <class Node>
  void initialise(Node& node) const {
    node.state.theta = select(initial_state > 0.0, initial_state, critical_slip / reference_speed);
  }

  std::uint32_t inputs() const { return inputs_of_contact(card.inputs, restitution, activation); }

  template <class Node>
  direct_effect<V> coefficient_in(const Node& node) const {
    const V age = log(middle(node) / (critical_slip / reference_speed));
    return {direct, reference_speed, (friction + zero_unless(evolving > 0.0, evolving * age)) / direct};
  }
  template <class Node>
  void slide(Node& node, V speed) const {
    const V after = aged(middle(node), speed, 0.5 * node.velocity_step);
    node.state.theta = select(node.impulse.n > 0.0, after, node.state.theta);
  }

 private:
  // The state after a time at a speed that does not change.
  V aged(V theta, V speed, double time) const {
    const V rate = speed / critical_slip, x = rate * time, lost = exp_minus_one(-x);
    const V slid = theta * exp(zero_unless(x > 0.0, log(rate * theta) * lost));
    if (evolution == slip_law) return zero_unless(theta > 0.0, slid);
    return theta * (1.0 + lost) + time * select(x > 0.0, -lost / x, 1.0);
  }
  template <class Node>
  V middle(const Node& node) const {
    return aged(node.state.theta, node.v_previous.tangential_length(), 0.5 * node.velocity_step);
  }
};

}  // namespace

ILAW_PLUGIN("rate_and_state", "1.0.0", "ilaw", "BSD-3-Clause", rate_and_state)
