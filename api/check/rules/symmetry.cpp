// Rules: the same in other axes, in a mirror and in other units.
// SPDX-License-Identifier: BSD-3-Clause
#include "check/rule.hpp"
#include "check/shake.hpp"
#include "check/units.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ilaw::check {
namespace {

// Nodes whose impulse differs by rounding, amplified by H^-1, pass.
double tolerance(const Trial& trial) { return trial.setup.floats() ? 1e-4 : 1e-9; }

double natural_impulse(const Inputs& in, std::size_t i) {
  const Wrench free = in.free(i);
  const double speed = free.head<3>().norm() + free.tail<3>().norm();
  return speed / in.delassus[i * in.form_width] + 1e-3;
}

// Arms are of order one, so that moments and impulses have one size.
bool are_alike(const Trial& trial, const Inputs& in, std::size_t i, const Wrench& a, const Wrench& b) {
  const double most = tolerance(trial) * (a.head<3>().norm() + a.tail<3>().norm() + natural_impulse(in, i));
  return ((a - b).array().abs() <= most).all();
}

[[noreturn]] void fail_image(const Trial& trial, const Inputs& in, std::size_t i, const std::string& how,
                             const Wrench& expected, const Wrench& found) {
  const auto text = [&](const Wrench& a) {
    return text_of(a.head<3>(), in.dimension) + (in.spins() ? ", moment " + text_of(a.tail<3>(), 3) : "");
  };
  fail(trial, in, i, joined(how, ": impulse ", text(found), ", brought back"), text(expected));
}

// Whether another form or frame refuses an H that is isotropic or transverse but for the rounding of its
// floats.
bool is_rounded_away(const Trial& other, const Results& image, std::size_t i) {
  return other.setup.floats() && !image.status.empty() && image.status[i] == ILAW_BAD_INPUT;
}

// A node that refuses what it was given says nothing of an edge.
void leave_out_edges(const Trial& trial, const Inputs& in, const Results& plain, const Results& shaken,
                     std::vector<bool>& is_judged) {
  for (std::size_t i = 0; i < in.count; ++i) {
    if (!shaken.status.empty() && shaken.status[i] == ILAW_BAD_INPUT) continue;
    is_judged[i] = is_judged[i] && are_alike(trial, in, i, plain.action(i), shaken.action(i));
  }
}

constexpr int shakes = 3;

template <class Change>
Script each_of(const Script& script, Change change) {
  Script changed;
  for (const Inputs& in : script) changed.push_back(change(in));
  return changed;
}

template <class Back>
void expect_image(const Trial& trial, const Script& script, const std::vector<Results>& plain,
                  const std::vector<Results>& image, const char* how, Back back) {
  for (std::size_t k = 0; k < script.size(); ++k)
    for (std::size_t i = 0; i < script[k].count; ++i) {
      const Wrench expected = plain[k].action(i), found = back(image[k].action(i));
      if (!are_alike(trial, script[k], i, expected, found))
        fail_image(trial, script[k], i, joined(how, ", step ", k), expected, found);
    }
}

// Each step of the other trial from the state of the first: what rounding makes of a memory is not the
// question. state: that of the first as the other has it.
template <class State, class Back>
void expect_steps_alike(const Trial& trial, const Script& script, const Trial& other,
                        const Script& other_script, const std::string& how, State state, Back back) {
  Started arrays(trial, script[0]), others(other, other_script[0]), shaken(trial, script[0]);
  Draw draw(script.size());
  Shake shake(trial, draw);
  for (std::size_t k = 0; k < script.size(); ++k) {
    const Inputs& in = script[k];
    const std::vector<double> before = arrays.state();
    others.set_state(state(before));
    const Results plain = arrays.evaluate(in), image = others.evaluate(other_script[k]);
    std::vector<bool> is_judged(in.count, true);
    for (int n = 0; n < shakes; ++n) {
      shaken.set_state(k > 0 ? shake(before) : before);  // a fresh node is told by its zeros
      leave_out_edges(trial, in, plain, shaken.evaluate(shake(in)), is_judged);
    }
    for (std::size_t i = 0; i < in.count; ++i) {
      const Wrench expected = plain.action(i), found = back(i, image.action(i));
      if (is_judged[i] && !is_rounded_away(other, image, i) && !are_alike(other, in, i, expected, found))
        fail_image(other, in, i, how + ", step " + std::to_string(k), expected, found);
    }
  }
}
std::vector<double> the_same(std::vector<double> state) { return state; }

// A scalar H is diagonal, transverse and full, a diagonal and a transverse one are full. Spins have one form.
bool form_agreement(const Trial& trial, Draw& draw) {
  if (trial.setup.form == ILAW_DELASSUS_FULL || trial.setup.spins()) return false;
  bool judged = false;
  const Script script = draw_script(trial, draw);
  for (const std::uint32_t form : {ILAW_DELASSUS_DIAGONAL, ILAW_DELASSUS_FULL, ILAW_DELASSUS_TRANSVERSE}) {
    if (form != ILAW_DELASSUS_FULL && trial.setup.form != ILAW_DELASSUS_SCALAR) continue;
    Setup setup = trial.setup;
    setup.form = form;
    if (!(trial.law.delassus_forms & form) || !create(trial.law, setup, trial.values)) continue;
    const Trial other(trial.law, setup, trial.values);
    if (other.info.state_size != trial.info.state_size) continue;
    const Script other_script = each_of(script, [&](const Inputs& in) { return in_form(in, setup); });
    expect_steps_alike(trial, script, other, other_script, "with the same H in form " + std::to_string(form),
                       the_same, [](std::size_t, const Wrench& a) { return a; });
    judged = true;
  }
  return judged;
}

// With tangents a state is in local components, so it is the same in any axes.
bool keeps_axes(const Trial& trial) {
  for (std::uint32_t k = 0; k < trial.info.state_variable_count; ++k)
    if (trial.info.state_variables[k]->kind == ILAW_KIND_AXIS) return true;
  return false;
}

// A setup in the axes of the host, which makes a diagonal H full.
Setup host_of(Setup own, bool has_tangent) {
  if (own.form == ILAW_DELASSUS_DIAGONAL) own.form = ILAW_DELASSUS_FULL;
  own.frame = ILAW_FRAME_GLOBAL;
  own.has_tangent = has_tangent ? 1 : 0;
  return own;
}

bool serves(const Trial& trial, const Setup& host) {
  return (trial.law.delassus_forms & host.form) && (trial.law.frames & host.frame) &&
         create(trial.law, host, trial.values);
}

std::vector<Matrix> draw_axes_of(const Script& script, Draw& draw) {
  std::vector<Matrix> axes;
  for (std::size_t i = 0; i < script[0].count; ++i) axes.push_back(draw_axes(script[0].dimension, draw));
  return axes;
}

// Whether the law serves the frame, and has the same state there.
bool expect_indifferent(const Trial& trial, const Setup& host, const Script& script,
                        const std::vector<Matrix>& axes) {
  if (!serves(trial, host)) return false;
  const Trial in_host(trial.law, host, trial.values);
  if (keeps_axes(in_host) || in_host.info.state_size != trial.info.state_size) return false;
  const Script host_script = each_of(script, [&](const Inputs& in) {
    Inputs in_axes = turned(in, axes);
    if (!host.has_tangent) in_axes.tangent.clear();
    return in_axes;
  });
  expect_steps_alike(trial, script, in_host, host_script, "in axes of the host", the_same,
                     [&](std::size_t i, const Wrench& a) { return turned(axes[i].transpose(), a); });
  return true;
}

bool frame_indifference(const Trial& trial, Draw& draw) {
  const Setup& own = trial.setup;
  if (own.global()) return false;
  const Setup host = host_of(own, own.dimension == 3);
  const Script script = draw_script(trial, draw);
  return expect_indifferent(trial, host, script, draw_axes_of(script, draw));
}

// The script in axes of the host that differ from step to step, without tangents.
Script in_axes(const Script& script, const std::vector<std::vector<Matrix>>& axes, const Setup& host) {
  Script turned_script;
  turned_script.reserve(script.size());
  for (std::size_t k = 0; k < script.size(); ++k) {
    turned_script.push_back(turned(script[k], axes[k]));
    turned_script.back().tangent.clear();
    turned_script.back().round_to(host);
  }
  return turned_script;
}

// In local axes a history stays as it is, and those without tangents are carried so. Nodes whose impulses
// differ in axes that stand still are left to other rules.
void expect_carried(const Trial& trial, const Trial& in_host, Draw& draw) {
  const Script script = draw_script(trial, draw);
  const std::size_t count = script[0].count, d = script[0].dimension;
  std::vector<std::vector<Matrix>> axes(script.size());
  axes[0] = draw_axes_of(script, draw);
  for (std::size_t k = 1; k < script.size(); ++k)
    for (std::size_t i = 0; i < count; ++i)
      axes[k].push_back(carried(axes[k - 1][i], draw_turned(axes[k - 1][i].col(0), d, draw)));
  const std::vector<std::vector<Matrix>> still(script.size(), axes[0]);
  const std::vector<Results> plain = run(trial, script),
                             unturned = run(in_host, in_axes(script, still, in_host.setup)),
                             found = run(in_host, in_axes(script, axes, in_host.setup));
  std::vector<std::vector<Results>> shaken(shakes);
  for (std::vector<Results>& of : shaken) of = run_shaken(trial, script, draw);
  std::vector<bool> is_judged(count, true);
  for (std::size_t k = 0; k < script.size(); ++k) {
    for (const std::vector<Results>& of : shaken)
      leave_out_edges(in_host, script[k], plain[k], of[k], is_judged);
    for (std::size_t i = 0; i < count; ++i) {
      const auto local = [&](const std::vector<Results>& of, const Matrix& by) {
        return turned(by.transpose(), of[k].action(i));
      };
      const Wrench r = plain[k].action(i), image = local(found, axes[k][i]);
      is_judged[i] = is_judged[i] && are_alike(in_host, script[k], i, r, local(unturned, axes[0][i]));
      // A refused node keeps its state bit for bit: that step has not carried it.
      if (!found[k].status.empty() && found[k].status[i] == ILAW_BAD_INPUT) is_judged[i] = false;
      if (is_judged[i] && !are_alike(in_host, script[k], i, r, image))
        fail_image(in_host, script[k], i, "after " + std::to_string(k) + " turns of the normal", r, image);
    }
  }
}

bool history_carried(const Trial& trial, Draw& draw) {
  const Setup& own = trial.setup;
  if (own.global() || own.dimension == 1 || trial.info.state_size == 0) return false;
  const Setup host = host_of(own, false);
  if (!serves(trial, host)) return false;
  expect_carried(trial, Trial(trial.law, host, trial.values), draw);
  return true;
}

// A state of the model as it would be in the turned one.
std::vector<double> turned_state(const Trial& trial, std::vector<double> state, const Matrix& rotation) {
  const std::size_t d = trial.setup.dimension;
  for (std::size_t first = 0; first < state.size(); first += trial.info.state_size)
    for (std::size_t k = 0, at = first; k < trial.info.state_variable_count; ++k) {
      const ilaw_state_variable& variable = *trial.info.state_variables[k];
      if (variable.kind == ILAW_KIND_AXIS) {
        Vector axis = Vector::Zero();
        std::copy_n(&state[at], d, axis.begin());
        axis = rotation * axis;
        std::copy_n(axis.begin(), d, &state[at]);
      }
      at += variable.count;
    }
  return state;
}

bool turned_whole(const Trial& trial, Draw& draw) {
  if (!trial.setup.global() || trial.setup.dimension == 1 || trial.setup.form == ILAW_DELASSUS_DIAGONAL)
    return false;
  const Script script = draw_script(trial, draw);
  const Matrix rotation = draw_axes(trial.setup.dimension, draw);
  const Script other = each_of(script, [&](const Inputs& in) { return turned_as_a_whole(in, rotation); });
  expect_steps_alike(
      trial, script, trial, other, "with the whole model turned",
      [&](std::vector<double> state) { return turned_state(trial, std::move(state), rotation); },
      [&](std::size_t, const Wrench& a) { return turned(rotation.transpose(), a); });
  return true;
}

// The same motion turned about the normal, or mirrored, with the same parameters.
void expect_turned(const Trial& trial, const Script& script, const Matrix& by, const char* how) {
  const Script other = each_of(script, [&](const Inputs& in) { return turned_as_a_whole(in, by); });
  expect_image(trial, script, run(trial, script), run(trial, other), how,
               [&](const Wrench& a) { return turned(by.transpose(), a); });
}

bool mirror(const Trial& trial, Draw& draw) {
  if (trial.setup.global() || trial.setup.dimension == 1) return false;
  expect_turned(trial, draw_script(trial, draw), Vector{1.0, -1.0, 1.0}.asDiagonal(), "in a mirror");
  return true;
}

// An instance that in the host's axes needs no tangent knows no direction along the interface.
bool isotropy(const Trial& trial, Draw& draw) {
  const Setup& own = trial.setup;
  if (own.global() || own.dimension != 3) return false;
  if (own.form == ILAW_DELASSUS_DIAGONAL || own.form == ILAW_DELASSUS_FULL) return false;
  const Setup host = host_of(own, false);
  if (!create(trial.law, host, trial.values)) return false;
  const Matrix spin = Eigen::AngleAxisd(-draw.within(0.2, 1.3), Vector::UnitX()).toRotationMatrix();
  const Script script = draw_script(trial, draw);
  expect_turned(trial, script, spin, "turned about the normal");
  expect_indifferent(trial, host, script, draw_axes_of(script, draw));
  return true;
}

// Values of the parameters in other units; none where one has a unit that is none.
std::optional<Values> in_units(const Trial& trial, const Units& units) {
  const std::vector<std::string> symbols = symbols_of(trial.law);
  const std::map<std::string, double> numbers = numbers_by_symbol(trial.law, trial.values);
  Values values = trial.values;
  for (const ilaw_parameter* p : trial.parameters()) {
    if (p->kind == ILAW_KIND_CHOICE) continue;
    const std::optional<Dimensions> unit = parse_unit(p->unit, symbols);
    if (!unit) return std::nullopt;
    const double value = number_of(trial.law, values, p->name), scaled = unit->in(units, numbers) * value;
    if (!std::isfinite(scaled) && !std::isinf(value)) return std::nullopt;
    values = with(values, {p->name, ILAW_KIND_VALUE_NUMBER, scaled});
  }
  return values;
}

Inputs in_units(Inputs in, const Units& units) {
  const auto scale = [](std::vector<double>& values, double factor) {
    for (double& value : values) value *= factor;
  };
  for (std::vector<double>* values : {&in.v_free, &in.v_smooth, &in.v_previous})
    scale(*values, units.velocity());
  scale(in.delassus, 1.0 / units.mass);
  for (std::vector<double>* values : {&in.spin_free, &in.spin_previous}) scale(*values, 1.0 / units.time);
  for (std::size_t i = 0; in.spins() && i < in.count; ++i) {  // k has 1/(kg m), j 1/(kg m^2)
    double* values = &in.delassus[i * in.form_width];
    values[2] /= units.length;
    for (const std::size_t c : {3U, 4U}) values[c] /= units.length * units.length;
  }
  scale(in.gap, units.length);
  scale(in.gap_offset, units.length);
  scale(in.area, units.length * units.length);
  for (double* time : {&in.time, &in.velocity_step, &in.position_step}) *time *= units.time;
  return in;
}

bool other_units(const Trial& trial, Draw& draw) {
  const Units units{0x1p+20, 0x1p-12, 0x1p+7};
  const std::optional<Values> values = in_units(trial, units);
  if (!values || !create(trial.law, trial.setup, *values)) return false;
  const Trial in_others(trial.law, trial.setup, *values);
  const Script script = draw_script(trial, draw);
  const Script other = each_of(script, [&](const Inputs& in) { return in_units(in, units); });
  expect_image(in_others, script, run(trial, script), run(in_others, other), "in other units",
               [&](const Wrench& a) {
                 Wrench image = a / units.impulse();
                 image.tail<3>() /= units.length;
                 return image;
               });
  return true;
}

}  // namespace

std::vector<Rule> symmetry_rules() {
  return {
      {"form-agreement", "The same H gives the same impulse in whichever form it is given.",
       "ilaw.h, ILAW_DELASSUS_SCALAR", on_trials(form_agreement, "the law serves one form of H alone")},
      {"frame-indifference", "An impulse, and a moment, is the same in local axes and in those of the host.",
       "ilaw.h, ILAW_FRAME_GLOBAL", on_trials(frame_indifference, "the law serves one frame alone")},
      {"frame-turned", "When the whole model is turned, impulses and moments turn with it.",
       "ilaw.h, ILAW_KIND_AXIS", on_trials(turned_whole, "the law serves no global frame in 2D or 3D")},
      {"history-carried",
       "Without tangents a history is carried from normal to normal by the shortest rotation.",
       "abi.md, Histories and rotations",
       on_trials(history_carried, "the law has no state, or serves one frame alone")},
      {"isotropy",
       "An instance that needs no tangent knows no direction along the interface, and is the same without.",
       "ilaw.h, ILAW_INPUT_TANGENT", on_trials(isotropy, "the law tells its tangents apart")},
      {"mirror", "In a mirror impulses are mirrored, and moments as axial vectors.", "check.md, Symmetries",
       on_trials(mirror, "the law serves no tangents")},
      {"units", "In other units, by those that its parameters declare, impulses and moments are the same.",
       "ilaw.h, Conventions", on_trials(other_units, "a unit of a parameter is not known")}};
}

}  // namespace ilaw::check
