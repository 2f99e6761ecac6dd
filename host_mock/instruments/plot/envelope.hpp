// envelope.hpp - what many nodes do, in few curves: the least, the median and the largest value over
// time, and how many nodes have which status. Written as data blocks into a script for gnuplot.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/ilaw.h>

#include <array>
#include <cstddef>
#include <ostream>
#include <string>
#include <vector>

namespace ilaw::host {

// Columns of a history, from 0, that one envelope is drawn of.
struct EnvelopeSetup {
  std::string block;  // its name in the script, as $u0
  std::vector<std::size_t> columns;
  bool summed = false;  // the running sums of the columns
  bool counts = false;  // statuses: how many columns have each, one upon the other
};

class Envelope {
 public:
  explicit Envelope(EnvelopeSetup setup) : setup_(std::move(setup)), sums_(setup_.columns.size()) {}

  // A row of the history; its first value is the time.
  void add(const std::vector<double>& row);
  // "$u0 << EOD" and a line per instant, at most some thousand: time, least, median, largest; or
  // time and the counts of status 0, of 0 and 1, and so on.
  void write(std::ostream& script) const;

 private:
  static constexpr std::size_t most_lines = 2000;
  using Line = std::array<double, 1 + ILAW_STATUS_COUNT>;

  void add_band(const std::vector<double>& row);
  void add_counts(const std::vector<double>& row);
  std::size_t width() const { return setup_.counts ? 1 + ILAW_STATUS_COUNT : 4; }

  EnvelopeSetup setup_;
  std::vector<double> sums_, values_;
  std::vector<Line> lines_;
};

}  // namespace ilaw::host
