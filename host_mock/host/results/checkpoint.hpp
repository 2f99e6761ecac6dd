// checkpoint.hpp - where a run stands, to go on from after it was killed, to the same bits.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/files.hpp"
#include "results/events.hpp"
#include "scene/scene.hpp"
#include "step/integrator.hpp"

#include <filesystem>
#include <functional>
#include <vector>

namespace ilaw::host {

struct Checkpoint {
  FileMark history;                   // what of history.csv belongs to it
  nlohmann::json fields;              // files written so far, and what is in them
  nlohmann::json history_state = {};  // what its next row depends on
  FileMark events = {};               // what of events.csv belongs to it
  Events::Touching touching = {};     // what the next events depend on
};

// Replaces folder/checkpoint.cbor, whole or not at all.
void write_checkpoint(const Scene& scene, const Integrator& integrator, const Checkpoint& checkpoint,
                      const std::filesystem::path& folder);

// Brings the integrator to where the checkpoint in folder stands. Throws std::runtime_error if there is none,
// if it or a file that it goes on from is damaged, or if it is one of another law or scene; what the scene
// writes and when it ends may be other than they were. take: what else is to be read from it. No file
// changes.
Checkpoint read_checkpoint(const Scene& scene, Integrator& integrator, const std::filesystem::path& folder,
                           const std::function<void(const Checkpoint&)>& take);

// Removes that of an earlier run, from which a new one cannot go on.
void clear_checkpoint(const std::filesystem::path& folder);

}  // namespace ilaw::host
