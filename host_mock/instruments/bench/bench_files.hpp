// bench_files.hpp - results of `ilaw bench` as JSON, a table and a picture.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "bench/measure.hpp"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <vector>

namespace ilaw::host {

nlohmann::json json_of(const BenchResult& result);
// bench.csv in the folder.
void write_bench(const std::vector<BenchResult>& results, const std::filesystem::path& folder);
// bench.png and .svg of it. The folder is absolute.
bool draw_bench(const std::vector<BenchResult>& results, const std::filesystem::path& folder);

}  // namespace ilaw::host
