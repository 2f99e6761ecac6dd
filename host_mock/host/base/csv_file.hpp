// csv_file.hpp - reads a table of numbers, row by row.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/csv.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace ilaw::host {

class CsvFile {
 public:
  // Without columns where there is no such file.
  explicit CsvFile(const std::filesystem::path& file) : stream_(file) {
    std::getline(stream_, line_);
    names_ = csv_cells(line_);
  }

  const std::vector<std::string>& names() const { return names_; }
  std::optional<std::size_t> index_of(const std::string& name) const {
    const auto found = std::find(names_.begin(), names_.end(), name);
    if (found == names_.end()) return std::nullopt;
    return static_cast<std::size_t>(found - names_.begin());
  }

  // The next row, a value per column, NaN where there is none; false after the last.
  bool next(std::vector<double>& row) {
    if (!std::getline(stream_, line_)) return false;
    row.assign(names_.size(), std::numeric_limits<double>::quiet_NaN());
    const char* text = line_.c_str();
    for (double& value : row) {
      char* end = nullptr;
      const double read = std::strtod(text, &end);
      if (end != text) value = read;
      if (*end != ',') break;
      text = end + 1;
    }
    return true;
  }
  // How many the last row has.
  std::size_t cells() const {
    return 1 + static_cast<std::size_t>(std::count(line_.begin(), line_.end(), ','));
  }

 private:
  std::ifstream stream_;
  std::string line_;
  std::vector<std::string> names_;
};

}  // namespace ilaw::host
