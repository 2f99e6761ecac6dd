// run_result.hpp - a scene run by the program, and what it wrote.
#pragma once

#include "host_runner.hpp"
#include "program_runner.hpp"

#include "base/csv.hpp"

#include <nlohmann/json.hpp>

#include <cstdlib>
#include <map>

namespace ilaw::host::testing {

// A table by columns; what is no number is 0.
inline std::map<std::string, std::vector<double>> table_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  const std::vector<std::string> names = csv_cells(line);
  std::map<std::string, std::vector<double>> table;
  for (const std::string& name : names) table[name];
  while (std::getline(stream, line)) {
    const std::vector<std::string> cells = csv_cells(line);
    for (std::size_t k = 0; k < cells.size(); ++k)
      table[names[k]].push_back(std::strtod(cells[k].c_str(), nullptr));
  }
  return table;
}

struct Ran {
  std::map<std::string, std::vector<double>> history;
  nlohmann::json summary;
  std::string events;

  // Force times time, summed over the rows.
  double impulse(const std::string& column) const {
    double sum = 0.0, before = 0.0;
    for (std::size_t k = 0; k < history.at("time").size(); ++k) {
      sum += history.at(column)[k] * (history.at("time")[k] - before);
      before = history.at("time")[k];
    }
    return sum;
  }
  double last(const std::string& column) const { return history.at(column).back(); }
  // Over the rows after a time.
  double mean_after(double time, const std::string& column) const {
    double sum = 0.0;
    int count = 0;
    for (std::size_t k = 0; k < history.at("time").size(); ++k)
      if (history.at("time")[k] > time) {
        sum += history.at(column)[k];
        ++count;
      }
    return sum / count;
  }
};

inline Ran ran(const nlohmann::json& scene, const std::string& options = "") {
  const auto folder = fresh_folder();
  std::ofstream(folder / "scene.json") << scene.dump();
  const Outcome outcome =
      run_program("run " + (folder / "scene.json").string() + " --out " + folder.string() + " " + options);
  EXPECT_EQ(outcome.code, 0) << outcome.output;
  Ran result{table_of(folder / "history.csv"), nlohmann::json::parse(text_of(folder / "summary.json")),
             text_of(folder / "events.csv")};
  std::filesystem::remove_all(folder);
  return result;
}

}  // namespace ilaw::host::testing
