// SPDX-License-Identifier: BSD-3-Clause
#include "run.hpp"

#include "output.hpp"
#include "progress.hpp"
#include "scene.hpp"
#include "validation.hpp"

#include <chrono>
#include <csignal>
#include <cstdio>
#include <exception>
#include <optional>
#include <system_error>

namespace ilaw::host {
namespace {

using Clock = std::chrono::steady_clock;

// Ctrl-C and kill end a run at the end of its step, with whole files.
volatile std::sig_atomic_t stop_requested = 0;

void request_stop(int /*signal*/) { stop_requested = 1; }

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Steps to the end, to a request to stop, or to a failure; the record says which.
void advance(const Scene& scene, Integrator& integrator, History& history, RunRecord& record) {
  Progress progress(scene.steps);
  try {
    while (integrator.steps() < scene.steps && !stop_requested) {
      integrator.step();
      if (integrator.steps() % scene.output.every == 0) {
        const Clock::time_point start = Clock::now();
        history.add_row(integrator);
        record.seconds_output += seconds_since(start);
      }
      progress.show(integrator.steps());
    }
  } catch (const std::exception& failure) {
    record.failure = failure.what();
  }
  record.interrupted = integrator.steps() < scene.steps && record.failure.empty();
}

std::optional<Scene> read_or_explain(const std::filesystem::path& file) {
  try {
    return read_scene(file);
  } catch (const SceneError& error) {
    std::fprintf(stderr, "ilaw: %s: %s\n", file.c_str(), error.what());
  }
  return std::nullopt;
}

bool make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (std::filesystem::is_directory(folder)) return true;
  std::fprintf(stderr, "ilaw: --out %s: found a file or a place that cannot be written, expected a folder\n",
               folder.c_str());
  return false;
}

int report(const Scene& scene, const Integrator& integrator, const RunRecord& record,
           const std::filesystem::path& folder) {
  if (!record.failure.empty()) {
    std::fprintf(stderr, "ilaw: %s: failed at step %lld, time %g: %s\n", scene.file.c_str(),
                 static_cast<long long>(integrator.steps()), integrator.time(), record.failure.c_str());
    return exit_failed;
  }
  if (record.interrupted) {
    std::fprintf(stderr,
                 "ilaw: %s: interrupted at step %lld of %lld; the files in %s are whole up to there\n",
                 scene.file.c_str(), static_cast<long long>(integrator.steps()),
                 static_cast<long long>(scene.steps), folder.c_str());
    return exit_failed;
  }
  std::printf("%s: %lld steps to time %g in %.2g s, energy balance closed to %.1e; results in %s\n",
              scene.title.c_str(), static_cast<long long>(integrator.steps()), integrator.time(),
              record.seconds_total, integrator.energy().balance_error, folder.c_str());
  return exit_done;
}

}  // namespace

int run(const std::filesystem::path& scene_file, const std::filesystem::path& folder) {
  const Clock::time_point start = Clock::now();
  std::optional<Scene> scene = read_or_explain(scene_file);
  if (!scene || !make_folder(folder)) return exit_bad_input;
  std::signal(SIGINT, request_stop);
  std::signal(SIGTERM, request_stop);
  try {
    Integrator integrator(*scene->model, scene->loads, scene->interfaces, scene->dt);
    History history(*scene, folder);
    RunRecord record;
    advance(*scene, integrator, history, record);
    history.commit();
    record.seconds_total = seconds_since(start);
    write_summary(*scene, integrator, record, folder);
    return report(*scene, integrator, record, folder);
  } catch (const std::exception& failure) {
    std::fprintf(stderr, "ilaw: %s: %s\n", scene_file.c_str(), failure.what());
    return exit_failed;
  }
}

}  // namespace ilaw::host
