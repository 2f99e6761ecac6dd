// SPDX-License-Identifier: BSD-3-Clause
#include "plot/comparison.hpp"

#include "plot/gnuplot.hpp"
#include "plot/history_file.hpp"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <set>

namespace ilaw::host {
namespace {

// Sizes in pixels.
constexpr double margin_left = 95, plot_width = 780, margin_above = 45, margin_below = 55, panel_gap = 18,
                 panel_height = 150, letter = 7.5, letter_of_title = 9.5, legend_line = 18;

std::set<std::string> columns_that_vary(const RunFolder& run) {
  HistoryFile history(run.folder / "history.csv");
  std::set<std::string> vary;
  for (std::vector<double> row; history.next(row);)
    for (std::size_t k = 1; k < row.size(); ++k)
      if (row[k] != 0.0 && row[k] == row[k]) vary.insert(history.names()[k]);
  return vary;
}

// Resultants, then the balance, then nodes.
int rank(const std::string& column) {
  if (column.starts_with("balance.")) return 1;
  const bool of_node =
      column.size() > 1 && column[0] == 'n' && std::isdigit(static_cast<unsigned char>(column[1]));
  return of_node ? 2 : 0;
}

std::string last_key(const std::string& pointer) { return pointer.substr(pointer.rfind('/') + 1); }

// A curve of each run; legends: one each, or none.
void draw_curves(std::ostream& script, const std::vector<RunFolder>& runs, const std::string& x,
                 const std::string& y, const std::vector<std::string>& legends) {
  for (std::size_t k = 0; k < runs.size(); ++k) {
    const std::filesystem::path file = runs[k].folder / "history.csv";
    const HistoryFile history(file);
    script << (k == 0 ? "plot " : ", ") << in_quotes(file.string()) << " using " << *history.index_of(x) + 1
           << ":" << *history.index_of(y) + 1 << " with lines linewidth 1.4 dashtype "
           << 1 + k / std::size(curve_colours) << " linecolor rgb "
           << in_quotes(curve_colours[k % std::size(curve_colours)]) << " title "
           << in_quotes(legends.empty() ? "" : legends[k]);
  }
  script << "\n";
}

}  // namespace

std::vector<std::string> comparable_columns(const std::vector<RunFolder>& runs) {
  std::set<std::string> vary;
  for (const RunFolder& run : runs) vary.merge(columns_that_vary(run));
  std::vector<std::string> columns;
  const HistoryFile first(runs.front().folder / "history.csv");
  for (const std::string& name : first.names())
    if (vary.contains(name) && !name.ends_with("status")) columns.push_back(name);
  for (const RunFolder& run : runs) {
    const HistoryFile history(run.folder / "history.csv");
    std::erase_if(columns, [&](const std::string& name) { return !history.index_of(name); });
  }
  std::stable_sort(columns.begin(), columns.end(),
                   [](const auto& a, const auto& b) { return rank(a) < rank(b); });
  return columns;
}

std::vector<std::string> legends_of(const std::vector<RunFolder>& runs) {
  const std::vector<std::string> different = differences(runs);
  std::vector<std::string> legends;
  constexpr std::size_t most_keys = 3;
  for (const RunFolder& run : runs) {
    std::string& text = legends.emplace_back();
    for (std::size_t k = 0; k < std::min(most_keys, different.size()); ++k)
      text += (k > 0 ? " " : "") + last_key(different[k]) + "=" + run.said(different[k]);
    if (text.empty() || different.size() > most_keys) text = run.name();
  }
  return legends;
}

bool draw_comparison(const std::filesystem::path& picture, const std::vector<RunFolder>& runs,
                     const ComparisonSetup& setup) {
  const std::vector<std::string> legends = legends_of(runs);
  std::size_t longest = 0;
  for (const std::string& legend : legends) longest = std::max(longest, legend.size());
  const double right = runs.size() > 1 ? 60.0 + letter * static_cast<double>(longest) : 30.0;
  const double key_height = runs.size() > 1 ? legend_line * static_cast<double>(runs.size()) : 0.0;
  const auto panels = static_cast<double>(setup.y.size());
  const double tall = setup.y.size() == 1 ? 2.0 * panel_height : panel_height;
  Sheet sheet{picture, margin_left + plot_width + right, 0.0};
  double title_lines = 1.0;
  const std::string title = in_lines(runs.front().summary["scene"].value("title", runs.front().name()),
                                     static_cast<std::size_t>(sheet.width / letter_of_title), title_lines);
  const double above = margin_above + 22.0 * (title_lines - 1.0);
  sheet.height = above + margin_below + std::max(panels * (tall + panel_gap) - panel_gap, key_height);
  sheet.multiplot = "title " + title + " font ',14' noenhanced";
  sheet.terminal = "rounded";
  return draw_sheet(sheet, [&](std::ostream& script) {
    script << "set lmargin at screen " << margin_left / sheet.width << "\nset rmargin at screen "
           << 1.0 - right / sheet.width << "\n"
           << grey_axes << "set xrange [*:*] noextend\nset ytics font ',10'\n";
    double top = sheet.height - above;
    for (std::size_t p = 0; p < setup.y.size(); ++p) {
      const std::string label = in_quotes(setup.y[p].substr(setup.y[p].starts_with("balance.") ? 8 : 0));
      place_panel(script, sheet, {top, top - tall, right, 0.015 * sheet.width}, label + " font ',9'");
      if (p + 1 == setup.y.size())
        script << "set xlabel " << in_quotes(setup.x) << " noenhanced\nset format x '%g'\n";
      draw_curves(script, runs, setup.x, setup.y[p],
                  p == 0 && runs.size() > 1 ? legends : std::vector<std::string>());
      top -= tall + panel_gap;
    }
  });
}

}  // namespace ilaw::host
