// run.hpp - a script through the functions of a law, in any layout of its arrays.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "check/memory.hpp"
#include "check/script.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace ilaw::check {

enum class List { none, of_32_bits, of_64_bits };
// Amounts are an output as others here, by a bit that ilaw.h does not use; single ones by Layout::no_amount.
inline constexpr std::uint32_t amounts_output = 1U << 31;
inline constexpr std::uint32_t spin_output = 1U << 30;  // where the form of H has spins
inline constexpr std::uint32_t all_outputs =
    ILAW_OUTPUT_VELOCITY | ILAW_OUTPUT_STATUS | ILAW_OUTPUT_ENERGY | amounts_output | spin_output;

struct Layout {
  Order order = Order::interleaved;
  std::optional<Order> order_of_state_out{};
  List list = List::none;
  std::int32_t index_base = 0;
  std::size_t spare = 0;  // nodes of the arrays that are on no list
  bool in_place = false;  // state_out is state_in
  bool unasked = true;    // v_smooth is there for a law that does not ask for it
  std::uint32_t outputs = all_outputs;
  std::optional<std::size_t> no_amount{};  // this one is not asked for
  std::vector<std::size_t> nodes{};        // of the script, in their order; empty: all
};

// Results node by node, whatever the layout of the arrays was.
struct Results {
  std::size_t nodes = 0;
  std::int32_t code = ILAW_OK;
  ilaw_report report{};
  std::vector<double> impulse{}, moment{}, state{}, velocity{}, spin{},
      energy{};                                // empty where there is none
  std::vector<std::vector<double>> amounts{};  // each empty where it was not asked for
  std::vector<std::uint8_t> status{};

  // All arrays of numbers; asked: by which bit of the outputs.
  struct Numbers {
    const char* name;
    const std::vector<double>* values;
    std::uint32_t asked;
  };
  std::vector<Numbers> numbers() const;
  Results of_nodes(const std::vector<std::size_t>& which) const;
  Wrench action(std::size_t node) const { return wrench_of(impulse, moment, node, impulse.size() / nodes); }
};

// The arrays of a batch that results are written to, but for amounts; asked: by which bit of the outputs.
struct OutputArray {
  const char* name;
  std::vector<double> Results::*values;
  ilaw_output ilaw_batch::*given;
  std::uint32_t asked = 0;
  bool is_of_spins = false;
};
inline constexpr std::array output_arrays{
    OutputArray{"impulse", &Results::impulse, &ilaw_batch::impulse},
    OutputArray{"moment", &Results::moment, &ilaw_batch::moment, 0, true},
    OutputArray{"state_out", &Results::state, &ilaw_batch::state_out},
    OutputArray{"velocity", &Results::velocity, &ilaw_batch::velocity, ILAW_OUTPUT_VELOCITY},
    OutputArray{"spin", &Results::spin, &ilaw_batch::spin, spin_output, true},
    OutputArray{"energy", &Results::energy, &ilaw_batch::energy, ILAW_OUTPUT_ENERGY}};
inline constexpr std::size_t state_place = 2;

// The arrays of a batch for a trial, on the heap unless there is a memory for them.
class Arrays {
 public:
  Arrays(const Trial& trial, const Inputs& first, const Layout& layout = {}, Memory* memory = nullptr);

  std::int32_t initialise(const Inputs& in);
  // From the state that the last call left.
  Results evaluate(const Inputs& in);
  Results evaluate_with(const Instance& instance, const Inputs& in);
  void set_state(const std::vector<double>& state);  // of each node in turn
  std::vector<double> state();
  Results results(std::int32_t code = ILAW_OK);  // as the outputs are now
  // The output that the last evaluate wrote outside the nodes of the batch; null where there is none.
  const char* written_beside();
  ilaw_batch& batch() { return batch_; }
  void load(const Inputs& in);

 private:
  Field made(const char* name, std::size_t width, Use use, ilaw_number_type numbers);
  template <class Number>
  Number* taken(const char* name, std::size_t count, Use use);
  void make_list();
  void make_inputs(const Inputs& first);
  void make_outputs();
  void load_one(Field& field, const std::vector<double>& values);
  template <class Visit>
  void for_outputs(Visit visit);
  std::vector<double> take(const Field& field) const;
  std::size_t node(std::size_t k) const { return layout_.nodes[k]; }
  Field& state_out() { return outputs_[state_place]; }
  std::size_t status_size() const { return (room_ - 1) * status_stride_ + 1; }

  const Trial& trial_;
  Layout layout_;
  Heap own_memory_;
  Memory& memory_;
  std::size_t room_, made_ = 0, status_stride_ = 1;
  std::vector<std::size_t> places_;  // in the arrays, of each node of the batch
  ilaw_batch batch_{};
  ilaw_report report_{};
  std::array<Field, node_arrays.size()> inputs_;
  std::array<Field, output_arrays.size()> outputs_;
  Field state_in_;
  std::vector<Field> per_node_, amounts_;
};

// With its first state.
struct Started : Arrays {
  Started(const Trial& trial, const Inputs& first, const Layout& layout = {}, Memory* memory = nullptr)
      : Arrays(trial, first, layout, memory) {
    initialise(first);
  }
};

// Results of all steps, from the first state on.
std::vector<Results> run(const Trial& trial, const Script& script, const Layout& layout = {},
                         Memory* memory = nullptr);

// Forgets the states of the trial before, which findings name.
void forget_states();

// The first array in which two results differ in a bit, at which node, with both values. "what" are the bits
// of ILAW_OUTPUT_* that both have.
struct Difference {
  std::size_t node;
  std::string text;
};
std::optional<Difference> difference(const Results& a, const Results& b, std::uint32_t outputs = all_outputs);

// Throws the finding where two runs of a script differ.
void expect_same(const Trial& trial, const Script& script, const std::vector<Results>& expected,
                 const std::vector<Results>& found, const std::string& how,
                 std::uint32_t outputs = all_outputs);
// Throws the finding where some nodes of a script get other results in a batch of their own than among "all".
void expect_part(const Trial& trial, const Script& script, const std::vector<Results>& all,
                 std::vector<std::size_t> nodes, const std::string& how);
// Throws a finding of a trial; with the inputs of a node, and its state before the last call with them.
[[noreturn]] void fail(const Trial& trial, const std::string& seen, const std::string& allowed);
[[noreturn]] void fail(const Trial& trial, const Inputs& in, std::size_t node, const std::string& seen,
                       const std::string& allowed);
// Throws the finding where a node has an impulse, a moment, an energy or an amount.
void expect_nothing(const Trial& trial, const Inputs& in, const Results& found, std::size_t node,
                    const std::string& how);
// Throws the finding where an impulse or a moment is not finite, or overflows floats in sums.
void expect_finite(const Trial& trial, const Inputs& in, const Results& found);
std::string text_of(const Vector& a, std::size_t dimension);

}  // namespace ilaw::check
