// faults.hpp - runs of the program whose files are looked at afterwards.
#pragma once

#include "host/program_runner.hpp"
#include "support/scene_files.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>

namespace ilaw::host::testing {

inline std::filesystem::path empty_folder() {
  static int number = 0;
  const auto folder = std::filesystem::temp_directory_path() /
                      ("ilaw_faults_" + std::to_string(getpid()) + "_" + std::to_string(number++));
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

// Everything in a folder, by name.
inline std::map<std::string, std::string> files_in(const std::filesystem::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    files[entry.path().filename().string()] = text_of(entry.path());
  return files;
}

inline std::filesystem::path written(const nlohmann::json& scene, const std::filesystem::path& folder) {
  std::ofstream(folder / "scene.json") << scene.dump();
  return folder / "scene.json";
}

inline nlohmann::json shipped_scene(const std::string& name) {
  return nlohmann::json::parse(text_of(scene_files::named(name + ".json")));
}

}  // namespace ilaw::host::testing
