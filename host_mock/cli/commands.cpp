// Parts that several commands use.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/commands.hpp"

#include <omp.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>

namespace ilaw::host {

void add_threads(CLI::App& command, int& threads) {
  command.add_option("--threads", threads, "Threads; any number gives the same bits")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
}

void set_threads(int threads) { omp_set_num_threads(threads); }

void remove_pictures(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> found;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::filesystem::path ending = entry.path().extension();
    if (!entry.is_regular_file() || (ending != ".png" && ending != ".svg")) continue;
    std::string head(2000, '\0');  // it names the program that drew
    std::ifstream(entry.path(), std::ios::binary)
        .read(head.data(), static_cast<std::streamsize>(head.size()));
    if (head.find("ilaw plot") != std::string::npos) found.push_back(entry.path());
  }
  for (const std::filesystem::path& picture : found) std::filesystem::remove(picture);
}

std::string text_of(const char* format, double value) {
  std::array<char, 32> buffer{"-"};
  if (std::isfinite(value)) std::snprintf(buffer.data(), buffer.size(), format, value);
  return buffer.data();
}

void print_rows(const std::vector<Row>& rows, const char* indent) {
  std::vector<std::size_t> widths;
  for (const Row& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t c = 0; c + 1 < row.size(); ++c) widths[c] = std::max(widths[c], row[c].size());
  }
  for (const Row& row : rows) {
    std::string line = indent;
    for (std::size_t c = 0; c + 1 < row.size(); ++c)
      line += row[c] + std::string(widths[c] + 2 - row[c].size(), ' ');
    std::printf("%s%s\n", line.c_str(), row.back().c_str());
  }
}

}  // namespace ilaw::host
