// Bars with temperatures, as scenes.
#pragma once

#include "run_result.hpp"

#include <nlohmann/json.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

namespace ilaw::host::testing {

inline constexpr std::array step_fractions{1.0, 0.71, 0.43, 0.19};  // of the stable step

// Units in which a bar conducts a few times slower than it vibrates.
struct Bar {
  double length = 1.0, density = 1.0, specific_heat = 1.0, conductivity = 1.0, temperature = 300.0;
  int elements = 5;

  double size() const { return length / elements; }
  double diffusivity() const { return conductivity / (density * specific_heat); }
  double effusivity() const { return std::sqrt(conductivity * density * specific_heat); }
  // Gershgorin's bound for cubes: C/K_ii = 3/8 of the size squared over the diffusivity.
  double stable_step() const { return 0.375 * size() * size() / diffusivity(); }
};

// A column of cubes along z from its bottom on.
inline nlohmann::json column(const Bar& bar, const std::string& name, double bottom) {
  return {{"name", name},
          {"corner", {0, 0, bottom}},
          {"size", {bar.size(), bar.size(), bar.length}},
          {"elements", {1, 1, bar.elements}},
          {"material", {{"type", "linear"}, {"young", 1.0}, {"poisson", 0.0}, {"density", bar.density}}},
          {"thermal",
           {{"specific_heat", bar.specific_heat},
            {"conductivity", bar.conductivity},
            {"initial_temperature", bar.temperature}}}};
}

inline nlohmann::json scene_with(nlohmann::json blocks, double dt, double end) {
  return {{"model", {{"type", "blocks"}, {"blocks", std::move(blocks)}}},
          {"time", {{"dt", dt}, {"end", end}}},
          {"interfaces", nlohmann::json::array()}};
}

inline nlohmann::json held(const std::string& nodes, double temperature) {
  return {{"type", "temperature"}, {"nodes", nodes}, {"history", {{0, temperature}}}};
}

// Temperatures are at half steps.
inline double thermal_time(const Integrator& integrator, double dt) { return integrator.time() + 0.5 * dt; }

inline void run(Integrator& integrator, std::int64_t steps) {
  for (std::int64_t n = 0; n < steps; ++n) integrator.step();
}

// Two columns on each other, pressed together by 1e-3 and shortened by as much: in equilibrium.
inline nlohmann::json two_columns(const Bar& below, const Bar& above, double dt, double end,
                                  const nlohmann::json& interface) {
  nlohmann::json scene =
      scene_with({column(below, "below", 0), column(above, "above", below.length)}, dt, end);
  scene["initial"] = {{{"gradient", {{0, 0, 0}, {0, 0, 0}, {0, 0, -1e-3}}}}};
  scene["loads"] = {{{"type", "motion"}, {"nodes", "below.z_min"}},
                    {{"type", "pressure"}, {"surface", "above.z_max"}, {"history", {{0, 1e-3}}}}};
  scene["interfaces"] = {interface};
  scene["interfaces"][0]["nodes"] = "above.z_min";
  scene["interfaces"][0]["against"] = {{"surface", "below.z_max"}};
  return scene;
}

}  // namespace ilaw::host::testing
