// SPDX-License-Identifier: BSD-3-Clause
#include "bench/measure.hpp"

#include "base/clock.hpp"
#include "base/large_pages.hpp"
#include "base/words.hpp"
#include "bench/bench_law.hpp"
#include "bench/node_arrays.hpp"
#include "bench/triad.hpp"

#include <algorithm>
#include <cstddef>
#include <fstream>
#include <limits>
#include <sstream>
#include <vector>

namespace ilaw::host {
namespace {

// Beyond this the triad is far larger than any cache, and only takes memory.
constexpr double most_triad_elements = 1e7;

// Seconds of one call, from as many as fill a few milliseconds.
template <class Work>
double seconds_of(Work&& work) {
  for (long calls = 1;; calls *= 4) {
    const double start = clock_seconds(CLOCK_THREAD_CPUTIME_ID);
    for (long k = 0; k < calls; ++k) work();
    const double seconds = clock_seconds(CLOCK_THREAD_CPUTIME_ID) - start;
    if (seconds > 2e-3) return seconds / static_cast<double>(calls);
  }
}

// As many bytes as the case moves, so that both come from the same cache.
std::size_t triad_elements(double bytes) {
  return static_cast<std::size_t>(std::clamp(bytes / 24.0, 64.0, most_triad_elements));
}

// Bytes that this machine can still give; infinity where it does not say.
double available_memory() {
  std::ifstream file("/proc/meminfo");
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string key;
    double kilobytes = 0.0;
    if (words >> key >> kilobytes && key == "MemAvailable:") return 1024.0 * kilobytes;
  }
  return std::numeric_limits<double>::infinity();
}

// A state is put back before every call, and what that takes is taken off.
double seconds_of_step(NodeArrays& arrays) {
  if (!arrays.has_state()) return seconds_of([&] { arrays.evaluate(); });
  const double both = seconds_of([&] {
    arrays.restore();
    arrays.evaluate();
  });
  return std::max(both - seconds_of([&] { arrays.restore(); }), 1e-3 * both);
}

}  // namespace

void check_bench(const ilaw::library& library, const BenchCase& bench_case, std::int64_t nodes) {
  const BenchLaw law(library, bench_case);
  const double bytes = bytes_per_node(law, bench_case) * static_cast<double>(nodes);
  const double needed = memory_per_node(law, bench_case) * static_cast<double>(nodes) +
                        24.0 * static_cast<double>(triad_elements(bytes));
  const double available = available_memory();
  if (needed > available)
    throw InputError(formatted(
        "--nodes: found %lld, whose arrays take %.3g GB for law '%s', expected at most the %.3g GB that this "
        "machine has left",
        static_cast<long long>(nodes), 1e-9 * needed, bench_case.law.c_str(), 1e-9 * available));
}

BenchResult run_bench(const ilaw::library& library, const BenchCase& bench_case, std::int64_t nodes,
                      int repetitions) {
  place_arrays_one_after_another();
  const BenchLaw law(library, bench_case);
  NodeArrays arrays(law, bench_case, nodes);
  BenchResult result;
  result.bench_case = bench_case;
  result.nodes = nodes;
  result.bytes_per_node = bytes_per_node(law, bench_case);
  const double bytes = result.bytes_per_node * static_cast<double>(nodes);
  Triad triad(triad_elements(bytes));
  // Alternated, so that drifts of the machine hit both.
  std::vector<double> times, bandwidths, ratios;
  for (int k = 0; k < repetitions; ++k) {
    const double bandwidth = triad.bytes() / seconds_of([&] { triad.run(); });
    const double seconds = seconds_of_step(arrays);
    times.push_back(1e9 * seconds / static_cast<double>(nodes));
    bandwidths.push_back(1e-9 * bandwidth);
    ratios.push_back(seconds * bandwidth / bytes);
  }
  result.ns_per_node = median(times);
  result.triad_gb_per_s = median(bandwidths);
  result.ratio = median(ratios);
  result.isa = law.instruction_set();
  arrays.restore();
  result.scalar_share = law.scalar_share(arrays.batch());
  return result;
}

}  // namespace ilaw::host
