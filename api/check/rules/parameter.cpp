// Rules: parameters are accepted and refused as their description says.
// SPDX-License-Identifier: BSD-3-Clause
#include "check/rule.hpp"

#include "check/sandbox.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace ilaw::check {
namespace {

void expect_refused(const Trial& trial, const Values& values) {
  check::expect_refused(trial, values, ILAW_INVALID_PARAMETER);
}

Value number(const std::string& name, double value) { return {name, ILAW_KIND_VALUE_NUMBER, value}; }
Value text(const ilaw_parameter& p, const std::string& word) {
  return {p.name, ILAW_KIND_VALUE_TEXT, 0.0, word};
}
Value per_node(const ilaw_parameter& p) { return {p.name, ILAW_KIND_VALUE_PER_NODE}; }
Value table(const ilaw_parameter& p, const std::vector<TableAxis>& axes, const std::vector<double>& values) {
  return {p.name, ILAW_KIND_VALUE_TABLE, 0.0, {}, axes, values};
}
// A table of one value.
Value table(const ilaw_parameter& p, const std::vector<TableAxis>& axes, double value) {
  std::size_t size = 1;
  for (const TableAxis& axis : axes) size *= axis.points.size();
  return table(p, axes, std::vector<double>(size, value));
}
// A value that a table of the parameter may have: that of the trial, or one near the minimum.
double value_in_table(const Trial& trial, const ilaw_parameter& p) {
  const double value = number_of(trial.law, trial.values, p.name);
  return in_range(p, value) && std::isfinite(value) ? value : std::nextafter(p.minimum, infinity);
}
// The fields of the law, which a table over them needs, given per node.
Values with_fields(const Trial& trial) {
  Values values = trial.values;
  for (const ilaw_parameter* p : all_parameters(trial.law))
    if (has(*p, ILAW_FLAG_FIELD)) values = with(values, per_node(*p));
  return values;
}
Values without(Values values, const std::string& name) {
  std::erase_if(values, [&](const Value& value) { return value.name == name; });
  return values;
}
bool is_choice(const ilaw_parameter& p) { return p.kind == ILAW_KIND_CHOICE; }
bool may_be_table(const ilaw_parameter& p) { return !is_choice(p) && p.axis_count > 0; }
bool may_be_per_node(const ilaw_parameter& p) { return !is_choice(p) && has(p, ILAW_FLAG_ALLOWS_PER_NODE); }
Value default_of(const ilaw_parameter& p) {
  return is_choice(p) ? text(p, p.choices[static_cast<std::size_t>(p.default_value)])
                      : number(p.name, p.default_value);
}

// Each parameter of one trial.
Judge on_parameters(bool (*look)(const Trial& trial, const ilaw_parameter& p, Draw& draw)) {
  return {Needs::instance, [look](const Subject& subject) {
            const Trial trial = any_trial(subject);
            Draw draw(subject.seed);
            bool judged = false;
            for (const ilaw_parameter* p : all_parameters(subject.law))
              judged = look(trial, *p, draw) || judged;
            if (!judged) throw NotJudged{"the law has no such parameter"};
          }};
}

// What create must refuse for a parameter of a trial; nothing: the rule is not about this one.
using WrongValues = std::vector<Value> (*)(const Trial& trial, const ilaw_parameter& p);
template <WrongValues wrong>
Judge refuses() {
  return on_parameters([](const Trial& trial, const ilaw_parameter& p, Draw&) {
    const std::vector<Value> values = wrong(trial, p);
    for (const Value& value : values) {
      const bool may_need_fields = may_be_table(p) && value.kind == ILAW_KIND_VALUE_TABLE;
      expect_refused(trial, with(may_need_fields ? with_fields(trial) : trial.values, value));
    }
    return !values.empty();
  });
}

// Each parameter that a trial may be given.
Judge on_trials_and_parameters(bool (*look)(const Trial& trial, const ilaw_parameter& p, Draw& draw),
                               const char* otherwise) {
  return on_trials(
      [look](const Trial& trial, Draw& draw) {
        bool judged = false;
        for (const ilaw_parameter* p : trial.parameters()) judged = look(trial, *p, draw) || judged;
        return judged;
      },
      otherwise);
}

void unknown(const Subject& subject) {
  const Trial trial = any_trial(subject);
  std::vector<std::string> names{"nobody_has_this"};
  for (const ilaw_parameter* p : all_parameters(subject.law)) names.push_back(std::string(p->name) + "_");
  for (const std::string& name : names)
    if (!parameter_of(subject.law, name)) expect_refused(trial, with(trial.values, number(name, 1.0)));
}

bool missing(const Trial& trial, const ilaw_parameter& p, Draw&) {
  if (!has(p, ILAW_FLAG_REQUIRED)) return false;
  expect_refused(trial, without(trial.values, p.name));
  return true;
}

std::vector<Value> beyond_range(const Trial&, const ilaw_parameter& p) {
  if (is_choice(p)) return {};
  // A count needs the next whole number, which beyond 2^53 is more than 1 away.
  const bool whole = p.kind == ILAW_KIND_INTEGER;
  const double below = whole ? std::min(p.minimum - 1.0, std::nextafter(p.minimum, -infinity))
                             : p.minimum - 1e-9 * std::max(1.0, std::abs(p.minimum));
  const double next = std::nextafter(p.maximum, infinity);
  const double above = whole ? std::max(p.maximum + 1.0, next) : next;
  std::vector<Value> wrong = {number(p.name, below)};
  if (has(p, ILAW_FLAG_EXCLUDES_MINIMUM)) wrong.push_back(number(p.name, p.minimum));
  if (above < infinity) wrong.push_back(number(p.name, above));
  return wrong;
}

std::vector<Value> no_number(const Trial&, const ilaw_parameter& p) {
  if (is_choice(p)) return {};
  return {number(p.name, std::nan(""))};
}

std::vector<Value> infinite(const Trial&, const ilaw_parameter& p) {
  if (is_choice(p)) return {};
  if (has(p, ILAW_FLAG_ALLOWS_INFINITY)) return {number(p.name, -infinity)};
  return {number(p.name, -infinity), number(p.name, infinity)};
}

std::vector<Value> no_whole_number(const Trial&, const ilaw_parameter& p) {
  if (p.kind != ILAW_KIND_INTEGER) return {};
  return {number(p.name, std::floor(p.minimum) + 0.5), number(p.name, std::floor(p.minimum) + 1.5)};
}

std::vector<Value> no_choice(const Trial&, const ilaw_parameter& p) {
  if (!is_choice(p)) return {};
  return {text(p, ""), text(p, std::string(p.choices[0]) + "_"), text(p, "none of them")};
}

std::vector<Value> other_kind(const Trial&, const ilaw_parameter& p) {
  Value unknown_kind = number(p.name, p.default_value);
  unknown_kind.kind = 77;
  return {is_choice(p) ? number(p.name, 1e6) : text(p, "many"), unknown_kind};
}

std::vector<Value> varying(const Trial&, const ilaw_parameter& p) {
  std::vector<Value> wrong;
  if (p.axis_count == 0) wrong.push_back(table(p, {{"time", {0.0, 1.0}}}, 0.5));
  if (!has(p, ILAW_FLAG_ALLOWS_PER_NODE)) wrong.push_back(per_node(p));
  return wrong;
}

// Every value at an end of its range is accepted beside some others: which, a law may restrict.
bool accepted_somewhere(const Trial& trial, const Value& value, Draw& draw) {
  constexpr int attempts = 300;
  const std::vector<Setup> setups = setups_of(trial.law);
  for (int k = 0; k < attempts; ++k) {
    const Setup& setup = setups[static_cast<std::size_t>(k) % setups.size()];
    Values values = {value};
    for (const ilaw_parameter* other : parameters_of(trial.law, setup))
      if (other->name != value.name && (has(*other, ILAW_FLAG_REQUIRED) || (k > 9 && draw.one_in(3))))
        values.push_back(draw_value(*other, draw));
    if (create(trial.law, setup, values)) return true;
  }
  return false;
}

bool accepted(const Trial& trial, const ilaw_parameter& p, Draw& draw) {
  Values ends;
  if (is_choice(p)) {
    for (std::uint32_t k = 0; k < p.choice_count; ++k) ends.push_back(text(p, p.choices[k]));
  } else {
    if (!has(p, ILAW_FLAG_EXCLUDES_MINIMUM)) ends.push_back(number(p.name, p.minimum));
    if (p.maximum < 1e6) ends.push_back(number(p.name, p.maximum));
    if (has(p, ILAW_FLAG_ALLOWS_INFINITY)) ends.push_back(number(p.name, infinity));
  }
  for (const Value& value : ends)
    if (!accepted_somewhere(trial, value, draw))
      fail(trial, joined("create refused ", text_of(Values{value}), " beside 300 sets of other parameters"),
           "accepted beside some, as its description says");
  return !ends.empty();
}

bool defaults(const Trial& trial, Draw& draw) {
  Values values = trial.values;
  for (const ilaw_parameter* p : trial.parameters()) {
    const bool given =
        std::any_of(values.begin(), values.end(), [&](const Value& value) { return value.name == p->name; });
    if (!given && !has(*p, ILAW_FLAG_REQUIRED)) values.push_back(default_of(*p));
  }
  if (values.size() == trial.values.size()) return false;
  const Trial said(trial.law, trial.setup, values);
  const Script script = draw_script(trial, draw);
  expect_same(said, script, run(trial, script), run(said, script), "with its defaults given");
  return true;
}

bool needs_spins(const Trial& trial, Draw&) {
  bool judged = false;
  for (const ilaw_parameter* p : all_parameters(trial.law)) {
    if (trial.setup.spins() || !has(*p, ILAW_FLAG_NEEDS_SPINS)) continue;
    expect_refused(trial, with(trial.values, default_of(*p)));
    judged = true;
  }
  return judged;
}

// Throws where a constant value that is given in another way changes a bit.
bool expect_no_change(const Trial& trial, const Value& value, Draw& draw) {
  const ilaw_parameter& p = *parameter_of(trial.law, value.name);
  const double exact = number_of(trial.law, trial.values, p.name);
  // An array of floats has the float next to a default such as 0.1; a table has doubles.
  const double constant = value.kind == ILAW_KIND_VALUE_PER_NODE ? trial.setup.rounded(exact) : exact;
  if (std::isinf(constant) || !in_range(p, constant)) return false;
  const Trial plain(trial.law, trial.setup, with(trial.values, number(p.name, constant)));
  const Values values = with(trial.values, value);
  if (!create(trial.law, trial.setup, values)) return false;  // does not go together with the others
  const Trial varied(trial.law, trial.setup, values);
  Script script = draw_script(plain, draw);
  const std::vector<Results> expected = run(plain, script);
  for (Inputs& in : script)
    in.per_node.assign(varied.info.per_node_parameter_count, std::vector<double>(in.count, constant));
  expect_same(varied, script, expected, run(varied, script), text_of(Values{value}));
  return true;
}

// Over each axis, and over as many as there may be.
std::vector<std::vector<TableAxis>> axes_for(const ilaw_parameter& p) {
  std::vector<std::vector<TableAxis>> all(1);
  for (std::uint32_t k = 0; k < p.axis_count; ++k) {
    const TableAxis axis{p.axes[k], {0.0, 0.003, 1.0}};
    all.push_back({axis});
    if (all[0].size() < 3) all[0].push_back(axis);
  }
  if (all[0].size() == 1) all.erase(all.begin());
  return all;
}

bool table_constant(const Trial& trial, const ilaw_parameter& p, Draw& draw) {
  const double value = number_of(trial.law, trial.values, p.name);
  if (!may_be_table(p) || !in_range(p, value)) return false;
  bool judged = false;
  for (const std::vector<TableAxis>& axes : axes_for(p)) {
    // Fields need a value: the one that they have anyway.
    Values values = trial.values;
    for (const TableAxis& axis : axes)
      if (const ilaw_parameter* field = parameter_of(trial.law, axis.name))
        values = with(values, number(field->name, number_of(trial.law, trial.values, axis.name)));
    if (!create(trial.law, trial.setup, values)) continue;
    const Trial plain(trial.law, trial.setup, values);
    judged = expect_no_change(plain, table(p, axes, value), draw) || judged;
  }
  return judged;
}

// Axes whose value the checker sets: the time, and fields of the law.
bool is_known_axis(const ilaw_law& law, const std::string& name) {
  const ilaw_parameter* field = parameter_of(law, name);
  return name == "time" || (field && field->kind == ILAW_KIND_NUMBER);
}

// A table at a place on its axes gives the bits of the constant that it has there.
bool expect_table_value(const Trial& trial, const Value& given, const std::vector<double>& place,
                        double value, Draw& draw) {
  Values values = trial.values;
  double time = 0.5;
  for (std::size_t k = 0; k < place.size(); ++k) {
    const ilaw_parameter* field = parameter_of(trial.law, given.axes[k].name);
    if (field && !in_range(*field, place[k])) return false;
    if (field) values = with(values, number(field->name, place[k]));
    if (given.axes[k].name == "time") time = place[k];
  }
  const ilaw_parameter& p = *parameter_of(trial.law, given.name);
  const Values constant = with(values, number(p.name, value));
  if (!in_range(p, value) || !create(trial.law, trial.setup, constant) ||
      !create(trial.law, trial.setup, with(values, given)))
    return false;
  const Trial plain(trial.law, trial.setup, constant), varied(trial.law, trial.setup, with(values, given));
  Script script = draw_script(plain, draw, {13, 1});
  script[0].time = time;
  std::string where;
  for (const double x : place) where += (where.empty() ? "" : ", ") + text_of(x);
  expect_same(varied, script, run(plain, script), run(varied, script),
              text_of(Values{given}) + " at (" + where + ") instead of " + text_of(value));
  return true;
}

// Places and values are exact in binary, so that any way to interpolate gives the same bits.
bool table_linear(const Trial& trial, const ilaw_parameter& p, Draw& draw) {
  if (!may_be_table(p) || p.kind != ILAW_KIND_NUMBER) return false;
  const double a = static_cast<float>(value_in_table(trial, p)), b = 2.0 * a, middle = 0.5 * (a + b);
  std::vector<std::string> known;
  for (std::uint32_t n = 0; n < p.axis_count; ++n)
    if (p.axes[n] != std::string(p.name) && is_known_axis(trial.law, p.axes[n]))
      known.emplace_back(p.axes[n]);
  bool judged = false;
  const auto expect = [&](const Value& given, const std::vector<double>& place, double value) {
    judged = expect_table_value(trial, given, place, value, draw) || judged;
  };
  for (const std::string& axis : known)
    for (const auto& [place, value] : std::map<double, double>{
             {0.125, a}, {0.25, a}, {0.5, middle}, {0.75, b}, {1.0, a}, {1.125, a}, {1024.0, a}})
      expect(table(p, {{axis, {0.25, 0.75, 1.0}}}, {a, b, a}), {place}, value);
  if (known.size() < 2) return judged;
  const Value over_two =
      table(p, {{known[0], {0.25, 0.75, 1.0}}, {known[1], {0.25, 0.75}}}, {a, b, a, a, b, a});
  const std::vector<std::pair<std::vector<double>, double>> corners{{{0.25, 0.25}, a}, {{0.25, 0.75}, b},
                                                                    {{0.75, 0.75}, a}, {{1.0, 0.25}, b},
                                                                    {{2.0, 0.75}, a},  {{0.25, 0.5}, middle}};
  for (const auto& [place, value] : corners) expect(over_two, place, value);
  return judged;
}

// Some nodes, each with its own values as constants, as they are among nodes with others.
bool expect_own_constants(const Trial& trial, Draw& draw) {
  const std::optional<Values> values = given_per_node(trial);
  if (!values) return false;
  const Trial varied(trial.law, trial.setup, *values);
  const Script script = draw_script(varied, draw, {13, 3});
  const std::vector<Results> all = run(varied, script);
  bool judged = false;
  for (const std::size_t node : {0U, 2U, 5U, 7U, 12U}) {
    const Values own = constants_of(varied, script[0], node);
    const bool has_infinite =
        std::any_of(own.begin(), own.end(), [](const Value& v) { return std::isinf(v.number); });
    if (has_infinite) continue;  // as a constant it may be another law
    const Trial alone(trial.law, trial.setup, own);
    if (alone.info.state_size != varied.info.state_size) continue;
    expect_part(alone, script, all, {node}, "with its values as constants");
    judged = true;
  }
  return judged;
}

bool node_constant(const Trial& trial, Draw& draw) {
  bool judged = false;
  for (const ilaw_parameter* p : trial.parameters())
    if (may_be_per_node(*p) && in_range(*p, number_of(trial.law, trial.values, p->name)))
      judged = expect_no_change(trial, per_node(*p), draw) || judged;
  return expect_own_constants(trial, draw) || judged;
}

std::vector<Value> table_shape(const Trial& trial, const ilaw_parameter& p) {
  if (!may_be_table(p)) return {};
  const double value = value_in_table(trial, p), not_a_number = std::nan("");
  const auto over = [&](const std::vector<double>& points, const std::vector<double>& values) {
    return table(p, {{p.axes[0], points}}, values);
  };
  return {over({}, {}),
          over({0.0, 0.0}, {value, value}),
          over({1.0, 0.0}, {value, value}),
          over({not_a_number}, {value}),
          over({0.0, infinity}, {value, value}),
          over({0.0, 1.0}, {value, p.minimum - 1.0 - 1e-9 * std::abs(p.minimum)}),
          over({0.0}, {not_a_number})};
}

std::vector<Value> table_axes(const Trial& trial, const ilaw_parameter& p) {
  if (!may_be_table(p)) return {};
  const TableAxis own{p.axes[0], {0.0, 1.0}}, unknown{"nobody_has_this", {0.0, 1.0}};
  std::vector<Value> wrong;
  for (const std::vector<TableAxis>& axes :
       std::vector<std::vector<TableAxis>>{{}, {unknown}, {own, unknown}, {own, own}, {own, own, own, own}})
    wrong.push_back(table(p, axes, value_in_table(trial, p)));
  return wrong;
}

bool table_field(const Trial& trial, const ilaw_parameter& p, Draw&) {
  bool judged = false;
  for (std::uint32_t k = 0; may_be_table(p) && k < p.axis_count; ++k) {
    const ilaw_parameter* field = parameter_of(trial.law, p.axes[k]);
    if (!field || !has(*field, ILAW_FLAG_FIELD)) continue;
    const Value over_field = table(p, {{field->name, {0.0, 1.0}}}, value_in_table(trial, p));
    expect_refused(trial, with(without(trial.values, field->name), over_field));
    judged = true;
  }
  return judged;
}

TableAxis long_axis(const char* name, std::size_t count) {
  TableAxis axis{name, std::vector<double>(count)};
  for (std::size_t k = 0; k < count; ++k) axis.points[k] = static_cast<double>(k);
  return axis;
}

// Two axes whose product is too large, and three whose product is 2^64: 0 in 64 bits. Values for all of them
// are not there, since nobody is to read them.
std::vector<Value> table_limit(const Trial& trial, const ilaw_parameter& p) {
  if (!may_be_table(p) || p.axis_count < 2) return {};
  std::vector<Value> wrong(p.axis_count > 2 ? 2 : 1,
                           table(p, {{p.axes[0], {0.0}}}, value_in_table(trial, p)));
  wrong[0].axes = {long_axis(p.axes[0], 4097), long_axis(p.axes[1], 4096)};
  if (wrong.size() > 1)
    wrong[1].axes = {long_axis(p.axes[0], 1U << 22), long_axis(p.axes[1], 1U << 21),
                     long_axis(p.axes[2], 1U << 21)};
  return wrong;
}

bool field_per_node(const Trial& trial, const ilaw_parameter& p, Draw&) {
  if (!has(p, ILAW_FLAG_FIELD)) return false;
  Refusal refusal{};
  if (!create(trial.law, trial.setup, with(trial.values, per_node(p)), refusal))
    fail(trial, joined("create refused the field '", p.name, "' per node: ", refusal.message),
         "an instance: hosts give a field that they have per node");
  return true;
}

// A value per node that is out of range is bad input at its node.
bool node_range(const Trial& trial, const ilaw_parameter& p, Draw& draw) {
  const Values values = with(trial.values, per_node(p));
  const double good = number_of(trial.law, trial.values, p.name);
  if (!may_be_per_node(p) || !std::isfinite(good)) return false;
  if (!create(trial.law, trial.setup, values)) return false;
  const Trial varied(trial.law, trial.setup, values);
  Script script = draw_script(varied, draw, {7, 1}, true);
  std::vector<double>& own = script[0].per_node[0];
  std::fill(own.begin(), own.end(), good);
  Arrays arrays(varied, script[0]);
  if (arrays.initialise(script[0]) != ILAW_OK) return false;
  const std::vector<double> state = arrays.state();
  if (arrays.evaluate(script[0]).code != ILAW_OK) return false;
  for (const double bad :
       {p.minimum - 1.0, std::nan(""), has(p, ILAW_FLAG_ALLOWS_INFINITY) ? -infinity : infinity}) {
    own[4] = bad;
    arrays.set_state(state);
    const Results found = arrays.evaluate(script[0]);
    if (found.code != ILAW_BAD_NODES || found.report.first_bad_node != 4)
      fail(varied, script[0], 4,
           joined("evaluate returned ", found.code, ", first bad node ", found.report.first_bad_node),
           "ILAW_BAD_NODES (1), node 4");
  }
  return true;
}

}  // namespace

std::vector<Rule> parameter_rules() {
  return {
      {"parameter-unknown", "A parameter that the law does not have is refused.",
       "ilaw.h, ILAW_INVALID_PARAMETER", needing(Needs::instance, unknown)},
      {"parameter-missing", "A set without a required parameter is refused.", "ilaw.h, ILAW_FLAG_REQUIRED",
       on_parameters(missing)},
      {"parameter-range",
       "A finite value below the minimum, at an excluded one, or above the maximum is refused.",
       "ilaw.h, ilaw_parameter.minimum", refuses<beyond_range>()},
      {"parameter-nan", "NaN is no value of a parameter.", "ilaw.h, ilaw_parameter.minimum",
       refuses<no_number>()},
      {"parameter-infinity", "Infinity is refused where it is not allowed, -infinity always.",
       "ilaw.h, ILAW_FLAG_ALLOWS_INFINITY", refuses<infinite>()},
      {"parameter-whole", "A count is a whole number.", "ilaw.h, ILAW_KIND_INTEGER",
       refuses<no_whole_number>()},
      {"parameter-choice", "A text that is none of the choices is refused.", "ilaw.h, ILAW_KIND_CHOICE",
       refuses<no_choice>()},
      {"parameter-kind", "A value of a kind that the parameter does not have is refused.",
       "ilaw.h, ilaw_argument.kind", refuses<other_kind>()},
      {"parameter-varying", "Tables, and values per node, are refused where they are not allowed.",
       "ilaw.h, ilaw_parameter.axes", refuses<varying>()},
      {"parameter-accepted",
       "The ends of its range, infinity where allowed, and every choice of a parameter are "
       "accepted beside some others.",
       "ilaw.h, ilaw_parameter", on_parameters(accepted)},
      {"parameter-default", "A parameter that is left out has its default value.",
       "ilaw.h, ilaw_parameter.default_value", on_trials(defaults, "all parameters are required")},
      {"parameter-spins",
       "A parameter that needs spins is refused for a form of H without, at its default value, too.",
       "ilaw.h, ILAW_FLAG_NEEDS_SPINS", on_instances(needs_spins, "no parameter needs spins")},
      {"table-shape",
       "A table without points, with points that do not increase or a value out of range is refused.",
       "ilaw.h, ilaw_axis.points", refuses<table_shape>()},
      {"table-axes", "A table over no axis, an unknown one, one twice, or more than three is refused.",
       "ilaw.h, ilaw_argument.axes", refuses<table_axes>()},
      {"table-field", "A table over a field that is not given is refused.", "ilaw.h, ilaw_argument.axes",
       on_parameters(table_field)},
      {"table-limit", "A table of more than ILAW_TABLE_MAX_VALUES values is refused.",
       "ilaw.h, ILAW_TABLE_MAX_VALUES", refuses<table_limit>()},
      {"table-constant", "A table of one value gives the bits of that value.",
       "ilaw.h, ILAW_KIND_VALUE_TABLE",
       on_trials_and_parameters(table_constant, "no parameter may be a table")},
      {"table-linear",
       "A table is linear along each axis and constant beyond its ends; the last axis varies fastest.",
       "ilaw.h, ILAW_KIND_VALUE_TABLE",
       on_trials_and_parameters(table_linear, "no parameter may be a table over time or a field")},
      {"field-per-node", "A field is accepted per node.", "ilaw.h, ILAW_FLAG_FIELD",
       needing(Needs::instance, on_trials_and_parameters(field_per_node, "the law has no fields").look)},
      {"per-node-constant",
       "A value per node gives the bits that it gives as a constant, whatever other nodes have.",
       "ilaw.h, ILAW_KIND_VALUE_PER_NODE", on_trials(node_constant, "no parameter may be given per node")},
      {"per-node-range", "A value per node that is out of range is bad input at its node.",
       "ilaw.h, ILAW_KIND_VALUE_PER_NODE",
       on_trials_and_parameters(node_range, "no parameter may be given per node")}};
}

}  // namespace ilaw::check
