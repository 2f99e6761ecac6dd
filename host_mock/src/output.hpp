// output.hpp - what a run leaves in its folder: history.csv and summary.json, each written whole or not at
// all.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "integrator.hpp"
#include "scene.hpp"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace ilaw::host {

// Makes the folder that --out names, if it does not exist, and tries whether files can be made in it; says on
// stderr why they cannot.
bool make_folder(const std::filesystem::path& folder);

// A file that appears under its name only when it is complete: written beside it, then renamed.
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path file);
  // Goes on after the first size bytes of what an earlier run left, complete or not.
  AtomicFile(std::filesystem::path file, std::uintmax_t size);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  std::ostream& stream() { return stream_; }
  // Bytes written so far, all of them in the file.
  std::uintmax_t flush();
  // Throws std::runtime_error when the disk did not take all so far, as far as is known.
  void check() const;
  // Throws std::runtime_error when the disk did not take it all.
  void commit();
  // Instead, where the file cannot be completed: the whole lines that the disk took get its name.
  void keep_lines();

 private:
  std::filesystem::path file_, partial_;
  std::ofstream stream_;
  bool committed_ = false;
};

// history.csv: a row per output instant, columns as in docs/scenes.md. Vectors are in the scene's axes.
class History {
 public:
  History(const Scene& scene, const Integrator& integrator, const std::filesystem::path& folder);
  // Goes on after the first size bytes of an earlier run's.
  History(const Scene& scene, const Integrator& integrator, const std::filesystem::path& folder,
          std::uintmax_t size);
  void add_row(const Integrator& integrator);
  std::uintmax_t flush() { return file_.flush(); }
  void commit() { file_.commit(); }
  void keep_rows() { file_.keep_lines(); }

 private:
  // A watched node in one interface.
  struct Contact {
    const Interface* interface;
    int place, slot;
    std::string prefix;  // "n0." or, where the node has several, "n0.<interface>."
  };
  void find_contacts(const Integrator& integrator);
  void write_header();
  void add_node(std::size_t watched, const Integrator& integrator, const Dofs& impulse);

  const Scene& scene_;
  AtomicFile file_;
  std::vector<std::vector<Contact>> contacts_;  // per watched node
};

struct RunRecord {
  std::int64_t resumed_at = 0;  // step
  bool interrupted = false;
  std::string failure;                // empty: none
  std::vector<std::string> warnings;  // of the integrator, at the end
  double seconds_total = 0.0, seconds_output = 0.0;
};

// summary.json.
void write_summary(const Scene& scene, const Integrator& integrator, const RunRecord& record,
                   const std::filesystem::path& folder);

}  // namespace ilaw::host
