// `ilaw run`: a scene from JSON to results.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/commands.hpp"

#include "audit/audit.hpp"
#include "base/clock.hpp"
#include "base/exit_code.hpp"
#include "base/files.hpp"
#include "base/large_pages.hpp"
#include "base/stop_request.hpp"
#include "base/words.hpp"
#include "check/progress.hpp"
#include "cli/guard.hpp"
#include "cli/python.hpp"
#include "cli/terminal.hpp"
#include "model/elements.hpp"
#include "results/checkpoint.hpp"
#include "results/events.hpp"
#include "results/expectations.hpp"
#include "results/fields.hpp"
#include "results/history.hpp"
#include "results/state_hash.hpp"
#include "results/summary.hpp"
#include "scene/read_meshes.hpp"
#include "scene/scene.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <optional>
#include <regex>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace ilaw::host {
namespace {

struct RunOptions {
  std::filesystem::path scene, folder, text;  // text: a file to read instead; empty: none
  std::int64_t checkpoint_every = 0;          // steps; 0: never
  bool resume = false;
  int threads = 1;
  std::optional<double> tolerance = {};  // of coupled contacts
  check::ProgressForm progress = check::ProgressForm::line;
  bool audits = false;                // each step (audit/audit.hpp)
  std::vector<std::string> settings;  // of --set, which ilaw.sweep reads
};

double seconds_since(double start) { return clock_seconds(CLOCK_MONOTONIC) - start; }

// Names of the files that are never continued.
constexpr const char* written_at_once =
    "(checkpoint\\.cbor|summary\\.json|(fields|obstacles)(_[0-9]{6,}\\.vtu|\\.vtu\\.series)|diverged\\.vtu)";

// A run and what it writes. The constructor throws WriteError where nothing can be written, and
// other std::runtime_error where there is nothing to resume from, or nothing gives a value that is expected:
// the folder is left as it was.
class Run {
 public:
  Run(Scene& scene, const RunOptions& options)
      : scene_(scene),
        options_(options),
        integrator_(*scene.model, scene.loads, scene.interfaces, scene.dt, scene.prestress),
        fields_(scene, options.folder),
        history_(scene, integrator_) {
    for (const auto& interface : scene.interfaces)
      interface->ask_energies(scene.output.energy != "interface_work");
    if (options.audits) audit_.emplace(scene, integrator_);
    if (options.tolerance) integrator_.set_tolerance(*options.tolerance);
    if (!expected().empty()) check_expectations(expected(), summary(), history_.names());
    // The folder of a run to resume is there already.
    if (!options.resume || std::filesystem::is_directory(options.folder))
      held_.emplace(options.folder, "summary.json");
    options.resume ? resume() : begin();
  }

  // Steps to the end, to a request to stop, or to a failure; the record says which.
  void advance() {
    try {
      if (!options_.resume) start();
      check::Progress progress("run", "steps", static_cast<double>(scene_.steps), options_.progress);
      progress.begin_at(static_cast<double>(integrator_.steps()));
      const double start_of_steps = clock_seconds(CLOCK_PROCESS_CPUTIME_ID);
      while (integrator_.steps() < scene_.steps && !stop_requested()) {
        audited([this] { integrator_.step(); });
        tell_of_stable_step();
        history_.add_step();
        if (events_) events_->add_step(integrator_);
        write_outputs();
        progress.add(1.0);
      }
      record.seconds_steps = clock_seconds(CLOCK_PROCESS_CPUTIME_ID) - start_of_steps;
      record.interrupted = integrator_.steps() < scene_.steps;
      check_results();
      // Also at the end, to go on to a later one.
      if (options_.checkpoint_every > 0 && !has_checkpoint()) write_checkpoint_now();
      history_.commit();
      if (events_) events_->commit();
    } catch (const Interrupted&) {
      record.interrupted = true;
      keep_rows();
    } catch (const Diverged& failure) {
      keep_what_there_is(failure.what());
      keep_diverged_state();
    } catch (const std::exception& failure) {
      keep_what_there_is(message_of(failure));
    }
  }

  // Where that fails, and nothing did before, the run did.
  void finish(double seconds_total) {
    record.seconds_total = seconds_total;
    integrator_.take_back_step();
    record.warnings = integrator_.warnings();
    warn_of_penetration();
    try {
      nlohmann::json all = summary();
      if (record.failure.empty() && !record.interrupted && !expected().empty())
        judged = all["expectations"] = judge_expectations(expected(), all, options_.folder);
      write_summary(all, options_.folder);
    } catch (const std::exception& failure) {
      if (record.failure.empty()) record.failure = message_of(failure);
    }
  }

  const Integrator& integrator() const { return integrator_; }
  bool has_checkpoint() const { return checkpoint_step_ == integrator_.steps(); }
  RunRecord record;
  nlohmann::json judged = nlohmann::json::array();  // expectations, of a whole run

 private:
  nlohmann::json expected() const { return scene_.source.value("expect", nlohmann::json::array()); }

  nlohmann::json summary() {
    record.forces = history_.forces().summary();
    return summary_of(scene_, integrator_, record);
  }

  void begin() {
    clear();
    history_.open(options_.folder);
    if (scene_.output.events) events_.emplace(scene_, options_.folder);
  }

  // Removes the files of an earlier run, or what is left of them, whose whole names match.
  void remove_files(const std::string& names) const {
    const std::regex own(names);
    std::vector<std::filesystem::path> earlier;
    for (const auto& entry : std::filesystem::directory_iterator(options_.folder))
      if (std::regex_match(entry.path().filename().string(), own)) earlier.push_back(entry.path());
    for (const std::filesystem::path& file : earlier) std::filesystem::remove(file);
  }

  // Results that an earlier run left in the folder, and pictures of them, would be taken for this one's.
  void clear() const {
    clear_checkpoint(options_.folder);  // before the files that it speaks of
    remove_files("(" + std::string(written_at_once) +
                 "|view\\.html|(history|history\\.until_step_[0-9]+|events)\\.csv)(\\.partial)?");
    remove_pictures(options_.folder);
  }

  void resume() {
    const Checkpoint checkpoint = read_checkpoint(
        scene_, integrator_, options_.folder,
        [this](const Checkpoint& found) { history_.load(found.history_state, integrator_.steps()); });
    remove_files(std::string(written_at_once) + "\\.partial");  // those that a killed run was writing
    fields_.resume(checkpoint.fields);
    record.resumed_at = checkpoint_step_ = integrator_.steps();
    const bool goes_on = history_.continues(checkpoint.history_state);
    resume_history(checkpoint, goes_on);
    resume_events(checkpoint);
    if (!goes_on) write_checkpoint_now();  // the one before it goes on from rows with other columns
  }

  // With other columns a history of its own begins, beside the one that there is. Its sums go on.
  void resume_history(const Checkpoint& checkpoint, bool goes_on) {
    const std::filesystem::path file = options_.folder / "history.csv";
    if (goes_on) {
      history_.open(options_.folder, checkpoint.history);
    } else {
      AtomicFile(file, checkpoint.history).commit();
      std::filesystem::rename(
          file, options_.folder / ("history.until_step_" + std::to_string(integrator_.steps()) + ".csv"));
      history_.open(options_.folder);
    }
    for (const std::string& late : history_.late_sums()) scene_.warnings.push_back(late);
  }

  // Events written before the resume are kept.
  void resume_events(const Checkpoint& checkpoint) {
    const bool had_events = checkpoint.events.size > 0;
    if (had_events && scene_.output.events)
      events_.emplace(scene_, options_.folder, checkpoint.events, checkpoint.touching);
    else if (had_events)
      AtomicFile(options_.folder / "events.csv", checkpoint.events).commit();
    else if (scene_.output.events)
      events_.emplace(scene_, options_.folder);
  }

  void start() {
    if (scene_.prestress) find_equilibrium();
    audited([this] { integrator_.start(); });
    if (const auto& found = integrator_.prestressed())
      std::printf("prestress: static equilibrium after %lld steps, residual %.2g\n",
                  static_cast<long long>(found->steps), found->residual);
    history_.add_start();
    if (events_) events_->add_step(integrator_);
    if (scene_.output.fields > 0) fields_.write(integrator_);
  }

  // The logarithm of the residual falls in about a straight line, from which follows how many steps there
  // are.
  void find_equilibrium() {
    const double most = scene_.prestress->ramp / scene_.dt + static_cast<double>(scene_.prestress->steps);
    check::Progress progress("prestress", "steps", most, options_.progress);
    double first = 0.0, steps = 0.0;
    integrator_.find_equilibrium([&](const PrestressReport& found) {
      if (first == 0.0) first = found.residual;
      steps = static_cast<double>(found.steps);
      const double all = std::log(first / scene_.prestress->tolerance),
                   done = std::log(first / found.residual);
      progress.set(steps, done > 0.0 && all > 0.0 ? std::min(steps * all / done, most) : most);
    });
    progress.set(steps, steps);
  }

  template <class Step>
  void audited(Step step) {
    if (audit_) audit_->open();
    step();
    if (audit_) audit_->close();
  }

  // At once, for the run may take long; the summary has it, too.
  void tell_of_stable_step() {
    if (!record.told.empty()) return;
    record.told = integrator_.step_warning();
    if (!record.told.empty())
      complain(scene_.file.string() + ": warning: step " + std::to_string(integrator_.steps()) + ": " +
               record.told);
  }

  void keep_what_there_is(const std::string& failure) {
    record.failure = failure;
    keep_rows();
  }

  void keep_rows() {
    history_.keep_rows();
    if (events_) events_->keep_rows();
  }

  void keep_diverged_state() {
    try {
      record.failure += "; that state is in " + fields_.write_diverged(integrator_).string();
    } catch (const std::exception& failure) {
      record.failure += std::string("; that state could not be written: ") + failure.what();
    }
  }

  void warn_of_penetration() {
    constexpr double max_penetration_fraction = 0.05;
    const double depth = integrator_.tally().penetration_max, part = depth / shortest_edge(*scene_.model);
    if (!(part > max_penetration_fraction)) return;
    record.warnings.push_back(
        formatted("nodes penetrate by up to %.2g, %.3g %% of the shortest element edge: they start there, a "
                  "penalty is too soft, or the step is too large",
                  depth, 100.0 * part));
  }

  void write_outputs() {
    const std::int64_t step = integrator_.steps();
    const bool last = step == scene_.steps;
    const bool row = last || step % scene_.output.every == 0;
    const bool field = scene_.output.fields > 0 && (last || step % scene_.output.fields == 0);
    const bool checkpoint = options_.checkpoint_every > 0 && step % options_.checkpoint_every == 0;
    if (!row && !field && !checkpoint) return;
    const double start = clock_seconds(CLOCK_MONOTONIC);
    if (row || field) check_motion();
    if (row) history_.add_row();
    if (field) fields_.write(integrator_);
    if (checkpoint) write_checkpoint_now();
    record.seconds_output += seconds_since(start);
  }

  // Velocities are looked at in every step; what follows from them, where it is written.
  void check_motion() const {
    if (!integrator_.displacement().allFinite()) throw Diverged("a displacement is not finite");
  }
  void check_results() const {
    check_motion();
    const EnergyReport energy = integrator_.energy();
    for (const auto& [name, value] :
         {std::pair{"kinetic energy", energy.kinetic}, std::pair{"internal energy", energy.internal},
          std::pair{"external work", energy.external_work},
          std::pair{"work of the interfaces", energy.interface_work}})
      if (!std::isfinite(value)) throw Diverged("the " + std::string(name) + " is " + std::to_string(value));
    integrator_.check_energy();
  }

  void write_checkpoint_now() {
    write_checkpoint(
        scene_, integrator_,
        {history_.flush(), fields_.written(), history_.state(), events_ ? events_->flush() : FileMark{},
         events_ ? events_->touching() : Events::Touching{}},
        options_.folder);
    checkpoint_step_ = integrator_.steps();
  }

  std::optional<HeldFolder> held_;
  Scene& scene_;
  const RunOptions& options_;
  Integrator integrator_;
  std::optional<Audit> audit_;
  Fields fields_;
  std::int64_t checkpoint_step_ = -1;  // of the newest one
  History history_;
  std::optional<Events> events_;
};

std::unique_ptr<Run> start_or_explain(Scene& scene, const RunOptions& options) {
  try {
    return in_scene(scene.file, [&] { return std::make_unique<Run>(scene, options); });
  } catch (const WriteError&) {
    throw;
  } catch (const std::runtime_error& error) {
    complain(message_of(error));
  }
  return nullptr;
}

// Of the expectations of a scene; a missed one is a complaint with its reason.
int report_judged(const Scene& scene, const nlohmann::json& judged) {
  int code = exit_done;
  for (const nlohmann::json& one : judged) {
    const std::string line = describe_judged(one);
    if (one["within"]) {
      std::printf("  %s\n", printable(line).c_str());
      continue;
    }
    complain(scene.file.string() + ": missed: " + line + "; " + one["because"].get<std::string>());
    code = exit_missed;
  }
  return code;
}

// In words and as an exit code.
int report_run(const Scene& scene, const Run& run, const RunOptions& options) {
  const Integrator& integrator = run.integrator();
  const RunRecord& record = run.record;
  const std::filesystem::path& folder = options.folder;
  const std::string file = scene.file.string(), steps = std::to_string(integrator.steps());
  if (!record.failure.empty()) {
    complain(file + ": failed after step " + steps + ", time " + text_of("%g", integrator.time()) + ": " +
             record.failure);
    return exit_failed;
  }
  if (record.interrupted) {
    complain(file + ": interrupted at step " + steps + " of " + std::to_string(scene.steps) +
             "; the files in " + folder.string() + " are whole up to there" +
             (run.has_checkpoint() ? ", and --resume goes on from there" : ""));
    return exit_failed;
  }
  std::printf(
      "%s: %lld steps to time %g in %.2g s, energy balance closed to %.1e, state %s%s; results in %s\n",
      printable(scene.title).c_str(), static_cast<long long>(integrator.steps()), integrator.time(),
      record.seconds_total, integrator.energy().balance_error, state_hash(scene, integrator).c_str(),
      scene.warnings.empty() && record.warnings.empty() ? "" : ", with warnings", folder.c_str());
  return report_judged(scene, run.judged);
}

// Into options.folder, which it makes and holds; says on stderr what goes wrong.
int run_scene(Scene& scene, const RunOptions& options) {
  const double start = clock_seconds(CLOCK_MONOTONIC);
  catch_interrupts();
  const std::unique_ptr<Run> run = start_or_explain(scene, options);
  if (!run) return exit_bad_input;
  const auto warn = [&](const std::vector<std::string>& warnings) {
    for (const std::string& warning : warnings)
      if (warning != run->record.told) complain(options.scene.string() + ": warning: " + warning);
  };
  warn(scene.warnings);
  run->advance();
  run->finish(seconds_since(start));
  warn(run->record.warnings);
  return report_run(scene, *run, options);
}

int run(const RunOptions& options) {
  place_arrays_one_after_another();
  set_threads(options.threads);
  name_crashes();
  if (!options.text.empty()) stop_with_parent();  // part of a sweep
  warn_of_search_path();
  Scene scene = in_scene(options.scene, [&] {
    return read_scene(read_scene_source(options.text.empty() ? options.scene : options.text), options.scene);
  });
  for (const nlohmann::json& mesh : scene.meshes) std::printf("%s\n", printable(line_of_mesh(mesh)).c_str());
  std::fflush(stdout);        // before what goes to stderr
  name_crashes_of_threads();  // after reading: readers of meshes are processes, which threads must not start
  return run_scene(scene, options);
}

}  // namespace

void add_run(CLI::App& app, int& code) {
  const auto options = std::make_shared<RunOptions>();
  CLI::App* command = app.add_subcommand("run", "Run a scene and write history.csv and summary.json");
  command->add_option("scene", options->scene, "Scene file (JSON)")->required();
  command->add_option("--out", options->folder, "Folder for the results, made if it does not exist")
      ->required();
  command
      ->add_option("--checkpoint-every", options->checkpoint_every, "Steps between checkpoints for --resume")
      ->check(CLI::Range(std::int64_t{1}, std::int64_t{1'000'000'000'000'000}));
  command->add_flag("--resume", options->resume,
                    "Continue from the checkpoint in the folder, to the same bits");
  add_threads(*command, options->threads);
  check::add_progress(*command, options->progress);
  command->add_flag(
      "--audit", options->audits,
      "Judge each step by the laws alone, momentum, energy and gaps; fail at the first that is off");
  command
      ->add_option("--tolerance", options->tolerance,
                   "Residual to which contacts that share nodes are solved, relative to the largest velocity "
                   "of the step [1e-10]")
      ->check(CLI::Range(1e-15, 0.1))
      ->excludes("--resume");
  command
      ->add_option("--set", options->settings,
                   "/pointer=value,value,...: a run with each value of a key of the scene, --threads at a "
                   "time, and sweep.csv; may be repeated")
      ->excludes("--resume")
      ->expected(1)
      ->take_all();
  command
      ->add_option("--read-from", options->text,
                   "File to read instead; names in it and messages stay those of the scene file")
      ->excludes("--set");
  command->footer("Example: ilaw run plugins/contact/bouncing_ball.json --out results");
  command->callback([=, &code] {
    if (!options->settings.empty()) become_python(*command, {"ilaw.sweep", "numpy", "python3-numpy"});
    code = run(*options);
  });
}

}  // namespace ilaw::host
