// SPDX-License-Identifier: BSD-3-Clause
#include "check/run.hpp"

#include "check/reach.hpp"
#include "check/sandbox.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <numeric>

namespace ilaw::check {
namespace {

constexpr std::uint8_t status_sentinel = 99;

std::optional<Difference> difference(const char* name, const std::vector<double>& a,
                                     const std::vector<double>& b, std::size_t nodes) {
  for (std::size_t k = 0; k < a.size() && k < b.size(); ++k) {
    if (same_bits(a[k], b[k])) continue;
    const std::size_t width = a.size() / nodes, node = k / width;
    return Difference{node, std::string(name) + "[" + std::to_string(k % width) + "] of node " +
                                std::to_string(node) + " is " + text_of(b[k]) + ", expected " +
                                text_of(a[k])};
  }
  return std::nullopt;
}

}  // namespace

std::string text_of(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.17g", value);
  return text.data();
}

std::string text_of(const Vector& a, std::size_t dimension) {
  std::string text = "(";
  for (std::size_t c = 0; c < dimension; ++c) text += (c ? ", " : "") + text_of(a[c]);
  return text + ")";
}

Vector Results::vector(const std::vector<double>& of, std::size_t node, std::size_t dimension) const {
  Vector a{};
  for (std::size_t c = 0; c < dimension; ++c) a[c] = of[node * dimension + c];
  return a;
}

Vector Results::moment_at(std::size_t node) const {
  return moment.empty() ? Vector{} : vector(moment, node, 3);
}

Arrays::Arrays(const Trial& trial, const Inputs& first, const Layout& layout, Memory& memory)
    : trial_(trial), layout_(layout), memory_(memory) {
  if (layout_.nodes.empty()) {
    layout_.nodes.resize(first.count);
    std::iota(layout_.nodes.begin(), layout_.nodes.end(), std::size_t{0});
  }
  room_ = layout_.nodes.size() + layout_.spare;
  make_list(memory);
  make_inputs(first, memory);
  make_outputs(memory);
  describe();
  load(first);
}

// Listed nodes stand in reverse, the spare ones among them.
void Arrays::make_list(Memory& memory) {
  const std::size_t count = layout_.nodes.size();
  for (std::size_t k = 0; k < count; ++k)
    places_.push_back(layout_.list == List::none ? k : room_ - 1 - k - k * layout_.spare / count);
  if (layout_.list == List::of_32_bits) {
    index_ = static_cast<std::int32_t*>(memory.take("index", count * sizeof *index_, Use::input));
    for (std::size_t k = 0; k < count; ++k)
      index_[k] = static_cast<std::int32_t>(places_[k]) + layout_.index_base;
  }
  if (layout_.list == List::of_64_bits) {
    index64_ = static_cast<std::int64_t*>(memory.take("index64", count * sizeof *index64_, Use::input));
    for (std::size_t k = 0; k < count; ++k)
      index64_[k] = static_cast<std::int64_t>(places_[k]) + layout_.index_base;
  }
}

Field Arrays::made(const char* name, std::size_t width, Use use, ilaw_number_type numbers) {
  return Field(memory_, name, width, room_, layout_.order, use, numbers, made_++ % 3);
}

void Arrays::make_inputs(const Inputs& first, Memory& memory) {
  const std::size_t d = first.dimension;
  const std::uint32_t wanted =
      trial_.info.inputs |
      (layout_.outputs & (ILAW_OUTPUT_ENERGY | amounts_output) ? trial_.info.balance_inputs : 0U);
  const auto make = [&](const char* name, std::size_t width, std::uint32_t bit) {
    const Use use = (wanted & bit) == bit ? Use::input : Use::unneeded;
    return made(name, width, use, trial_.setup.numbers);
  };
  v_free_ = make("v_free", d, 0);
  if (layout_.unasked || trial_.reads(ILAW_INPUT_V_SMOOTH))
    v_smooth_ = make("v_smooth", d, ILAW_INPUT_V_SMOOTH);
  delassus_ = make("delassus", first.form_width, 0);
  gap_ = make("gap", 1, ILAW_INPUT_GAP);
  gap_offset_ = make("gap_offset", 1, ILAW_INPUT_GAP);
  v_previous_ = make("v_previous", d, ILAW_INPUT_V_PREVIOUS);
  area_ = make("area", 1, ILAW_INPUT_AREA);
  if (!first.normal.empty()) normal_ = make("normal", d, 0);
  if (!first.tangent.empty()) tangent_ = make("tangent", d, 0);
  if (first.spins()) {
    spin_free_ = make("spin_free", d, 0);
    spin_previous_ = make("spin_previous", d, ILAW_INPUT_V_PREVIOUS);
  }
  const std::size_t varying = trial_.info.per_node_parameter_count;
  for (std::size_t k = 0; k < varying; ++k) per_node_.push_back(make("per_node_parameters", 1, 0));
  if (varying > 0) {
    void* room = memory.take("per_node_parameters", varying * sizeof(ilaw_input), Use::input);
    per_node_inputs_ = static_cast<ilaw_input*>(room);
    for (std::size_t k = 0; k < varying; ++k) per_node_inputs_[k] = per_node_[k].input();
  }
}

void Arrays::make_outputs(Memory& memory) {
  const auto make = [&](const char* name, std::size_t width, Use use) {
    return made(name, width, use, trial_.setup.numbers);
  };
  const auto make_state = [&](const char* name, Use use) {
    return made(name, trial_.info.state_size, use, ILAW_NUMBERS_DOUBLE);
  };
  const std::uint32_t outputs = layout_.outputs & (trial_.law.outputs | spin_output);
  const std::size_t d = trial_.setup.dimension;
  state_out_ = make_state("state_out", Use::output);
  state_in_ = layout_.in_place ? state_out_ : make_state("state_in", Use::input);
  impulse_ = make("impulse", d, Use::output);
  if (outputs & ILAW_OUTPUT_VELOCITY) velocity_ = make("velocity", d, Use::output);
  if (outputs & ILAW_OUTPUT_ENERGY) energy_ = make("energy", ILAW_ENERGY_COUNT, Use::output);
  if (trial_.setup.spins()) {
    moment_ = make("moment", d, Use::output);
    if (outputs & spin_output) spin_ = make("spin", d, Use::output);
  }
  const std::size_t amount_count = trial_.info.amount_count;
  if ((layout_.outputs & amounts_output) && amount_count > 0) {
    amounts_.resize(amount_count);
    for (std::size_t k = 0; k < amount_count; ++k)
      if (layout_.no_amount != k) amounts_[k] = make("amounts", 1, Use::output);
    void* room = memory.take("amounts", amount_count * sizeof(ilaw_output), Use::input);
    amount_outputs_ = static_cast<ilaw_output*>(room);
    for (std::size_t k = 0; k < amount_count; ++k) amount_outputs_[k] = amounts_[k].output();
  }
  if (outputs & ILAW_OUTPUT_STATUS) {
    status_stride_ = layout_.order == Order::spread ? 3 : 1;
    status_ =
        static_cast<std::uint8_t*>(memory.take("status", (room_ - 1) * status_stride_ + 1, Use::output));
  }
}

void Arrays::describe() {
  batch_.struct_size = sizeof batch_;
  batch_.index_base = layout_.index_base;
  batch_.node_count = static_cast<std::int64_t>(layout_.nodes.size());
  batch_.index = index_;
  batch_.index64 = index64_;
  batch_.v_free = v_free_.input();
  if (v_smooth_.given()) batch_.v_smooth = v_smooth_.input();
  batch_.delassus = delassus_.input();
  batch_.gap = gap_.input();
  batch_.gap_offset = gap_offset_.input();
  batch_.v_previous = v_previous_.input();
  batch_.area = area_.input();
  batch_.normal = normal_.input();
  batch_.tangent = tangent_.input();
  batch_.per_node_parameters = per_node_inputs_;
  batch_.state_in = state_in_.input();
  batch_.state_out = state_out_.output();
  batch_.impulse = impulse_.output();
  batch_.velocity = velocity_.output();
  batch_.energy = energy_.output();
  batch_.status = status_;
  batch_.status_stride = static_cast<std::int64_t>(status_stride_);
  batch_.amounts = amount_outputs_;
  batch_.spin_free = spin_free_.input();
  batch_.spin_previous = spin_previous_.input();
  batch_.moment = moment_.output();
  batch_.spin = spin_.output();
}

void Arrays::load_one(Field& field, const std::vector<double>& values) {
  if (!field.given()) return;
  for (std::size_t k = 0; k < layout_.nodes.size(); ++k)
    for (std::size_t c = 0; c < field.components(); ++c)
      field.put(places_[k], c, values[node(k) * field.components() + c]);
}

void Arrays::load(const Inputs& in) {
  batch_.time = in.time;
  batch_.velocity_step = in.velocity_step;
  batch_.position_step = in.position_step;
  batch_.gap_offset = in.gap_offset.empty() ? ilaw_input{} : gap_offset_.input();
  load_one(v_free_, in.v_free);
  if (trial_.reads(ILAW_INPUT_V_SMOOTH))
    batch_.v_smooth = in.v_smooth.empty() ? ilaw_input{} : v_smooth_.input();
  if (!in.v_smooth.empty()) load_one(v_smooth_, in.v_smooth);
  load_one(delassus_, in.delassus);
  load_one(gap_, in.gap);
  if (!in.gap_offset.empty()) load_one(gap_offset_, in.gap_offset);
  load_one(v_previous_, in.v_previous);
  load_one(area_, in.area);
  load_one(normal_, in.normal);
  load_one(tangent_, in.tangent);
  load_one(spin_free_, in.spin_free);
  load_one(spin_previous_, in.spin_previous);
  for (std::size_t k = 0; k < per_node_.size(); ++k) load_one(per_node_[k], in.per_node[k]);
}

std::int32_t Arrays::initialise(const Inputs& in) {
  load(in);
  report_ = {};
  report_.struct_size = sizeof report_;
  memory_.before_call();
  const std::int32_t code = trial_.instance.initialise(batch_, &report_);
  memory_.after_call();
  return code;
}

Results Arrays::evaluate(const Inputs& in) { return evaluate_with(trial_.instance, in); }

Results Arrays::evaluate_with(const Instance& instance, const Inputs& in) {
  load(in);
  const std::vector<double> before = take(state_out_);
  if (!layout_.in_place) {
    for (const std::size_t place : places_)
      for (std::size_t c = 0; c < state_out_.components(); ++c)
        state_in_.put(place, c, state_out_.get(place, c));
    state_out_.clear();
  }
  impulse_.clear();
  for (Field* optional : {&velocity_, &energy_, &moment_, &spin_})
    if (optional->given()) optional->clear();
  for (Field& amount : amounts_)
    if (amount.given()) amount.clear();
  if (status_) std::fill_n(status_, (room_ - 1) * status_stride_ + 1, status_sentinel);
  report_ = {};
  report_.struct_size = sizeof report_;
  memory_.before_call();
  const std::int32_t code = instance.evaluate(batch_, &report_);
  memory_.after_call();
  Results found = results(code);
  if (code >= 0) reach_of_thread().add(trial_.info, before, found.state, found.status);
  return found;
}

void Arrays::set_state(const std::vector<double>& state) { load_one(state_out_, state); }

std::vector<double> Arrays::take(const Field& field) const {
  std::vector<double> values;
  for (std::size_t k = 0; field.given() && k < places_.size(); ++k)
    for (std::size_t c = 0; c < field.components(); ++c) values.push_back(field.get(places_[k], c));
  return values;
}

std::vector<double> Arrays::state() { return take(state_out_); }
std::vector<double> Arrays::impulses() {
  std::vector<double> all = take(impulse_);
  for (const double value : take(moment_)) all.push_back(value);
  return all;
}
std::vector<double> Arrays::amounts() {
  std::vector<double> all;
  for (const Field& amount : amounts_)
    for (const double value : take(amount)) all.push_back(value);
  return all;
}

Results Arrays::results(std::int32_t code) {
  Results results{places_.size(), code, report_, take(impulse_), take(state_out_), take(velocity_),
                  take(energy_),  {},   {},      take(moment_),  take(spin_)};
  for (const Field& amount : amounts_) results.amounts.push_back(take(amount));
  for (std::size_t k = 0; status_ && k < places_.size(); ++k)
    results.status.push_back(status_[places_[k] * status_stride_]);
  return results;
}

const char* Arrays::written_beside() {
  std::vector<Field*> outputs{&state_out_, &impulse_, &velocity_, &energy_, &moment_, &spin_};
  for (Field& amount : amounts_) outputs.push_back(&amount);
  for (Field* field : outputs)
    if (field->given() && field->components() > 0 && !field->is_untouched_beside(places_))
      return field->name();
  for (std::size_t k = 0; status_ && k < (room_ - 1) * status_stride_ + 1; ++k) {
    const bool used = std::any_of(places_.begin(), places_.end(),
                                  [&](std::size_t place) { return place * status_stride_ == k; });
    if (!used && status_[k] != status_sentinel) return "status";
  }
  return nullptr;
}

std::vector<Results> run(const Trial& trial, const Script& script, const Layout& layout, Memory& memory) {
  Arrays arrays(trial, script.front(), layout, memory);
  arrays.initialise(script.front());
  std::vector<Results> results;
  for (const Inputs& in : script) results.push_back(arrays.evaluate(in));
  return results;
}

std::vector<Results> run(const Trial& trial, const Script& script, const Layout& layout) {
  Heap heap;
  return run(trial, script, layout, heap);
}

std::optional<Difference> difference(const Results& a, const Results& b, std::uint32_t outputs) {
  const std::size_t nodes = std::max<std::size_t>(a.nodes, 1);
  if (auto found = difference("impulse", a.impulse, b.impulse, nodes)) return found;
  if (auto found = difference("moment", a.moment, b.moment, nodes)) return found;
  if (auto found = difference("state_out", a.state, b.state, nodes)) return found;
  if (outputs & ILAW_OUTPUT_VELOCITY)
    if (auto found = difference("velocity", a.velocity, b.velocity, nodes)) return found;
  if (outputs & spin_output)
    if (auto found = difference("spin", a.spin, b.spin, nodes)) return found;
  if (outputs & ILAW_OUTPUT_ENERGY)
    if (auto found = difference("energy", a.energy, b.energy, nodes)) return found;
  for (std::size_t k = 0; (outputs & amounts_output) && k < std::min(a.amounts.size(), b.amounts.size()); ++k)
    if (auto found = difference("amount", a.amounts[k], b.amounts[k], nodes)) return found;
  for (std::size_t i = 0; (outputs & ILAW_OUTPUT_STATUS) && i < a.status.size() && i < b.status.size(); ++i)
    if (a.status[i] != b.status[i])
      return Difference{i, "status of node " + std::to_string(i) + " is " + std::to_string(b.status[i]) +
                               ", expected " + std::to_string(a.status[i])};
  if (a.code != b.code)
    return Difference{0, "the code is " + std::to_string(b.code) + ", expected " + std::to_string(a.code)};
  return std::nullopt;
}

void fail(const Trial& trial, const Inputs& in, std::size_t node, const std::string& seen,
          const std::string& allowed) {
  throw Finding{seen, allowed, trial.text(), in.arrays_of(node)};
}

void expect_same(const Trial& trial, const Script& script, const std::vector<Results>& expected,
                 const std::vector<Results>& found, const std::string& how, std::uint32_t outputs) {
  for (std::size_t k = 0; k < script.size(); ++k)
    if (const auto differs = difference(expected[k], found[k], outputs))
      fail(trial, script[k], differs->node, how + ", step " + std::to_string(k) + ": " + differs->text,
           "the same bits");
}

void expect_part(const Trial& trial, const Script& script, const std::vector<Results>& all,
                 const std::vector<std::size_t>& nodes, const char* how) {
  Layout layout;
  layout.nodes = nodes;
  const std::vector<Results> part = run(trial, script, layout);
  const std::size_t d = script[0].dimension, s = trial.info.state_size;
  for (std::size_t k = 0; k < script.size(); ++k)
    for (std::size_t j = 0; j < nodes.size(); ++j) {
      const auto same = [&](const std::vector<double>& a, const std::vector<double>& b, std::size_t width) {
        return a.empty() || std::equal(a.begin() + static_cast<std::ptrdiff_t>(nodes[j] * width),
                                       a.begin() + static_cast<std::ptrdiff_t>((nodes[j] + 1) * width),
                                       b.begin() + static_cast<std::ptrdiff_t>(j * width), same_bits);
      };
      const bool equal = same(all[k].impulse, part[k].impulse, d) && same(all[k].state, part[k].state, s) &&
                         same(all[k].velocity, part[k].velocity, d) &&
                         same(all[k].moment, part[k].moment, d) && same(all[k].spin, part[k].spin, d) &&
                         same(all[k].energy, part[k].energy, ILAW_ENERGY_COUNT) &&
                         std::equal(all[k].amounts.begin(), all[k].amounts.end(), part[k].amounts.begin(),
                                    [&](const auto& a, const auto& b) { return same(a, b, 1); }) &&
                         (all[k].status.empty() || all[k].status[nodes[j]] == part[k].status[j]);
      if (!equal)
        fail(trial, script[k], nodes[j],
             std::string(how) + ", step " + std::to_string(k) + ": node " + std::to_string(nodes[j]) +
                 " got the impulse " + text_of(part[k].vector(part[k].impulse, j, d), d) + ", among all " +
                 text_of(all[k].vector(all[k].impulse, nodes[j], d), d),
             "the same bits");
    }
}

}  // namespace ilaw::check
