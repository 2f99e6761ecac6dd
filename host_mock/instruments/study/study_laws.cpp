// SPDX-License-Identifier: BSD-3-Clause
#include "study/study_laws.hpp"

#include "scene/json_text.hpp"
#include "scene/scene.hpp"
#include "scene/validation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace ilaw::host {
namespace {

using nlohmann::json;

// In units of a node's mass m and a step h: the stiffnesses of m/h^2, the damper of m/h.
constexpr std::array<std::pair<const char*, int>, 3> scaled_parameters{
    {{"stiffness", 2}, {"tangential_stiffness", 2}, {"damping", 1}}};

// Mass of the lightest interface node.
double least_mass(const Scene& scene) {
  double mass = std::numeric_limits<double>::infinity();
  for (const auto& interface : scene.interfaces)
    for (const int node : interface->nodes())
      mass = std::min(mass, scene.model->mass()[Eigen::Index{node} * scene.model->dimension()]);
  return mass;
}

void scale(const Scene& scene, double unit_step, json& parameters) {
  const double critical = scene.model->critical_step(), h = std::isfinite(critical) ? critical : unit_step;
  const double mass = least_mass(scene);
  for (const auto& [name, power] : scaled_parameters)
    if (parameters.contains(name) && parameters[name].is_number())
      parameters[name] = parameters[name].get<double>() * mass / std::pow(h, power);
}

bool is_contact(const json& interface) {
  return interface["law"] == "contact" || interface["law"] == "coulomb";
}

// Damper of an explicit penalty of stiffness k (in units of m and h) from which a mass leaves at e times
// its speed: -ln e = 2 zeta arccos(zeta)/sqrt(1 - zeta^2) (Schwager and Poeschel 2007), by bisection.
double damping_of(double restitution, double stiffness) {
  double low = 0.0, high = 0.999;
  for (int k = 0; k < 50; ++k) {
    const double zeta = 0.5 * (low + high);
    const double loss = 2.0 * zeta * std::acos(zeta) / std::sqrt(1.0 - zeta * zeta);
    (std::exp(-loss) > restitution ? low : high) = zeta;
  }
  return 2.0 * low * std::sqrt(stiffness);
}

// With the friction of the scene's own law, and its restitution where no body gives the rebound.
json usual_penalty(const json& source, const char* integration, double stiffness) {
  const json own = source["interfaces"][0].value("parameters", json::object());
  const bool rebounds_by_itself = source["model"]["type"] == "bars" || source["model"]["type"] == "blocks";
  const bool is_explicit = std::string(integration) == "explicit";
  const json given = own.value("restitution", json(0.0));
  json parameters{{"stiffness", stiffness}, {"integration", integration}};
  if (own.contains("friction")) {
    parameters["friction"] = own["friction"];
    if (is_explicit) parameters["tangential_stiffness"] = stiffness;
  }
  if (!is_explicit)
    parameters["restitution"] = given;
  else if (!rebounds_by_itself && given.is_number() && given < 1.0)
    parameters["damping"] = damping_of(given.get<double>(), stiffness);
  return {{"name", std::string(integration) + " k=" + json(stiffness).dump()},
          {"law", "penalty"},
          {"scaled", true},
          {"parameters", parameters}};
}

}  // namespace

json read_law_option(const std::string& text) {
  const auto parsed = [&](const std::string& part) {
    try {
      return parse_scene(part);
    } catch (const SceneError& error) {
      throw SceneError("--law " + text + ": " + error.what());
    }
  };
  if (text.starts_with('{')) return parsed(text);
  const auto colon = text.find(':');
  json entry{{"law", text.substr(0, colon)}};
  if (colon != std::string::npos) entry["parameters"] = parsed(text.substr(colon + 1));
  return entry;
}

json usual_laws(const json& source) {
  json laws = json::array();
  const json& interfaces = source["interfaces"];
  if (interfaces.empty() || !std::all_of(interfaces.begin(), interfaces.end(), is_contact))
    return json::array({{{"name", "as in the scene"}}});
  for (const char* activation : {"predictive", "moreau"})
    laws.push_back({{"name", interfaces[0]["law"].get<std::string>() + " " + activation},
                    {"parameters", {{"activation", activation}}}});
  for (const double stiffness : {0.1, 1.0, 10.0})
    laws.push_back(usual_penalty(source, "explicit", stiffness));
  for (const double stiffness : {1.0, 100.0}) laws.push_back(usual_penalty(source, "implicit", stiffness));
  return laws;
}

std::string name_of(const json& entry) {
  if (entry.contains("name")) return entry["name"].get<std::string>();
  std::string name = entry.value("law", std::string("own law"));
  const json parameters = entry.value("parameters", json::object());
  for (const auto& [key, value] : parameters.items())
    name += ' ' + key + ' ' + (value.is_string() ? value.get<std::string>() : value.dump());
  std::replace(name.begin(), name.end(), ',', ';');  // in a table of values that commas separate
  return name;
}

json with_law(const json& source, const json& entry, double unit_step, const std::filesystem::path& file) {
  json parameters = entry.value("parameters", json::object());
  if (entry.value("scaled", false)) scale(read_scene(source, file), unit_step, parameters);
  json scene = source;
  for (json& interface : scene["interfaces"]) {
    if (entry.contains("law")) {
      interface["law"] = entry["law"];
      interface.erase("library");
      interface["parameters"] = parameters;
    } else {
      interface["parameters"].update(parameters);
    }
    if (entry.contains("library")) interface["library"] = entry["library"];
  }
  return scene;
}

}  // namespace ilaw::host
