// study_laws.hpp - the laws that a study compares: what a scene lists under "study", what the command
// line names instead, or a choice of its own.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>

namespace ilaw::host {

// An entry of study/laws from the command line: a law's name, NAME:{parameters}, or the entry itself.
// Throws SceneError.
nlohmann::json read_law_option(const std::string& text);

// Entries for a scene that lists none: its own law and, where that is contact, its activations and
// penalties.
nlohmann::json usual_laws(const nlohmann::json& source);

// The name of an entry in tables.
std::string name_of(const nlohmann::json& entry);

// The scene with the law of an entry at all its interfaces. An entry that names no law changes
// parameters of the scene's own. Scaled parameters are in units of the lightest interface node and of
// the body's critical step, or of unit_step for a model that has none. Throws SceneError.
nlohmann::json with_law(const nlohmann::json& source, const nlohmann::json& entry, double unit_step,
                        const std::filesystem::path& file);

}  // namespace ilaw::host
