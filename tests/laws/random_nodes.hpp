// random_nodes.hpp - many interface nodes at random, stepped through the ABI as they are, in other units, in
// other axes, or in a mirror.
#pragma once

#include "support/law_batch.hpp"
#include "support/law_cases.hpp"

#include <cstring>
#include <regex>
#include <sstream>
#include <tuple>

namespace ilaw::testing {

// Units as powers of two, which change no digit. A length of 4^k keeps its root one, for Hertz's stiffness.
struct Units {
  double mass = 1.0, length = 1.0, time = 1.0;

  double velocity() const { return length / time; }
  double impulse() const { return mass * velocity(); }
  double energy() const { return impulse() * velocity(); }

  // The unit of a parameter as declared, say N.s/m^2 or N/m^p; exponents: the values of letters like p.
  double of(const std::string& unit, const std::map<std::string, double>& exponents) const {
    const double force = mass * length / (time * time);
    const std::map<std::string, double> known = {{"1", 1.0},
                                                 {"kg", mass},
                                                 {"m", length},
                                                 {"s", time},
                                                 {"N", force},
                                                 {"J", force * length},
                                                 {"K", 1.0},
                                                 {"Pa", force / (length * length)},
                                                 {"W", force * length / time}};
    double product = 1.0;
    bool divides = false;
    std::istringstream factors(std::regex_replace(unit, std::regex("[./]"), " $& "));
    for (std::string factor; factors >> factor;) {
      if (factor == "." || factor == "/") {
        divides = factor == "/";
        continue;
      }
      const std::size_t caret = factor.find('^');
      const std::string base = factor.substr(0, caret),
                        power = caret == std::string::npos ? "1" : factor.substr(caret + 1);
      const double exponent = exponents.contains(power) ? exponents.at(power) : std::stod(power);
      product *= std::pow(known.at(base), divides ? -exponent : exponent);
    }
    return product;
  }
};

// A law's parameters in other units, by the units that its description declares.
inline Parameters in_units(const std::string& law, Parameters parameters, const Units& units) {
  const ilaw::library library(plugin_file(law));
  const ilaw_law& description = *library.law(law);
  std::map<std::string, double> exponents;
  for (std::uint32_t k = 0; k < description.parameter_count; ++k) {
    const ilaw_parameter& parameter = *description.parameters[k];
    const auto given = parameters.numbers.find(parameter.name);
    exponents[parameter.symbol] = given == parameters.numbers.end() ? parameter.default_value : given->second;
  }
  for (std::uint32_t k = 0; k < description.parameter_count; ++k) {
    const ilaw_parameter& parameter = *description.parameters[k];
    if (parameters.numbers.contains(parameter.name))
      parameters.numbers[parameter.name] *= units.of(parameter.unit, exponents);
  }
  return parameters;
}

// Which H a law is given: any of its form, or one without coupling and with equal tangential entries, written
// in that form.
enum class Inertia { any, isotropic };

inline Inertia inertia_of(const LawCase& given) {
  return given.more.value("inertia", "any") == "isotropic" ? Inertia::isotropic : Inertia::any;
}

// Each case in each form of H that its law serves, in 2D and 3D.
using Combination = std::tuple<LawCase, std::uint32_t, std::uint32_t>;
inline std::vector<Combination> combinations_of(const std::vector<LawCase>& cases) {
  std::vector<Combination> all;
  for (const LawCase& law : cases)
    for (const std::uint32_t form :
         {ILAW_DELASSUS_SCALAR, ILAW_DELASSUS_DIAGONAL, ILAW_DELASSUS_FULL, ILAW_DELASSUS_TRANSVERSE})
      for (const std::uint32_t dimension : {2U, 3U})
        if (serves(law, form)) all.emplace_back(law, form, dimension);
  return all;
}
inline std::string name_of_combination(const ::testing::TestParamInfo<Combination>& drawn) {
  const auto& [law, form, dimension] = drawn.param;
  return law.name + "_" + name_of_form(form) + "_" + std::to_string(dimension) + "D";
}

class RandomNodes {
 public:
  static constexpr double step = 0x1p-10;

  RandomNodes(std::size_t size, std::uint32_t d, std::uint32_t delassus_form, Inertia kind, unsigned seed)
      : uniform(seed),
        count(size),
        dimension(d),
        form(delassus_form),
        inertia(kind),
        v_free(size),
        v_previous(size),
        h(size),
        gap(size),
        area(size),
        axes(size) {
    for (std::size_t i = 0; i < count; ++i) {
      axes[i] = random_axes();
      area[i] = uniform(0.5, 2.0);
    }
  }

  void draw() {
    for (std::size_t i = 0; i < count; ++i) {
      v_free[i] = {uniform() - 0.2, uniform(), dimension == 3 ? uniform() : 0.0};
      draw_inertia(h[i]);
    }
  }

  Random uniform;
  std::size_t count;
  std::uint32_t dimension, form;
  Inertia inertia;
  std::vector<Vector> v_free, v_previous;
  std::vector<Matrix> h;
  std::vector<double> gap, area;
  std::vector<Matrix> axes;  // rows: normal and tangents in the host's axes

 private:
  Matrix random_axes() {
    if (dimension == 2) {
      const double angle = uniform(-3.1, 3.1), c = std::cos(angle), s = std::sin(angle);
      return {Vector{c, s, 0.0}, {-s, c, 0.0}, {0.0, 0.0, 1.0}};
    }
    const auto unit = [](Vector a) {
      const double size = std::sqrt(dot(a, a));
      return Vector{a[0] / size, a[1] / size, a[2] / size};
    };
    const Vector n = unit({uniform(), uniform(), uniform()});
    Vector t{uniform(), uniform(), uniform()};
    for (int pass = 0; pass < 2; ++pass) {  // the second takes off what the first left by rounding
      const double along = dot(n, t);
      for (std::size_t c = 0; c < 3; ++c) t[c] -= along * n[c];
      t = unit(t);
    }
    return {n, t, Vector{n[1] * t[2] - n[2] * t[1], n[2] * t[0] - n[0] * t[2], n[0] * t[1] - n[1] * t[0]}};
  }

  // Positive definite, with condition numbers up to some hundreds.
  void draw_inertia(Matrix& m) {
    const bool scalar = form == ILAW_DELASSUS_SCALAR;
    const double normal = uniform(0.1, 2.0), tangential = scalar ? normal : uniform(0.1, 2.0);
    const bool equal = scalar || form == ILAW_DELASSUS_TRANSVERSE || inertia == Inertia::isotropic;
    m = {
        Vector{normal, 0.0, 0.0}, {0.0, tangential, 0.0}, {0.0, 0.0, equal ? tangential : uniform(0.1, 2.0)}};
    if (form == ILAW_DELASSUS_FULL && inertia == Inertia::any) couple(m);
  }

  // A A^T beside the diagonal.
  void couple(Matrix& m) {
    const std::size_t d = dimension;
    Matrix a{};
    for (std::size_t r = 0; r < d; ++r)
      for (std::size_t c = 0; c < d; ++c) a[r][c] = uniform();
    for (std::size_t r = 0; r < d; ++r)
      for (std::size_t c = 0; c <= r; ++c) m[c][r] = m[r][c] += dot(a[r], a[c]);
  }
};

// The axes in which a law is given its nodes: their own, the host's with tangents or with normals alone, or
// their own with the first tangent reversed.
enum class Axes { local, host, normals, mirrored };

// An instance that evaluates RandomNodes, with states of its own.
class Runner : public LawBatch {
 public:
  Runner(const std::string& id, const Parameters& parameters, const RandomNodes& nodes,
         Axes axes = Axes::local, const Units& units = {})
      : LawBatch(instance(id, in_units(id, parameters, units), nodes, axes), nodes.count),
        before(state),
        nodes_(nodes),
        units_(units),
        global_(is_global(axes)),
        mirrored_(axes == Axes::mirrored),
        amounts_(law->info().amount_count, std::vector<double>(nodes.count)) {
    velocity_step = position_step = RandomNodes::step;
    for (std::vector<double>& values : amounts_) amount_outputs_.push_back(ilaw::output(values.data(), 1, 0));
  }

  void initialise() {
    write_inputs();
    ASSERT_EQ(law->initialise(scaled_batch()), ILAW_OK);
  }

  // From the state as it stands; before keeps that.
  std::int32_t evaluate() {
    before = state;
    return evaluate_from(before);
  }
  std::int32_t evaluate_from(const std::vector<double>& state_in) {
    write_inputs();
    ilaw_batch b = scaled_batch();
    b.state_in = ilaw::input(state_in.data(), static_cast<std::int64_t>(state_size()), 1);
    return law->evaluate(b, &report);
  }

  // The named state variable of node i; NaN where there is none.
  double named(const char* name, std::size_t i) const {
    const std::size_t at = place_of(name, i);
    return at < state.size() ? state[at] : nan_value;
  }
  // The named amount of node i.
  double amount(const char* name, std::size_t i) const {
    const ilaw_instance_info info = law->info();
    for (std::uint32_t k = 0; k < info.amount_count; ++k)
      if (std::strcmp(info.amounts[k]->name, name) == 0) return amounts_[k][i];
    return nan_value;
  }
  void set(const char* name, std::size_t i, double value) { state.at(place_of(name, i)) = value; }

  // An impulse or velocity in the local axes and the units of RandomNodes.
  Vector local(std::size_t i, const Vector& a, double unit) const {
    const Vector turned = global_ ? times(nodes_.axes[i], a) : a;
    return {turned[0] / unit, (mirrored_ ? -turned[1] : turned[1]) / unit, turned[2] / unit};
  }

  std::vector<double> before;

 private:
  static bool is_global(Axes axes) { return axes == Axes::host || axes == Axes::normals; }
  static ilaw::interface instance(const std::string& id, const Parameters& parameters,
                                  const RandomNodes& nodes, Axes axes) {
    const bool global = is_global(axes);
    const auto form =
        global && nodes.form == ILAW_DELASSUS_DIAGONAL ? std::uint32_t{ILAW_DELASSUS_FULL} : nodes.form;
    return make_law(id, SetupBuilder(parameters, nodes.dimension, form,
                                     global ? ILAW_FRAME_GLOBAL : ILAW_FRAME_LOCAL, axes == Axes::host));
  }
  std::size_t place_of(const char* name, std::size_t i) const {
    const ilaw_instance_info info = law->info();
    std::size_t at = i * state_size();
    for (std::uint32_t k = 0; k < info.state_variable_count; at += info.state_variables[k++]->count)
      if (std::strcmp(info.state_variables[k]->name, name) == 0) return at;
    return state.size();
  }
  void write_inputs() {
    for (std::size_t i = 0; i < nodes_.count; ++i) {
      v_free[i] = outward(i, nodes_.v_free[i]);
      v_previous[i] = outward(i, nodes_.v_previous[i]);
      gap[i] = nodes_.gap[i] * units_.length;
      area[i] = nodes_.area[i] * units_.length * units_.length;
      normal[i] = nodes_.axes[i][0];
      tangent[i] = nodes_.axes[i][1];
      write_delassus(i);
    }
  }
  Vector outward(std::size_t i, Vector a) const {
    if (global_) a = times(transposed(nodes_.axes[i]), a);
    if (mirrored_) a[1] = -a[1];
    return units_.velocity() * a;
  }
  void write_delassus(std::size_t i) {
    Matrix m = nodes_.h[i];
    const bool full = nodes_.form == ILAW_DELASSUS_FULL || (global_ && nodes_.form == ILAW_DELASSUS_DIAGONAL);
    const Matrix& q = nodes_.axes[i];
    if (global_ && full) m = product(product(transposed(q), m), q);  // Q^T H Q
    if (mirrored_)
      for (const std::size_t k : {0, 2}) m[1][k] = m[k][1] = -m[k][1];
    if (nodes_.dimension == 2 && full)
      h[i] = {m[0][0], m[1][1], m[0][1]};
    else
      h[i] = {m[0][0], m[1][1], m[2][2], m[0][1], m[0][2], m[1][2]};
    for (double& entry : h[i]) entry /= units_.mass;
  }

  ilaw_batch scaled_batch() {
    ilaw_batch b = batch();
    b.time *= units_.time;
    b.velocity_step *= units_.time;
    b.position_step *= units_.time;
    b.amounts = amount_outputs_.data();
    return b;
  }

  const RandomNodes& nodes_;
  Units units_;
  bool global_, mirrored_;
  std::vector<std::vector<double>> amounts_;
  std::vector<ilaw_output> amount_outputs_;
};

}  // namespace ilaw::testing
