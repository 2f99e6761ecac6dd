// random_scene.hpp - scenes that nobody would think of: any model, loads, obstacles and laws.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/loader.hpp>

#include <nlohmann/json.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace ilaw::host {

// Laws of all libraries on the search path, or of the named libraries.
class LawBook {
 public:
  // Throws ilaw::error where a library cannot be opened.
  explicit LawBook(const std::vector<std::string>& names);

  struct Entry {
    const ilaw::library* library;
    const ilaw_law* law;
  };
  // The laws that serve a dimension.
  std::vector<Entry> serving(int dimension) const;
  const std::vector<Entry>& all() const { return all_; }

 private:
  std::vector<ilaw::library> libraries_;
  std::vector<Entry> all_;
};

struct StressSize {
  std::int64_t steps = 10'000;  // the most of a scene, which may have down to a tenth
  int nodes = 20;               // the most points of a scene
  bool is_plain = false;        // one body, obstacles that do not turn, and nothing follows a path
};

// The scene of a seed, as JSON. The law is one of the book's; other laws may be in it, too. It may be
// refused, with the reason, by the model or by the laws.
nlohmann::json random_scene(const LawBook& laws, const LawBook::Entry& law, std::uint64_t seed,
                            const StressSize& size);

}  // namespace ilaw::host
