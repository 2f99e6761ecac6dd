// events.hpp - events.csv: every contact, release, rupture and healing of every node, whatever the
// rows and the watched nodes of the history.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/csv.hpp"
#include "base/files.hpp"
#include "scene/scene.hpp"
#include "step/integrator.hpp"

#include <filesystem>
#include <optional>
#include <vector>

namespace ilaw::host {

class Events {
 public:
  // By node_index, per interface: those whose status was not free after the last step.
  using Touching = std::vector<std::vector<int>>;

  // written: by an earlier run, which this one continues, and the nodes that touched at its end.
  Events(const Scene& scene, const std::filesystem::path& folder, const std::optional<FileMark>& written = {},
         const Touching& touching = {});

  // After every step.
  void add_step(const Integrator& integrator);

  FileMark flush() { return file_.flush(); }
  void commit() { file_.commit(); }
  void keep_rows() { file_.keep_lines(); }

  // Which nodes touch, for the checkpoint.
  const Touching& touching() const { return touching_; }

 private:
  void add_interface(std::size_t number, const Integrator& integrator);
  void add_row(double time, int node, const Interface& interface, const char* event, const double* impulse);

  const Scene& scene_;
  AtomicFile file_;
  CsvWriter table_;
  Touching touching_, still_touching_;
};

}  // namespace ilaw::host
