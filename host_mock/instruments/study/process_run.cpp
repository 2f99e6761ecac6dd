// SPDX-License-Identifier: BSD-3-Clause
#include "study/process_run.hpp"

#include "base/bytes.hpp"
#include "base/child_process.hpp"
#include "study/stable_step.hpp"

#include <omp.h>

#include <array>
#include <cstdint>
#include <sstream>
#include <utility>

namespace ilaw::host {
namespace {

// Calls work with all numbers of a trace, where arrays have their sizes.
template <class AnyTrace, class Work>
void for_each_number(AnyTrace& trace, Work work) {
  for (auto* value : {&trace.dt, &trace.seconds, &trace.energy, &trace.penetration}) work(*value);
  for (auto* rows : {&trace.displacement, &trace.velocity, &trace.impulse})
    for (auto& row : *rows)
      for (auto& value : row) work(value);
  for (auto& value : trace.work) work(value);
  for (auto& of : trace.instants)
    for (auto* value : {&of.first_impulse, &of.last_impulse, &of.last_rupture}) work(*value);
}

// steps, dimension, and the sizes of the arrays: rows, their three lengths, watched nodes.
using Sizes = std::array<std::int64_t, 7>;
Sizes sizes_of(const Trace& trace) {
  const auto length = [](const std::vector<Dofs>& rows) { return rows.empty() ? 0 : rows.front().size(); };
  return {trace.steps,
          trace.dimension,
          static_cast<std::int64_t>(trace.work.size()),
          length(trace.displacement),
          length(trace.velocity),
          length(trace.impulse),
          static_cast<std::int64_t>(trace.instants.size())};
}

void write_trace(std::ostream& out, const Trace& trace) {
  write_array(out, sizes_of(trace).data(), Sizes().size());
  for_each_number(trace, [&](double value) { write_value(out, value); });
}

Trace read_trace(std::istream& in) {
  Sizes sizes{};
  read_array(in, sizes.data(), sizes.size());
  const auto rows = static_cast<std::size_t>(sizes[2]);
  Trace trace;
  trace.steps = sizes[0];
  trace.dimension = static_cast<int>(sizes[1]);
  trace.displacement.assign(rows, Dofs(sizes[3]));
  trace.velocity.assign(rows, Dofs(sizes[4]));
  trace.impulse.assign(rows, Dofs(sizes[5]));
  trace.work.resize(rows);
  trace.instants.resize(static_cast<std::size_t>(sizes[6]));
  for_each_number(trace, [&](double& value) { read_value(in, value); });
  return trace;
}

template <class Work>
std::istringstream result_of(const SceneMaker& make, int threads, Work work) {
  return std::istringstream(result_in_process([&] {
    Scene scene = make();
    omp_set_num_threads(threads);
    std::ostringstream out;
    work(scene, out);
    return out.str();
  }));
}

}  // namespace

Trace trace_in_process(const SceneMaker& make, int threads) {
  std::istringstream result =
      result_of(make, threads, [](Scene& scene, std::ostream& out) { write_trace(out, trace_of(scene)); });
  return read_trace(result);
}

double seconds_in_process(const SceneMaker& make, int threads) {
  double seconds = 0.0;
  std::istringstream result =
      result_of(make, threads, [](Scene& scene, std::ostream& out) { write_value(out, seconds_of(scene)); });
  read_value(result, seconds);
  return seconds;
}

bool is_stable_in_process(const SceneMaker& make, int threads) {
  return !result_of(make, threads,
                    [](Scene& scene, std::ostream& out) {
                      if (is_stable(std::move(scene))) out << '+';
                    })
              .str()
              .empty();
}

}  // namespace ilaw::host
