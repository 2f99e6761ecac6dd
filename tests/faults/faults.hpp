// faults.hpp - what attacks on the program share.
#pragma once

#include "host/program_runner.hpp"
#include "support/scene_files.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

namespace ilaw::host::testing {

inline json shipped(const std::string& name) {
  json scene = json::parse(text_of(scene_files::named(name + ".json")));
  scene.erase("expect");  // its values belong to the scene as it is
  return scene;
}

}  // namespace ilaw::host::testing
