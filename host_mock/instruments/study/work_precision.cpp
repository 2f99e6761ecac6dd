// SPDX-License-Identifier: BSD-3-Clause
#include "study/work_precision.hpp"

#include "base/clock.hpp"
#include "scene/json_text.hpp"
#include "scene/validation.hpp"
#include "study/process_run.hpp"
#include "study/stable_step.hpp"
#include "study/study_laws.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

namespace ilaw::host {
namespace {

using nlohmann::json;

// Laws run at most at this part of their largest stable step.
constexpr double margin = 0.9;

// The scenes of a study.
class Scenes {
 public:
  Scenes(const json& source, const Sweep& sweep, std::filesystem::path file)
      : source_(source), sweep_(sweep), file_(std::move(file)) {
    const json& time = source_["time"];
    key_ = time.contains("dt") ? "dt" : "cfl";
    given_ = time[key_].get<double>();
  }

  // The scene's own law, or that of an entry; part: of the step of that refinement.
  Scene own(double refinement) const { return read_scene(refined(source_, sweep_, refinement), file_); }
  Scene with(const json& entry, double refinement, double part) const {
    json source = refined(source_, sweep_, refinement);
    json& step = source["time"][key_];
    step = std::min(step.get<double>() * part, largest(refinement));
    try {
      return read_scene(with_law(source, entry, given_, file_), file_);
    } catch (const SceneError& error) {
      throw SceneError("with law '" + name_of(entry) + "': " + error.what());
    }
  }

 private:
  // A step beyond the critical one is refused, or makes no sense.
  double largest(double refinement) const {
    return std::string_view(key_) == "cfl" ? 1.0 : own(refinement).model->critical_step();
  }

  const json& source_;
  const Sweep& sweep_;
  std::filesystem::path file_;
  const char* key_;
  double given_;
};

// A run that fails is part of what is measured.
template <class Run>
void attempt(MeasuredRun& measured, Run run) {
  try {
    run();
  } catch (const SceneError&) {
    throw;
  } catch (const std::runtime_error& failure) {
    measured.failure = failure.what();
    const double none = ContactInstants::none;
    measured.errors = {none, none, none, none, none, none};
  }
}

class Measurement {
 public:
  Measurement(const json& source, const StudySetup& setup, const std::filesystem::path& file,
              const Told& told)
      : setup_(setup), scenes_(source, setup.sweep, file), told_(told), total_(all_work()) {}

  Study run() {
    for (const json& entry : setup_.laws) find_steps(entry);
    find_reference();
    for (std::size_t k = 0; k < study_.laws.size(); ++k) {
      std::vector<MeasuredRun>& runs = study_.laws[k].runs;
      for (int level = 0; level < setup_.sweep.levels; ++level) {
        const Scene run = scene(k, refinement(level));
        if (level > 0 && run.steps > setup_.most_steps) break;
        runs.push_back({run.dt});
        runs.back().steps = run.steps;
        measure(k, level, runs.back());
        did(weight(level));
      }
    }
    find_times();
    told_(total_, total_);
    return std::move(study_);
  }

 private:
  double refinement(int level) const { return setup_.sweep.refinement(level); }

  // Work is told in runs of level 0. The search for the largest stable step has about search_runs of them.
  static constexpr double search_runs = 12.0;
  double weight(int level) const { return refinement(level) / refinement(0); }
  double reference_work() const { return setup_.reference * weight(setup_.sweep.levels - 1); }
  double all_work() const {
    double of_law = search_runs;
    for (int level = 0; level < setup_.sweep.levels; ++level)
      of_law += weight(level) * (1.0 + setup_.repetitions);
    return reference_work() + static_cast<double>(setup_.laws.size()) * of_law;
  }
  void did(double work) { told_(done_ += work, total_); }

  bool has_run(std::size_t law, int level) const {
    return static_cast<std::size_t>(level) < study_.laws[law].runs.size();
  }
  MeasuredRun& run_of(std::size_t law, int level) {
    return study_.laws[law].runs[static_cast<std::size_t>(level)];
  }
  Scene scene(std::size_t law, double refinement) const {
    return scenes_.with(study_.laws[law].entry, refinement, parts_[law]);
  }

  // On the coarsest mesh; on finer ones the step follows it.
  void find_steps(const json& entry) {
    LawRuns law{name_of(entry), entry};
    const double level0 = refinement(0), step = scenes_.own(level0).dt;
    law.tried = scenes_.with(entry, level0, 1.0 / margin).dt;
    const double upper = law.tried / step;
    law.stable = law.tried *
                 largest_stable_step([&](double part) { return scenes_.with(entry, level0, part * upper); },
                                     setup_.sweep.threads);
    if (law.stable == 0.0) throw SceneError("law '" + law.name + "' has no stable step in this scene");
    parts_.push_back(std::min(margin * law.stable / step, 1.0));
    study_.laws.push_back(std::move(law));
    did(search_runs);
  }

  void find_reference() {
    study_.exact = !exact_solution(scenes_.own(refinement(0))).empty();
    did(reference_work());
    if (study_.exact) return;
    const double finest = refinement(setup_.sweep.levels - 1) * setup_.reference;
    reference_ = trace_in_process([&] { return scene(0, finest); }, setup_.sweep.threads);
  }

  void measure(std::size_t law, int level, MeasuredRun& measured) const {
    attempt(measured, [&] {
      const Trace trace =
          trace_in_process([&] { return scene(law, refinement(level)); }, setup_.sweep.threads);
      measured.penetration = trace.penetration;
      measured.errors = study_.exact ? errors_against(exact_solution(scenes_.own(refinement(level))), trace)
                                     : errors_against(reference_, trace);
    });
  }

  // All laws in turn, and all over again: what else the machine does hits them alike.
  void find_times() {
    for (int level = 0; level < setup_.sweep.levels; ++level) {
      std::vector<std::vector<double>> seconds(study_.laws.size());
      for (int repetition = 0; repetition < setup_.repetitions; ++repetition)
        for (std::size_t k = 0; k < study_.laws.size(); ++k) {
          if (!has_run(k, level) || !run_of(k, level).failure.empty()) continue;
          seconds[k].push_back(
              seconds_in_process([&] { return scene(k, refinement(level)); }, setup_.sweep.threads));
          did(weight(level));
        }
      for (std::size_t k = 0; k < study_.laws.size(); ++k)
        if (!seconds[k].empty()) run_of(k, level).seconds = median(seconds[k]);
    }
  }

  const StudySetup& setup_;
  Scenes scenes_;
  const Told& told_;
  double done_ = 0.0, total_;
  std::vector<double> parts_{};  // per law: step over that of the scene
  Trace reference_{};
  Study study_{};
};

}  // namespace

StudySetup read_study(json& source, const std::vector<std::string>& laws) {
  json& study = source["study"];
  if (study.is_null()) study = json::object();
  if (!laws.empty()) {
    study["laws"] = json::array();
    for (const std::string& law : laws) study["laws"].push_back(read_law_option(law));
    validate_scene(source);
  }
  return {read_sweep(study), study.value("most_steps", std::int64_t{1'000'000}),
          study.value("reference", 4.0), study.value("repetitions", 5),
          study.contains("laws") ? study["laws"] : usual_laws(source)};
}

void check_study(const json& source, const StudySetup& setup, const std::filesystem::path& file) {
  check_mesh(source, setup.sweep, "/study");
  const Scenes scenes(source, setup.sweep, file);
  const Scene own = scenes.own(setup.sweep.refinement(0));
  if (own.output.watch.empty()) throw mistake("/output/watch", "no node", "those to compare");
  exact_solution(own);
  std::set<std::string> names;
  for (std::size_t k = 0; k < setup.laws.size(); ++k) {
    const std::string name = name_of(setup.laws[k]);
    if (!names.insert(name).second)
      throw mistake(at("/study/laws", k), "'" + name + "' twice", "a different name for each");
    scenes.with(setup.laws[k], setup.sweep.refinement(0), 1.0);
  }
}

Study run_study(const json& source, const StudySetup& setup, const std::filesystem::path& file,
                const Told& told) {
  return Measurement(source, setup, file, told).run();
}

Cost cost_of(const std::vector<MeasuredRun>& runs, Norm norm, double error) {
  const auto error_of = [&](const MeasuredRun& run) {
    return run.errors[norm] / (norm == norm_instant ? run.dt * static_cast<double>(run.steps) : 1.0);
  };
  std::size_t first = runs.size();
  while (first > 0 && error_of(runs[first - 1]) <= error) --first;
  if (first == runs.size()) return {};
  const MeasuredRun& below = runs[first];
  if (first == 0) return {static_cast<double>(below.steps), below.seconds};
  const MeasuredRun& above = runs[first - 1];
  const double upper = error_of(above), lower = error_of(below);
  const bool is_line = std::isfinite(upper) && lower > 0.0;
  const double part = is_line ? std::log(upper / error) / std::log(upper / lower) : 1.0;
  const auto between = [part](double coarse, double fine) { return coarse * std::pow(fine / coarse, part); };
  return {between(static_cast<double>(above.steps), static_cast<double>(below.steps)),
          between(above.seconds, below.seconds)};
}

}  // namespace ilaw::host
