// trial.hpp - instances of a law: which setups it serves, which parameters it accepts, its functions called
// with what is needed to name them in a finding.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "check/draw.hpp"
#include "check/finding.hpp"

#include <ilaw/ilaw.h>

#include <bit>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace ilaw::check {

inline constexpr double infinity = std::numeric_limits<double>::infinity();
inline constexpr double ulp = std::numeric_limits<double>::epsilon();
inline bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

// As few digits as tell it from all others.
std::string text_of(double value);
// Texts and numbers one after another.
template <class... Parts>
std::string joined(const Parts&... parts) {
  std::string text;
  const auto add = [&text](const auto& part) {
    if constexpr (std::is_same_v<std::decay_t<decltype(part)>, double>)
      text += text_of(part);
    else if constexpr (std::is_arithmetic_v<std::decay_t<decltype(part)>>)
      text += std::to_string(part);
    else
      text += part;
  };
  (add(parts), ...);
  return text;
}

struct TableAxis {
  std::string name;
  std::vector<double> points;
};
// A value of a parameter, with what its ilaw_argument points to.
struct Value {
  std::string name;
  std::uint32_t kind = ILAW_KIND_VALUE_NUMBER;
  double number = 0.0;
  std::string text{};
  std::vector<TableAxis> axes{};
  std::vector<double> table{};  // one per point of the grid, the last axis varies fastest
};
using Values = std::vector<Value>;
std::string text_of(const Values& values);
// With one more, or another for the same name.
Values with(Values values, const Value& value);

struct Setup {
  std::uint32_t dimension = 3, form = ILAW_DELASSUS_SCALAR, frame = ILAW_FRAME_LOCAL, has_tangent = 0;
  ilaw_number_type numbers = ILAW_NUMBERS_DOUBLE;

  bool global() const { return frame == ILAW_FRAME_GLOBAL; }
  bool floats() const { return numbers == ILAW_NUMBERS_FLOAT; }
  bool spins() const { return form == ILAW_DELASSUS_TRANSVERSE_SPIN; }
  // As the arrays of a batch keep it.
  double rounded(double value) const { return floats() ? double{static_cast<float>(value)} : value; }
  std::size_t form_width() const;
};
std::string text_of(const Setup& setup);

// The struct of the ABI with all that it points to; ends as rubbish, since nothing of it need outlive create.
class SetupStruct {
 public:
  SetupStruct(const Setup& setup, const Values& values);
  SetupStruct(const SetupStruct&) = delete;
  SetupStruct& operator=(const SetupStruct&) = delete;
  ~SetupStruct();

  ilaw_setup given{};
  std::vector<ilaw_argument> arguments;
  std::vector<std::vector<ilaw_axis>> axes;  // of each argument

 private:
  Values values_;
  std::vector<std::vector<const ilaw_axis*>> axis_pointers_;
  std::vector<const ilaw_argument*> pointers_;
};

struct Refusal {
  std::int32_t code;
  std::string message;
};

// Owns an instance of a law.
class Instance {
 public:
  Instance(const ilaw_law& law, ilaw_instance* made) : law_(&law), made_(made, Destroy{&law}) {}

  ilaw_instance_info info() const;
  std::int32_t initialise(const ilaw_batch& batch, ilaw_report* report) const;
  std::int32_t evaluate(const ilaw_batch& batch, ilaw_report* report) const;
  const ilaw_instance* get() const { return made_.get(); }

 private:
  struct Destroy {
    const ilaw_law* law;
    void operator()(ilaw_instance* made) const;
  };
  const ilaw_law* law_;
  std::unique_ptr<ilaw_instance, Destroy> made_;
};

// Makes an instance, or says why not.
std::optional<Instance> create(const ilaw_law& law, const ilaw_setup& setup, Refusal& refusal);
std::optional<Instance> create(const ilaw_law& law, const Setup& setup, const Values& values);
std::optional<Instance> create(const ilaw_law& law, const Setup& setup, const Values& values,
                               Refusal& refusal);

// A law with parameters and a setup that it accepts.
struct Trial {
  Trial(const ilaw_law& law, const Setup& setup, const Values& values);  // throws Finding where it is refused

  std::string text() const;
  std::vector<const ilaw_parameter*> parameters() const;  // those that the setup may be given
  bool writes(std::uint32_t output) const { return (law.outputs & output) != 0; }
  bool can(std::uint32_t capability) const { return (info.capabilities & capability) != 0; }
  bool permits(ilaw_permissions permission) const { return (info.permissions & permission) != 0; }
  // Relative rounding of a result.
  double epsilon() const {
    return setup.floats() ? std::numeric_limits<float>::epsilon() : std::numeric_limits<double>::epsilon();
  }
  // Bonds whose traction falls with their opening have several solutions where the step is too large for the
  // fall (docs/theory/bonds.md), and may refuse it.
  bool may_soften() const { return can(ILAW_CAN_ADHERE) && can(ILAW_CAN_STORE_ENERGY); }
  bool reads(std::uint32_t input) const { return (info.inputs & input) != 0; }

  const ilaw_law& law;
  Setup setup;
  Values values;
  Instance instance;
  ilaw_instance_info info;
};

inline bool has(const ilaw_parameter& p, ilaw_parameter_flags flag) { return (p.flags & flag) != 0; }
const ilaw_parameter* parameter_of(const ilaw_law& law, const std::string& name);
bool in_range(const ilaw_parameter& p, double value);
// The value that a parameter has: of the list, or its default.
double number_of(const ilaw_law& law, const Values& values, const std::string& name);

// All setups that the law's description serves, with doubles first, and spins before others.
std::vector<Setup> setups_of(const ilaw_law& law);
inline std::span<const ilaw_parameter* const> all_parameters(const ilaw_law& law) {
  return {law.parameters, law.parameter_count};
}
// By their symbols, which units have as powers.
std::vector<std::string> symbols_of(const ilaw_law& law);
std::map<std::string, double> numbers_by_symbol(const ilaw_law& law, const Values& values);
// The parameters that a setup may be given: without spins those that need none.
std::vector<const ilaw_parameter*> parameters_of(const ilaw_law& law, const Setup& setup);
// A value of a parameter within what its description allows.
Value draw_value(const ilaw_parameter& p, Draw& draw, std::optional<double> natural = std::nullopt);
// The value that a parameter of this unit has where inertia, motion and steps as those of draw_script decide:
// tractions, for one, that stop a node within a step. None where its unit is not known.
std::optional<double> natural_value(const ilaw_law& law, const ilaw_parameter& p);
// Draws values until the law accepts them in a setup, every second time near their natural ones; none where
// it accepts nothing.
std::optional<Values> draw_values(const ilaw_law& law, const Setup& setup, Draw& draw);
// With all parameters given per node that may be, and go together with the others so; what each was stays as
// its number. None where there is no such parameter.
std::optional<Values> given_per_node(const Trial& trial);

}  // namespace ilaw::check
