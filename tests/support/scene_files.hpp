// scene_files.hpp - the shipped scenes: those of the host, and those that stand beside the laws they show.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace scene_files {

// All of them, in the order of their names. ILAW_SOURCE is the root of the tree.
inline std::vector<std::filesystem::path> all() {
  const std::filesystem::path root = ILAW_SOURCE;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(root / "host_mock/scenes"))
    files.push_back(entry.path());
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root / "plugins"))
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  std::sort(files.begin(), files.end(),
            [](const auto& a, const auto& b) { return a.filename() < b.filename(); });
  return files;
}

// The one of a name, with its extension.
inline std::filesystem::path named(const std::string& name) {
  for (const std::filesystem::path& file : all())
    if (file.filename() == name) return file;
  throw std::runtime_error("no shipped scene is called " + name);
}

}  // namespace scene_files
