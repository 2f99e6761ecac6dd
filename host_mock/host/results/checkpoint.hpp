// checkpoint.hpp - where a run stands, to go on from after it was killed, to the same bits.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/files.hpp"
#include "results/fields.hpp"
#include "scene/scene.hpp"
#include "step/integrator.hpp"

#include <filesystem>
#include <string>

namespace ilaw::host {

struct Checkpoint {
  FileMark history;                // what of history.csv belongs to it
  nlohmann::json fields;           // files written so far, and what is in them
  std::string history_state = {};  // what its next row depends on
  FileMark events = {};            // what of events.csv belongs to it
  std::string events_state = {};   // what the next events depend on
  nlohmann::json output = {};      // what the scene asked for, when it was written
};

// Makes folder/checkpoint.cbor, whole or not at all; the one before it stays as
// checkpoint.previous.cbor.
void write_checkpoint(const Scene& scene, const Integrator& integrator, const Checkpoint& checkpoint,
                      const std::filesystem::path& folder);

// Brings the integrator to where the checkpoint in folder stands: the newest of the two that is
// whole, as are the files that it goes on from. Throws std::runtime_error where there is none, or
// one of another law or scene; what the scene writes and when it ends may be other than they were.
// said: why the newest was left out, if it was.
Checkpoint read_checkpoint(const Scene& scene, Integrator& integrator, const std::filesystem::path& folder,
                           std::string& said);

// Removes the checkpoints of an earlier run, from which a new one cannot go on.
void clear_checkpoints(const std::filesystem::path& folder);

}  // namespace ilaw::host
