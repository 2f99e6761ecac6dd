// SPDX-License-Identifier: BSD-3-Clause
#include "scene/readers.hpp"

#include "base/words.hpp"
#include "scene/arguments.hpp"
#include "scene/json_text.hpp"
#include "scene/scene.hpp"
#include "scene/values.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace ilaw::host {
namespace {

using nlohmann::json;

// By node, the axes along which motions drive it.
std::map<int, std::set<int>> driven_axes(const Loads& loads) {
  std::map<int, std::set<int>> driven;
  for (const auto& load : loads)
    for (const int node : load->prescribed_nodes())
      driven[node].insert(load->prescribed_axes().begin(), load->prescribed_axes().end());
  return driven;
}

// Whether motions drive nodes of an interface. A contact whose nodes are all driven along all axes has no
// velocity that its law could change.
bool find_driven(const InterfaceSetup& setup, const Scene& scene, const std::string& pointer) {
  const std::map<int, std::set<int>> driven = driven_axes(scene.loads);
  const auto d = static_cast<std::size_t>(scene.model->dimension());
  const auto is_driven = [&](int node) { return driven.contains(node); };
  const auto is_held = [&](int node) { return is_driven(node) && driven.at(node).size() == d; };
  const std::vector<int>& partners = setup.counterpart->partners();
  const bool all_held = std::all_of(partners.begin(), partners.end(), is_held),
             has_pairs = !partners.empty() && !setup.counterpart->shares_partners();
  for (std::size_t k = 0; k < setup.nodes.size(); ++k)
    if (is_held(setup.nodes[k]) && (has_pairs ? is_held(partners[k]) : all_held))
      throw mistake(pointer,
                    "node " + std::to_string(setup.nodes[k]) + ", which a motion drives along all axes",
                    "a node that is free along one axis, or that meets one that is");
  return std::any_of(setup.nodes.begin(), setup.nodes.end(), is_driven) ||
         std::any_of(partners.begin(), partners.end(), is_driven);
}

std::string library_of(const json& interface, const std::filesystem::path& scene_file) {
  std::string library = interface.value("library", interface["law"].get<std::string>());
  if (library.find('/') == std::string::npos) return library;
  return beside(scene_file, library).string();
}

// The libraries there are.
std::string known_libraries() {
  std::vector<std::string> names;
  for (const std::string& file : ilaw::search()) names.push_back(std::filesystem::path(file).stem().string());
  return names.empty() ? "none" : joined(names);
}

// The first tangent, for laws that tell the two apart: one direction for the whole interface, which
// must be flat.
Vector read_tangent(const json& interface, const InterfaceSetup& setup, const Model& model,
                    const std::string& pointer) {
  if (!interface.contains("tangent")) return {};
  Vector tangent = read_direction(interface["tangent"], model.dimension(), pointer).normalized();
  if (!setup.counterpart->keeps_normal())
    throw mistake(pointer, "a tangent", "none: the normal of the counterpart turns");
  if (std::abs(tangent.dot(
          setup.counterpart->contact_point(0, Dofs::Zero(model.mass().size()), 0.0).normal)) > 1e-9)
    throw mistake(pointer, interface["tangent"].dump(), "a direction across the normal");
  return tangent;
}

// The fields of a scene at nodes: a number each, or one value per node of the model.
std::map<std::string, std::vector<double>> read_fields(const json& scene, const std::vector<int>& nodes,
                                                       const Model& model) {
  std::map<std::string, std::vector<double>> fields;
  if (!scene.contains("fields")) return fields;
  for (const auto& [name, values] : scene["fields"].items()) {
    std::vector<double>& own = fields[name];
    if (values.is_number()) {
      own.assign(nodes.size(), values.get<double>());
      continue;
    }
    if (values.size() != static_cast<std::size_t>(model.node_count()))
      throw mistake("/fields/" + name, std::to_string(values.size()) + " values",
                    std::to_string(model.node_count()) + ", one per node of the model");
    for (const int node : nodes) own.push_back(values[static_cast<std::size_t>(node)].get<double>());
  }
  return fields;
}

// Weights that are integrated have areas of their own.
void read_areas(InterfaceSetup& setup, const Scene& scene) {
  const Dofs& u = scene.model->initial_displacement();
  setup.counterpart->follow(u);
  for (std::size_t k = 0; k < setup.nodes.size(); ++k)
    if (const ContactPoint point =
            setup.counterpart->contact_point(static_cast<int>(k), u, scene.start_time());
        point.area > 0.0)
      setup.areas[k] = setup.area_factor * point.area;
}

// "initial": all nodes touch at the start, as the faces of two meshes of one curved face are meant to.
void read_gap_offset(const json& interface, InterfaceSetup& setup, const Scene& scene) {
  const json offset = interface.value("gap_offset", json(0.0));
  if (offset.is_number()) {
    setup.common_gap_offset = offset.get<double>();
    return;
  }
  const Dofs& u = scene.model->initial_displacement();
  setup.counterpart->follow(u);
  for (std::size_t k = 0; k < setup.nodes.size(); ++k)
    setup.own_gap_offsets.push_back(
        setup.counterpart->contact_point(static_cast<int>(k), u, scene.start_time()).gap);
}

InterfaceSetup read_setup(const json& interface, std::size_t number, const Scene& scene, const NodeSet& own,
                          const std::string& pointer) {
  InterfaceSetup setup;
  setup.name = interface.value("name", "interface" + std::to_string(number));
  setup.law = interface["law"].get<std::string>();
  setup.library = library_of(interface, scene.file);
  setup.nodes = own.nodes;
  setup.areas = own.areas;
  setup.area_factor = interface.value("area_factor", setup.area_factor);
  for (double& area : setup.areas) area *= setup.area_factor;
  setup.counterpart = read_counterpart(interface, own, *scene.model, pointer);
  setup.arguments = read_arguments(interface.value("parameters", json::object()), setup.nodes.size(),
                                   pointer + "/parameters");
  setup.arguments.fields = read_fields(scene.source, setup.nodes, *scene.model);
  read_contact_heat(interface, scene, pointer, setup);
  setup.birth = interface.value("birth", setup.birth);
  setup.death = interface.value("death", setup.death);
  if (setup.death <= setup.birth)
    throw mistake(pointer + "/death", interface["death"].dump(),
                  "a time after birth, " + json(setup.birth).dump());
  setup.tangent = read_tangent(interface, setup, *scene.model, pointer + "/tangent");
  read_gap_offset(interface, setup, scene);
  if (setup.counterpart->shares_partners()) read_areas(setup, scene);
  setup.keeps_all_active = !interface.value("skip", true);
  return setup;
}

// Reports an error of the loader or the law at the key that it is about.
[[noreturn]] void refuse_law(const ilaw::error& error, const json& interface, const std::string& pointer) {
  const std::string library = pointer + (interface.contains("library") ? "/library" : "/law");
  if (error.code() == ILAW_BAD_LIBRARY) throw SceneError(library, error.what());
  if (error.code() == ILAW_NOT_FOUND)
    throw SceneError(library, std::string(error.what()) + "; libraries found: " + known_libraries());
  throw SceneError(pointer, error.what());
}

}  // namespace

std::unique_ptr<Interface> read_interface(std::size_t number, const Scene& scene) {
  const json& interface = scene.source["interfaces"][number];
  const std::string pointer = at("/interfaces", number);
  const NodeSet own = select_nodes(interface["nodes"], *scene.model, pointer + "/nodes");
  try {
    InterfaceSetup setup = read_setup(interface, number, scene, own, pointer);
    setup.has_driven_nodes = find_driven(setup, scene, pointer + "/nodes");
    auto made = std::make_unique<Interface>(std::move(setup), *scene.model);
    check_temperatures_read(*made, scene, pointer);
    return made;
  } catch (const ParameterError& error) {
    const std::string whose =
        error.node_index() ? " (node " + std::to_string(own.nodes[*error.node_index()]) + ")" : "";
    throw SceneError(pointer + "/parameters" + error.pointer(), error.what() + whose);
  } catch (const ilaw::error& error) {
    refuse_law(error, interface, pointer);
  }
}

}  // namespace ilaw::host
