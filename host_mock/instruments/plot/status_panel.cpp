// SPDX-License-Identifier: BSD-3-Clause
#include "plot/status_panel.hpp"

#include "base/csv.hpp"
#include "plot/gnuplot.hpp"

#include <ilaw/ilaw.h>

#include <algorithm>
#include <fstream>
#include <iterator>

namespace ilaw::host {
namespace {

struct Status {
  const char* name;
  const char* colour;
};

// By number; colours as those of curves.
constexpr Status statuses[] = {{"free", "#dcdcdc"},   {"closed", "#56B4E9"},   {"stick", "#0072B2"},
                               {"slip", "#E69F00"},   {"bonded", "#009E73"},   {"broken", "#D55E00"},
                               {"healed", "#CC79A7"}, {"bad_input", "#000000"}};

// The numbers of those that occur.
std::vector<std::size_t> known(const StatusCounts& counts) {
  std::vector<std::size_t> numbers;
  for (std::size_t k = 0; k < std::size(statuses); ++k)
    if (counts.contains(static_cast<int>(k))) numbers.push_back(k);
  return numbers;
}

// From the one that lasts longest to the rarest.
std::vector<std::size_t> by_duration(const StatusCounts& counts) {
  std::vector<std::size_t> numbers = known(counts);
  const auto count = [&](std::size_t k) { return counts.at(static_cast<int>(k)); };
  std::stable_sort(numbers.begin(), numbers.end(),
                   [&](std::size_t a, std::size_t b) { return count(a) > count(b); });
  return numbers;
}

}  // namespace

// A block without lines is an error for gnuplot.
bool write_ruptures(std::ostream& script, const std::filesystem::path& folder, const StatusRows& rows) {
  std::map<std::string, std::size_t> row_of;
  for (std::size_t k = 0; k < rows.size(); ++k) row_of[rows[k].owner] = k + 1;
  bool any = false;
  script << "$ruptures << EOD\nNaN,NaN\n";
  std::ifstream events(folder / "events.csv");
  for (std::string line; std::getline(events, line);) {
    const std::vector<std::string> cells = csv_cells(line);
    if (cells.size() < 4 || cells[3] != "rupture") continue;
    auto found = row_of.find("n" + cells[1]);
    if (found == row_of.end()) found = row_of.find("n" + cells[1] + "." + cells[2]);
    if (found == row_of.end()) continue;
    script << cells[0] << "," << found->second << "\n";
    any = true;
  }
  script << "EOD\n";
  return any;
}

// A status of one step is a dot, thanks to round caps; the rarest lies on top.
void draw_status(std::ostream& script, const StatusRows& rows, const StatusCounts& counts) {
  script << "set yrange [" << static_cast<double>(rows.size()) + 0.5 << ":0.5]\nset ytics (";
  for (std::size_t row = 0; row < rows.size(); ++row)
    script << (row > 0 ? ", " : "") << in_quotes(rows[row].owner) << " " << row + 1;
  script << ") scale 0\nplot ";
  for (const std::size_t k : by_duration(counts))
    for (std::size_t row = 0; row < rows.size(); ++row)
      script << "before = -1, history using 1:(now = $" << rows[row].column << ", drawn = now == " << k
             << " || before == " << k << ", before = now, drawn ? " << row + 1
             << " : NaN) with lines linewidth 7 linecolor rgb " << in_quotes(statuses[k].colour)
             << " title '', ";
  script << "$ruptures using 1:2 with points pointtype 7 pointsize 0.85 linecolor rgb "
         << in_quotes(statuses[ILAW_BROKEN].colour) << " title ''";
  for (const std::size_t k : known(counts))
    script << ", NaN with lines linewidth 7 linecolor rgb " << in_quotes(statuses[k].colour) << " title "
           << in_quotes(statuses[k].name);
  script << "\n";
}

void draw_counts(std::ostream& script, const std::string& block, std::size_t contacts,
                 const StatusCounts& counts) {
  script << "set yrange [0:" << contacts << "] noextend\nset ytics autofreq\n";
  const char* separator = "plot ";
  for (const std::size_t k : known(counts)) {
    script << separator << block << " using 1:(" << (k == 0 ? "0" : "$" + std::to_string(k + 1))
           << "):" << k + 2 << " with filledcurves fillcolor rgb " << in_quotes(statuses[k].colour)
           << " fillstyle solid noborder title " << in_quotes(statuses[k].name);
    separator = ", ";
  }
  script << "\n";
}

}  // namespace ilaw::host
