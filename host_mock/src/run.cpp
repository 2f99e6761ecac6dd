// SPDX-License-Identifier: BSD-3-Clause
#include "run.hpp"

#include "checkpoint.hpp"
#include "fields.hpp"
#include "output.hpp"
#include "progress.hpp"
#include "scene.hpp"
#include "validation.hpp"

#include <chrono>
#include <csignal>
#include <cstdio>
#include <exception>
#include <memory>
#include <optional>

namespace ilaw::host {
namespace {

using Clock = std::chrono::steady_clock;

// Ctrl-C and kill end a run at the end of its step, with whole files.
volatile std::sig_atomic_t stop_requested = 0;

void request_stop(int /*signal*/) { stop_requested = 1; }

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// A run and what it writes.
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
    if (scene_.output.fields > 0) fields_.write(integrator_);
  }

  // Steps to the end, to a request to stop, or to a failure; the record says which.
  void advance() {
    Progress progress(integrator_.steps(), scene_.steps);
    try {
      while (integrator_.steps() < scene_.steps && !stop_requested) {
        integrator_.step();
        write_outputs();
        progress.show(integrator_.steps());
      }
    } catch (const std::exception& failure) {
      record.failure = failure.what();
    }
    record.interrupted = integrator_.steps() < scene_.steps && record.failure.empty();
    if (record.interrupted && options_.checkpoint_every > 0) write_checkpoint_now();
    history_->commit();
  }

  const Integrator& integrator() const { return integrator_; }
  RunRecord record;

 private:
  void resume() {
    const Checkpoint checkpoint = read_checkpoint(scene_, integrator_, options_.folder);
    history_ = std::make_unique<History>(scene_, integrator_, options_.folder, checkpoint.history_size);
    fields_.resume(checkpoint.fields);
    record.resumed_at = integrator_.steps();
  }

  void write_outputs() {
    const std::int64_t step = integrator_.steps();
    const bool row = step % scene_.output.every == 0;
    const bool field = scene_.output.fields > 0 && step % scene_.output.fields == 0;
    const bool checkpoint = options_.checkpoint_every > 0 && step % options_.checkpoint_every == 0;
    if (!row && !field && !checkpoint) return;
    const Clock::time_point start = Clock::now();
    if (row) history_->add_row(integrator_);
    if (field) fields_.write(integrator_);
    if (checkpoint) write_checkpoint_now();
    record.seconds_output += seconds_since(start);
  }

  void write_checkpoint_now() {
    write_checkpoint(scene_, integrator_, {history_->flush(), fields_.written()}, options_.folder);
  }

  Scene& scene_;
  const RunOptions& options_;
  Integrator integrator_;
  Fields fields_;
  std::unique_ptr<History> history_;
};

std::optional<Scene> read_or_explain(const std::filesystem::path& file) {
  try {
    return read_scene(file);
  } catch (const SceneError& error) {
    std::fprintf(stderr, "ilaw: %s: %s\n", file.c_str(), error.what());
  }
  return std::nullopt;
}

int report(const Scene& scene, const Integrator& integrator, const RunRecord& record,
           const RunOptions& options) {
  const std::filesystem::path& folder = options.folder;
  if (!record.failure.empty()) {
    std::fprintf(stderr, "ilaw: %s: failed at step %lld, time %g: %s\n", scene.file.c_str(),
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
  std::printf("%s: %lld steps to time %g in %.2g s, energy balance closed to %.1e; results in %s\n",
              scene.title.c_str(), static_cast<long long>(integrator.steps()), integrator.time(),
              record.seconds_total, integrator.energy().balance_error, folder.c_str());
  return exit_done;
}

}  // namespace

int run(const RunOptions& options) {
  const Clock::time_point start = Clock::now();
  std::optional<Scene> scene = read_or_explain(options.scene);
  if (!scene || !make_folder(options.folder)) return exit_bad_input;
  std::signal(SIGINT, request_stop);
  std::signal(SIGTERM, request_stop);
  try {
    Run run(*scene, options);
    run.advance();
    run.record.seconds_total = seconds_since(start);
    write_summary(*scene, run.integrator(), run.record, options.folder);
    return report(*scene, run.integrator(), run.record, options);
  } catch (const std::exception& failure) {
    std::fprintf(stderr, "ilaw: %s: %s\n", options.scene.c_str(), failure.what());
    return exit_failed;
  }
}

}  // namespace ilaw::host
