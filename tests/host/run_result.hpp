// run_result.hpp - a scene run by the program, and what it wrote.
#pragma once

#include "host_runner.hpp"

#include "base/csv.hpp"

namespace ilaw::host::testing {

// The rows of a table, by column.
inline std::vector<std::map<std::string, std::string>> rows_of(const fs::path& file) {
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  const std::vector<std::string> names = csv_cells(line);
  std::vector<std::map<std::string, std::string>> rows;
  while (std::getline(stream, line)) {
    const std::vector<std::string> cells = csv_cells(line);
    rows.emplace_back();
    for (std::size_t k = 0; k < cells.size(); ++k) rows.back()[names[k]] = cells[k];
  }
  return rows;
}
// A cell that is no number, such as an empty one, is NaN.
inline double number_in(const std::string& cell) {
  char* end = nullptr;
  const double number = std::strtod(cell.c_str(), &end);
  return cell.empty() || *end != '\0' ? NAN : number;
}
// Its columns.
inline std::map<std::string, std::vector<double>> table_of(const fs::path& file) {
  std::map<std::string, std::vector<double>> table;
  for (const auto& row : rows_of(file))
    for (const auto& [name, cell] : row) table[name].push_back(number_in(cell));
  return table;
}

struct Ran {
  std::map<std::string, std::vector<double>> history;
  json summary;
  std::string events;

  const std::vector<double>& operator[](const std::string& column) const { return history.at(column); }
  std::size_t rows() const { return history.at("time").size(); }
  double last(const std::string& column) const { return history.at(column).back(); }
  double energy(const char* part) const { return summary["energy"][part]; }
  // Force times time, summed over the rows.
  double impulse(const std::string& column) const {
    double sum = 0.0, before = 0.0;
    for (std::size_t k = 0; k < rows(); before = history.at("time")[k++])
      sum += history.at(column)[k] * (history.at("time")[k] - before);
    return sum;
  }
  // Over the rows after a time.
  double mean_after(double time, const std::string& column) const {
    double sum = 0.0;
    int count = 0;
    for (std::size_t k = 0; k < rows(); ++k)
      if (history.at("time")[k] > time) {
        sum += history.at(column)[k];
        ++count;
      }
    return sum / count;
  }
};

// Each step is judged by the laws alone, momentum, energy and gaps.
inline Ran ran(const json& scene, const std::string& options = "") {
  const auto folder = fresh_folder();
  const Outcome outcome = run_scene(scene, folder, options + " --audit");
  EXPECT_EQ(outcome.code, 0) << outcome.output;
  return {table_of(folder / "history.csv"), json_of(folder / "summary.json"), text_of(folder / "events.csv")};
}

}  // namespace ilaw::host::testing
