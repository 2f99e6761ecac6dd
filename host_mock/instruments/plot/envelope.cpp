// SPDX-License-Identifier: BSD-3-Clause
#include "plot/envelope.hpp"

#include "base/csv.hpp"

#include <algorithm>
#include <cmath>

namespace ilaw::host {

void Envelope::add(const std::vector<double>& row) { setup_.counts ? add_counts(row) : add_band(row); }

// Values that do not exist (the gap of what is far away) are left out.
void Envelope::add_band(const std::vector<double>& row) {
  values_.clear();
  for (std::size_t k = 0; k < setup_.columns.size(); ++k) {
    sums_[k] = setup_.summed ? sums_[k] + row[setup_.columns[k]] : row[setup_.columns[k]];
    if (std::isfinite(sums_[k])) values_.push_back(sums_[k]);
  }
  if (values_.empty()) return;
  std::sort(values_.begin(), values_.end());
  lines_.push_back({row[0], values_.front(), values_[values_.size() / 2], values_.back()});
}

void Envelope::add_counts(const std::vector<double>& row) {
  Line line{row[0]};
  for (const std::size_t column : setup_.columns)
    for (std::size_t k = 0; k < ILAW_STATUS_COUNT; ++k)
      if (row[column] <= static_cast<double>(k)) ++line[1 + k];
  lines_.push_back(line);
}

// Where there are more instants than pixels, a line holds what several of them reach.
void Envelope::write(std::ostream& script) const {
  script << setup_.block << " << EOD\n";
  CsvWriter table(script, 7);
  const std::size_t step = 1 + lines_.size() / most_lines;
  for (std::size_t first = 0; first < lines_.size(); first += step) {
    Line line = lines_[first];
    for (std::size_t k = first; !setup_.counts && k < std::min(first + step, lines_.size()); ++k) {
      line[1] = std::min(line[1], lines_[k][1]);
      line[3] = std::max(line[3], lines_[k][3]);
    }
    for (std::size_t c = 0; c < width(); ++c) table << line[c];
    table.end_row();
  }
  script << "EOD\n";
}

}  // namespace ilaw::host
