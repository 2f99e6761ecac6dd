// Contact that conducts heat. See conductance.md for the equations.
#include <ilaw/kit.hpp>

namespace {

using namespace ilaw::kit;

template <class V>
struct conductance {
  V constant, per_pressure;
  V temperature, counterpart_temperature, heat_capacity, counterpart_heat_capacity;
  V restitution;
  double activation;

  static constexpr law_card card{
      .id = "conductance",
      .title = "Contact that conducts heat",
      .doc =
          "Frictionless contact through which heat flows with the difference of temperature, by a conductance that "
          "may grow with the pressure.",
      .inputs = reads_gap | reads_v_previous | reads_v_smooth | reads_area,
      .permissions = may_skip_fresh | may_skip_free,
      .is_isotropic = true};

  static constexpr const char* references[] = {
      "M. G. Cooper, B. B. Mikic, M. M. Yovanovich, 1969, Thermal contact conductance",
      "J.-J. Moreau, 1988, Unilateral contact and dry friction in finite freedom dynamics"};

  static constexpr parameter<conductance> field(V conductance::*member, const char* name, const char* symbol,
                                                const char* unit, const char* doc, double value) {
    parameter<conductance> made{member, name, symbol, unit, doc, value};
    made.is_field = true;
    made.infinity_allowed = value == infinity;
    made.minimum_excluded = value == infinity;
    return made;
  }
  static constexpr parameter<conductance> parameters[] = {
      {&conductance::constant, "conductance", "h_0", "W/m^2/K", "Heat flow per area and difference."},
      {&conductance::per_pressure, "conductance_per_pressure", "h_p", "W/N/K",
       "Growth of the conductance with the pressure."},
      field(&conductance::temperature, "temperature", "T", "K", "Of the body at the node.", 293.0),
      field(&conductance::counterpart_temperature, "counterpart_temperature", "T_c", "K",
            "Of the counterpart at the node.", 293.0),
      field(&conductance::heat_capacity, "heat_capacity", "C", "J/K",
            "Of the body's node: no step passes its equilibrium with the counterpart.", infinity),
      field(&conductance::counterpart_heat_capacity, "counterpart_heat_capacity", "C_c", "J/K",
            "Of the counterpart's part at the node.", infinity),
      restitution_parameter(&conductance::restitution),
      activation_parameter(&conductance::activation)};

  static constexpr amount_card amounts[] = {
      {.name = "conducted_heat", .unit = "J", .doc = "Flows from the counterpart into the body in the step."},
      {.name = "heat_per_kelvin",
       .unit = "J/K",
       .doc = "The same over the difference of temperature, if both stay as they are."}};

  std::uint32_t inputs() const {
    return inputs_of_contact(constant > 0.0 ? card.inputs : card.inputs & ~reads_area, restitution,
                             activation);
  }

  template <class Node>
  status_of<V> step(Node& node) const {
    const contact_problem contact =
        contact_problem_of(contact_at(node, restitution, activation), node.v_free, node.v_previous);
    node.impulse.n = pressing_impulse(node.delassus, contact);
    const mask_of<V> touches = node.impulse.n > 0.0;
    if (node.wants_energy) {
      const V flow = zero_unless(touches, heat_per_kelvin(node));
      node.amounts[0] = conducted(flow);
      node.amounts[1] = flow;
    }
    return select(touches, status::closed, status::free);
  }

 private:
  // G h = h_0 A h + h_p r_N.
  template <class Node>
  V heat_per_kelvin(const Node& node) const {
    const V by_area = zero_unless(constant > 0.0, constant * node.area * node.velocity_step);
    return by_area + per_pressure * node.impulse.n;
  }
  // (T_c - T) (1 - e^-x)/c with x = c G h and c = 1/C + 1/C_c, the exchange of two capacities over the step;
  // (T_c - T) G h where both are infinite.
  V conducted(V flow) const {
    const V c = 1.0 / heat_capacity + 1.0 / counterpart_heat_capacity;
    const V exchanged = -exp_minus_one(-(flow * c)) / select(c > 0.0, c, 1.0);
    const V per_kelvin = select(c > 0.0, exchanged, flow);
    const V difference = counterpart_temperature - temperature;
    // A flow that overflows in a huge step times no difference would be NaN.
    return zero_unless((per_kelvin > 0.0) & (difference != 0.0), difference * per_kelvin);
  }
};

}  // namespace

ILAW_PLUGIN("conductance", "1.0.0", "ilaw", "BSD-3-Clause", conductance)
