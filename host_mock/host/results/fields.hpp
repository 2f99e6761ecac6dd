// fields.hpp - the state of all nodes as VTK files, with an index in time that ParaView opens
// (fields.vtu.series).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "scene/scene.hpp"
#include "step/integrator.hpp"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>

class vtkUnstructuredGrid;

namespace ilaw::host {

class Fields {
 public:
  Fields(const Scene& scene, std::filesystem::path folder) : scene_(scene), folder_(std::move(folder)) {}

  // Writes one file: u, v, r per node, stress per cell, and per interface gap, status, traction and
  // state variables (vectors in the node's local frame, normal first). A node that an interface does
  // not have gets status -1 and NaN elsewhere. With several interfaces, arrays are called
  // <interface>.gap and so on. Obstacles are a file of their own, one for all times if none moves.
  void write(const Integrator& integrator);

  // Writes diverged.vtu, the bodies alone: u, v, stress, and which elements are turned inside out.
  std::filesystem::path write_diverged(const Integrator& integrator) const;

  // The files so far, with their times and what is in them: to go on after a checkpoint.
  const nlohmann::json& written() const { return written_; }
  void resume(nlohmann::json written) {
    written_ = std::move(written);
    if (!written_.empty()) write_series();
  }

 private:
  void add_body(vtkUnstructuredGrid& grid, const Integrator& integrator) const;
  void write_next(const std::string& kind, vtkUnstructuredGrid& grid, double time);
  nlohmann::json names_of(const std::string& kind) const;
  void write_series() const;

  const Scene& scene_;
  std::filesystem::path folder_;
  nlohmann::json written_ = nlohmann::json::array();
};

}  // namespace ilaw::host
