// SPDX-License-Identifier: BSD-3-Clause
#include "study/work_precision.hpp"

#include "base/csv.hpp"
#include "base/files.hpp"
#include "plot/gnuplot.hpp"

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

// An error over a column of study.csv, both counted from 1.
struct ErrorPanel {
  Norm norm;
  const char* title;
  std::size_t column;
  double unit;
  const char* label;
};

constexpr std::size_t steps_column = 3, seconds_column = 4, first_norm_column = 6;

// Logarithmic axes show what is larger than zero; an exact solution may tell no impulse or work.
bool has_points(const Study& study, Norm norm) {
  return std::any_of(study.laws.begin(), study.laws.end(), [&](const LawRuns& law) {
    return std::any_of(law.runs.begin(), law.runs.end(), [&](const MeasuredRun& run) {
      return std::isfinite(run.errors[norm]) && run.errors[norm] > 0.0;
    });
  });
}

void write_panel(const Study& study, const std::string& csv, const ErrorPanel& panel, bool has_key,
                 std::ostream& script) {
  script
      << "set xlabel " << in_quotes(panel.label) << "\nset title " << in_quotes(panel.title)
      << " noenhanced\n"
      << (has_key
              ? "set key at screen 0.77,0.9 left top vertical maxcols 1 noenhanced samplen 2 Left reverse\n"
              : "unset key\n");
  for (std::size_t k = 0; k < study.laws.size(); ++k)
    script << (k == 0 ? "plot " : ", ") << csv << " using (strcol(1) eq " << in_quotes(study.laws[k].name)
           << " ? $" << panel.column << '/' << panel.unit << " : NaN):" << first_norm_column + panel.norm
           << " with linespoints linewidth " << (k == 0 ? 3.0 : 1.5) << " pointsize 0.8 pointtype "
           << (k == 0 ? 7 : 3 + k) << " linecolor rgb "
           << in_quotes(curve_colours[k % std::size(curve_colours)]) << " title "
           << in_quotes(study.laws[k].name);
  script << "\n";
}

}  // namespace

void write_study(const Study& study, const std::string& title, const std::filesystem::path& folder) {
  write_runs(study, folder);
  write_costs(study, folder);
  write_laws(study, title, folder);
}

bool draw_study(const Study& study, const std::string& title, const std::filesystem::path& folder) {
  // Run times of machines differ: over that of the first law's finest run.
  const double unit = study.laws[0].runs.back().seconds;
  const char *steps = "steps", *time = "run time / that of the first law's finest run";
  const ErrorPanel panels[] = {
      {norm_u_L2, "error of displacements (u_L2)", steps_column, 1.0, steps},
      {norm_u_L2, "error of displacements (u_L2)", seconds_column, std::isfinite(unit) ? unit : 1.0, time},
      {norm_impulse, "error of the impulse history", steps_column, 1.0, steps},
      {norm_energy, "error of the interfaces' work", steps_column, 1.0, steps}};
  const std::string csv = in_quotes((folder / "study.csv").string());
  const Sheet sheet{folder / "study", 1200, 840, "title " + in_quotes(title) + " font ',14' noenhanced"};
  return draw_sheet(sheet, [&](std::ostream& script) {
    script << log_axes;
    for (std::size_t k = 0; k < std::size(panels); ++k) {
      if (!has_points(study, panels[k].norm)) continue;
      script << "set origin " << (k % 2 ? 0.38 : 0.0) << ',' << (k < 2 ? 0.47 : 0.0)
             << "\nset size 0.38,0.48\n";
      write_panel(study, csv, panels[k], k == 1, script);
    }
  });
}

}  // namespace ilaw::host
