// random_nodes.hpp - many interface nodes at random, stepped through the ABI as they are, in other units, in
// other axes, or in a mirror.
#pragma once

#include "support/law_cases.hpp"

#include <ilaw/arrays.hpp>

#include <cstring>
#include <limits>
#include <random>
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

  // Of a parameter by its declared unit, say N.s/m^2 or N/m^p; exponents: the values of letters like p.
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

// Fast and the same everywhere.
class Uniform {
 public:
  explicit Uniform(unsigned seed) : random_(seed) {}
  double operator()(double low = -1.0, double high = 1.0) {
    return low + (high - low) * (static_cast<double>(random_() >> 11) * 0x1p-53);
  }

 private:
  std::mt19937_64 random_;
};

using Matrix = std::array<Vector, 3>;  // rows

inline Vector times(const Matrix& m, const Vector& a) { return {dot(m[0], a), dot(m[1], a), dot(m[2], a)}; }
inline Matrix transposed(const Matrix& m) {
  return {Vector{m[0][0], m[1][0], m[2][0]}, {m[0][1], m[1][1], m[2][1]}, {m[0][2], m[1][2], m[2][2]}};
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

  Uniform uniform;
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
class Runner {
 public:
  Runner(const std::string& law, const Parameters& parameters, const RandomNodes& nodes,
         Axes axes = Axes::local, const Units& units = {})
      : nodes_(nodes),
        units_(units),
        global_(axes == Axes::host || axes == Axes::normals),
        mirrored_(axes == Axes::mirrored),
        form_(global_ && nodes.form == ILAW_DELASSUS_DIAGONAL ? std::uint32_t{ILAW_DELASSUS_FULL}
                                                              : nodes.form),
        interface_(
            make_law(law, SetupBuilder(in_units(law, parameters, units), nodes.dimension, form_,
                                       global_ ? ILAW_FRAME_GLOBAL : ILAW_FRAME_LOCAL, axes == Axes::host))),
        size_(interface_.info().state_size),
        r(nodes.count),
        v(nodes.count),
        energy(nodes.count),
        status(nodes.count),
        state(size_ * nodes.count + 1),
        before(size_ * nodes.count + 1),
        v_free_(nodes.count),
        v_previous_(nodes.count),
        normal_(nodes.count),
        tangent_(nodes.count),
        gap_(nodes.count),
        area_(nodes.count),
        h_(nodes.count),
        amounts_(interface_.info().amount_count, std::vector<double>(nodes.count)) {
    for (std::vector<double>& values : amounts_) amount_outputs_.push_back(ilaw::output(values.data(), 1, 0));
    report.struct_size = sizeof report;
  }

  void initialise() {
    write_inputs();
    ilaw_batch b = batch();
    ASSERT_EQ(interface_.initialise(b), ILAW_OK);
  }

  // From the state as it stands; before keeps that.
  std::int32_t evaluate() {
    before = state;
    return evaluate_from(before);
  }
  std::int32_t evaluate_from(const std::vector<double>& state_in) {
    write_inputs();
    ilaw_batch b = batch();
    b.state_in = ilaw::input(state_in.data(), static_cast<std::int64_t>(size_), 1);
    return interface_.evaluate(b, &report);
  }

  // The named state variable of node i; NaN where there is none.
  double named(const char* name, std::size_t i) const {
    const std::size_t at = place_of(name, i);
    return at < state.size() ? state[at] : std::numeric_limits<double>::quiet_NaN();
  }
  // The named amount of node i.
  double amount(const char* name, std::size_t i) const {
    const ilaw_instance_info info = interface_.info();
    for (std::uint32_t k = 0; k < info.amount_count; ++k)
      if (std::strcmp(info.amounts[k]->name, name) == 0) return amounts_[k][i];
    return std::numeric_limits<double>::quiet_NaN();
  }
  void set(const char* name, std::size_t i, double value) { state.at(place_of(name, i)) = value; }

  // An impulse or velocity in the local axes and the units of RandomNodes.
  Vector local(std::size_t i, const Vector& a, double unit) const {
    const Vector turned = global_ ? times(nodes_.axes[i], a) : a;
    return {turned[0] / unit, (mirrored_ ? -turned[1] : turned[1]) / unit, turned[2] / unit};
  }

 private:
  std::size_t place_of(const char* name, std::size_t i) const {
    const ilaw_instance_info info = interface_.info();
    std::size_t at = i * size_;
    for (std::uint32_t k = 0; k < info.state_variable_count; at += info.state_variables[k++]->count)
      if (std::strcmp(info.state_variables[k]->name, name) == 0) return at;
    return state.size();
  }
  void write_inputs() {
    for (std::size_t i = 0; i < nodes_.count; ++i) {
      v_free_[i] = outward(i, nodes_.v_free[i]);
      v_previous_[i] = outward(i, nodes_.v_previous[i]);
      gap_[i] = nodes_.gap[i] * units_.length;
      area_[i] = nodes_.area[i] * units_.length * units_.length;
      normal_[i] = nodes_.axes[i][0];
      tangent_[i] = nodes_.axes[i][1];
      write_delassus(i);
    }
  }
  Vector outward(std::size_t i, Vector a) const {
    if (global_) a = times(transposed(nodes_.axes[i]), a);
    if (mirrored_) a[1] = -a[1];
    for (double& component : a) component *= units_.velocity();
    return a;
  }
  void write_delassus(std::size_t i) {
    Matrix m = nodes_.h[i];
    if (global_ && form_ == ILAW_DELASSUS_FULL) {
      // Q^T H Q with the rows of Q as axes: rows of Q^T H first, H being symmetric.
      const Matrix to_host = transposed(nodes_.axes[i]);
      Matrix half;
      for (std::size_t k = 0; k < 3; ++k) half[k] = times(to_host, m[k]);
      half = transposed(half);
      for (std::size_t k = 0; k < 3; ++k) m[k] = times(to_host, half[k]);
    }
    if (mirrored_)
      for (const std::size_t k : {0, 2}) m[1][k] = m[k][1] = -m[k][1];
    if (nodes_.dimension == 1)
      h_[i] = {m[0][0]};
    else
      h_[i] = nodes_.dimension == 2 && form_ == ILAW_DELASSUS_FULL
                  ? std::array<double, 6>{m[0][0], m[1][1], m[0][1]}
                  : std::array<double, 6>{m[0][0], m[1][1], m[2][2], m[0][1], m[0][2], m[1][2]};
    for (double& entry : h_[i]) entry /= units_.mass;
  }

  ilaw_batch batch() {
    const auto size = static_cast<std::int64_t>(size_);
    ilaw_batch b{};
    b.struct_size = sizeof b;
    b.node_count = static_cast<std::int64_t>(nodes_.count);
    b.time = time * units_.time;
    b.velocity_step = velocity_step * units_.time;
    b.position_step = position_step * units_.time;
    b.v_free = ilaw::input(v_free_[0].data(), 3, 1);
    b.v_previous = ilaw::input(v_previous_[0].data(), 3, 1);
    b.delassus = ilaw::input(h_[0].data(), 6, 1);
    b.gap = ilaw::input(gap_.data(), 1, 1);
    b.area = ilaw::input(area_.data(), 1, 1);
    if (global_) b.normal = ilaw::input(normal_[0].data(), 3, 1);
    if (global_) b.tangent = ilaw::input(tangent_[0].data(), 3, 1);
    b.state_out = ilaw::output(state.data(), size, 1);
    b.impulse = ilaw::output(r[0].data(), 3, 1);
    b.velocity = ilaw::output(v[0].data(), 3, 1);
    b.energy = ilaw::output(energy[0].data(), 4, 1);
    b.status = status.data();
    b.status_stride = 1;
    b.per_node_parameters = per_node.data();
    b.amounts = amount_outputs_.data();
    return b;
  }

  const RandomNodes& nodes_;
  Units units_;
  bool global_, mirrored_;
  std::uint32_t form_;
  ilaw::interface interface_;
  std::size_t size_;

 public:
  double time = 0.0, velocity_step = RandomNodes::step, position_step = RandomNodes::step;
  std::vector<ilaw_input> per_node;  // in the order of the instance
  std::vector<Vector> r, v;
  std::vector<std::array<double, 4>> energy;
  std::vector<std::uint8_t> status;
  std::vector<double> state, before;
  ilaw_report report{};

 private:
  std::vector<Vector> v_free_, v_previous_, normal_, tangent_;
  std::vector<double> gap_, area_;
  std::vector<std::array<double, 6>> h_;
  std::vector<std::vector<double>> amounts_;
  std::vector<ilaw_output> amount_outputs_;
};

}  // namespace ilaw::testing
