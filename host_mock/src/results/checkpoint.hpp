// checkpoint.hpp - where a run stands, to go on from after it was killed, to the same bits.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "results/fields.hpp"
#include "scene/scene.hpp"
#include "step/integrator.hpp"

#include <filesystem>

namespace ilaw::host {

struct Checkpoint {
  std::uintmax_t history_size;     // bytes of history.csv that belong to it
  nlohmann::json fields;           // files written so far
  std::string history = {};        // what its next row depends on
  std::uintmax_t events_size = 0;  // bytes of events.csv that belong to it
  std::string events = {};         // what the next events depend on
};

// Replaces folder/checkpoint.cbor, whole or not at all.
void write_checkpoint(const Scene& scene, const Integrator& integrator, const Checkpoint& checkpoint,
                      const std::filesystem::path& folder);

// Brings the integrator to where the checkpoint in folder stands. Throws std::runtime_error where
// there is none, or one of another scene or law.
Checkpoint read_checkpoint(const Scene& scene, Integrator& integrator, const std::filesystem::path& folder);

}  // namespace ilaw::host
