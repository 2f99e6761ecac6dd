// csv.hpp - a table as comma-separated values, as all results are written.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <charconv>
#include <concepts>
#include <ostream>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

namespace ilaw::host {

class CsvWriter {
 public:
  // digits: significant ones of numbers that are not whole; 0: as few as read back to the same
  // double.
  explicit CsvWriter(std::ostream& out, int digits = 0) : out_(out), digits_(digits) {}

  CsvWriter& operator<<(std::string_view text) {
    if (!first_) out_ << ',';
    first_ = false;
    out_ << text;
    return *this;
  }
  CsvWriter& operator<<(double value) {
    char text[32];
    const auto end = digits_ > 0
                         ? std::to_chars(text, text + sizeof text, value, std::chars_format::general, digits_)
                         : std::to_chars(text, text + sizeof text, value);
    return *this << std::string_view(text, end.ptr);
  }
  CsvWriter& operator<<(const char* text) { return *this << std::string_view(text); }
  CsvWriter& operator<<(std::integral auto value) { return *this << std::to_string(value); }

  void end_row() {
    out_ << '\n';
    first_ = true;
  }

 private:
  std::ostream& out_;
  int digits_;
  bool first_ = true;  // in its row
};

// The cells of a line.
inline std::vector<std::string> csv_cells(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
  return cells;
}

}  // namespace ilaw::host
