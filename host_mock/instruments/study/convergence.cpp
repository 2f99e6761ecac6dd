// SPDX-License-Identifier: BSD-3-Clause
#include "study/convergence.hpp"

#include "base/csv.hpp"
#include "base/files.hpp"
#include "scene/json_text.hpp"
#include "study/process_run.hpp"

#include <ostream>

namespace ilaw::host {
namespace {

using nlohmann::json;

// The scene of a level.
Scene scene_at(const json& source, const Sweep& sweep, int level, const std::filesystem::path& file) {
  Scene scene = read_scene(refined(source, sweep, sweep.refinement(level)), file);
  if (scene.output.watch.empty()) throw mistake("/output/watch", "no node", "those to compare");
  return scene;
}

// ---- files ----------------------------------------------------------------------------------------------

void write_table(const ErrorTable& table, const std::filesystem::path& folder) {
  AtomicFile file(folder / "converge.csv");
  CsvWriter csv(file.stream(), 10);
  csv << "dt"
      << "steps"
      << "seconds";
  for (const char* norm : norm_names) csv << norm;
  csv.end_row();
  for (std::size_t k = 0; k < table.errors.size(); ++k) {
    csv << table.runs[k].dt << table.runs[k].steps << table.runs[k].seconds;
    for (std::size_t n = 0; n < norm_names.size(); ++n) csv.add_if_finite(table.errors[k][n]);
    csv.end_row();
  }
  file.commit();
}

void write_orders(const ErrorTable& table, const Sweep& sweep, const std::string& title,
                  const std::filesystem::path& folder) {
  json orders;
  for (std::size_t n = 0; n < norm_names.size(); ++n)
    orders[norm_names[n]] = table.order(n);  // NaN is written as null
  const json found = {{"title", title},
                      {"reference", table.exact ? "exact solution" : "finest run"},
                      {"refined", sweep.with_mesh ? "mesh and time step" : "time step"},
                      {"levels", sweep.levels},
                      {"orders", orders}};
  write_file(folder / "converge.json", found.dump(2) + "\n");
}

}  // namespace

double ErrorTable::order(std::size_t norm) const {
  std::vector<double> steps, values;
  for (std::size_t k = 0; k < errors.size(); ++k) {
    steps.push_back(runs[k].dt);
    values.push_back(errors[k][norm]);
  }
  // Errors are relative but those of instants.
  return order_of(steps, values,
                  norm == norm_instant ? runs[0].dt * static_cast<double>(runs[0].steps) : 1.0);
}

void check_sweep(const json& source, const Sweep& sweep, const std::filesystem::path& file) {
  check_mesh(source, sweep, "/converge");
  exact_solution(scene_at(source, sweep, 0, file));
}

ErrorTable run_levels(const json& source, const Sweep& sweep, const std::filesystem::path& file,
                      const Told& told) {
  ErrorTable table;
  double done = 0.0, total = 0.0;  // steps per level grow with the refinement
  table.exact = !exact_solution(scene_at(source, sweep, 0, file)).empty();
  for (int level = 0; level < sweep.levels; ++level) {
    const auto scene = [&] { return scene_at(source, sweep, level, file); };
    const Trace& run = table.runs.emplace_back(trace_in_process(scene, sweep.threads));
    if (table.exact) table.errors.push_back(errors_against(exact_solution(scene()), run));
    const auto steps = static_cast<double>(run.steps);
    if (level == 0)
      for (int k = 0; k < sweep.levels; ++k) total += steps * sweep.refinement(k) / sweep.refinement(0);
    told(done += steps, total);
  }
  for (std::size_t k = 0; !table.exact && k + 1 < table.runs.size(); ++k)
    table.errors.push_back(errors_against(table.runs.back(), table.runs[k]));
  return table;
}

void write_convergence(const ErrorTable& table, const Sweep& sweep, const std::string& title,
                       const std::filesystem::path& folder) {
  write_table(table, folder);
  write_orders(table, sweep, title, folder);
}

}  // namespace ilaw::host
