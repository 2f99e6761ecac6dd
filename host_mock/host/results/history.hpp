// history.hpp - history.csv: what the watched nodes do, as time goes on.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/csv.hpp"
#include "base/files.hpp"
#include "results/forces.hpp"
#include "scene/scene.hpp"
#include "step/integrator.hpp"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace ilaw::host {

// history.csv: a row per output instant, columns as in docs/scenes.md. Vectors are in the scene's
// axes.
class History {
 public:
  History(const Scene& scene, Integrator& integrator);
  // Before the first row. written: by an earlier run, which this one continues.
  void open(const std::filesystem::path& folder, const std::optional<FileMark>& written = {});
  // After the start, before any step.
  void add_start();
  // After every step, before its row.
  void add_step();
  void add_row();
  FileMark flush() { return file_->flush(); }
  void commit() { file_->commit(); }
  void keep_rows() { file_->keep_lines(); }

  std::vector<std::string> names() const;  // of the columns
  const Forces& forces() const { return forces_; }
  // The state beside the integrator on which the next row depends, by name: a resumed run may have other
  // columns.
  nlohmann::json state() const;
  void load(const nlohmann::json& state, std::int64_t step);
  // Whether the run that left the state had the same columns.
  bool continues(const nlohmann::json& state) const { return state.at("columns") == layout(); }
  // Warnings of sums that do not begin at the start of the run.
  const std::vector<std::string>& late_sums() const { return late_sums_; }

 private:
  // A watched node in one interface.
  struct Contact {
    const Interface* interface;
    int node_index;
    std::string prefix;           // "n0." or, where the node has several, "n0.<interface>."
    std::vector<double> state{};  // in the last row
    Interface::Rubbing last{};
    double slip = 0.0, wear = 0.0;  // since the start
  };
  struct Column {
    std::string name;
    std::function<double()> value;
  };
  // visit(contact, contact_index), of those whose status is not free, where they are to be told.
  template <class Visit>
  void for_each_acting(Visit visit);
  void find_contacts();
  void find_motions(Integrator& integrator);
  void describe_columns();
  void refresh();
  nlohmann::json layout() const { return {{"names", names()}, {"points", forces_.points()}}; }

  const Scene& scene_;
  const Integrator& integrator_;
  std::optional<AtomicFile> file_;
  std::optional<CsvWriter> table_;
  std::vector<std::vector<Contact>> contacts_;  // per watched node
  std::vector<bool> is_alone_;                  // per watched node: no interface acts on it
  std::vector<std::size_t> motions_;            // loads that drive a watched node
  std::vector<std::string> late_sums_;
  Forces forces_;
  std::vector<Column> columns_;
  // Of the last row.
  Dofs impulse_, held_;  // of interfaces, and of what drives nodes
  EnergyReport energy_{};
  Vector angular_momentum_;
  HeatReport heat_{};
};

}  // namespace ilaw::host
