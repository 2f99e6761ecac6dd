// Rules: the same in other axes, in a mirror and in other units.
// SPDX-License-Identifier: BSD-3-Clause
#include "check/rule.hpp"
#include "check/units.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

namespace ilaw::check {
namespace {

// Nodes whose impulse differs by rounding, amplified by H^-1, pass.
double tolerance(const Trial& trial) { return trial.setup.floats() ? 1e-4 : 1e-9; }

double natural_impulse(const Inputs& in, std::size_t i) {
  return length(in.vector(in.v_free, i)) / in.delassus[i * in.form_width] + 1e-3;
}

template <class Back>
void expect_image(const Trial& trial, const Script& script, const std::vector<Results>& plain,
                  const std::vector<Results>& image, const char* how, Back back) {
  for (std::size_t k = 0; k < script.size(); ++k)
    for (std::size_t i = 0; i < script[k].count; ++i) {
      const std::size_t d = script[k].dimension;
      const Vector r = plain[k].vector(plain[k].impulse, i, d),
                   found = back(i, image[k].vector(image[k].impulse, i, d));
      for (std::size_t c = 0; c < d; ++c)
        if (!(std::abs(r[c] - found[c]) <= tolerance(trial) * (length(r) + natural_impulse(script[k], i))))
          fail(trial, script[k], i,
               std::string(how) + ", step " + std::to_string(k) + ": impulse " + text_of(found, d) +
                   ", brought back",
               text_of(r, d));
    }
}

// Each step of the other trial from the state of the first: what rounding makes of a memory is not the
// question. state: that of the first as the other has it.
template <class State, class Back>
void expect_steps_alike(const Trial& trial, const Script& script, const Trial& other,
                        const Script& other_script, const std::string& how, State state, Back back) {
  Heap heap;
  Arrays arrays(trial, script[0], {}, heap), others(other, other_script[0], {}, heap);
  arrays.initialise(script[0]);
  std::vector<Results> plain, image;
  for (std::size_t k = 0; k < script.size(); ++k) {
    others.set_state(state(arrays.state()));
    plain.push_back(arrays.evaluate(script[k]));
    image.push_back(others.evaluate(other_script[k]));
  }
  expect_image(other, script, plain, image, how.c_str(), back);
}
std::vector<double> the_same(std::vector<double> state) { return state; }

// A scalar H is diagonal, transverse and full, a diagonal and a transverse one are full.
void form_agreement(const Subject& subject) {
  for_trials(
      subject,
      [](const Trial& trial, Draw& draw) {
        if (trial.setup.form == ILAW_DELASSUS_FULL) return false;
        bool judged = false;
        const Script script = draw_script(trial, draw);
        for (const std::uint32_t form :
             {ILAW_DELASSUS_DIAGONAL, ILAW_DELASSUS_FULL, ILAW_DELASSUS_TRANSVERSE}) {
          if (form != ILAW_DELASSUS_FULL && trial.setup.form != ILAW_DELASSUS_SCALAR) continue;
          Setup setup = trial.setup;
          setup.form = form;
          if (!(trial.law.delassus_forms & form) || !create(trial.law, setup, trial.values)) continue;
          const Trial other(trial.law, setup, trial.values);
          if (other.info.state_size != trial.info.state_size) continue;
          Script other_script;
          for (const Inputs& in : script) other_script.push_back(in_form(in, setup));
          expect_steps_alike(trial, script, other, other_script,
                             "with the same H in form " + std::to_string(form), the_same,
                             [](std::size_t, const Vector& r) { return r; });
          judged = true;
        }
        return judged;
      },
      "the law serves one form of H alone");
}

// With tangents a state is in local components, so it is the same in any axes.
bool keeps_axes(const Trial& trial) {
  for (std::uint32_t k = 0; k < trial.info.state_variable_count; ++k)
    if (trial.info.state_variables[k]->kind == ILAW_STATE_AXIS) return true;
  return false;
}

void frame_indifference(const Subject& subject) {
  for_trials(
      subject,
      [](const Trial& trial, Draw& draw) {
        const Setup& own = trial.setup;
        if (own.global()) return false;
        const std::uint32_t form =
            own.form == ILAW_DELASSUS_DIAGONAL ? std::uint32_t{ILAW_DELASSUS_FULL} : own.form;
        const Setup host{own.dimension, form, ILAW_FRAME_GLOBAL, own.dimension == 3 ? 1U : 0U, own.numbers};
        if (!(trial.law.delassus_forms & form) || !(trial.law.frames & ILAW_FRAME_GLOBAL) ||
            !create(trial.law, host, trial.values))
          return false;
        const Trial in_host(trial.law, host, trial.values);
        if (keeps_axes(in_host) || in_host.info.state_size != trial.info.state_size) return false;
        const Script script = draw_script(trial, draw);
        std::vector<Matrix> axes;
        for (std::size_t i = 0; i < script[0].count; ++i) axes.push_back(draw_axes(own.dimension, draw));
        Script host_script;
        for (const Inputs& in : script) {
          host_script.push_back(turned(in, axes));
          if (!host.has_tangent) host_script.back().tangent.clear();
        }
        expect_steps_alike(trial, script, in_host, host_script, "in axes of the host", the_same,
                           [&](std::size_t i, const Vector& r) { return times(axes[i], r); });
        return true;
      },
      "the law serves one frame alone");
}

// A state of the model as it would be in the turned one.
std::vector<double> turned_state(const Trial& trial, std::vector<double> state, const Matrix& rotation) {
  const std::size_t d = trial.setup.dimension;
  for (std::size_t first = 0; first < state.size(); first += trial.info.state_size)
    for (std::size_t k = 0, at = first; k < trial.info.state_variable_count; ++k) {
      const ilaw_state_variable& variable = *trial.info.state_variables[k];
      if (variable.kind == ILAW_STATE_AXIS) {
        Vector axis{};
        std::copy_n(&state[at], d, axis.begin());
        std::copy_n(times(rotation, axis).begin(), d, &state[at]);
      }
      at += variable.count;
    }
  return state;
}

void turned_whole(const Subject& subject) {
  for_trials(
      subject,
      [](const Trial& trial, Draw& draw) {
        if (!trial.setup.global() || trial.setup.dimension == 1 || trial.setup.form == ILAW_DELASSUS_DIAGONAL)
          return false;
        const Script script = draw_script(trial, draw);
        const Matrix rotation = draw_axes(trial.setup.dimension, draw);
        Script other;
        for (const Inputs& in : script) other.push_back(turned_as_a_whole(in, rotation));
        expect_steps_alike(
            trial, script, trial, other, "with the whole model turned",
            [&](std::vector<double> state) { return turned_state(trial, std::move(state), rotation); },
            [&](std::size_t, const Vector& r) { return times(transposed(rotation), r); });
        return true;
      },
      "the law serves no global frame in 2D or 3D");
}

void mirror(const Subject& subject) {
  for_trials(
      subject,
      [](const Trial& trial, Draw& draw) {
        const Setup& own = trial.setup;
        if (own.global() || own.dimension == 1) return false;
        const Script script = draw_script(trial, draw);
        Script other = script;
        for (Inputs& in : other)
          for (std::size_t i = 0; i < in.count; ++i) {
            in.v_free[i * in.dimension + 1] *= -1.0;
            in.v_previous[i * in.dimension + 1] *= -1.0;
            if (own.form != ILAW_DELASSUS_FULL) continue;
            double* couplings = &in.delassus[i * in.form_width + in.dimension];
            couplings[0] *= -1.0;                         // 01
            if (in.dimension == 3) couplings[2] *= -1.0;  // 12
          }
        expect_image(trial, script, run(trial, script), run(trial, other), "in a mirror",
                     [](std::size_t, const Vector& r) {
                       return Vector{r[0], -r[1], r[2]};
                     });
        return true;
      },
      "the law serves no tangents");
}

// An instance that in the host's axes needs no tangent knows no direction along the interface.
void isotropy(const Subject& subject) {
  for_trials(
      subject,
      [](const Trial& trial, Draw& draw) {
        const Setup& own = trial.setup;
        if (own.global() || own.dimension != 3) return false;
        if (own.form != ILAW_DELASSUS_SCALAR && own.form != ILAW_DELASSUS_TRANSVERSE) return false;
        if (!create(trial.law, {3, own.form, ILAW_FRAME_GLOBAL, 0, own.numbers}, trial.values)) return false;
        const double angle = draw.within(0.2, 1.3), c = std::cos(angle), s = std::sin(angle);
        const Matrix spin{Vector{1.0, 0.0, 0.0}, {0.0, c, s}, {0.0, -s, c}},
            back{Vector{1.0, 0.0, 0.0}, {0.0, c, -s}, {0.0, s, c}};
        const Script script = draw_script(trial, draw);
        Script other;
        for (const Inputs& in : script) other.push_back(turned_as_a_whole(in, spin));
        expect_image(trial, script, run(trial, script), run(trial, other), "turned about the normal",
                     [&](std::size_t, const Vector& r) { return times(back, r); });
        return true;
      },
      "the law tells its tangents apart");
}

// Values of the parameters in other units; none where one has a unit that is none.
std::optional<Values> in_units(const Trial& trial, const Units& units) {
  std::vector<std::string> symbols;
  std::map<std::string, double> numbers;
  for (std::uint32_t k = 0; k < trial.law.parameter_count; ++k) {
    const ilaw_parameter& p = *trial.law.parameters[k];
    symbols.emplace_back(p.symbol);
    numbers[p.symbol] = number_of(trial.law, trial.values, p.name);
  }
  Values values = trial.values;
  for (std::uint32_t k = 0; k < trial.law.parameter_count; ++k) {
    const ilaw_parameter& p = *trial.law.parameters[k];
    if (p.kind == ILAW_PARAMETER_CHOICE) continue;
    const std::optional<Dimensions> unit = parse_unit(p.unit, symbols);
    if (!unit) return std::nullopt;
    const double scaled = unit->in(units, numbers) * number_of(trial.law, values, p.name);
    if (!std::isfinite(scaled) && !std::isinf(number_of(trial.law, values, p.name))) return std::nullopt;
    values = with(values, {p.name, ILAW_VALUE_NUMBER, scaled});
  }
  return values;
}

Inputs in_units(Inputs in, const Units& units) {
  const auto scale = [](std::vector<double>& values, double factor) {
    for (double& value : values) value *= factor;
  };
  scale(in.v_free, units.velocity());
  scale(in.v_previous, units.velocity());
  scale(in.delassus, 1.0 / units.mass);
  scale(in.gap, units.length);
  scale(in.gap_offset, units.length);
  scale(in.area, units.length * units.length);
  for (double* time : {&in.time, &in.velocity_step, &in.position_step}) *time *= units.time;
  return in;
}

void other_units(const Subject& subject) {
  const Units units{0x1p+20, 0x1p-12, 0x1p+7};
  for_trials(
      subject,
      [&](const Trial& trial, Draw& draw) {
        const std::optional<Values> values = in_units(trial, units);
        if (!values || !create(trial.law, trial.setup, *values)) return false;
        const Trial scaled(trial.law, trial.setup, *values);
        const Script script = draw_script(trial, draw);
        Script other;
        for (const Inputs& in : script) other.push_back(in_units(in, units));
        expect_image(scaled, script, run(trial, script), run(scaled, other), "in other units",
                     [&](std::size_t, Vector r) {
                       for (double& component : r) component /= units.impulse();
                       return r;
                     });
        return true;
      },
      "a unit of a parameter is not known");
}

}  // namespace

std::vector<Rule> symmetry_rules() {
  return {{"form-agreement", "The same H gives the same impulse in whichever form it is given.",
           "ilaw.h, ILAW_DELASSUS_SCALAR", Needs::motion, form_agreement},
          {"frame-indifference", "An impulse is the same in local axes and in those of the host.",
           "ilaw.h, ILAW_FRAME_GLOBAL", Needs::motion, frame_indifference},
          {"frame-turned", "Where the whole model is turned, impulses turn with it.",
           "ilaw.h, ILAW_STATE_AXIS", Needs::motion, turned_whole},
          {"isotropy", "An instance that needs no tangent knows no direction along the interface.",
           "ilaw.h, ILAW_INPUT_TANGENT", Needs::motion, isotropy},
          {"mirror", "In a mirror impulses are mirrored.", "check.md, Symmetries", Needs::motion, mirror},
          {"units", "In other units, by those that its parameters declare, impulses are the same.",
           "ilaw.h, Conventions", Needs::motion, other_units}};
}

}  // namespace ilaw::check
