// host_runner.hpp - scenes, run in the test's own process or by the program. It brings JSON, files, strings,
// containers, random numbers and matchers.
#pragma once

#include "program_runner.hpp"
#include "scene_parts.hpp"
#include "support/matchers.hpp"
#include "support/order.hpp"
#include "support/random.hpp"
#include "support/scene_files.hpp"

#include "audit/audit.hpp"
#include "scene/scene.hpp"
#include "scene/validation.hpp"
#include "step/integrator.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace ilaw::host::testing {

using ilaw::testing::order;
using ilaw::testing::Random;

// Laws come from this build, here and in the programs that a test starts.
inline const int plugin_folder_is_set = setenv("ILAW_PATH", ILAW_PLUGIN_FOLDER, 1);

// Without the values that it expects, which belong to the scene as it is.
inline json shipped(const std::string& name) {
  json source = read_scene_source(scene_files::named(name + ".json"));
  source.erase("expect");
  return source;
}

inline Scene scene_of(const std::string& text) {
  const auto folder = fresh_folder();
  std::ofstream(folder / "scene.json") << text;
  Scene scene = read_scene(folder / "scene.json");
  fs::remove_all(folder);
  return scene;
}
inline Scene scene_of(const char* text) { return scene_of(std::string(text)); }
inline Scene scene_of(const json& source) { return scene_of(source.dump()); }
inline Scene scene_of(Scene scene) { return scene; }

// The host's, of which each step is judged by the laws alone, momentum, energy and gaps.
class Integrator : public host::Integrator {
 public:
  explicit Integrator(Scene& scene)
      : host::Integrator(*scene.model, scene.loads, scene.interfaces, scene.dt, scene.prestress),
        audit_(scene, *this) {}
  Integrator(const Integrator&) = delete;

  void start() {
    if (has_started()) return;
    find_equilibrium();
    audited([this] { host::Integrator::start(); });
  }
  void step() {
    start();
    audited([this] { host::Integrator::step(); });
  }

 private:
  template <class Step>
  void audited(Step step) {
    audit_.open();
    step();
    audit_.close();
  }
  Audit audit_;
};

inline Integrator integrator_of(Scene& scene) { return Integrator(scene); }
// For what an audit would refuse, such as contacts that are not solved, and what takes too long with one.
inline host::Integrator unaudited(Scene& scene) {
  return {*scene.model, scene.loads, scene.interfaces, scene.dt, scene.prestress};
}

inline void run_to_end(Integrator& integrator, const Scene& scene) {
  integrator.start();
  while (integrator.steps() < scene.steps) integrator.step();
}

// A scene and what moves it: auto [scene, integrator] = simulation_of(source). Stays where it is made, since
// the integrator refers to the scene.
struct Simulation {
  explicit Simulation(Scene read, bool ends = false)
      : scene(std::move(read)), integrator(integrator_of(scene)) {
    if (ends) run_to_end(integrator, scene);
  }
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  Scene scene;
  Integrator integrator;
};
template <class Source>
Simulation simulation_of(Source source) {
  return Simulation(scene_of(std::move(source)));
}
template <class Source>
Simulation run_to_end(Source source) {
  return Simulation(scene_of(std::move(source)), true);
}

// All digits of a number, for a scene.
inline std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

}  // namespace ilaw::host::testing
