// `ilaw run`: a scene from JSON to results.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/run.hpp"
#include "cli/commands.hpp"

#include "base/exit_code.hpp"
#include "base/files.hpp"
#include "base/scene_error.hpp"
#include "cli/progress.hpp"
#include "cli/sweep.hpp"
#include "model/elements.hpp"
#include "results/checkpoint.hpp"
#include "results/events.hpp"
#include "results/fields.hpp"
#include "results/history.hpp"
#include "results/summary.hpp"
#include "scene/scene.hpp"

#include <array>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

namespace ilaw::host {
namespace {

using Clock = std::chrono::steady_clock;

// Ctrl-C and kill end a run at the end of its step, with whole files.
volatile std::sig_atomic_t stop_requested = 0;

void request_stop(int /*signal*/) { stop_requested = 1; }

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// What an earlier run left in the folder, and pictures of it, would pass for results of this one.
void clear_results(const std::filesystem::path& folder) {
  std::error_code ignored;
  for (const char* name : {"events.csv", "history.png", "history.svg", "history.gnuplot"})
    std::filesystem::remove(folder / name, ignored);
}

// A run and what it writes. The constructor throws std::runtime_error where there is nothing to
// resume from, or nothing can be written.
class Run {
 public:
  Run(Scene& scene, const RunOptions& options)
      : scene_(scene),
        options_(options),
        integrator_(*scene.model, scene.loads, scene.interfaces, scene.dt),
        fields_(scene, options.folder) {
    if (options.resume) {
      resume();
      return;
    }
    history_ = std::make_unique<History>(scene_, integrator_, options_.folder);
    clear_results(options_.folder);
    fields_.clear();
    if (scene_.output.events) events_.emplace(scene_, options_.folder);
  }

  // Steps to the end, to a request to stop, or to a failure; the record says which.
  void advance() {
    std::optional<Progress> progress;
    if (options_.shows_progress) progress.emplace(integrator_.steps(), scene_.steps);
    try {
      if (!options_.resume && scene_.output.fields > 0) fields_.write(integrator_);
      while (integrator_.steps() < scene_.steps && !stop_requested) {
        integrator_.step();
        history_->add_step(integrator_);
        if (events_) events_->add_step(integrator_);
        write_outputs();
        if (progress) progress->show(integrator_.steps());
      }
      record.interrupted = integrator_.steps() < scene_.steps;
      if (record.interrupted && options_.checkpoint_every > 0) write_checkpoint_now();
      history_->commit();
      if (events_) events_->commit();
    } catch (const std::exception& failure) {
      record.failure = failure.what();
      history_->keep_rows();
      if (events_) events_->keep_rows();
    }
  }

  // Where that fails, and nothing did before, the run did.
  void finish(double seconds_total) {
    record.seconds_total = seconds_total;
    record.warnings = integrator_.warnings();
    warn_of_penetration();
    record.forces = history_->forces().summary();
    try {
      write_summary(scene_, integrator_, record, options_.folder);
    } catch (const std::exception& failure) {
      if (record.failure.empty()) record.failure = failure.what();
    }
  }

  const Integrator& integrator() const { return integrator_; }
  RunRecord record;

 private:
  void resume() {
    const Checkpoint checkpoint = read_checkpoint(scene_, integrator_, options_.folder);
    history_ = std::make_unique<History>(scene_, integrator_, options_.folder, checkpoint.history_size);
    std::istringstream history(checkpoint.history), events(checkpoint.events);
    history_->load(history);
    if (scene_.output.events) events_.emplace(scene_, options_.folder, checkpoint.events_size).load(events);
    fields_.resume(checkpoint.fields);
    record.resumed_at = integrator_.steps();
  }

  void warn_of_penetration() {
    constexpr double much = 0.05;
    const double depth = integrator_.tally().penetration_max, part = depth / shortest_edge(*scene_.model);
    if (!(part > much)) return;
    std::array<char, 160> text{};
    std::snprintf(
        text.data(), text.size(),
        "nodes penetrate by up to %.2g, %.0f %% of the shortest element edge: a penalty that is too "
        "soft does, and a large step",
        depth, 100.0 * part);
    record.warnings.emplace_back(text.data());
  }

  void write_outputs() {
    const std::int64_t step = integrator_.steps();
    const bool last = step == scene_.steps;
    const bool row = last || step % scene_.output.every == 0;
    const bool field = scene_.output.fields > 0 && (last || step % scene_.output.fields == 0);
    const bool checkpoint = options_.checkpoint_every > 0 && step % options_.checkpoint_every == 0;
    if (!row && !field && !checkpoint) return;
    const Clock::time_point start = Clock::now();
    if (row) history_->add_row(integrator_);
    if (field) fields_.write(integrator_);
    if (checkpoint) write_checkpoint_now();
    record.seconds_output += seconds_since(start);
  }

  void write_checkpoint_now() {
    std::ostringstream history, events;
    history_->save(history);
    if (events_) events_->save(events);
    write_checkpoint(
        scene_, integrator_,
        {history_->flush(), fields_.written(), history.str(), events_ ? events_->flush() : 0, events.str()},
        options_.folder);
  }

  Scene& scene_;
  const RunOptions& options_;
  Integrator integrator_;
  Fields fields_;
  std::unique_ptr<History> history_;
  std::optional<Events> events_;
};

std::optional<Scene> read_or_explain(const std::filesystem::path& file) {
  try {
    return read_scene(file);
  } catch (const SceneError& error) {
    std::fprintf(stderr, "ilaw: %s: %s\n", file.c_str(), error.what());
  }
  return std::nullopt;
}

std::unique_ptr<Run> start_or_explain(Scene& scene, const RunOptions& options) {
  try {
    return std::make_unique<Run>(scene, options);
  } catch (const std::runtime_error& error) {
    std::fprintf(stderr, "ilaw: %s\n", error.what());
  }
  return nullptr;
}

int report(const Scene& scene, const Integrator& integrator, const RunRecord& record,
           const RunOptions& options) {
  const std::filesystem::path& folder = options.folder;
  if (!record.failure.empty()) {
    std::fprintf(stderr, "ilaw: %s: failed after step %lld, time %g: %s\n", scene.file.c_str(),
                 static_cast<long long>(integrator.steps()), integrator.time(), record.failure.c_str());
    return exit_failed;
  }
  if (record.interrupted) {
    std::fprintf(
        stderr, "ilaw: %s: interrupted at step %lld of %lld; the files in %s are whole up to there%s\n",
        scene.file.c_str(), static_cast<long long>(integrator.steps()), static_cast<long long>(scene.steps),
        folder.c_str(), options.checkpoint_every > 0 ? ", and --resume goes on from there" : "");
    return exit_failed;
  }
  std::printf("%s: %lld steps to time %g in %.2g s, energy balance closed to %.1e%s; results in %s\n",
              scene.title.c_str(), static_cast<long long>(integrator.steps()), integrator.time(),
              record.seconds_total, integrator.energy().balance_error,
              scene.warnings.empty() && record.warnings.empty() ? "" : ", with warnings", folder.c_str());
  return exit_done;
}

int run(const RunOptions& options) {
  set_threads(options.threads);
  std::optional<Scene> scene = read_or_explain(options.scene);
  // What a run resumes from stands in its folder already.
  if (!scene || !(options.resume || make_folder(options.folder))) return exit_bad_input;
  return run_scene(*scene, options);
}

}  // namespace

int run_scene(Scene& scene, const RunOptions& options) {
  const Clock::time_point start = Clock::now();
  std::signal(SIGINT, request_stop);
  std::signal(SIGTERM, request_stop);
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is an error to report, not one to die of
  const std::unique_ptr<Run> run = start_or_explain(scene, options);
  if (!run) return exit_bad_input;
  const auto warn = [&](const std::vector<std::string>& warnings) {
    for (const std::string& warning : warnings)
      std::fprintf(stderr, "ilaw: %s: warning: %s\n", options.scene.c_str(), warning.c_str());
  };
  warn(scene.warnings);
  run->advance();
  run->finish(seconds_since(start));
  warn(run->record.warnings);
  return report(scene, run->integrator(), run->record, options);
}

void add_run(CLI::App& app, Action& chosen) {
  const auto options = std::make_shared<RunOptions>();
  const auto settings = std::make_shared<std::vector<std::string>>();
  CLI::App* command = app.add_subcommand("run", "Run a scene and write history.csv and summary.json");
  command->add_option("scene", options->scene, "Scene file (JSON)")->required();
  command->add_option("--out", options->folder, "Folder for the results, made if it does not exist")
      ->required();
  command
      ->add_option("--checkpoint-every", options->checkpoint_every,
                   "Steps between checkpoints, from which --resume goes on")
      ->check(CLI::Range(std::int64_t{1}, std::int64_t{1'000'000'000'000'000}));
  command->add_flag("--resume", options->resume, "Go on from the checkpoint in the folder, to the same bits");
  add_threads(*command, options->threads);
  command
      ->add_option("--set", *settings,
                   "/pointer=value,value,...: a run with each value of a key of the scene, --threads at a "
                   "time, and sweep.csv; may be repeated")
      ->excludes("--resume")
      ->expected(1)
      ->take_all();
  command->footer("Example: ilaw run plugins/contact/bouncing_ball.json --out results");
  command->callback([=, &chosen] {
    chosen = [=] { return settings->empty() ? run(*options) : sweep(*options, *settings); };
  });
}

}  // namespace ilaw::host
