// points_file.hpp - the points of a scene as a table: as JSON, a million of them take 600 MB.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "model/points.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace ilaw::host {

// Columns: mass, area, x0 ..., v0 ...; throws SceneError at the pointer.
std::vector<PointMass> read_points_file(const std::filesystem::path& file, int dimension,
                                        const std::string& pointer);

}  // namespace ilaw::host
