// faults.hpp - runs of the program whose files are looked at afterwards.
#pragma once

#include "host/program_runner.hpp"
#include "support/scene_files.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>

namespace ilaw::host::testing {

// Everything in a folder, by name.
inline std::map<std::string, std::string> files_in(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::directory_iterator(folder))
    files[entry.path().filename().string()] = text_of(entry.path());
  return files;
}

inline json shipped(const std::string& name) {
  json scene = json::parse(text_of(scene_files::named(name + ".json")));
  scene.erase("expect");  // its values belong to the scene as it is
  return scene;
}

}  // namespace ilaw::host::testing
