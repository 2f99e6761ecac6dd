// random_nodes.hpp - many interface nodes at random, stepped through the ABI.
#pragma once

#include "support/law_batch.hpp"
#include "support/law_cases.hpp"

#include <cstring>
#include <tuple>

namespace ilaw::testing {

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
        area(size) {
    for (double& each : area) {
      for (std::uint32_t k = 0; k < (dimension == 2 ? 1U : 6U); ++k)
        uniform();  // axes, in the sequence of old
      each = uniform(0.5, 2.0);
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

 private:
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

// An instance that evaluates RandomNodes, with states of its own.
class Runner : public LawBatch {
 public:
  Runner(const std::string& id, const Parameters& parameters, const RandomNodes& nodes)
      : LawBatch(make_law(id, SetupBuilder(parameters, nodes.dimension, nodes.form)), nodes.count),
        before(state),
        nodes_(nodes),
        amounts_(law->info().amount_count, std::vector<double>(nodes.count)) {
    velocity_step = position_step = RandomNodes::step;
    for (std::vector<double>& values : amounts_) amount_outputs_.push_back(ilaw::output(values.data(), 1, 0));
  }

  void initialise() {
    write_inputs();
    ASSERT_EQ(law->initialise(batch_with_amounts()), ILAW_OK);
  }

  // From the state as it stands; before keeps that.
  std::int32_t evaluate() {
    before = state;
    write_inputs();
    ilaw_batch b = batch_with_amounts();
    b.state_in = ilaw::input(before.data(), static_cast<std::int64_t>(state_size()), 1);
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

  std::vector<double> before;

 private:
  std::size_t place_of(const char* name, std::size_t i) const {
    const ilaw_instance_info info = law->info();
    std::size_t at = i * state_size();
    for (std::uint32_t k = 0; k < info.state_variable_count; at += info.state_variables[k++]->count)
      if (std::strcmp(info.state_variables[k]->name, name) == 0) return at;
    return state.size();
  }
  void write_inputs() {
    v_free = nodes_.v_free;
    v_previous = nodes_.v_previous;
    gap = nodes_.gap;
    area = nodes_.area;
    for (std::size_t i = 0; i < nodes_.count; ++i) {
      const Matrix& m = nodes_.h[i];
      if (nodes_.dimension == 2 && nodes_.form == ILAW_DELASSUS_FULL)
        h[i] = {m[0][0], m[1][1], m[0][1]};
      else
        h[i] = {m[0][0], m[1][1], m[2][2], m[0][1], m[0][2], m[1][2]};
    }
  }

  ilaw_batch batch_with_amounts() {
    ilaw_batch b = batch();
    b.amounts = amount_outputs_.data();
    return b;
  }

  const RandomNodes& nodes_;
  std::vector<std::vector<double>> amounts_;
  std::vector<ilaw_output> amount_outputs_;
};

}  // namespace ilaw::testing
