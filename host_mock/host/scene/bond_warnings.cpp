// Bonds that nothing in the scene can break: a wrong unit, often. The drive of a scene is bounded above, by
// all loads and momenta together on the weakest node; the factor leaves room for waves. And bonds whose
// memory is too short for the step.
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/json_text.hpp"
#include "scene/warnings.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <string_view>

namespace ilaw::host {
namespace {

using nlohmann::json;

// Upper bounds of the loads of a scene: a force, and impulses besides.
struct Drive {
  double force = 0.0, impulse = 0.0;
};

// The times at which loads may be largest: histories are linear between their own.
std::set<double> knots_of(const Scene& scene) {
  std::set<double> times{0.0, static_cast<double>(scene.steps) * scene.dt};
  for (const json& load : scene.source.value("loads", json::array()))
    for (const json& row : load.value("history", json::array()))
      if (row.is_array()) times.insert(row[0].get<double>());
  return times;
}

double sum_of_sizes(const Dofs& values, Eigen::Index d) {
  double sum = 0.0;
  for (Eigen::Index i = 0; i < values.size(); i += d) sum += values.segment(i, d).norm();
  return sum;
}

// Prescribed motions, smooth tables and strains at the start may act with any force.
bool is_bounded(const Scene& scene) {
  const std::set<std::string> known{"gravity", "force", "shock", "damping", "motion"};
  for (const json& load : scene.source.value("loads", json::array()))
    if (!known.contains(load["type"].get<std::string>()) || load.contains("velocity") ||
        load.contains("path") || load.value("history", json()).is_object())
      return false;
  const std::set<std::string> still{"type", "point", "normal", "center", "radius", "axis"};
  for (const json& interface : scene.source["interfaces"]) {
    const json obstacle = interface.value("obstacle", json::object());
    for (const auto& [key, ignored] : obstacle.items())
      if (!still.contains(key)) return false;
  }
  if (scene.source.contains("springs")) return false;
  return scene.model->initial_displacement().isZero(0.0);
}

std::optional<Drive> drive_of(const Scene& scene) {
  if (!is_bounded(scene)) return {};
  const Eigen::Index d = scene.model->dimension();
  Drive drive;
  const Dofs none = Dofs::Zero(scene.model->mass().size());
  for (const auto& load : scene.loads) {
    double largest = 0.0;
    for (const double time : knots_of(scene)) {
      Dofs force = none;
      load->add_force(time, none, force);
      largest = std::max(largest, sum_of_sizes(force, d));
    }
    Dofs impulse = none;
    load->add_impulse({0.0, static_cast<double>(scene.steps) * scene.dt}, impulse);
    drive.force += largest;
    drive.impulse += sum_of_sizes(impulse, d);
  }
  drive.impulse += sum_of_sizes(scene.model->mass().cwiseProduct(scene.model->initial_velocity()), d);
  return drive;
}

// Empty where the law has no such parameter.
std::string_view unit_of(const ilaw_law& law, std::string_view parameter) {
  for (std::uint32_t i = 0; i < law.parameter_count; ++i)
    if (law.parameters[i]->name == parameter) return law.parameters[i]->unit;
  return "";
}

double weakest(const Interface& interface, double strength) {
  double least = HUGE_VAL;
  for (const double area : interface.setup().areas)
    if (area > 0.0) least = std::min(least, strength * area);
  return least;
}

}  // namespace

void warn_of_strength(Scene& scene) {
  constexpr double least_ratio = 10.0;
  std::optional<Drive> drive;
  for (std::size_t i = 0; i < scene.interfaces.size(); ++i) {
    const Interface& interface = *scene.interfaces[i];
    const auto& numbers = interface.setup().arguments.numbers;
    const auto strength = numbers.find("strength"), memory = numbers.find("memory");
    const ilaw_law* law = interface.library().law(interface.setup().law);
    if (!law || strength == numbers.end() || !std::isfinite(strength->second)) continue;
    if (!drive) drive = drive_of(scene);
    if (!drive) return;
    const std::string_view unit = unit_of(*law, "strength");
    const double end = static_cast<double>(scene.steps) * scene.dt,
                 window = memory == numbers.end() ? scene.dt : std::clamp(memory->second, scene.dt, end),
                 limit = weakest(interface, strength->second);
    const bool of_impulse = unit == "N.s/m^2";
    if (!of_impulse && unit != "N/m^2") continue;
    const double reached =
        of_impulse ? drive->force * window + drive->impulse : drive->force + drive->impulse / scene.dt;
    if (!std::isfinite(limit) || !(limit > least_ratio * reached)) continue;
    scene.warnings.push_back(at("/interfaces", i) + "/parameters/strength: found " +
                             json(strength->second).dump() + ", at which the weakest node holds " +
                             (of_impulse ? "an impulse" : "a force") + " of " + json(limit).dump() +
                             "; all loads and velocities of the scene together give " + json(reached).dump() +
                             ", which cannot break it");
  }
}

// A window that holds hardly more than the impulse of one step.
void warn_of_memory(Scene& scene) {
  constexpr double least_steps = 2.0;
  for (std::size_t i = 0; i < scene.interfaces.size(); ++i) {
    const Interface& interface = *scene.interfaces[i];
    const auto& numbers = interface.setup().arguments.numbers;
    const auto memory = numbers.find("memory");
    const ilaw_law* law = interface.library().law(interface.setup().law);
    if (!law || memory == numbers.end() || unit_of(*law, "memory") != "s") continue;
    if (!(memory->second > 0.0) || memory->second >= least_steps * scene.dt) continue;
    scene.warnings.push_back(at("/interfaces", i) + "/parameters/memory: found " +
                             json(memory->second).dump() + ", less than two steps of " +
                             json(scene.dt).dump() + ": whether a load that is not smooth breaks the bond " +
                             "depends on where a step begins; only smaller steps help");
  }
}

}  // namespace ilaw::host
