// measure.hpp - times the cases of `ilaw bench`, each beside the triad in the same run.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "bench/bench_case.hpp"

#include <ilaw/loader.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace ilaw::host {

struct BenchResult {
  BenchCase bench_case;  // with all parameters
  std::int64_t nodes = 0;
  double ns_per_node = 0.0, bytes_per_node = 0.0, triad_gb_per_s = 0.0;
  double ratio = 0.0;  // the time over what the bytes cost at the triad's bandwidth
  std::optional<std::string> isa;
  std::optional<double> scalar_share;
};

// Throws InputError or ilaw::error where the law does not serve the case, or so many nodes do not fit into
// the memory.
void check_bench(const ilaw::library& library, const BenchCase& bench_case, std::int64_t nodes);

// Medians over the repetitions, of the thread's own time.
BenchResult run_bench(const ilaw::library& library, const BenchCase& bench_case, std::int64_t nodes,
                      int repetitions);

nlohmann::json json_of(const BenchResult& result);
// bench.csv in the folder.
void write_bench(const std::vector<BenchResult>& results, const std::filesystem::path& folder);

}  // namespace ilaw::host
