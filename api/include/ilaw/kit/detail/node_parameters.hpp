// node_parameters.hpp - the parameters of a block of nodes where some come per node, as columns, so that its
// loop is the vector code of any other.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/gather.hpp>
#include <ilaw/kit/detail/instance.hpp>
#include <ilaw/kit/detail/run_block.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// The law at the nodes of a block with parameters per node in columns, in the order of Law::parameters.
template <class Law, class Form = Law>
struct law_per_node {
  using form = Form;
  Form law;
  const column* parameters;
  const double* valid;  // 1 or 0

  Form at(int i) const { return with(i, std::make_index_sequence<parameter_count<Law>>{}); }
  bool is_valid(int i) const { return valid[i] != 0.0; }

  // The form that a law names for such nodes, and whether the first ones have it.
  auto in_form_of_nodes() const {
    return law_per_node<Law, typename Law::form_of_nodes>{{law}, parameters, valid};
  }
  // On its own, and from copies, lest it be no vector code.
  [[gnu::noinline, gnu::flatten]] bool have_form_of_nodes(int count) const {
    const law_per_node laws = *this;
    const auto differs = [](const law_per_node& own, int i) {
      return own.at(i).has_form_of_nodes() ? 0.0 : 1.0;
    };
    column others;
#pragma omp simd
    for (int i = 0; i < count; ++i) others.values[i] = differs(laws, i);
    return !any_one(others.values, count);
  }

 private:
  template <std::size_t... K>
  Form with(int i, std::index_sequence<K...>) const {
    Form own = law;
    ((own.*Law::parameters[K].member = parameters[K].values[i]), ...);
    return own;
  }
};

// The parameters of one node; says what is wrong with them, null where nothing is. Then law stays as it was:
// no step need stand what no parameter may be.
template <class Law>
const char* at_node(const instance<Law>& made, const ilaw_kit_batch& batch, std::int64_t node, Law& law) {
  Law own = law;
  for (std::uint32_t k = 0; k < made.per_node_count; ++k) {
    const ilaw_kit_input given = in_kit(batch.per_node_parameters[k]);
    const std::int64_t at = node * given.node_stride;
    const double value = holds_floats(batch) ? double{as_floats(given.values)[at]} : given.values[at];
    if (!in_range(*made.per_node[k], value)) return "a per-node parameter is out of range";
    own.*made.per_node_members[k] = value;
  }
  if constexpr (requires { own.conflict(); })
    if (const char* conflict = made.per_node_count > 0 ? own.conflict() : nullptr) return conflict;
  law = own;
  return nullptr;
}

// Where none comes per node.
struct same_parameters {
  template <class... Arguments>
  explicit same_parameters(const Arguments&... /*unused*/) {}
};

template <class Law>
class node_parameters {
 public:
  static constexpr int count = static_cast<int>(parameter_count<Law>);

  node_parameters(const instance<Law>& made, const Law& law, const ilaw_kit_batch& batch)
      : made_(made), law_(law), batch_(batch) {
    for (int p = 0; p < count; ++p)
      for (double& value : values_[p].values) value = law.*Law::parameters[p].member;
  }

  law_per_node<Law> of(const node_range& nodes) {
    for (double& valid : valid_.values) valid = 1.0;
    for (std::uint32_t k = 0; k < made_.per_node_count; ++k) take(k, nodes);
    if constexpr (requires { law_.conflict(); })
      for (int i = 0; i < nodes.count; ++i)
        if (Law own = law_; at_node(made_, batch_, nodes.node(i), own)) valid_.values[i] = 0.0;
    for (std::uint32_t k = 0; k < made_.per_node_count; ++k) keep_valid(position_of(k), nodes.count);
    return {law_, values_, valid_.values};
  }

 private:
  int position_of(std::uint32_t k) const {
    int p = 0;
    while (Law::parameters[p].member != made_.per_node_members[k]) ++p;
    return p;
  }

  void take(std::uint32_t k, const node_range& nodes) {
    const parameter_range range(*made_.per_node[k]);
    double *const own = values_[position_of(k)].values, *const valid = valid_.values;
    const double* const given = gather(in_kit(batch_.per_node_parameters[k]), nodes, own);
#pragma omp simd
    for (int i = 0; i < nodes.count; ++i) {
      own[i] = given[i];
      valid[i] = range.has(given[i]) ? valid[i] : 0.0;
    }
  }

  // Elsewhere the law stays as it was.
  void keep_valid(int parameter, int nodes) {
    const double otherwise = law_.*Law::parameters[parameter].member;
    double* const own = values_[parameter].values;
    const double* const valid = valid_.values;
#pragma omp simd
    for (int i = 0; i < nodes; ++i) own[i] = valid[i] != 0.0 ? own[i] : otherwise;
  }

  const instance<Law>& made_;
  const Law law_;
  const ilaw_kit_batch& batch_;
  column values_[count + 1], valid_;  // one more than needed: no array of length zero
};

}  // namespace ilaw::kit::detail
