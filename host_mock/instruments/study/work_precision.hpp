// work_precision.hpp - laws side by side in one scene: what error they reach with how many steps, and in
// what time.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "study/errors.hpp"
#include "study/sweep.hpp"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace ilaw::host {

struct StudySetup {
  Sweep sweep;
  std::int64_t most_steps;  // of a run but the first of a law
  double reference;         // the finest run's step over that of the run that it is compared with, inverted
  int repetitions;          // of every run, to take the median of their times
  nlohmann::json laws;
};

// The "study" of a scene, with the laws of the command line instead where there are any.
// Throws SceneError.
StudySetup read_study(nlohmann::json& source, const std::vector<std::string>& laws);

struct MeasuredRun {
  double dt = 0.0, seconds = ContactInstants::none;
  std::int64_t steps = 0;
  double penetration = ContactInstants::none;
  Errors errors{};
  std::string failure{};  // why it has no errors
};

struct LawRuns {
  std::string name;
  nlohmann::json entry;
  double tried = 0.0;   // largest step that was tried: that of the scene over 0.9, at most the critical one
  double stable = 0.0;  // largest of them that is stable
  std::vector<MeasuredRun> runs{};  // steps from 0.9 of that down, at most the scene's
};

struct Study {
  std::vector<LawRuns> laws;
  bool exact = false;  // against the exact solution, not the first law with smaller steps still
};

// Throws SceneError where the study makes no sense of the scene, before anything is run.
void check_study(const nlohmann::json& source, const StudySetup& setup, const std::filesystem::path& file);

// Runs everything, and tells of runs, each weighed by its refinement. Throws SceneError where a law has no
// stable step.
Study run_study(const nlohmann::json& source, const StudySetup& setup, const std::filesystem::path& file,
                const Told& told);

// The cost of a law to come below an error and stay there with all smaller steps: between runs along
// straight lines in logarithms; NaN where it never does. Instants are relative to the end of the run.
struct Cost {
  double steps = ContactInstants::none, seconds = ContactInstants::none;
};
Cost cost_of(const std::vector<MeasuredRun>& runs, Norm norm, double error);

// The errors that tables ask for.
constexpr std::array<double, 7> wanted_errors{1e-1, 3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4};

// study.csv with all runs, study_needed.csv with what errors cost, study.json with the laws and their
// largest stable steps.
void write_study(const Study& study, const std::string& title, const std::filesystem::path& folder);

}  // namespace ilaw::host
