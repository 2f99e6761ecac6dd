// node_arrays.hpp - the arrays of a batch whose nodes are drawn at random, as those of a running host are:
// contacts rest or slide, closed to a tenth of what they move in a step, the other nodes are far away.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "bench/bench_law.hpp"
#include "stress/draw.hpp"

#include <cstdint>
#include <vector>

namespace ilaw::host {

// What a node moves in one evaluate: inputs and outputs once, the state in and out.
double bytes_per_node(const BenchLaw& law, const BenchCase& bench_case);
// What NodeArrays takes of the memory for each node.
double memory_per_node(const BenchLaw& law, const BenchCase& bench_case);

class NodeArrays {
 public:
  // The state, where there is one, has gone through some steps.
  NodeArrays(const BenchLaw& law, const BenchCase& bench_case, std::int64_t nodes);
  NodeArrays(const NodeArrays&) = delete;
  NodeArrays& operator=(const NodeArrays&) = delete;

  // One step, the same at every call that follows restore().
  void evaluate() const { law_.evaluate(is_of_floats_ ? float_batch_ : batch_); }
  // What evaluate has changed is as it was.
  void restore() { state_ = first_state_; }
  bool has_state() const { return !state_.empty(); }
  const ilaw_batch& batch() const { return batch_; }  // of doubles, in any case

 private:
  void draw_node(Draw& draw, const BenchCase& bench_case, std::int64_t i);
  void draw_delassus(Draw& draw, std::int64_t i);
  void draw_spins(Draw& draw);
  void lay_out(const BenchCase& bench_case);
  void reach_a_representative_state();
  void round_to_floats();

  // Where component c of node i stands in an array of vectors.
  std::size_t place(std::int64_t i, std::int64_t c, std::int64_t components) const {
    return static_cast<std::size_t>(is_soa_ ? i + c * drawn_ : i * components + c);
  }
  ilaw_input input(const std::vector<double>& values, std::int64_t components) const;
  ilaw_output output(std::vector<double>& values, std::int64_t components) const;

  const BenchLaw& law_;
  std::int64_t nodes_, drawn_, dimension_, delassus_components_, state_size_;
  bool is_global_, is_soa_, has_spins_, is_of_floats_ = false;
  std::vector<double> v_free_, v_previous_, delassus_, gap_, area_, normal_, tangent_;
  std::vector<double> spin_free_, spin_previous_, moment_, spin_;
  std::vector<double> impulse_, velocity_, energy_, state_, first_state_;
  std::vector<std::vector<double>> per_node_;
  std::vector<ilaw_input> per_node_inputs_;
  std::vector<std::uint8_t> status_;
  ilaw_batch batch_{};
  std::vector<std::vector<float>> floats_;
  std::vector<ilaw_input> per_node_floats_;
  ilaw_batch float_batch_{};
};

}  // namespace ilaw::host
