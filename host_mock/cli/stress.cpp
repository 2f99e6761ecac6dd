// `ilaw stress`: random scenes, held to what every scene must fulfil.
// SPDX-License-Identifier: BSD-3-Clause
#include "stress/stress.hpp"

#include "base/exit_code.hpp"
#include "base/files.hpp"
#include "check/progress.hpp"
#include "cli/commands.hpp"
#include "cli/guard.hpp"
#include "cli/terminal.hpp"

#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace ilaw::host {
namespace {

void print_table(const StressReport& report) {
  std::vector<Row> rows = {{"law", "scenes", "refused", "stopped", "failed", "steps", "node-steps", "balance",
                            "added", "penetration", "of bound", "coupled", "unsolved"}};
  const auto count = [](std::int64_t n) { return std::to_string(n); };
  for (const StressRow& row : report.rows)
    rows.push_back({row.law, count(row.scenes), count(row.refused), count(row.stopped), count(row.failed),
                    text_of("%.2g", static_cast<double>(row.worst.steps)),
                    text_of("%.2g", static_cast<double>(row.worst.node_steps)),
                    text_of("%.1e", row.worst.balance), text_of("%.1e", row.worst.added),
                    text_of("%.2f", row.worst.penetration), text_of("%.2f", row.worst.worst_bound),
                    count(row.made), count(row.unsolved)});
  print_rows(rows, "");
}

void print_finding(const char* ending, const StressFinding& finding) {
  std::printf("seed %llu (%s) %s: %s%s%s\n", static_cast<unsigned long long>(finding.seed),
              finding.law.c_str(), ending, finding.reason.c_str(), finding.file.empty() ? "" : "; ",
              finding.file.c_str());
}

int run_stress(const StressSetup& setup, check::ProgressForm form) {
  std::optional<HeldFolder> kept, written;
  if (!setup.keep.empty()) kept.emplace(setup.keep);
  if (!setup.write.empty()) written.emplace(setup.write);
  name_crashes();
  const StressReport report = [&] {
    check::Progress progress("stress", "scenes", static_cast<double>(setup.scenes), form);
    return stress(setup, [&](std::int64_t) { progress.add(1.0); });
  }();
  if (report.rows.empty()) throw InputError("found no law on the search path, " + ilaw::search_path());
  print_table(report);
  for (const StressFinding& stop : report.stops) print_finding("stopped", stop);
  for (const StressFinding& failure : report.failures) print_finding("failed", failure);
  return report.failures.empty() ? exit_done : exit_failed;
}

}  // namespace

void add_stress(CLI::App& app, int& code) {
  const auto setup = std::make_shared<StressSetup>();
  const auto form = std::make_shared<check::ProgressForm>(check::ProgressForm::line);
  CLI::App* command = app.add_subcommand(
      "stress", "Run random scenes of all laws and hold them to rules on energy, penetration and bits");
  command->add_option("--law", setup->laws,
                      "Only the laws of this library, a name or a path; may be repeated (all)");
  command->add_option("--seed", setup->seed, "Seed of the first scene; the next scene has the next number")
      ->capture_default_str();
  command->add_option("--scenes", setup->scenes, "Number of scenes; the laws take turns")
      ->check(CLI::Range(std::int64_t{1}, std::int64_t{1'000'000'000}))
      ->capture_default_str();
  command->add_option("--steps", setup->size.steps, "Most steps of a scene; the least are a tenth")
      ->check(CLI::Range(std::int64_t{10}, std::int64_t{1'000'000'000}))
      ->capture_default_str();
  command->add_option("--nodes", setup->size.nodes, "Most points of a scene")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  command->add_flag("--plain", setup->size.is_plain, "One body, obstacles that do not turn, no paths");
  command->add_option("--keep", setup->keep,
                      "Folder for scenes that failed, each reduced while it still fails");
  command->add_option("--write", setup->write, "Folder for every scene, as it is run; not that of --keep");
  check::add_progress(*command, *form);
  command->footer(
      "coupled: contacts of several bodies made from a solution, which is known to exist; unsolved of them.\n"
      "Exit codes: 0 all scenes kept the rules, were refused, or stopped with a reason; 1 a scene broke one;\n"
      "2 bad usage, or a library that cannot be opened.\n"
      "Example: ilaw stress --law build/my_law.so --scenes 200 --keep failures");
  command->callback([setup, form, &code] { code = run_stress(*setup, *form); });
}

}  // namespace ilaw::host
