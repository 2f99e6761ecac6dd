// scene_files.hpp - the shipped scenes: those of the host, and those that stand beside the laws they show.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace scene_files {

// Scenes below a folder of the tree, whose root is ILAW_SOURCE.
inline std::vector<std::filesystem::path> below(const char* folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(std::filesystem::path(ILAW_SOURCE) / folder))
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  return files;
}
inline std::vector<std::filesystem::path> of_host() { return below("host_mock/scenes"); }
inline std::vector<std::filesystem::path> of_laws() { return below("plugins"); }

// All of them, in the order of their names.
inline std::vector<std::filesystem::path> all() {
  std::vector<std::filesystem::path> files = of_host();
  for (const std::filesystem::path& file : of_laws()) files.push_back(file);
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
