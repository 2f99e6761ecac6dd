// SPDX-License-Identifier: BSD-3-Clause
#include "check/trial.hpp"

#include "check/sandbox.hpp"
#include "check/units.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <exception>
#include <limits>
#include <utility>

namespace ilaw::check {
namespace {

std::string text_of(const Value& value) {
  switch (value.kind) {
    case ILAW_KIND_VALUE_TEXT:
      return value.name + " = \"" + value.text + "\"";
    case ILAW_KIND_VALUE_TABLE: {
      const auto list = [](const std::vector<double>& numbers) {
        std::string all;
        for (std::size_t k = 0; k < numbers.size() && k < 20; ++k)
          all += (all.empty() ? "" : ", ") + check::text_of(numbers[k]);
        return "{" + all + (numbers.size() > 20 ? ", ..." : "") + "}";
      };
      std::string axes;
      for (const TableAxis& axis : value.axes)
        axes += (axes.empty() ? "" : ", ") + axis.name + " " + list(axis.points);
      return value.name + " = table " + list(value.table) + " over " + axes;
    }
    case ILAW_KIND_VALUE_PER_NODE:
      return value.name + " per node";
    default:
      return value.name + " = " + check::text_of(value.number);
  }
}

}  // namespace

std::string text_of(double value) {
  std::array<char, 32> text;
  return {text.data(), std::to_chars(text.begin(), text.end(), value).ptr};
}

std::string text_of(const Values& values) {
  std::string text;
  for (const Value& value : values) text += (text.empty() ? "" : ", ") + text_of(value);
  return text.empty() ? "default parameters" : text;
}

Values with(Values values, const Value& value) {
  std::erase_if(values, [&](const Value& old) { return old.name == value.name; });
  values.push_back(value);
  return values;
}

std::size_t Setup::form_width() const {
  const std::size_t d = dimension;
  if (form == ILAW_DELASSUS_SCALAR) return 1;
  if (form == ILAW_DELASSUS_DIAGONAL) return d;
  if (form == ILAW_DELASSUS_FULL) return d * (d + 1) / 2;
  return spins() ? 5 : 2;
}

std::string text_of(const Setup& setup) {
  const char* form = setup.form == ILAW_DELASSUS_SCALAR     ? "scalar"
                     : setup.form == ILAW_DELASSUS_DIAGONAL ? "diagonal"
                     : setup.form == ILAW_DELASSUS_FULL     ? "full"
                     : setup.spins()                        ? "transverse and spinning"
                                                            : "transverse";
  return "dimension " + std::to_string(setup.dimension) + ", " + form + " H, " +
         (setup.global() ? "global" : "local") + " frame" + (setup.has_tangent ? " with tangents" : "") +
         (setup.floats() ? ", floats" : "");
}

SetupStruct::SetupStruct(const Setup& setup, const Values& values)
    : axes(values.size()), values_(values), axis_pointers_(values.size()) {
  for (const Value& value : values_) {
    ilaw_argument argument{};
    argument.struct_size = sizeof argument;
    argument.kind = value.kind;
    argument.name = value.name.c_str();
    argument.number = value.number;
    if (value.kind == ILAW_KIND_VALUE_TEXT) argument.text = value.text.c_str();
    if (value.kind == ILAW_KIND_VALUE_TABLE) {
      const std::size_t at = arguments.size();
      for (const TableAxis& axis : value.axes)
        axes[at].push_back({sizeof(ilaw_axis), 0, axis.name.c_str(), axis.points.data(), axis.points.size()});
      for (const ilaw_axis& axis : axes[at]) axis_pointers_[at].push_back(&axis);
      argument.values = value.table.data();
      argument.axes = axis_pointers_[at].data();
      argument.axis_count = static_cast<std::uint32_t>(axes[at].size());
    }
    arguments.push_back(argument);
  }
  for (const ilaw_argument& argument : arguments) pointers_.push_back(&argument);
  given.struct_size = sizeof given;
  given.dimension = setup.dimension;
  given.delassus_form = setup.form;
  given.frame = setup.frame;
  given.has_tangent = setup.has_tangent;
  given.numbers = setup.numbers;
  given.arguments = pointers_.empty() ? nullptr : pointers_.data();
  given.argument_count = static_cast<std::uint32_t>(pointers_.size());
}

SetupStruct::~SetupStruct() {
  for (std::vector<ilaw_axis>& of_argument : axes)
    std::fill(of_argument.begin(), of_argument.end(), ilaw_axis{});
  for (Value& value : values_) {
    for (TableAxis& axis : value.axes) {
      std::fill(axis.points.begin(), axis.points.end(), std::numeric_limits<double>::quiet_NaN());
      std::fill(axis.name.begin(), axis.name.end(), '#');
    }
    std::fill(value.table.begin(), value.table.end(), std::numeric_limits<double>::quiet_NaN());
    std::fill(value.text.begin(), value.text.end(), '#');
    std::fill(value.name.begin(), value.name.end(), '#');
  }
}

void Instance::Destroy::operator()(ilaw_instance* made) const {
  if (std::uncaught_exceptions() == 0) calling("destroy");  // else what threw is what is named
  law->destroy(made);
}

ilaw_instance_info Instance::info() const {
  ilaw_instance_info info{};
  info.struct_size = sizeof info;
  calling("info");
  if (const std::int32_t code = law_->info(made_.get(), &info); code != ILAW_OK)
    throw Finding{joined("info returned ", code, " for its own instance"), "ILAW_OK"};
  return info;
}

std::int32_t Instance::initialise(const ilaw_batch& batch, ilaw_report* report) const {
  calling("initialise");
  return law_->initialise(made_.get(), &batch, report);
}

std::int32_t Instance::evaluate(const ilaw_batch& batch, ilaw_report* report) const {
  calling("evaluate");
  return law_->evaluate(made_.get(), &batch, report);
}

std::optional<Instance> create(const ilaw_law& law, const ilaw_setup& setup, Refusal& refusal) {
  std::array<char, 1024> message{};
  ilaw_instance* made = nullptr;
  calling("create");
  refusal.code = law.create(law.id, &setup, &made, message.data(), message.size());
  message.back() = '\0';
  refusal.message = message.data();
  if (refusal.code != ILAW_OK) return std::nullopt;
  if (!made) throw Finding{"create returned ILAW_OK and no instance", "an instance"};
  return Instance(law, made);
}

std::optional<Instance> create(const ilaw_law& law, const Setup& setup, const Values& values) {
  Refusal refusal{};
  return create(law, setup, values, refusal);
}

std::optional<Instance> create(const ilaw_law& law, const Setup& setup, const Values& values,
                               Refusal& refusal) {
  const SetupStruct given(setup, values);
  set_setting(joined(text_of(setup), "; ", text_of(values)));
  return create(law, given.given, refusal);
}

namespace {

Instance created(const ilaw_law& law, const Setup& setup, const Values& values) {
  Refusal refusal{};
  if (std::optional<Instance> made = create(law, setup, values, refusal)) return std::move(*made);
  throw Finding{joined("create refused them with code ", refusal.code, ": ", refusal.message),
                "an instance, since it accepted these parameters before",
                joined(text_of(setup), "; ", text_of(values))};
}

}  // namespace

Trial::Trial(const ilaw_law& of, const Setup& given, const Values& chosen)
    : law(of), setup(given), values(chosen), instance(created(of, given, chosen)), info(instance.info()) {}

std::string Trial::text() const { return text_of(setup) + "; " + text_of(values); }

std::vector<const ilaw_parameter*> Trial::parameters() const { return parameters_of(law, setup); }

const ilaw_parameter* parameter_of(const ilaw_law& law, const std::string& name) {
  for (const ilaw_parameter* p : all_parameters(law))
    if (name == p->name) return p;
  return nullptr;
}

bool in_range(const ilaw_parameter& p, double value) {
  if (value == infinity) return has(p, ILAW_FLAG_ALLOWS_INFINITY);
  return value <= p.maximum && (has(p, ILAW_FLAG_EXCLUDES_MINIMUM) ? value > p.minimum : value >= p.minimum);
}

double number_of(const ilaw_law& law, const Values& values, const std::string& name) {
  for (const Value& value : values)
    if (value.name == name) return value.number;
  const ilaw_parameter* p = parameter_of(law, name);
  return p ? p->default_value : std::numeric_limits<double>::quiet_NaN();
}

std::vector<Setup> setups_of(const ilaw_law& law) {
  std::vector<Setup> setups;
  for (const ilaw_number_type numbers : {ILAW_NUMBERS_DOUBLE, ILAW_NUMBERS_FLOAT})
    for (std::uint32_t d = 3; d >= 1; --d)
      for (const std::uint32_t form :
           {ILAW_DELASSUS_TRANSVERSE_SPIN, ILAW_DELASSUS_SCALAR, ILAW_DELASSUS_DIAGONAL, ILAW_DELASSUS_FULL,
            ILAW_DELASSUS_TRANSVERSE}) {
        if (!(law.numbers & numbers) || !(law.dimensions & (1U << d)) || !(law.delassus_forms & form))
          continue;
        if (form == ILAW_DELASSUS_TRANSVERSE_SPIN && d != 3) continue;
        if (law.frames & ILAW_FRAME_LOCAL) setups.push_back({d, form, ILAW_FRAME_LOCAL, 0, numbers});
        if (!(law.frames & ILAW_FRAME_GLOBAL)) continue;
        setups.push_back({d, form, ILAW_FRAME_GLOBAL, 0, numbers});
        if (d == 3) setups.push_back({d, form, ILAW_FRAME_GLOBAL, 1, numbers});
      }
  return setups;
}

std::vector<std::string> symbols_of(const ilaw_law& law) {
  std::vector<std::string> symbols;
  for (const ilaw_parameter* p : all_parameters(law)) symbols.emplace_back(p->symbol);
  return symbols;
}

std::map<std::string, double> numbers_by_symbol(const ilaw_law& law, const Values& values) {
  std::map<std::string, double> numbers;
  for (const ilaw_parameter* p : all_parameters(law)) numbers[p->symbol] = number_of(law, values, p->name);
  return numbers;
}

std::vector<const ilaw_parameter*> parameters_of(const ilaw_law& law, const Setup& setup) {
  std::vector<const ilaw_parameter*> all(law.parameters, law.parameters + law.parameter_count);
  if (!setup.spins())
    std::erase_if(all, [](const ilaw_parameter* p) { return has(*p, ILAW_FLAG_NEEDS_SPINS); });
  return all;
}

std::optional<double> natural_value(const ilaw_law& law, const ilaw_parameter& p) {
  // Moments have arms of order one; other lengths are those of a step.
  const Units natural{1.0, has(p, ILAW_FLAG_NEEDS_SPINS) ? 1.0 : 0x1p-10, 0x1p-10};
  std::optional<Dimensions> unit = parse_unit(p.unit, symbols_of(law));
  if (!unit) return std::nullopt;
  unit->fixed.length += 2.0 * unit->fixed.mass;  // per area, which is of order one
  const double value = unit->in(natural, numbers_by_symbol(law, {}));
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

Value draw_value(const ilaw_parameter& p, Draw& draw, std::optional<double> natural) {
  Value value{p.name};
  if (p.kind == ILAW_KIND_CHOICE) {
    value.kind = ILAW_KIND_VALUE_TEXT;
    value.text = p.choices[draw.below(p.choice_count)];
    return value;
  }
  if (has(p, ILAW_FLAG_ALLOWS_INFINITY) && draw.one_in(8)) {
    value.number = infinity;
    return value;
  }
  const bool whole = p.kind == ILAW_KIND_INTEGER;
  const double low = p.minimum, high = std::min(p.maximum, whole ? std::max(8.0, low + 2.0) : p.maximum);
  // Most numbers are of order one, strengths and stiffnesses are large, times and toughnesses small.
  const double drawn = high - low <= 4.0 ? draw.within(low, high)
                       : natural         ? *natural * std::pow(10.0, draw.within(-1.0, 1.0))
                                         : std::pow(10.0, draw.within(-3.0, 5.0));
  value.number = std::clamp(drawn, low, high);
  if (whole) value.number = std::clamp(std::floor(draw.within(low, high + 1.0)), std::ceil(low), high);
  if (!in_range(p, value.number)) value.number = std::nextafter(low, high);
  return value;
}

std::optional<Values> draw_values(const ilaw_law& law, const Setup& setup, Draw& draw) {
  constexpr int attempts = 200;
  const bool is_natural = draw.one_in(2);
  for (int k = 0; k < attempts; ++k) {
    Values values;
    for (const ilaw_parameter* p : parameters_of(law, setup))
      if (has(*p, ILAW_FLAG_REQUIRED) || draw.one_in(2)) {
        values.push_back(draw_value(*p, draw, is_natural ? natural_value(law, *p) : std::nullopt));
        // So that the value may be given per node, too.
        const double rounded = setup.rounded(values.back().number);
        if (in_range(*p, rounded)) values.back().number = rounded;
      }
    if (create(law, setup, values)) return values;
  }
  return std::nullopt;
}

std::optional<Values> given_per_node(const Trial& trial) {
  Values values = trial.values;
  bool varies = false;
  for (const ilaw_parameter* p : trial.parameters()) {
    if (p->kind == ILAW_KIND_CHOICE || !has(*p, ILAW_FLAG_ALLOWS_PER_NODE)) continue;
    const double constant = number_of(trial.law, trial.values, p->name);
    const Values more = with(values, {p->name, ILAW_KIND_VALUE_PER_NODE, constant});
    if (!create(trial.law, trial.setup, more)) continue;
    values = more;
    varies = true;
  }
  return varies ? std::optional(values) : std::nullopt;
}

}  // namespace ilaw::check
