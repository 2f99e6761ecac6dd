// node_arrays.hpp - the arrays of a batch whose nodes are drawn at random, as those of a running host are:
// contacts rest or slide, closed to a tenth of what they move in a step, the other nodes are far away.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "bench/bench_law.hpp"
#include "stress/draw.hpp"

#include <cstdint>
#include <vector>

namespace ilaw::host {

// An array that evaluate reads, or one that it writes.
struct BatchArray {
  ilaw_input ilaw_batch::*input;
  ilaw_output ilaw_batch::*output;
  std::int64_t components;  // numbers of a node
  std::vector<double> values{};
  std::vector<float> floats{};
};

// Bytes that a node moves in one evaluate: inputs and outputs once, the state in and out.
double bytes_per_node(const BenchLaw& law, const BenchCase& bench_case);
// Bytes of memory that NodeArrays takes for each node.
double memory_per_node(const BenchLaw& law, const BenchCase& bench_case);

class NodeArrays {
 public:
  // The state, where there is one, has gone through some steps.
  NodeArrays(const BenchLaw& law, const BenchCase& bench_case, std::int64_t nodes);
  NodeArrays(const NodeArrays&) = delete;
  NodeArrays& operator=(const NodeArrays&) = delete;

  // One step, the same at every call that follows restore().
  void evaluate() const { law_.evaluate(is_of_floats_ ? float_batch_ : batch_); }
  // Undoes what evaluate has changed.
  void restore() { state_ = first_state_; }
  bool has_state() const { return !state_.empty(); }
  const ilaw_batch& batch() const { return batch_; }  // of doubles, in any case

 private:
  void draw_node(Draw& draw, std::int64_t i);
  void draw_delassus(Draw& draw, std::int64_t i);
  void draw_spins(Draw& draw);
  // Component c of node i of an input; null where evaluate does not read it.
  double* place(ilaw_input ilaw_batch::*input, std::int64_t i, std::int64_t c);
  // Points a batch to the arrays, of doubles or of floats.
  template <class Number>
  void lay_out(ilaw_batch& batch, std::vector<ilaw_input>& per_node,
               std::vector<Number> BatchArray::*numbers);
  void reach_a_representative_state();
  void round_to_floats();

  const BenchLaw& law_;
  std::int64_t nodes_, drawn_, dimension_;
  bool is_global_, is_soa_, has_spins_, is_of_floats_ = false;
  std::vector<BatchArray> arrays_, per_node_;
  std::vector<std::uint8_t> status_;
  std::vector<double> state_, first_state_;
  ilaw_batch batch_{}, float_batch_{};
  std::vector<ilaw_input> per_node_inputs_, per_node_floats_;
};

}  // namespace ilaw::host
