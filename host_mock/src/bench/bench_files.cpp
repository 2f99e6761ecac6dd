// SPDX-License-Identifier: BSD-3-Clause
#include "bench/bench_files.hpp"

#include "base/csv.hpp"
#include "base/files.hpp"
#include "results/gnuplot.hpp"

#include <algorithm>
#include <ostream>
#include <set>
#include <string>
#include <utility>

namespace ilaw::host {
namespace {

using nlohmann::json;

constexpr std::size_t law_column = 1, nodes_column = 3, ratio_column = 7;

std::set<std::int64_t> sizes_of(const std::vector<BenchResult>& results) {
  std::set<std::int64_t> sizes;
  for (const BenchResult& result : results) sizes.insert(result.nodes);
  return sizes;
}

// A cell of any text.
std::string quoted(const std::string& text) {
  std::string cell;
  for (const char c : text) cell += c == '"' ? std::string("\"\"") : std::string(1, c);
  return '"' + cell + '"';
}

// A panel per number of nodes: the ratios as bars, upwards from the last case.
void write_panels(const std::vector<BenchResult>& results, const std::string& csv, std::ostream& script) {
  script
      << "set style fill solid 0.8\nset boxwidth 0.8\nset grid xtics\nset border 1\nset tics nomirror\nset xrange [0:*]\n"
         "set key off\nset xlabel 'time over that of the bytes at the triad''s bandwidth'\n"
         "set arrow from 1, graph 0 to 1, graph 1 nohead dashtype 2\n";
  for (const std::int64_t nodes : sizes_of(results)) {
    const auto rows = std::count_if(results.begin(), results.end(),
                                    [&](const BenchResult& result) { return result.nodes == nodes; });
    script << "row = 0\nset title '" << nodes << " nodes'\nset yrange [" << -rows << ".5:0.5]\nplot " << csv
           << " skip 1 using (0):($" << nodes_column << " == " << nodes
           << " ? (row = row - 1, row) : NaN):(0):" << '(' << '$' << ratio_column
           << "):(row - 0.4):(row + 0.4):ytic(strcol(" << law_column << ").': '.strcol(" << law_column + 1
           << ")) with boxxyerror linecolor rgb '#0072B2'\n";
  }
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
          {"touching", c.touching},
          {"pressed", c.pressed},
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

bool draw_bench(const std::vector<BenchResult>& results, const std::filesystem::path& folder) {
  const std::size_t panels = sizes_of(results).size(), rows = results.size() / panels + 1;
  return draw_by_gnuplot(folder / "bench.gnuplot", [&](std::ostream& script) {
    for (const auto& [terminal, kind] : {std::pair{"pngcairo", ".png"}, std::pair{"svg", ".svg"}}) {
      script << "reset\nset datafile separator comma\nset terminal " << terminal << " size " << 700 * panels
             << ',' << 120 + 24 * rows << " font 'sans,11' noenhanced background rgb 'white'\nset output "
             << drawn_name(folder / (std::string("bench") + kind)) << "\nset multiplot layout 1," << panels
             << "\n";
      write_panels(results, in_quotes((folder / "bench.csv").string()), script);
      script << "unset multiplot\nunset output\n";
    }
  });
}

}  // namespace ilaw::host
