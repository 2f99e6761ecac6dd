// SPDX-License-Identifier: BSD-3-Clause
#include "stress/stress.hpp"

#include "base/files.hpp"
#include "stress/shrink.hpp"

#include <algorithm>
#include <utility>

namespace ilaw::host {
namespace {

using nlohmann::json;

constexpr int most_tries = 400;  // to make a failure smaller
constexpr std::size_t most_kept = 20;

void add(StressRow& row, const StressVerdict& verdict) {
  ++row.scenes;
  row.refused += verdict.ending == StressEnding::refused ? 1 : 0;
  row.stopped += verdict.ending == StressEnding::stopped ? 1 : 0;
  row.failed += verdict.ending == StressEnding::failed ? 1 : 0;
  const StressFigures& figures = verdict.figures;
  row.worst.steps += figures.steps;
  row.worst.node_steps += figures.node_steps;
  row.worst.balance = std::max(row.worst.balance, figures.balance);
  row.worst.added = std::max(row.worst.added, figures.added);
  row.worst.penetration = std::max(row.worst.penetration, figures.penetration);
  row.worst.worst_bound = std::max(row.worst.worst_bound, figures.worst_bound);
}

std::filesystem::path write(const json& scene, const std::string& name, const std::filesystem::path& folder) {
  std::filesystem::path path = folder / (name + ".json");
  write_file(path, scene.dump(1) + "\n");
  return path;
}

// The same invariant must fail: another failure may be another mistake.
std::filesystem::path keep(const json& scene, const StressVerdict& verdict, const std::string& name,
                           const std::filesystem::path& folder) {
  StressVerdict last = verdict;
  const auto fails = [&](const json& smaller) {
    const StressVerdict found = stress_scene(smaller);
    if (found.ending != StressEnding::failed || found.invariant != verdict.invariant) return false;
    last = found;
    return true;
  };
  json small = shrink(scene, fails, most_tries);
  small["doc"] = last.reason;
  return write(small, name, folder);
}

}  // namespace

StressReport stress(const StressSetup& setup, const std::function<void(std::int64_t)>& progress) {
  const LawBook laws(setup.laws);
  StressReport report;
  for (const LawBook::Entry& entry : laws.all()) report.rows.push_back({.law = entry.law->id, .worst = {}});
  for (std::int64_t i = 0; i < setup.scenes && !laws.all().empty(); ++i) {
    const std::uint64_t seed = setup.seed + static_cast<std::uint64_t>(i);
    const std::size_t which = static_cast<std::size_t>(seed % laws.all().size());
    const json scene = random_scene(laws, laws.all()[which], seed, setup.size);
    const std::string name = report.rows[which].law + "_" + std::to_string(seed);
    if (!setup.write.empty()) write(scene, name, setup.write);
    const StressVerdict verdict = stress_scene(scene);
    add(report.rows[which], verdict);
    if (verdict.ending == StressEnding::stopped)
      report.stops.push_back({seed, report.rows[which].law, verdict.reason, {}});
    if (verdict.ending == StressEnding::failed) {
      StressFinding failure{seed, report.rows[which].law, verdict.reason, {}};
      if (!setup.keep.empty() && report.failures.size() < most_kept)
        failure.file = keep(scene, verdict, name, setup.keep);
      report.failures.push_back(std::move(failure));
    }
    if (const auto fault = stress_coupled(laws.all()[which], seed, report.rows[which])) {
      ++report.rows[which].failed;
      report.failures.push_back({seed, report.rows[which].law, *fault, {}});
    }
    progress(i + 1);
  }
  return report;
}

}  // namespace ilaw::host
