// Contact with the friction of rubber. See rubber.md for the equations.
#include <ilaw/kit/changing_friction.hpp>
#include <ilaw/kit/plugin.hpp>

namespace {

using namespace ilaw::kit;

constexpr double ln_10 = 2.302585092994046, ln_2 = 0.6931471805599453;
constexpr double lowest_pressure = 1e-6, glass_transition = -50.0, largest = 1e300;

// mu_0 + (mu_m - mu_0) exp(-k x^2) over x = ln(v/v_p), v the slip speed after the step.
template <class V>
struct bell {
  V least, rise, peak, k, speed_before;

  coefficient<V> operator()(V v) const {
    const V moving = larger(v, 0x1p-900), x = log(moving / peak), high = rise * exp(-k * (x * x));
    return {least + high, -2.0 * (k * x) * high / moving};
  }
  // v + drag mu(v) = most, the first solution from the speed before on: v_p e^x + height e^(-k x^2) = rest.
  // The left side rises with x but between top and bottom.
  V speed(V most, V drag) const {
    const V rest = most - drag * least, height = drag * rise;
    const mask_of<V> slips = rest > 0.0;
    const auto excess = [&](V x) ILAW_KIT_LAMBDA {
      const V v = peak * exp(x), high = height * exp(-k * (x * x));
      return value_and_slope<V>{(v - rest) + high, v - 2.0 * (k * x) * high};
    };
    const auto [top, bottom] = turns(height);
    const V before = log(larger(speed_before, 0x1p-900) / peak);
    const mask_of<V> is_fast = excess(smaller(larger(before, top), bottom)).value < 0.0;
    const mask_of<V> is_slow = (!is_fast) & ((peak - rest) + height >= 0.0);  // before the peak
    // There the bell is between rest/2 and rest, or v is.
    const auto flank = [&](double part) { return square_root(positive_part(log(part * height / rest)) / k); };
    const V end = log(smaller(rest / peak, largest));
    V low = select(is_fast, bottom, select(is_slow, smaller(-flank(2.0), end - ln_2), V(0.0)));
    V high = select(is_fast, end, select(is_slow, smaller(-flank(1.0), smaller(end, 0.0)), top));
    return zero_unless(slips, peak * exp(newton_between(low, high, slips, excess)));
  }

 private:
  struct pair {
    V first, second;
  };
  // The zeros of h(x) = x + k x^2 - ln(x steep), convex with its minimum at 2/(1 + sqrt(1 + 8 k)), by
  // Newton's steps from outside. Both 0 where it has none.
  pair turns(V height) const {
    const V steep = smaller(2.0 * k * height / peak, largest);
    const V middle = 2.0 / (1.0 + square_root(1.0 + 8.0 * k));
    const auto h = [&](V x) ILAW_KIT_LAMBDA { return x + k * (x * x) - log(x * steep); };
    const mask_of<V> falls = h(middle) < 0.0;
    if (!any(falls)) return {0.0, 0.0};
    const V reach = square_root(positive_part(-2.0 * h(middle)) / (1.0 / (middle * middle) + 2.0 * k));
    pair at{larger(middle - reach, 1.0 / steep), middle + reach};
    for (int step = 0; step < 6; ++step)
      for (V* x : {&at.first, &at.second}) *x = *x - h(*x) / (1.0 + 2.0 * k * *x - 1.0 / *x);
    return {zero_unless(falls, at.first), zero_unless(falls, at.second)};
  }
};

template <class V>
struct rubber : changing_friction<rubber, bell, V> {
  V static_friction, peak_friction, peak_speed, width;
  V temperature, reference_temperature, pressure_exponent, reference_pressure;
  V restitution, heat_partition, wear_coefficient;
  double activation;

  static constexpr law_card card{
      .id = "rubber",
      .title = "Contact with the friction of rubber",
      .doc =
          "Friction with a peak over the slip speed, shifted by the temperature, that falls with the pressure. Any H.",
      .inputs = reads_gap | reads_v_previous | reads_v_smooth | reads_area,
      .permissions = may_skip_fresh | may_skip_free,
      .is_isotropic = true};

  static constexpr const char* references[] = {
      "M. L. Williams, R. F. Landel, J. D. Ferry, 1955, The temperature dependence of relaxation mechanisms",
      "K. A. Grosch, 1963, The relation between the friction and visco-elastic properties of rubber",
      "A. R. Savkoor, 1965, On the friction of rubber"};

  using own = parameter<rubber>;  // member, name, symbol, unit, doc, default, minimum, maximum
  static constexpr own parameters[] = {
      own{&rubber::static_friction, "static_friction", "mu_0", "1", "Coefficient far from the peak."}
          .as_required(),
      own{&rubber::peak_friction, "peak_friction", "mu_m", "1", "At the peak; below mu_0: none."}
          .as_required(),
      own{&rubber::peak_speed, "peak_speed", "v_m", "m/s", "Of the peak at T_s.", 1.0, 1e-30}.as_required(),
      own{&rubber::width, "width", "c", "1", "1/c decades beside the peak 1/e of it is left.", 0.5, 1e-3,
          1e3},
      {.member = &rubber::temperature,
       .name = "temperature",
       .symbol = "T",
       .unit = "K",
       .doc = "Temperature of the rubber at the node.",
       .default_value = 293.0,
       .is_field = true},
      own{&rubber::reference_temperature, "reference_temperature", "T_s", "K", "T_g + 50 K.", 293.0},
      own{&rubber::pressure_exponent, "pressure_exponent", "n", "1", "It falls as p^-n.", 0.0, 0.0, 1.0},
      own{&rubber::reference_pressure, "reference_pressure", "p_0", "Pa", "Of mu_0 and mu_m.", 1e5, 1e-6},
      restitution_parameter(&rubber::restitution),
      activation_parameter(&rubber::activation),
      heat_partition_parameter(&rubber::heat_partition),
      wear_coefficient_parameter(&rubber::wear_coefficient)};

  std::uint32_t inputs() const {
    const std::uint32_t all = pressure_exponent > 0.0 ? card.inputs : card.inputs & ~reads_area;
    return inputs_of_contact(all, restitution, activation);
  }

  template <class Node>
  bell<V> coefficient_in(const Node& node) const {
    const V above = larger(temperature - reference_temperature, glass_transition);
    V factor = 1.0;
    if (any(pressure_exponent > 0.0)) {
      const V pressure = larger(this->pressure_in(node) / reference_pressure, lowest_pressure);
      factor = select(pressure_exponent > 0.0, exp(-pressure_exponent * log(pressure)), 1.0);
    }
    return {factor * static_friction, factor * positive_part(peak_friction - static_friction),
            peak_speed * exp(ln_10 * 8.86 * above / (101.5 + above)), width * width / (ln_10 * ln_10),
            node.v_previous.tangential_length()};
  }
  template <class Node>
  void slide(const Node& /*node*/, V /*speed*/) const {}
};

}  // namespace

ILAW_PLUGIN("rubber", "1.0.0", "ilaw", "BSD-3-Clause", rubber)
