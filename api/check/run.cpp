// SPDX-License-Identifier: BSD-3-Clause
#include "check/run.hpp"

#include "check/reach.hpp"
#include "check/sandbox.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>

namespace ilaw::check {
namespace {

constexpr std::uint8_t status_sentinel = 99;

std::optional<Difference> difference(const char* name, const std::vector<double>& a,
                                     const std::vector<double>& b, std::size_t nodes) {
  for (std::size_t k = 0; k < a.size() && k < b.size(); ++k) {
    if (same_bits(a[k], b[k])) continue;
    const std::size_t width = a.size() / nodes, node = k / width;
    return Difference{node, std::string(name) + "[" + std::to_string(k % width) + "] is " + text_of(b[k]) +
                                ", expected " + text_of(a[k])};
  }
  return std::nullopt;
}

// Some steps are given it, others not.
bool is_optional(const NodeArray& array) {
  return array.values == &Inputs::v_smooth || array.values == &Inputs::gap_offset;
}

// The states that the last call began from, by inputs of all nodes: findings name them.
thread_local std::map<const Inputs*, std::vector<double>> states_in;

}  // namespace

void forget_states() { states_in.clear(); }

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

Vector Results::moment_at(std::size_t node) const {
  return moment.empty() ? Vector{} : vector_of(moment, node, 3);
}

Results Results::of_nodes(const std::vector<std::size_t>& which) const {
  const auto of = [&](const auto& values) { return picked(values, which, nodes); };
  Results own{which.size(), code, report,     of(impulse), of(state), of(velocity),
              of(energy),   {},   of(status), of(moment),  of(spin)};
  for (const std::vector<double>& amount : amounts) own.amounts.push_back(of(amount));
  return own;
}

Arrays::Arrays(const Trial& trial, const Inputs& first, const Layout& layout, Memory& memory)
    : trial_(trial), layout_(layout), memory_(memory) {
  if (layout_.nodes.empty()) layout_.nodes = numbers_below(first.count);
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
  const std::uint32_t wanted =
      trial_.info.inputs |
      (layout_.outputs & (ILAW_OUTPUT_ENERGY | amounts_output) ? trial_.info.balance_inputs : 0U);
  const auto make = [&](const char* name, std::size_t width, std::uint32_t bit) {
    const Use use = (wanted & bit) == bit ? Use::input : Use::unneeded;
    return made(name, width, use, trial_.setup.numbers);
  };
  for (std::size_t k = 0; k < node_arrays.size(); ++k) {
    const NodeArray& array = node_arrays[k];
    const bool is_smooth = array.asked == ILAW_INPUT_V_SMOOTH;
    const bool is_given = is_smooth ? layout_.unasked || trial_.reads(ILAW_INPUT_V_SMOOTH)
                                    : !(first.*array.values).empty() || is_optional(array);
    const std::size_t width = is_smooth            ? first.dimension
                              : is_optional(array) ? 1
                                                   : (first.*array.values).size() / first.count;
    if (is_given) inputs_[k] = make(array.name, width, array.asked);
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
  for (std::size_t k = 0; k < node_arrays.size(); ++k)
    if (inputs_[k].given()) batch_.*node_arrays[k].given = inputs_[k].input();
  batch_.per_node_parameters = per_node_inputs_;
  batch_.state_in = state_in_.input();
  batch_.state_out = state_out_.output();
  batch_.impulse = impulse_.output();
  batch_.velocity = velocity_.output();
  batch_.energy = energy_.output();
  batch_.status = status_;
  batch_.status_stride = static_cast<std::int64_t>(status_stride_);
  batch_.amounts = amount_outputs_;
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
  for (std::size_t k = 0; k < node_arrays.size(); ++k) {
    const NodeArray& array = node_arrays[k];
    const std::vector<double>& values = in.*array.values;
    if (is_optional(array) && trial_.reads(array.asked))
      batch_.*array.given = values.empty() ? ilaw_input{} : inputs_[k].input();
    if (!values.empty()) load_one(inputs_[k], values);
  }
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
  if (std::is_sorted(layout_.nodes.begin(), layout_.nodes.end()) && layout_.nodes.size() == in.count)
    states_in[&in] = before;
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
      return Difference{
          i, "status is " + std::to_string(b.status[i]) + ", expected " + std::to_string(a.status[i])};
  if (a.code != b.code)
    return Difference{0, "the code is " + std::to_string(b.code) + ", expected " + std::to_string(a.code)};
  return std::nullopt;
}

void fail(const Trial& trial, const std::string& seen, const std::string& allowed) {
  throw Finding{seen, allowed, trial.text(), {}};
}

void fail(const Trial& trial, const Inputs& in, std::size_t node, const std::string& seen,
          const std::string& allowed) {
  std::vector<NamedArray> arrays = in.arrays_of(node);
  if (const auto found = states_in.find(&in); found != states_in.end() && !found->second.empty())
    arrays.push_back({"state_in", picked(found->second, {node}, in.count)});
  throw Finding{seen, allowed, trial.text(), arrays};
}

void expect_nothing(const Trial& trial, const Inputs& in, const Results& found, std::size_t node,
                    const std::string& how) {
  const auto expect = [&](const char* name, const std::vector<double>& values) {
    const std::size_t width = values.size() / in.count;
    for (std::size_t k = node * width; k < (node + 1) * width; ++k)
      if (values[k] != 0.0) fail(trial, in, node, how + ", " + name + text_of(values[k]), "0");
  };
  expect("impulse ", found.impulse);
  expect("moment ", found.moment);
  expect("energy ", found.energy);
  for (const std::vector<double>& amount : found.amounts) expect("an amount of ", amount);
}

void expect_finite(const Trial& trial, const Inputs& in, const Results& found) {
  const auto expect = [&](const char* name, const std::vector<double>& values) {
    for (std::size_t at = 0; at < values.size(); ++at)
      if (!(std::abs(values[at]) < (trial.setup.floats() ? 0x1p126 : infinity)))
        fail(trial, in, at / in.dimension, name + text_of(values[at]),
             trial.setup.floats() ? "below 2^126, or bad input with 0" : "finite, or bad input with 0");
  };
  expect("impulse ", found.impulse);
  expect("moment ", found.moment);
}

void expect_same(const Trial& trial, const Script& script, const std::vector<Results>& expected,
                 const std::vector<Results>& found, const std::string& how, std::uint32_t outputs) {
  for (std::size_t k = 0; k < script.size(); ++k)
    if (const auto differs = difference(expected[k], found[k], outputs))
      fail(trial, script[k], differs->node,
           how + ", step " + std::to_string(k) + ", node " + std::to_string(differs->node) + ": " +
               differs->text,
           "the same bits");
}

void expect_part(const Trial& trial, const Script& script, const std::vector<Results>& all,
                 std::vector<std::size_t> nodes, const std::string& how) {
  const std::size_t count = script[0].count;
  std::erase_if(nodes, [count](std::size_t node) { return node >= count; });
  if (nodes.empty()) return;
  Layout layout;
  layout.nodes = nodes;
  const std::vector<Results> part = run(trial, script, layout);
  for (std::size_t k = 0; k < script.size(); ++k) {
    Results expected = all[k].of_nodes(nodes);
    expected.code = part[k].code;  // which other nodes decide, too
    if (const auto differs = difference(expected, part[k]))
      fail(trial, script[k], nodes[differs->node],
           how + ", step " + std::to_string(k) + ", node " + std::to_string(nodes[differs->node]) + ": " +
               differs->text,
           "the same bits");
  }
}

}  // namespace ilaw::check
