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

// Labels longer than this are cut: with room for any, the panels would be lost beside them.
constexpr std::size_t most_letters = 110;

// Pixels of the picture: the labels stand once, left of panels that share their rows.
struct Sheet {
  static constexpr double letter = 8.0, panel_width = 400.0, between = 40.0, row = 24.0, above = 40.0,
                          below = 70.0;

  std::size_t panels, rows;
  double label_width;

  double width() const { return left_of(panels); }
  double height() const { return above + row * static_cast<double>(rows) + below; }
  double left_of(std::size_t panel) const {
    return label_width + static_cast<double>(panel) * (panel_width + between);
  }
};

std::size_t letters_of(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

std::size_t rows_of(const std::vector<BenchResult>& results, std::int64_t nodes) {
  return static_cast<std::size_t>(std::count_if(
      results.begin(), results.end(), [&](const BenchResult& result) { return result.nodes == nodes; }));
}

Sheet sheet_for(const std::vector<BenchResult>& results) {
  std::size_t letters = 0;
  for (const BenchResult& result : results)
    letters = std::max(letters, letters_of(result.bench_case.law + ": " + text_of(result.bench_case)));
  return {sizes_of(results).size(), rows_of(results, results.front().nodes),
          Sheet::letter * static_cast<double>(std::min(letters, most_letters) + 3)};
}

// The mark at 1 stays in sight where all are faster.
double longest_bar(const std::vector<BenchResult>& results, std::int64_t nodes) {
  double longest = 1.0;
  for (const BenchResult& result : results)
    if (result.nodes == nodes) longest = std::max(longest, result.ratio);
  return longest;
}

void write_common(const Sheet& sheet, std::ostream& script) {
  script
      << "set style fill solid 0.8\nset boxwidth 0.8\nset grid xtics\nset border 3\nset tics nomirror\n"
         "set ytics scale 0\nset key off\nset xlabel 'time over that of the bytes at the triad''s bandwidth'\n"
         "set arrow from 1, graph 0 to 1, graph 1 nohead front dashtype 2\n"
         "label(law, name) = strlen(law.name) > "
      << most_letters - 2 << " ? (law.': '.name)[1:" << most_letters << "].'...' : law.': '.name\n"
      << "set tmargin at screen " << 1.0 - Sheet::above / sheet.height() << "\nset bmargin at screen "
      << Sheet::below / sheet.height() << "\nset yrange [" << -static_cast<double>(sheet.rows)
      << " - 0.5:-0.5]\n";
}

// A panel per number of nodes: the ratios as bars, downwards from the first case.
void write_panels(const std::vector<BenchResult>& results, const Sheet& sheet, const std::string& csv,
                  std::ostream& script) {
  std::size_t panel = 0;
  for (const std::int64_t nodes : sizes_of(results)) {
    const double left = sheet.left_of(panel);
    script << "set lmargin at screen " << left / sheet.width() << "\nset rmargin at screen "
           << (left + Sheet::panel_width) / sheet.width()
           << "\nset xrange [0:" << 1.05 * longest_bar(results, nodes) << "]\nrow = 0\nset title '" << nodes
           << " nodes'\nplot " << csv << " skip 1 using (0):($" << nodes_column << " == " << nodes
           << " ? (row = row - 1, row) : NaN):(0):($" << ratio_column << "):(row - 0.4):(row + 0.4)";
    if (panel == 0) script << ":ytic(label(strcol(" << law_column << "), strcol(" << law_column + 1 << ")))";
    script << " with boxxyerror linecolor rgb '#0072B2'\nset format y ''\nset ytics autofreq\n";
    ++panel;
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
  const Sheet sheet = sheet_for(results);
  return draw_by_gnuplot(folder / "bench.gnuplot", [&](std::ostream& script) {
    for (const auto& [terminal, kind] : {std::pair{"pngcairo", ".png"}, std::pair{"svg", ".svg"}}) {
      script << "reset\nset encoding utf8\nset datafile separator comma\nset terminal " << terminal
             << " size " << sheet.width() << ',' << sheet.height()
             << " font 'sans,11' noenhanced background rgb 'white'\nset output "
             << drawn_name(folder / (std::string("bench") + kind)) << "\n";
      write_common(sheet, script);
      script << "set multiplot\n";
      write_panels(results, sheet, in_quotes((folder / "bench.csv").string()), script);
      script << "unset multiplot\nunset output\n";
    }
  });
}

}  // namespace ilaw::host
