// host_runner.hpp - scenes as text, run in the test's own process.
#pragma once

#include "support/scene_files.hpp"

#include "scene/scene.hpp"
#include "scene/validation.hpp"
#include "step/integrator.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace ilaw::host::testing {

inline std::filesystem::path fresh_folder() {
  static int number = 0;
  const auto folder = std::filesystem::temp_directory_path() /
                      ("ilaw_test_" + std::to_string(getpid()) + "_" + std::to_string(number++));
  std::filesystem::create_directories(folder);
  return folder;
}

inline Scene scene_of(const std::string& text) {
  const auto folder = fresh_folder();
  std::ofstream(folder / "scene.json") << text;
  setenv("ILAW_PATH", ILAW_PLUGIN_FOLDER, 1);
  Scene scene = read_scene(folder / "scene.json");
  std::filesystem::remove_all(folder);
  return scene;
}

// What a scene is refused with.
inline std::string refusal_of_text(const std::string& text) {
  try {
    scene_of(text);
  } catch (const SceneError& error) {
    return error.what();
  }
  return "not refused";
}
inline std::string refusal_of_scene(const nlohmann::json& scene) { return refusal_of_text(scene.dump()); }

inline Integrator integrator_of(Scene& scene) {
  return Integrator(*scene.model, scene.loads, scene.interfaces, scene.dt, scene.prestress);
}

// Of a number in a scene, all its digits.
inline std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

// Slope of log(error) over log(h) by least squares.
inline double order(const std::vector<double>& h, const std::vector<double>& error) {
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  const auto n = static_cast<double>(h.size());
  for (std::size_t k = 0; k < h.size(); ++k) {
    const double x = std::log(h[k]), y = std::log(error[k]);
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

}  // namespace ilaw::host::testing
