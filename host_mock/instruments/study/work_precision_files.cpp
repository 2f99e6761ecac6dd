// SPDX-License-Identifier: BSD-3-Clause
#include "study/work_precision.hpp"

#include "base/csv.hpp"
#include "base/files.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <ostream>

namespace ilaw::host {
namespace {

using nlohmann::json;

void write_runs(const Study& study, const std::filesystem::path& folder) {
  AtomicFile file(folder / "study.csv");
  CsvWriter csv(file.stream(), 6);
  for (const char* column : {"law", "dt", "steps", "seconds", "penetration"}) csv << column;
  for (const char* norm : norm_names) csv << norm;
  csv.end_row();
  for (const LawRuns& law : study.laws)
    for (const MeasuredRun& run : law.runs) {
      csv << law.name << run.dt << run.steps;
      csv.add_if_finite(run.seconds);
      csv.add_if_finite(run.penetration);
      for (std::size_t n = 0; n < norm_names.size(); ++n) csv.add_if_finite(run.errors[n]);
      csv.end_row();
    }
  file.commit();
}

void write_costs(const Study& study, const std::filesystem::path& folder) {
  AtomicFile file(folder / "study_needed.csv");
  CsvWriter csv(file.stream(), 6);
  for (const char* column :
       {"law", "norm", "error", "steps", "seconds", "steps / first law's", "seconds / first law's"})
    csv << column;
  csv.end_row();
  for (std::size_t n = 0; n < norm_names.size(); ++n)
    for (const double error : wanted_errors) {
      const Cost first = cost_of(study.laws[0].runs, static_cast<Norm>(n), error);
      for (const LawRuns& law : study.laws) {
        const Cost cost = cost_of(law.runs, static_cast<Norm>(n), error);
        csv << law.name << norm_names[n] << error;
        for (const double value :
             {std::round(cost.steps), cost.seconds, cost.steps / first.steps, cost.seconds / first.seconds})
          csv.add_if_finite(value);
        csv.end_row();
      }
    }
  file.commit();
}

void write_laws(const Study& study, const std::string& title, const std::filesystem::path& folder) {
  json laws = json::array();
  for (const LawRuns& law : study.laws) {
    json failures = json::array();
    for (const MeasuredRun& run : law.runs)
      if (!run.failure.empty()) failures.push_back({{"dt", run.dt}, {"failure", run.failure}});
    laws.push_back({{"name", law.name},
                    {"entry", law.entry},
                    {"largest_step_tried", law.tried},
                    {"largest_stable_step", law.stable},
                    {"failures", failures}});
  }
  const json found = {{"title", title},
                      {"reference", study.exact ? "exact solution" : "finest run of the first law"},
                      {"laws", laws}};
  write_file(folder / "study.json", found.dump(2) + "\n");
}

}  // namespace

void write_study(const Study& study, const std::string& title, const std::filesystem::path& folder) {
  write_runs(study, folder);
  write_costs(study, folder);
  write_laws(study, title, folder);
}

}  // namespace ilaw::host
