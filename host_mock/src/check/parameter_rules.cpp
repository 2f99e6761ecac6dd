// Rules: parameters are accepted and refused as their description says.
// SPDX-License-Identifier: BSD-3-Clause
#include "check/rule.hpp"

#include "check/sandbox.hpp"

#include <algorithm>
#include <cmath>

namespace ilaw::check {
namespace {

// create refuses the values with ILAW_INVALID_PARAMETER, no instance and a message.
void expect_refused(const Trial& trial, const Values& values) {
  const SetupStruct given(trial.setup, values);
  const std::string setting = text_of(trial.setup) + "; " + text_of(values);
  set_setting(setting);
  Refusal refusal{};
  if (create(trial.law, given.given, refusal))
    throw Finding{"create accepted them", "ILAW_INVALID_PARAMETER", setting, {}};
  if (refusal.code != ILAW_INVALID_PARAMETER)
    throw Finding{"create returned " + std::to_string(refusal.code) + ": " + refusal.message,
                  "ILAW_INVALID_PARAMETER (-2)",
                  setting,
                  {}};
}

Value number(const ilaw_parameter& p, double value) { return {p.name, ILAW_VALUE_NUMBER, value}; }
Value text(const ilaw_parameter& p, const std::string& word) { return {p.name, ILAW_VALUE_TEXT, 0.0, word}; }
bool is_choice(const ilaw_parameter& p) { return p.kind == ILAW_PARAMETER_CHOICE; }

template <class Look>
void for_parameters(const Subject& subject, Look look) {
  const Trial trial = any_trial(subject);
  bool judged = false;
  for (std::uint32_t k = 0; k < subject.law.parameter_count; ++k)
    judged = look(trial, *subject.law.parameters[k]) || judged;
  if (!judged) throw NotJudged{"the law has no such parameter"};
}

void unknown(const Subject& subject) {
  const Trial trial = any_trial(subject);
  std::string name = "nobody_has_this";
  expect_refused(trial, with(trial.values, {name, ILAW_VALUE_NUMBER, 1.0}));
  for (std::uint32_t k = 0; k < subject.law.parameter_count; ++k) {
    name = std::string(subject.law.parameters[k]->name) + "_";
    if (!parameter_of(subject.law, name))
      expect_refused(trial, with(trial.values, {name, ILAW_VALUE_NUMBER, 1.0}));
  }
}

void missing(const Subject& subject) {
  for_parameters(subject, [](const Trial& trial, const ilaw_parameter& p) {
    if (!p.required) return false;
    Values values = trial.values;
    std::erase_if(values, [&](const Value& value) { return value.name == p.name; });
    expect_refused(trial, values);
    return true;
  });
}

void range(const Subject& subject) {
  for_parameters(subject, [](const Trial& trial, const ilaw_parameter& p) {
    if (is_choice(p)) return false;
    // Of whole numbers the next ones, which beyond 2^53 are further off.
    const bool whole = p.kind == ILAW_PARAMETER_COUNT;
    const double below = whole ? std::min(p.minimum - 1.0, std::nextafter(p.minimum, -infinity))
                               : p.minimum - 1e-9 * std::max(1.0, std::abs(p.minimum));
    expect_refused(trial, with(trial.values, number(p, below)));
    if (p.minimum_excluded) expect_refused(trial, with(trial.values, number(p, p.minimum)));
    const double next = std::nextafter(p.maximum, infinity);
    const double above = whole ? std::max(p.maximum + 1.0, next) : next;
    if (above < infinity) expect_refused(trial, with(trial.values, number(p, above)));
    return true;
  });
}

void no_number(const Subject& subject) {
  for_parameters(subject, [](const Trial& trial, const ilaw_parameter& p) {
    if (is_choice(p)) return false;
    expect_refused(trial, with(trial.values, number(p, std::nan(""))));
    return true;
  });
}

void infinite(const Subject& subject) {
  for_parameters(subject, [](const Trial& trial, const ilaw_parameter& p) {
    if (is_choice(p)) return false;
    expect_refused(trial, with(trial.values, number(p, -infinity)));
    if (!p.infinity_allowed) expect_refused(trial, with(trial.values, number(p, infinity)));
    return true;
  });
}

void whole_number(const Subject& subject) {
  for_parameters(subject, [](const Trial& trial, const ilaw_parameter& p) {
    if (p.kind != ILAW_PARAMETER_COUNT) return false;
    expect_refused(trial, with(trial.values, number(p, std::floor(p.minimum) + 0.5)));
    expect_refused(trial, with(trial.values, number(p, std::floor(p.minimum) + 1.5)));
    return true;
  });
}

void choice(const Subject& subject) {
  for_parameters(subject, [](const Trial& trial, const ilaw_parameter& p) {
    if (!is_choice(p)) return false;
    for (const std::string& word :
         {std::string(), std::string(p.choices[0]) + "_", std::string("none of them")})
      expect_refused(trial, with(trial.values, text(p, word)));
    return true;
  });
}

void kind(const Subject& subject) {
  for_parameters(subject, [](const Trial& trial, const ilaw_parameter& p) {
    if (is_choice(p))
      expect_refused(trial, with(trial.values, number(p, 1e6)));
    else
      expect_refused(trial, with(trial.values, text(p, "many")));
    Value unknown_kind = number(p, p.default_value);
    unknown_kind.kind = 77;
    expect_refused(trial, with(trial.values, unknown_kind));
    return true;
  });
}

void varying(const Subject& subject) {
  for_parameters(subject, [](const Trial& trial, const ilaw_parameter& p) {
    if (!(p.may_be & ILAW_MAY_BE_TABLE))
      expect_refused(trial, with(trial.values, {p.name, ILAW_VALUE_TABLE, 0.0, {}, {0.0, 0.5, 1.0, 0.5}}));
    if (!(p.may_be & ILAW_MAY_BE_PER_NODE))
      expect_refused(trial, with(trial.values, {p.name, ILAW_VALUE_PER_NODE}));
    return p.may_be != (ILAW_MAY_BE_TABLE | ILAW_MAY_BE_PER_NODE);
  });
}

// Every value at an end of its range is accepted beside some others: which, a law may restrict.
bool accepted_somewhere(const Trial& trial, const Value& value, Draw& draw) {
  constexpr int attempts = 300;
  const std::vector<Setup> setups = setups_of(trial.law);
  for (int k = 0; k < attempts; ++k) {
    Values values = {value};
    for (std::uint32_t p = 0; p < trial.law.parameter_count; ++p) {
      const ilaw_parameter& other = *trial.law.parameters[p];
      if (other.name != value.name && (other.required || (k > 9 && draw.one_in(3))))
        values.push_back(draw_value(other, draw));
    }
    if (create(trial.law, setups[static_cast<std::size_t>(k) % setups.size()], values)) return true;
  }
  return false;
}

void accepted(const Subject& subject) {
  Draw draw(subject.seed);
  for_parameters(subject, [&](const Trial& trial, const ilaw_parameter& p) {
    Values ends;
    if (is_choice(p)) {
      for (std::uint32_t k = 0; k < p.choice_count; ++k) ends.push_back(text(p, p.choices[k]));
    } else {
      if (!p.minimum_excluded) ends.push_back(number(p, p.minimum));
      if (p.maximum < 1e6) ends.push_back(number(p, p.maximum));
      if (p.infinity_allowed) ends.push_back(number(p, infinity));
    }
    for (const Value& value : ends)
      if (!accepted_somewhere(trial, value, draw))
        throw Finding{"create refused " + text_of(Values{value}) + " beside 300 sets of other parameters",
                      "accepted beside some, as its description says",
                      trial.text(),
                      {}};
    return !ends.empty();
  });
}

void defaults(const Subject& subject) {
  for_trials(
      subject,
      [](const Trial& trial, Draw& draw) {
        Values values = trial.values;
        for (std::uint32_t k = 0; k < trial.law.parameter_count; ++k) {
          const ilaw_parameter& p = *trial.law.parameters[k];
          const bool given = std::any_of(values.begin(), values.end(),
                                         [&](const Value& value) { return value.name == p.name; });
          if (given || p.required) continue;
          values.push_back(is_choice(p) ? text(p, p.choices[static_cast<std::size_t>(p.default_value)])
                                        : number(p, p.default_value));
        }
        if (values.size() == trial.values.size()) return false;
        const Trial said(trial.law, trial.setup, values);
        const Script script = draw_script(trial, draw);
        expect_same(said, script, run(trial, script), run(said, script), "with its defaults given");
        return true;
      },
      "all parameters are required");
}

// Throws where a constant value that is given in another way changes a bit.
bool expect_no_change(const Trial& trial, const Value& value, Draw& draw) {
  const ilaw_parameter& p = *parameter_of(trial.law, value.name);
  const double constant = number_of(trial.law, trial.values, p.name);
  if (std::isinf(constant)) return false;
  const Trial plain(trial.law, trial.setup, with(trial.values, number(p, constant)));
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

bool may_be(const ilaw_parameter& p, std::uint32_t way) { return !is_choice(p) && (p.may_be & way); }

void table_constant(const Subject& subject) {
  for_trials(
      subject,
      [](const Trial& trial, Draw& draw) {
        bool judged = false;
        for (std::uint32_t k = 0; k < trial.law.parameter_count; ++k) {
          const ilaw_parameter& p = *trial.law.parameters[k];
          const double value = number_of(trial.law, trial.values, p.name);
          if (may_be(p, ILAW_MAY_BE_TABLE) && in_range(p, value))
            judged = expect_no_change(
                         trial, {p.name, ILAW_VALUE_TABLE, 0.0, {}, {0.0, value, 0.003, value, 1.0, value}},
                         draw) ||
                     judged;
        }
        return judged;
      },
      "no parameter may be a table");
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

void node_constant(const Subject& subject) {
  for_trials(
      subject,
      [](const Trial& trial, Draw& draw) {
        bool judged = false;
        for (std::uint32_t k = 0; k < trial.law.parameter_count; ++k) {
          const ilaw_parameter& p = *trial.law.parameters[k];
          if (may_be(p, ILAW_MAY_BE_PER_NODE) && in_range(p, number_of(trial.law, trial.values, p.name)))
            judged = expect_no_change(trial, {p.name, ILAW_VALUE_PER_NODE}, draw) || judged;
        }
        return expect_own_constants(trial, draw) || judged;
      },
      "no parameter may be given per node");
}

void table_shape(const Subject& subject) {
  for_parameters(subject, [](const Trial& trial, const ilaw_parameter& p) {
    if (!may_be(p, ILAW_MAY_BE_TABLE)) return false;
    const double good = number_of(trial.law, trial.values, p.name), below = p.minimum - 1.0;
    const double value =
        in_range(p, good) && std::isfinite(good) ? good : std::nextafter(p.minimum, infinity);
    const double not_a_number = std::nan("");
    for (const std::vector<double>& table : {std::vector<double>{},
                                             {0.0, value, 0.0, value},
                                             {1.0, value, 0.0, value},
                                             {not_a_number, value},
                                             {0.0, value, infinity, value},
                                             {0.0, value, 1.0, below},
                                             {0.0, not_a_number}})
      expect_refused(trial, with(trial.values, {p.name, ILAW_VALUE_TABLE, 0.0, {}, table}));
    return true;
  });
}

// A value per node that is out of range is bad input at its node.
void node_range(const Subject& subject) {
  for_trials(
      subject,
      [](const Trial& trial, Draw& draw) {
        bool judged = false;
        for (std::uint32_t k = 0; k < trial.law.parameter_count; ++k) {
          const ilaw_parameter& p = *trial.law.parameters[k];
          const Values values = with(trial.values, {p.name, ILAW_VALUE_PER_NODE});
          const double good = number_of(trial.law, trial.values, p.name);
          if (!may_be(p, ILAW_MAY_BE_PER_NODE) || !std::isfinite(good)) continue;
          if (!create(trial.law, trial.setup, values)) continue;
          const Trial varied(trial.law, trial.setup, values);
          Script script = draw_script(varied, draw, {7, 1}, true);
          std::vector<double>& own = script[0].per_node[0];
          std::fill(own.begin(), own.end(), good);
          Heap heap;
          Arrays arrays(varied, script[0], {}, heap);
          if (arrays.initialise(script[0]) != ILAW_OK) continue;
          const std::vector<double> state = arrays.state();
          if (arrays.evaluate(script[0]).code != ILAW_OK) continue;
          for (const double bad :
               {p.minimum - 1.0, std::nan(""), p.infinity_allowed ? -infinity : infinity}) {
            own[4] = bad;
            arrays.set_state(state);
            const Results found = arrays.evaluate(script[0]);
            if (found.code != ILAW_BAD_NODES || found.report.first_bad_node != 4)
              fail(varied, script[0], 4,
                   "evaluate returned " + std::to_string(found.code) + ", first bad node " +
                       std::to_string(found.report.first_bad_node),
                   "ILAW_BAD_NODES (1), node 4");
          }
          judged = true;
        }
        return judged;
      },
      "no parameter may be given per node");
}

}  // namespace

std::vector<Rule> parameter_rules() {
  return {{"parameter-unknown", "A parameter that the law does not have is refused.",
           "ilaw.h, ILAW_INVALID_PARAMETER", Needs::instance, unknown},
          {"parameter-missing", "A set without a required parameter is refused.",
           "ilaw.h, ilaw_parameter.required", Needs::instance, missing},
          {"parameter-range",
           "A finite value below the minimum, at an excluded one, or above the maximum is refused.",
           "ilaw.h, ilaw_parameter.minimum", Needs::instance, range},
          {"parameter-nan", "NaN is no value of a parameter.", "ilaw.h, ilaw_parameter.minimum",
           Needs::instance, no_number},
          {"parameter-infinity", "Infinity is refused where it is not allowed, -infinity always.",
           "ilaw.h, ilaw_parameter.infinity_allowed", Needs::instance, infinite},
          {"parameter-whole", "A count is a whole number.", "ilaw.h, ILAW_PARAMETER_COUNT", Needs::instance,
           whole_number},
          {"parameter-choice", "A text that is none of the choices is refused.",
           "ilaw.h, ILAW_PARAMETER_CHOICE", Needs::instance, choice},
          {"parameter-kind", "A value of a kind that the parameter does not have is refused.",
           "ilaw.h, ilaw_argument.kind", Needs::instance, kind},
          {"parameter-varying", "Tables, and values per node, are refused where they are not allowed.",
           "ilaw.h, ilaw_parameter.may_be", Needs::instance, varying},
          {"parameter-accepted",
           "The ends of its range, infinity where allowed, and every choice of a parameter are "
           "accepted beside some others.",
           "ilaw.h, ilaw_parameter", Needs::instance, accepted},
          {"parameter-default", "A parameter that is left out has its default value.",
           "ilaw.h, ilaw_parameter.default_value", Needs::motion, defaults},
          {"table-shape",
           "A table without pairs, with times that do not increase or a value out of range is refused.",
           "ilaw.h, ilaw_argument.values", Needs::instance, table_shape},
          {"table-constant", "A table of one value gives the bits of that value.", "ilaw.h, ILAW_VALUE_TABLE",
           Needs::motion, table_constant},
          {"per-node-constant",
           "A value per node gives the bits that it gives as a constant, whatever other nodes have.",
           "ilaw.h, ILAW_VALUE_PER_NODE", Needs::motion, node_constant},
          {"per-node-range", "A value per node that is out of range is bad input at its node.",
           "ilaw.h, ILAW_VALUE_PER_NODE", Needs::motion, node_range}};
}

}  // namespace ilaw::check
