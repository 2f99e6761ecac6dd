// output.hpp - what a run leaves in its folder: history.csv and summary.json, each written whole or not at
// all. SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "integrator.hpp"
#include "scene.hpp"

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace ilaw::host {

// A file that appears under its name only when it is complete: written beside it, then renamed.
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path file);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  std::ostream& stream() { return stream_; }
  // Throws std::runtime_error when the disk did not take it all.
  void commit();

 private:
  std::filesystem::path file_, partial_;
  std::ofstream stream_;
  bool committed_ = false;
};

// history.csv: a row per output instant, columns as in docs/scenes.md. Vectors are in the scene's axes.
class History {
 public:
  History(const Scene& scene, const std::filesystem::path& folder);
  void add_row(const Integrator& integrator);
  void commit() { file_.commit(); }

 private:
  // A watched node in one interface.
  struct Contact {
    const Interface* interface;
    int place;
    std::string prefix;  // "n0." or, where the node has several, "n0.<interface>."
  };
  void find_contacts();
  void write_header();

  const Scene& scene_;
  AtomicFile file_;
  std::vector<std::vector<Contact>> contacts_;  // per watched node
};

struct RunRecord {
  bool interrupted = false;
  std::string failure;  // empty: none
  double seconds_total = 0.0, seconds_output = 0.0;
};

// summary.json.
void write_summary(const Scene& scene, const Integrator& integrator, const RunRecord& record,
                   const std::filesystem::path& folder);

}  // namespace ilaw::host
