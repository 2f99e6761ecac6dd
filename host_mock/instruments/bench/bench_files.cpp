// SPDX-License-Identifier: BSD-3-Clause
#include "bench/measure.hpp"

#include "base/csv.hpp"
#include "base/files.hpp"
#include "plot/gnuplot.hpp"

#include <algorithm>
#include <map>
#include <ostream>
#include <string>

namespace ilaw::host {
namespace {

using nlohmann::json;

constexpr std::size_t law_column = 1, nodes_column = 3, ratio_column = 7;

// A cell of any text.
std::string quoted(const std::string& text) {
  std::string cell;
  for (const char c : text) cell += c == '"' ? std::string("\"\"") : std::string(1, c);
  return '"' + cell + '"';
}

// Labels longer than this are cut: with room for any, the panels would be lost beside them.
constexpr std::size_t most_letters = 110;

// Pixels: the labels stand once, left of panels that share their rows.
constexpr double letter = 8.0, panel_width = 400.0, panel_gap = 40.0, row_height = 24.0, above = 40.0,
                 below = 70.0;

std::size_t letters_of(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

double label_width_of(const std::vector<BenchResult>& results) {
  std::size_t letters = 0;
  for (const BenchResult& result : results)
    letters = std::max(letters, letters_of(result.bench_case.law + ": " + text_of(result.bench_case)));
  return letter * static_cast<double>(std::min(letters, most_letters) + 3);
}

// By number of nodes, the longest bar. The mark at 1 stays in sight where all are faster.
std::map<std::int64_t, double> panels_of(const std::vector<BenchResult>& results) {
  std::map<std::int64_t, double> panels;
  for (const BenchResult& result : results) {
    double& longest = panels.try_emplace(result.nodes, 1.0).first->second;
    longest = std::max(longest, result.ratio);
  }
  return panels;
}

void write_common(std::ostream& script, double height, double rows) {
  script << "set encoding utf8\nset style fill solid 0.8\nset boxwidth 0.8\nset grid xtics\nset border 3\n"
            "set tics nomirror\nset ytics scale 0\nset key off\n"
            "set xlabel 'time over that of the bytes at the triad''s bandwidth'\n"
            "set arrow from 1, graph 0 to 1, graph 1 nohead front dashtype 2\n"
            "label(law, name) = strlen(law.name) > "
         << most_letters - 2 << " ? (law.': '.name)[1:" << most_letters << "].'...' : law.': '.name\n"
         << "set tmargin at screen " << 1.0 - above / height << "\nset bmargin at screen " << below / height
         << "\nset yrange [" << -rows << " - 0.5:-0.5]\n";
}

// The ratios for a number of nodes as bars, downwards from the first case.
void write_panel(std::ostream& script, const std::string& csv, std::int64_t nodes, double longest,
                 bool has_labels) {
  script << "set xrange [0:" << 1.05 * longest << "]\nrow = 0\nset title '" << nodes << " nodes'\nplot "
         << csv << " skip 1 using (0):($" << nodes_column << " == " << nodes
         << " ? (row = row - 1, row) : NaN):(0):($" << ratio_column << "):(row - 0.4):(row + 0.4)";
  if (has_labels) script << ":ytic(label(strcol(" << law_column << "), strcol(" << law_column + 1 << ")))";
  script << " with boxxyerror linecolor rgb '#0072B2'\nset format y ''\nset ytics autofreq\n";
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
  const std::map<std::int64_t, double> panels = panels_of(results);
  const auto rows = static_cast<double>(std::count_if(
      results.begin(), results.end(), [&](const auto& one) { return one.nodes == results.front().nodes; }));
  const double label_width = label_width_of(results);
  const Sheet sheet{folder / "bench",
                    label_width + static_cast<double>(panels.size()) * (panel_width + panel_gap),
                    above + row_height * rows + below, "", "noenhanced"};
  return draw_sheet(sheet, [&](std::ostream& script) {
    write_common(script, sheet.height, rows);
    double left = label_width;
    for (const auto& [nodes, longest] : panels) {
      script << "set lmargin at screen " << left / sheet.width << "\nset rmargin at screen "
             << (left + panel_width) / sheet.width << "\n";
      write_panel(script, in_quotes((folder / "bench.csv").string()), nodes, longest, left == label_width);
      left += panel_width + panel_gap;
    }
  });
}

}  // namespace ilaw::host
