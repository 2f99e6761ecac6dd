// Contact with the friction of rubber. See rubber.md for the equations.
#include <ilaw/kit/changing_friction.hpp>
#include <ilaw/kit/plugin.hpp>

namespace {

using namespace ilaw::kit;

constexpr double ln_10 = 2.302585092994046, lowest_pressure = 1e-6, glass_transition = -50.0;
constexpr double root_of_e = 1.6487212707001282;

// mu_0 + (mu_m - mu_0) exp(-c^2 log10^2(v/v_p)) over the slip speed v after the step.
template <class V>
struct bell {
  V least, rise, peak, square, speed_before;  // square: c^2

  coefficient<V> operator()(V v) const {
    const V moving = larger(v, 0x1p-900), decades = log(moving / peak) / ln_10;
    const V high = rise * exp(-square * (decades * decades));
    return {least + high, -2.0 * (square * decades) * high / (ln_10 * moving)};
  }
  // v + drag mu(v) = most: the first solution from the speed before on. The left side falls between two
  // speeds alone, around the steepest place of the bell, and rises elsewhere.
  V speed(V most, V drag) const {
    const auto excess = [&](V v) ILAW_KIT_LAMBDA { return (v - most) + drag * (*this)(v).value; };
    V top = peak, bottom = peak;
    const V steepest = peak * exp(2.0 * ln_10 / (ln_10 + square_root(ln_10 * ln_10 + 8.0 * square)));
    const mask_of<V> falls = drag * (*this)(steepest).slope < -1.0;
    if (any(falls)) {
      const V far = larger(drag * rise * square_root(2.0 * square) / (root_of_e * ln_10), steepest);
      const auto turn = [&](double sign) {
        return [=, this](V v) {
          const V value = sign * (1.0 + drag * (*this)(v).slope);
          return root_trial<V>{value, 1.0 / steepest, 1.0, steepest, !(v == v)};
        };
      };
      top =
          root_between(peak, steepest, select(falls, square_root(peak * steepest), peak), falls, turn(-1.0));
      bottom =
          root_between(steepest, far, select(falls, square_root(steepest * far), peak), falls, turn(1.0));
    }
    const V start = smaller(speed_before, most);
    const mask_of<V> speeds_up = excess(start) < 0.0;
    const mask_of<V> ends_before = (start < top) & (excess(top) >= 0.0);
    const mask_of<V> ends_behind = (start > bottom) & (excess(bottom) <= 0.0);
    const V low = select(speeds_up, select(ends_before, start, smaller(larger(start, bottom), most)),
                         zero_unless(ends_behind, bottom));
    const V high =
        select(speeds_up, select(ends_before, top, most), select(ends_behind, start, smaller(start, top)));
    const mask_of<V> slips = (low > 0.0) | (excess(V(0.0)) < 0.0);
    const auto trial = [&](V v) ILAW_KIT_LAMBDA {
      const coefficient<V> c = (*this)(v);
      return root_trial<V>{(v - most) + drag * c.value, 1.0, 1.0 + drag * c.slope, 1.0, slips};
    };
    return zero_unless(slips, root_between(larger(low, 0x1p-900 * most), high, high, slips, trial));
  }
};

template <class V>
struct rubber : changing_friction<rubber, bell, V> {
  V static_friction;
  V peak_friction;
  V peak_speed;
  V width;
  V temperature;
  V reference_temperature;
  V pressure_exponent;
  V reference_pressure;
  V restitution;
  double activation;

  static constexpr law_card card{
      .id = "rubber",
      .title = "Contact with the friction of rubber",
      .doc =
          "Dry contact whose friction has a peak over the slip speed, which the temperature shifts, and falls with "
          "the pressure. Any H.",
      .inputs = reads_gap | reads_v_previous | reads_area,
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
      activation_parameter(&rubber::activation)};

  std::uint32_t inputs() const { return pressure_exponent > 0.0 ? card.inputs : card.inputs & ~reads_area; }

  template <class Node>
  bell<V> coefficient_in(const Node& node) const {
    const V above = larger(temperature - reference_temperature, glass_transition);
    V factor = 1.0;
    if (any(pressure_exponent > 0.0)) {
      const V pressure = larger(this->pressure_in(node) / reference_pressure, lowest_pressure);
      factor = select(pressure_exponent > 0.0, exp(-pressure_exponent * log(pressure)), 1.0);
    }
    return {factor * static_friction, factor * positive_part(peak_friction - static_friction),
            peak_speed * exp(ln_10 * 8.86 * above / (101.5 + above)), width * width,
            node.v_previous.tangential_length()};
  }
  template <class Node>
  void slide(const Node& /*node*/, V /*speed*/) const {}
};

}  // namespace

ILAW_PLUGIN("rubber", "1.0.0", "ilaw", "BSD-3-Clause", rubber)
