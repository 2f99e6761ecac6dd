// Contact with friction from a table. See table_friction.md for the equations.
#include <ilaw/kit/changing_friction.hpp>
#include <ilaw/kit/plugin.hpp>

namespace {

using namespace ilaw::kit;

constexpr const char* axes_of_friction[] = {"slip_speed", "pressure", "temperature", "time"};

// The coefficient of one node over the slip speed v after the step, linear between the points of the table.
struct curve {
  const grid& friction;
  double pressure, temperature, time;

  double at(double v) const {
    const double quantities[] = {v, pressure, temperature, time};
    return friction.at(quantities);
  }
  // v + drag mu(v) = most: the first solution from the speed before the step on, up where the load exceeds
  // the friction there, else down; 0 where there is none below. Exact, since mu is linear between stops.
  double reached(double most, double drag, double before) const {
    const auto [points, count] = friction.along(0);
    const auto excess = [&](double v) { return (v - most) + drag * at(v); };
    double v = smaller(before, most), here = excess(v);
    const bool speeds_up = here < 0.0;
    std::int64_t k = speeds_up ? 0 : count - 1;
    while (speeds_up ? v < most : v > 0.0 && here != 0.0) {
      while (speeds_up ? k < count && points[k] <= v : k >= 0 && points[k] >= v) k += speeds_up ? 1 : -1;
      const bool has_point = k >= 0 && k < count;
      const double next =
          speeds_up ? smaller(has_point ? points[k] : most, most) : larger(has_point ? points[k] : 0.0, 0.0);
      const double there = excess(next);
      if ((here < 0.0) != (there < 0.0)) return v + (next - v) * (here / (here - there));
      v = next;
      here = there;
    }
    return v;
  }
};

// The quantities of a node and step beside the slip speed; then with the table.
template <class V>
struct conditions {
  V pressure, temperature, time, speed_before;
};
template <class V>
struct coefficient_from_table : conditions<V> {
  grid friction;

  coefficient<V> operator()(V v) const {
    return {each([](const curve& c, double speed) { return c.at(speed); }, v), V(0.0)};
  }
  V speed(V most, V drag) const {
    return each([](const curve& c, double m, double d, double before) { return c.reached(m, d, before); },
                most, drag, this->speed_before);
  }

 private:
  template <class Function, class... Given>
  V each(Function f, Given... given) const {
    return lane_by_lane(
        [&](double p, double t, double now, auto... x) {
          return f(curve{friction, p, t, now}, x...);
        },
        this->pressure, this->temperature, this->time, given...);
  }
};

template <class V>
struct table_friction : changing_friction<table_friction, conditions, V> {
  grid friction;
  V temperature;
  V restitution;
  double activation;
  V heat_partition;
  V wear_coefficient;

  static constexpr law_card card{
      .id = "table_friction",
      .title = "Contact with friction from a table",
      .doc =
          "Signorini-Moreau contact with Coulomb friction whose coefficient is a table over slip speed, pressure, "
          "temperature and time. Any H.",
      .inputs = reads_gap | reads_v_previous | reads_v_smooth | reads_area,
      .permissions = may_skip_fresh | may_skip_free,
      .is_isotropic = true};

  static constexpr const char* references[] = {
      "J.-J. Moreau, 1988, Unilateral contact and dry friction in finite freedom dynamics"};

  static constexpr parameter<table_friction> parameters[] = {
      {.member = &table_friction::friction,
       .name = "friction",
       .symbol = "mu",
       .doc =
           "Coefficient; its axis slip_speed [m/s] is the speed after the step, pressure [Pa] that of the step.",
       .required = true,
       .axes = axes_of_friction},
      {.member = &table_friction::temperature,
       .name = "temperature",
       .symbol = "T",
       .unit = "K",
       .doc = "Temperature of the body at the node.",
       .default_value = 293.15,
       .is_field = true},
      restitution_parameter(&table_friction::restitution),
      activation_parameter(&table_friction::activation),
      heat_partition_parameter(&table_friction::heat_partition),
      wear_coefficient_parameter(&table_friction::wear_coefficient)};

  std::uint32_t inputs() const {
    const std::uint32_t all = friction.along(1).count > 0 ? card.inputs : card.inputs & ~reads_area;
    return inputs_of_contact(all, restitution, activation);
  }

  template <class Node>
  conditions<V> coefficient_in(const Node& node) const {
    return {this->pressure_in(node), temperature, node.time, node.v_previous.tangential_length()};
  }
  coefficient_from_table<V> curve_of(const conditions<V>& given) const { return {given, friction}; }
  template <class Node>
  void slide(const Node& /*node*/, V /*speed*/) const {}
};

}  // namespace

ILAW_PLUGIN("table_friction", "1.0.0", "ilaw", "BSD-3-Clause", table_friction)
