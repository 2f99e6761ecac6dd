// The cost of keeping the host's floating-point environment in evaluate: contact as it is beside contact
// compiled without, called in turn in one process. Medians; docs/benchmarks.md tells what was measured.
// Usage: ilaw_bench_environment [PAIRS]
// SPDX-License-Identifier: BSD-3-Clause
#include <ilaw/arrays.hpp>
#include <ilaw/loader.hpp>

#include <algorithm>
#include <cfenv>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <vector>

namespace {

ilaw::interface contact(const char* file) {
  ilaw_setup setup{};
  setup.struct_size = sizeof setup;
  setup.dimension = 3;
  setup.delassus_form = ILAW_DELASSUS_SCALAR;
  setup.frame = ILAW_FRAME_LOCAL;
  setup.numbers = ILAW_NUMBERS_DOUBLE;
  return {ilaw::library(file), "contact", setup};
}

// Arrays of n nodes, half of them touching.
struct Nodes {
  explicit Nodes(std::size_t n) : v(3 * n, -1.0), r(3 * n), h(n, 1.0), gap(n) {
    for (std::size_t i = 0; i < n; ++i) gap[i] = i % 2 == 0 ? -1e-3 : 1.0;
    batch.struct_size = sizeof batch;
    batch.node_count = static_cast<std::int64_t>(n);
    batch.velocity_step = batch.position_step = 1e-3;
    batch.v_free = batch.v_previous = ilaw::input(v.data(), 3, 1);
    batch.delassus = ilaw::input(h.data(), 1, 1);
    batch.gap = ilaw::input(gap.data(), 1, 1);
    batch.impulse = ilaw::output(r.data(), 3, 1);
  }
  std::vector<double> v, r, h, gap;
  ilaw_batch batch{};
};

// Nanoseconds per call. clear: with all exception flags down before each call, which the law must lower
// again.
double time_of(const ilaw::interface& law, const ilaw_batch& batch, int calls, bool clear) {
  const auto evaluate = law.law().evaluate;
  const auto start = std::chrono::steady_clock::now();
  for (int k = 0; k < calls; ++k) {
    if (clear) std::feclearexcept(FE_ALL_EXCEPT);
    if (evaluate(law.instance(), &batch, nullptr) != ILAW_OK) throw std::runtime_error("contact refuses");
  }
  const std::chrono::duration<double, std::nano> elapsed = std::chrono::steady_clock::now() - start;
  return elapsed.count() / calls;
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

void compare(const ilaw::interface& with, const ilaw::interface& without, std::size_t n, int pairs,
             bool clear) {
  const Nodes nodes(n);
  const int calls = static_cast<int>(40000 / (n + 20)) + 1;
  std::vector<double> kept, left, differences;
  for (int k = 0; k < pairs; ++k) {
    const bool swapped = k % 2 == 1;  // neither is always the first
    double a = time_of(swapped ? without : with, nodes.batch, calls, clear);
    double b = time_of(swapped ? with : without, nodes.batch, calls, clear);
    if (swapped) std::swap(a, b);
    kept.push_back(a);
    left.push_back(b);
    differences.push_back(a - b);
  }
  std::printf("%-18s %6zu %12.1f %12.1f %12.1f %10.2f %%\n", clear ? "flags down" : "flags as they are", n,
              median(kept), median(left), median(differences), 100.0 * median(differences) / median(left));
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const int pairs = argc > 1 ? std::atoi(argv[1]) : 2001;
    const ilaw::interface with = contact(ILAW_WITH), without = contact(ILAW_WITHOUT);
    std::printf("%-18s %6s %12s %12s %12s %12s\n", "host", "nodes", "with, ns", "without, ns", "difference",
                "");
    for (const bool clear : {false, true})
      for (const std::size_t n : {1, 8, 64, 1024}) compare(with, without, n, std::max(pairs, 1), clear);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "ilaw_bench_environment: %s\n", error.what());
    return 1;
  }
}
