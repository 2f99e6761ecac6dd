// mesh_file.hpp - a mesh from a file of VTK: nodes, cells, and arrays of integers that name sets.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "model/mesh_data.hpp"

#include <filesystem>

namespace ilaw::host {

// Reads a .vtu or a legacy .vtk file and checks it: all indices are in range, all cells have a type that
// MeshData knows. VTK's readers crash on some damaged files, so they run in a process of their own. Throws
// MeshError.
MeshData read_mesh_file(const std::filesystem::path& file);

}  // namespace ilaw::host
