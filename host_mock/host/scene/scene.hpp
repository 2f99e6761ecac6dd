// scene.hpp - a scene read from JSON: everything checked, nothing run yet.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "contact/interface.hpp"
#include "model/load.hpp"
#include "model/model.hpp"
#include "model/springs.hpp"
#include "step/prestress.hpp"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace ilaw::host {

// A resultant that the history shows: of an interface, of loads, or of springs.
struct ForceSetup {
  std::string name;
  int interface = -1;              // -1: of loads or springs
  int other_side = -1;             // the interface of the same joint on the other body; -1: none
  std::vector<std::size_t> loads;  // by number
  std::vector<int> nodes;          // of the loads' nodes, those that count; empty: all
  std::vector<Spring> springs;     // on their own nodes; empty: of loads
  std::optional<Vector> about;     // the point that a moment is asked for about
};

struct OutputSetup {
  std::int64_t every = 1;  // steps per row of the history
  std::vector<int> watch;  // nodes
  bool balance = false;    // energies and angular momentum in the history
  std::string energy;      // the one that the history shows without the others
  bool contact = false;    // pressure, slip and wear of watched nodes in the history
  bool events = false;     // events.csv
  std::vector<ForceSetup> forces;
  std::int64_t fields = 0;  // steps per VTK file; 0: none
};

struct Scene {
  std::filesystem::path file;
  std::string title;
  nlohmann::json source;
  std::unique_ptr<Model> model;
  nlohmann::json meshes = nlohmann::json::array();  // what was read of files
  Loads loads;
  Interfaces interfaces;
  double dt = 0.0;
  std::int64_t steps = 0;
  std::optional<PrestressSetup> prestress;
  OutputSetup output;
  std::vector<std::string> warnings;  // of what can run, but can hardly be meant

  // Before 0 with a prestress: its ramp.
  double start_time() const { return prestress ? -prestress->ramp : 0.0; }
};

// Reads and checks a scene, loads its laws. Throws SceneError, whose message starts with the JSON
// pointer.
Scene read_scene(const std::filesystem::path& file);

// The same from parsed JSON; file: where relative library paths start from.
nlohmann::json read_scene_source(const std::filesystem::path& file);
Scene read_scene(nlohmann::json source, const std::filesystem::path& file);

}  // namespace ilaw::host
