// SPDX-License-Identifier: BSD-3-Clause
#include "check/run.hpp"

#include "check/reach.hpp"
#include "check/sandbox.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

namespace ilaw::check {
namespace {

std::optional<Difference> difference(const Results::Numbers& ours, const Results::Numbers& theirs,
                                     std::size_t nodes) {
  const std::vector<double>&a = *ours.values, &b = *theirs.values;
  const std::size_t width = a.size() / nodes;
  for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k)
    if (!same_bits(a[k], b[k]))
      return Difference{k / width, joined(ours.name, "[", k % width, "] is ", b[k], ", expected ", a[k])};
  return std::nullopt;
}

// The states that the last call began from, by inputs of all nodes: findings name them.
thread_local std::map<const Inputs*, std::vector<double>> states_in;

}  // namespace

void forget_states() { states_in.clear(); }

std::string text_of(const Vector& a, std::size_t dimension) {
  std::string text = "(";
  for (std::size_t c = 0; c < dimension; ++c) text += (c ? ", " : "") + text_of(a[c]);
  return text + ")";
}

std::vector<Results::Numbers> Results::numbers() const {
  std::vector<Numbers> all;
  all.reserve(std::size(output_arrays) + amounts.size());
  for (const OutputArray& array : output_arrays)
    all.push_back({array.name, &(this->*array.values), array.asked});
  for (const std::vector<double>& amount : amounts) all.push_back({"amounts", &amount, amounts_output});
  return all;
}

Results Results::of_nodes(const std::vector<std::size_t>& which) const {
  Results own{which.size(), code, report};
  for (const OutputArray& array : output_arrays)
    own.*array.values = picked(this->*array.values, which, nodes);
  for (const std::vector<double>& amount : amounts) own.amounts.push_back(picked(amount, which, nodes));
  own.status = picked(status, which, nodes);
  return own;
}

Arrays::Arrays(const Trial& trial, const Inputs& first, const Layout& layout, Memory* memory)
    : trial_(trial), layout_(layout), memory_(memory ? *memory : own_memory_) {
  if (layout_.nodes.empty()) layout_.nodes = numbers_below(first.count);
  room_ = layout_.nodes.size() + layout_.spare;
  batch_.struct_size = sizeof batch_;
  batch_.index_base = layout_.index_base;
  batch_.node_count = static_cast<std::int64_t>(layout_.nodes.size());
  make_list();
  make_inputs(first);
  make_outputs();
  load(first);
}

template <class Number>
Number* Arrays::taken(const char* name, std::size_t count, Use use) {
  return static_cast<Number*>(memory_.take(name, count * sizeof(Number), use));
}

// Listed nodes stand in reverse, the spare ones among them.
void Arrays::make_list() {
  const std::size_t count = layout_.nodes.size();
  for (std::size_t k = 0; k < count; ++k)
    places_.push_back(layout_.list == List::none ? k : room_ - 1 - k - k * layout_.spare / count);
  const auto list = [&]<class Number>(const char* name, const Number*& index) {
    Number* const own = taken<Number>(name, count, Use::input);
    for (std::size_t k = 0; k < count; ++k) own[k] = static_cast<Number>(places_[k]) + layout_.index_base;
    index = own;
  };
  if (layout_.list == List::of_32_bits) list("index", batch_.index);
  if (layout_.list == List::of_64_bits) list("index64", batch_.index64);
}

Field Arrays::made(const char* name, std::size_t width, Use use, ilaw_number_type numbers) {
  const Order order = name == output_arrays[state_place].name
                          ? layout_.order_of_state_out.value_or(layout_.order)
                          : layout_.order;
  return Field(memory_, name, width, room_, order, use, numbers, made_++ % 3);
}

void Arrays::make_inputs(const Inputs& first) {
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
                                    : !(first.*array.values).empty() || array.is_optional;
    const std::size_t width = is_smooth           ? first.dimension
                              : array.is_optional ? 1
                                                  : (first.*array.values).size() / first.count;
    if (!is_given) continue;
    inputs_[k] = make(array.name, width, array.asked);
    batch_.*array.given = inputs_[k].input();
  }
  const std::size_t varying = trial_.info.per_node_parameter_count;
  if (varying == 0) return;
  auto* const given = taken<ilaw_input>("per_node_parameters", varying, Use::input);
  batch_.per_node_parameters = given;
  for (std::size_t k = 0; k < varying; ++k) {
    per_node_.push_back(make("per_node_parameters", 1, 0));
    given[k] = per_node_[k].input();
  }
}

void Arrays::make_outputs() {
  const std::uint32_t outputs = layout_.outputs & (trial_.law.outputs | spin_output | amounts_output);
  const auto is_asked = [outputs](std::uint32_t bit) { return (outputs & bit) == bit; };
  for (std::size_t k = 0; k < output_arrays.size(); ++k) {
    const OutputArray& array = output_arrays[k];
    if (!is_asked(array.asked) || (array.is_of_spins && !trial_.setup.spins())) continue;
    const std::size_t width = k == state_place                    ? trial_.info.state_size
                              : array.asked == ILAW_OUTPUT_ENERGY ? std::size_t{ILAW_ENERGY_COUNT}
                                                                  : trial_.setup.dimension;
    const ilaw_number_type numbers =
        k == state_place ? ilaw_number_type{ILAW_NUMBERS_DOUBLE} : trial_.setup.numbers;
    outputs_[k] = made(array.name, width, Use::output, numbers);
    batch_.*array.given = outputs_[k].output();
  }
  state_in_ = layout_.in_place ? state_out()
                               : made("state_in", trial_.info.state_size, Use::input, ILAW_NUMBERS_DOUBLE);
  batch_.state_in = state_in_.input();
  const std::size_t amount_count = trial_.info.amount_count;
  if (is_asked(amounts_output) && amount_count > 0) {
    auto* const given = taken<ilaw_output>("amounts", amount_count, Use::input);
    batch_.amounts = given;
    amounts_.resize(amount_count);
    for (std::size_t k = 0; k < amount_count; ++k) {
      if (layout_.no_amount != k) amounts_[k] = made("amounts", 1, Use::output, trial_.setup.numbers);
      given[k] = amounts_[k].output();
    }
  }
  if (!is_asked(ILAW_OUTPUT_STATUS)) return;
  status_stride_ = layout_.order == Order::spread ? 3 : 1;
  batch_.status = taken<std::uint8_t>("status", status_size(), Use::output);
  batch_.status_stride = static_cast<std::int64_t>(status_stride_);
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
    if (array.is_optional && trial_.reads(array.asked))
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
  const std::vector<double> before = state();
  if (std::is_sorted(layout_.nodes.begin(), layout_.nodes.end()) && layout_.nodes.size() == in.count)
    states_in[&in] = before;
  for (std::size_t at = 0, width = state_in_.components(); at < before.size(); ++at)
    state_in_.put(places_[at / width], at % width, before[at]);
  for_outputs([&](Field& field) {
    if (&field != &state_out() || !layout_.in_place) field.clear();
  });
  if (batch_.status) std::fill_n(batch_.status, status_size(), status_sentinel);
  report_ = {};
  report_.struct_size = sizeof report_;
  memory_.before_call();
  const std::int32_t code = instance.evaluate(batch_, &report_);
  memory_.after_call();
  Results found = results(code);
  if (code >= 0) reach_of_thread().add(trial_.info, before, found.state, found.status);
  return found;
}

template <class Visit>
void Arrays::for_outputs(Visit visit) {
  for (Field& field : outputs_)
    if (field.given()) visit(field);
  for (Field& field : amounts_)
    if (field.given()) visit(field);
}

void Arrays::set_state(const std::vector<double>& state) { load_one(state_out(), state); }

std::vector<double> Arrays::take(const Field& field) const {
  std::vector<double> values;
  for (std::size_t k = 0; field.given() && k < places_.size(); ++k)
    for (std::size_t c = 0; c < field.components(); ++c) values.push_back(field.get(places_[k], c));
  return values;
}

std::vector<double> Arrays::state() { return take(state_out()); }

Results Arrays::results(std::int32_t code) {
  Results results{places_.size(), code, report_};
  for (std::size_t k = 0; k < output_arrays.size(); ++k) results.*output_arrays[k].values = take(outputs_[k]);
  for (const Field& amount : amounts_) results.amounts.push_back(take(amount));
  for (std::size_t k = 0; batch_.status && k < places_.size(); ++k)
    results.status.push_back(batch_.status[places_[k] * status_stride_]);
  return results;
}

const char* Arrays::written_beside() {
  const char* name = nullptr;
  for_outputs([&](Field& field) {
    if (!name && field.components() > 0 && !field.is_untouched_beside(places_)) name = field.name();
  });
  for (std::size_t k = 0; !name && batch_.status && k < status_size(); ++k) {
    const bool used = std::any_of(places_.begin(), places_.end(),
                                  [&](std::size_t place) { return place * status_stride_ == k; });
    if (!used && batch_.status[k] != status_sentinel) name = "status";
  }
  return name;
}

std::vector<Results> run(const Trial& trial, const Script& script, const Layout& layout, Memory* memory) {
  Started arrays(trial, script.front(), layout, memory);
  std::vector<Results> results;
  for (const Inputs& in : script) results.push_back(arrays.evaluate(in));
  return results;
}

std::optional<Difference> difference(const Results& a, const Results& b, std::uint32_t outputs) {
  const std::vector<Results::Numbers> ours = a.numbers(), theirs = b.numbers();
  for (std::size_t k = 0; k < std::min(ours.size(), theirs.size()); ++k)
    if ((ours[k].asked & ~outputs) == 0)
      if (auto found = difference(ours[k], theirs[k], std::max<std::size_t>(a.nodes, 1))) return found;
  for (std::size_t i = 0; (outputs & ILAW_OUTPUT_STATUS) && i < a.status.size() && i < b.status.size(); ++i)
    if (a.status[i] != b.status[i])
      return Difference{i, joined("status is ", b.status[i], ", expected ", a.status[i])};
  if (a.code != b.code) return Difference{0, joined("the code is ", b.code, ", expected ", a.code)};
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
  for (const Results::Numbers& array : found.numbers()) {
    const bool is_free =
        array.values == &found.state || array.values == &found.velocity || array.values == &found.spin;
    const std::size_t width = is_free ? 0 : array.values->size() / in.count;
    for (std::size_t k = node * width; k < (node + 1) * width; ++k)
      if ((*array.values)[k] != 0.0)
        fail(trial, in, node, joined(how, ", ", array.name, " ", (*array.values)[k]), "0");
  }
}

void expect_finite(const Trial& trial, const Inputs& in, const Results& found) {
  const bool floats = trial.setup.floats();
  for (const OutputArray& array : output_arrays) {
    if (array.values != &Results::impulse && array.values != &Results::moment) continue;
    const std::vector<double>& values = found.*array.values;
    for (std::size_t at = 0; at < values.size(); ++at)
      if (!(std::abs(values[at]) < (floats ? 0x1p126 : infinity)))
        fail(trial, in, at / in.dimension, joined(array.name, " ", values[at]),
             floats ? "below 2^126, or bad input with 0" : "finite, or bad input with 0");
  }
}

namespace {

// Also of some nodes of the script alone.
void expect_step(const Trial& trial, const Script& script, std::size_t step, const Results& expected,
                 const Results& found, const std::vector<std::size_t>& nodes, const std::string& how,
                 std::uint32_t outputs) {
  const auto differs = difference(expected, found, outputs);
  if (!differs) return;
  const std::size_t node = nodes.empty() ? differs->node : nodes[differs->node];
  fail(trial, script[step], node, joined(how, ", step ", step, ", node ", node, ": ", differs->text),
       "the same bits");
}

}  // namespace

void expect_same(const Trial& trial, const Script& script, const std::vector<Results>& expected,
                 const std::vector<Results>& found, const std::string& how, std::uint32_t outputs) {
  for (std::size_t k = 0; k < script.size(); ++k)
    expect_step(trial, script, k, expected[k], found[k], {}, how, outputs);
}

void expect_part(const Trial& trial, const Script& script, const std::vector<Results>& all,
                 std::vector<std::size_t> nodes, const std::string& how) {
  std::erase_if(nodes, [&](std::size_t node) { return node >= script[0].count; });
  if (nodes.empty()) return;
  const std::vector<Results> part = run(trial, script, {.nodes = nodes});
  for (std::size_t k = 0; k < script.size(); ++k) {
    Results expected = all[k].of_nodes(nodes);
    expected.code = part[k].code;  // which other nodes decide, too
    expect_step(trial, script, k, expected, part[k], nodes, how, all_outputs);
  }
}

}  // namespace ilaw::check
