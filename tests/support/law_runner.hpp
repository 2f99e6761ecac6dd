// law_runner.hpp - drives a shipped law through the loader and the ABI, a few nodes at a time, in the local
// frame. It brings containers, strings, vectors, random numbers and matchers.
#pragma once

#include "matchers.hpp"
#include "numbers.hpp"
#include "random.hpp"
#include "vectors.hpp"

#include <ilaw/arrays.hpp>
#include <ilaw/loader.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <deque>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace ilaw::testing {

// The library of this build, or of the build of a copy of the tree under test (see law_cases.hpp).
inline std::string plugin_file(const std::string& law) {
  if (const char* folder = std::getenv("ILAW_TEST_PLUGINS")) {
    const std::string file = std::string(folder) + "/" + law + ".so";
    if (std::filesystem::exists(file)) return file;
  }
  std::string file = ILAW_PLUGIN_FOLDER "/";
  file += law;
  return file += ".so";
}

struct Parameters {
  std::map<std::string, double> numbers;
  std::map<std::string, std::string> texts;
  std::map<std::string, std::vector<double>> tables = {};  // time, value, time, value ...
  std::vector<std::string> per_node = {};
  struct Grid {
    std::vector<ilaw::parameters::axis> axes;
    std::vector<double> values;
  };
  std::map<std::string, Grid> grids = {};
};

// Setup with the storage that its pointers need.
class SetupBuilder {
 public:
  explicit SetupBuilder(const Parameters& given, std::uint32_t dimension = 3,
                        std::uint32_t form = ILAW_DELASSUS_SCALAR, std::uint32_t frame = ILAW_FRAME_LOCAL,
                        bool tangent = false) {
    for (const auto& [name, value] : given.numbers) arguments_.number(name, value);
    for (const auto& [name, text] : given.texts) arguments_.text(name, text);
    for (const auto& [name, pairs] : given.tables) add_time_table(name, pairs);
    for (const std::string& name : given.per_node) arguments_.per_node(name);
    for (const auto& [name, grid] : given.grids) arguments_.table(name, grid.axes, grid.values);
    setup.struct_size = sizeof setup;
    setup.dimension = dimension;
    setup.delassus_form = form;
    setup.frame = frame;
    setup.numbers = ILAW_NUMBERS_DOUBLE;
    setup.has_tangent = tangent;
    arguments_.give(setup);
  }
  SetupBuilder(const SetupBuilder&) = delete;

  ilaw_setup setup{};

 private:
  // Pairs (time, value).
  void add_time_table(const std::string& name, const std::vector<double>& pairs) {
    ilaw::parameters::axis times{"time", {}};
    std::vector<double> values;
    for (std::size_t k = 0; k + 1 < pairs.size(); k += 2) {
      times.points.push_back(pairs[k]);
      values.push_back(pairs[k + 1]);
    }
    arguments_.table(name, {times}, values);
  }

  ilaw::parameters arguments_;
};

inline ilaw::interface make_law(const std::string& law, const SetupBuilder& builder) {
  return {ilaw::library(plugin_file(law)), law, builder.setup};
}

// Why a law refuses a setup, in its words; "not refused" where it does not.
inline std::string refusal_of(const std::string& law, const SetupBuilder& builder,
                              std::int32_t code = ILAW_INVALID_PARAMETER) {
  try {
    make_law(law, builder);
  } catch (const ilaw::error& error) {
    EXPECT_EQ(error.code(), code) << error.what();
    return error.what();
  }
  return "not refused";
}
inline std::string refusal_of(const std::string& law, const Parameters& parameters) {
  return refusal_of(law, SetupBuilder(parameters));
}

// One node stepped in time, with all inputs as plain members; scalar H unless h has more values.
struct NodeRun {
  NodeRun(const std::string& law, const Parameters& parameters, double step = 1e-3,
          std::uint32_t form = ILAW_DELASSUS_SCALAR)
      : interface(make_law(law, SetupBuilder(parameters, 3, form, ILAW_FRAME_LOCAL))),
        dt(step),
        state(std::max<std::size_t>(interface.info().state_size, 1)),
        amounts(interface.info().amount_count) {
    initialise();
  }

  void initialise() {
    ilaw_batch b = batch();
    b.state_out = ilaw::output(state.data(), 0, 1);
    ASSERT_EQ(interface.initialise(b), ILAW_OK);
  }

  // A step with the given free velocity; returns the code of evaluate.
  std::int32_t step(const Vector& free_velocity) {
    v_free = free_velocity;
    ilaw_batch b = batch();
    b.state_in = ilaw::input(state.data(), 0, 1);
    b.state_out = ilaw::output(state.data(), 0, 1);
    b.impulse = ilaw::output(r.data(), 0, 1);
    b.velocity = ilaw::output(v.data(), 0, 1);
    b.energy = ilaw::output(energy.data(), 0, 1);
    b.status = &status;
    b.status_stride = 1;
    std::vector<ilaw_output> amount_outputs;
    for (double& amount : amounts) amount_outputs.push_back(ilaw::output(&amount, 0, 0));
    b.amounts = amount_outputs.data();
    report.struct_size = sizeof report;
    const std::int32_t code = interface.evaluate(b, &report);
    v_previous = v;
    return code;
  }

  // The named state variable.
  double named(const std::string& name) const {
    const ilaw_instance_info info = interface.info();
    std::size_t at = 0;
    for (std::uint32_t i = 0; i < info.state_variable_count; ++i) {
      if (info.state_variables[i]->name == name) return state[at];
      at += info.state_variables[i]->count;
    }
    ADD_FAILURE() << "no state variable " << name;
    return NAN;
  }

  ilaw_batch batch() const {
    ilaw_batch b{};
    b.struct_size = sizeof b;
    b.node_count = 1;
    b.time = time;
    b.velocity_step = dt;
    b.position_step = position_dt.value_or(dt);
    b.v_free = ilaw::input(v_free.data(), 0, 1);
    b.delassus = ilaw::input(h.data(), 0, 1);
    b.gap = ilaw::input(&gap, 0, 1);
    b.v_previous = ilaw::input(v_previous.data(), 0, 1);
    b.area = ilaw::input(&area, 0, 1);
    return b;
  }

  ilaw::interface interface;
  double time = 0.0, dt;
  std::optional<double> position_dt;  // where it is not dt
  Vector v_free{}, v_previous{}, r{}, v{};
  std::array<double, 6> h{1.0};
  double gap = 0.0, area = 1.0;
  std::array<double, 4> energy{};
  std::uint8_t status = 0;
  ilaw_report report{};
  std::vector<double> state, amounts;
};

}  // namespace ilaw::testing
