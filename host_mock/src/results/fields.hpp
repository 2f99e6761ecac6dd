// fields.hpp - the state of all nodes as VTK files, with an index in time that ParaView opens
// (fields.vtu.series).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "scene/scene.hpp"
#include "step/integrator.hpp"

#include <nlohmann/json.hpp>

#include <filesystem>

namespace ilaw::host {

class Fields {
 public:
  Fields(const Scene& scene, std::filesystem::path folder) : scene_(scene), folder_(std::move(folder)) {}

  // Writes one file: u, v, r per node, and per interface gap, status and state variables (vectors
  // in the node's local frame, normal first). A node that an interface does not have gets gap NaN
  // and status -1. With several interfaces, arrays are called <interface>.gap and so on.
  void write(const Integrator& integrator);

  // Removes those of an earlier run in the folder, which this one would not replace.
  void clear() const;

  // The files so far, with their times and what is in them: to go on after a checkpoint.
  const nlohmann::json& written() const { return written_; }
  void resume(nlohmann::json written) {
    written_ = std::move(written);
    if (!written_.empty()) write_series();
  }

 private:
  void write_series() const;

  const Scene& scene_;
  std::filesystem::path folder_;
  nlohmann::json written_ = nlohmann::json::array();
};

}  // namespace ilaw::host
