// read_meshes.hpp - the bodies of a scene whose meshes are in files.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "model/solids.hpp"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace ilaw::host {

// The mesh at a pointer of a scene in that file. Throws SceneError.
MeshSetup read_mesh(const nlohmann::json& mesh, const std::string& pointer,
                    const std::filesystem::path& scene_file);

// Counts, quality, critical step and sets of a mesh, for the summary; and a line of it for a terminal.
nlohmann::json describe_mesh(const nlohmann::json& mesh, const MeshSetup& setup, double critical_step);
std::string line_of_mesh(const nlohmann::json& described);

// Sizes and checksums of the files of a model, by which a checkpoint knows its meshes and points.
nlohmann::json marks_of_files(const nlohmann::json& model, const std::filesystem::path& scene_file);

// Reads a .vtu file and checks it: all indices are in range, all cells have a type that MeshData knows. VTK's
// reader crashes on some damaged files, so it runs in a process of its own. A legacy .vtk file has no end
// that tells whether it is whole, so none is read. Throws MeshError.
MeshData read_mesh_file(const std::filesystem::path& file);

}  // namespace ilaw::host
