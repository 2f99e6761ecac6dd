// stress.hpp - many random scenes, and what came of them, law by law.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "stress/invariants.hpp"
#include "stress/random_scene.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace ilaw::host {

struct StressSetup {
  std::vector<std::string> laws;  // names of their libraries; empty: all on the search path
  std::uint64_t seed = 1;         // of the first scene; the others follow
  std::int64_t scenes = 100;
  StressSize size;
  std::filesystem::path keep;   // where failures are written, made smaller; empty: nowhere
  std::filesystem::path write;  // where every scene is written before it is run; empty: nowhere
};

// The results of one law, that of the first interface.
struct StressRow {
  std::string law;
  std::int64_t scenes = 0, refused = 0, stopped = 0, failed = 0;
  std::int64_t made = 0, unsolved = 0;  // coupled contacts made from their solution
  StressFigures worst;                  // sums of steps, largest of the others
};

// A scene that did not come to its end, or not as it must.
struct StressFinding {
  std::uint64_t seed;
  std::string law, reason;
  std::filesystem::path file;  // empty: not kept
};

struct StressReport {
  std::vector<StressRow> rows;
  std::vector<StressFinding> failures, stops;
};

// The laws take turns: each has a random scene, and coupled contacts made from their solution. progress is
// told the number of scenes done. Throws ilaw::error where a library cannot be opened, std::runtime_error
// where a scene cannot be written.
StressReport stress(const StressSetup& setup, const std::function<void(std::int64_t)>& progress);

// Solves the coupled contacts of a seed, made from their solution, and holds what is called solved to the
// law, to momentum and to its work. Returns what is wrong, or nothing. A law that cannot have such contacts
// has none.
std::optional<std::string> stress_coupled(const LawBook::Entry& law, std::uint64_t seed, StressRow& row);

}  // namespace ilaw::host
