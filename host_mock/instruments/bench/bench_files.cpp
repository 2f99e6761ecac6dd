// SPDX-License-Identifier: BSD-3-Clause
#include "bench/measure.hpp"

#include "base/csv.hpp"
#include "base/files.hpp"

#include <algorithm>
#include <map>
#include <ostream>
#include <string>

namespace ilaw::host {
namespace {

using nlohmann::json;

// A cell of any text.
std::string quoted(const std::string& text) {
  std::string cell;
  for (const char c : text) cell += c == '"' ? std::string("\"\"") : std::string(1, c);
  return '"' + cell + '"';
}

}  // namespace

json json_of(const BenchResult& result) {
  const BenchCase& c = result.bench_case;
  return {{"law", c.law},
          {"case", text_of(c)},
          {"library", c.library},
          {"parameters", c.parameters},
          {"delassus", c.delassus},
          {"frame", c.frame},
          {"layout", c.layout},
          {"outputs", c.outputs},
          {"nodes", result.nodes},
          {"ns_per_node", result.ns_per_node},
          {"bytes_per_node", result.bytes_per_node},
          {"triad_gb_per_s", result.triad_gb_per_s},
          {"ratio", result.ratio},
          {"isa", result.isa ? json(*result.isa) : json(nullptr)},
          {"scalar_share", result.scalar_share ? json(*result.scalar_share) : json(nullptr)}};
}

void write_bench(const std::vector<BenchResult>& results, const std::filesystem::path& folder) {
  AtomicFile file(folder / "bench.csv");
  CsvWriter csv(file.stream(), 6);
  for (const char* column : {"law", "case", "nodes", "ns_per_node", "bytes_per_node", "triad_gb_per_s",
                             "ratio", "isa", "scalar_share"})
    csv << column;
  csv.end_row();
  for (const BenchResult& result : results) {
    csv << result.bench_case.law << quoted(text_of(result.bench_case)) << result.nodes << result.ns_per_node
        << result.bytes_per_node << result.triad_gb_per_s << result.ratio << result.isa.value_or("");
    if (result.scalar_share)
      csv << *result.scalar_share;
    else
      csv << "";
    csv.end_row();
  }
  file.commit();
}

}  // namespace ilaw::host
