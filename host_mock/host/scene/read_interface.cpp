// SPDX-License-Identifier: BSD-3-Clause
#include "scene/readers.hpp"

#include "base/words.hpp"
#include "scene/arguments.hpp"
#include "scene/json_text.hpp"
#include "scene/scene.hpp"
#include "scene/sharp_nodes.hpp"
#include "scene/values.hpp"
#include "surface/mortar_surface.hpp"

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

// In shortest edges of the face: how far behind the other face edge rows hold its nodes, so that faces on
// each other do not touch them (an edge of the other face is right to 0.01).
constexpr double edge_depth = 0.02;

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

// "initial": all nodes touch at the start, as the faces of two meshes of one curved face are meant to. Edge
// rows have a depth, and are deeper where the bodies overlap at the start.
void read_gap_offset(const json& interface, double depth, InterfaceSetup& setup, const Scene& scene) {
  const json offset = interface.value("gap_offset", json(0.0));
  const bool is_initial = !offset.is_number();
  if (!is_initial) setup.common_gap_offset = offset.get<double>();
  if (!is_initial && depth == 0.0) return;
  const Dofs& u = scene.model->initial_displacement();
  setup.counterpart->follow(u);
  for (std::size_t k = 0; k < setup.nodes.size(); ++k) {
    const ContactPoint point = setup.counterpart->contact_point(static_cast<int>(k), u, scene.start_time());
    double gap = point.gap - setup.common_gap_offset;
    if (depth > 0.0 && (point.is_beyond_border || !is_initial)) gap = std::min(gap, 0.0);
    if (depth == 0.0 && point.is_beyond_border) gap = 0.0;  // it does not touch
    setup.own_gap_offsets.push_back(gap - depth);
  }
}

InterfaceSetup read_setup(const json& interface, std::size_t number, const Scene& scene, const NodeSet& own,
                          std::unique_ptr<Counterpart> counterpart, double depth,
                          const std::string& pointer) {
  InterfaceSetup setup;
  setup.name = interface.value("name", "interface" + std::to_string(number));
  setup.law = interface["law"].get<std::string>();
  setup.library = library_of(interface, scene.file);
  setup.nodes = own.nodes;
  setup.areas = own.areas;
  setup.area_factor = interface.value("area_factor", setup.area_factor);
  for (double& area : setup.areas) area *= setup.area_factor;
  setup.counterpart = std::move(counterpart);
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
  read_gap_offset(interface, depth, setup, scene);
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

std::unique_ptr<Interface> make_interface(const json& interface, std::size_t number, const Scene& scene,
                                          const NodeSet& own, std::unique_ptr<Counterpart> counterpart,
                                          std::string edges_of = "", double depth = 0.0) {
  const std::string pointer = at("/interfaces", number);
  try {
    InterfaceSetup setup = read_setup(interface, number, scene, own, std::move(counterpart), depth, pointer);
    setup.edges_of = std::move(edges_of);
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

// ---- edge rows: no averaged constraint belongs to a sharp edge of the main face -------------------------

// A law that can pull bonds the faces, and needs no edge rows.
bool may_have_edge_rows(const Interface& made) { return (made.info().capabilities & ILAW_CAN_ADHERE) == 0; }

// Values per node are of the secondary nodes: an edge row has the value of the closest one at the start.
void give_values(json& parameters, const std::vector<int>& edges, const std::vector<int>& own,
                 const Model& model) {
  for (json& value : parameters) {
    if (!value.is_object() || !value.contains("per_node")) continue;
    json values = json::array();
    for (const int edge : edges) {
      const auto distance = [&](int node) {
        return (model.position(node) - model.position(edge)).squaredNorm();
      };
      const auto closest =
          std::min_element(own.begin(), own.end(), [&](int a, int b) { return distance(a) < distance(b); });
      values.push_back(value["per_node"][static_cast<std::size_t>(closest - own.begin())]);
    }
    value["per_node"] = std::move(values);
  }
}

// Without the nodes that motions hold, which no impulse moves.
NodeSet moving_part(const NodeSet& set, const std::map<int, std::set<int>>& driven, std::size_t dimension) {
  NodeSet part;
  for (std::size_t k = 0; k < set.nodes.size(); ++k) {
    const auto found = driven.find(set.nodes[k]);
    if (found != driven.end() && found->second.size() == dimension) continue;
    part.nodes.push_back(set.nodes[k]);
    part.areas.push_back(set.areas[k]);
  }
  return part;
}

// Null if the interface has none, or the main face no sharp node that could move.
std::unique_ptr<Interface> make_edge_rows(std::size_t number, const Scene& scene) {
  json interface = scene.source["interfaces"][number];
  const std::string pointer = at("/interfaces", number);
  const Interface& made = *scene.interfaces[number];
  const auto* const faces = dynamic_cast<const MortarSurface*>(made.setup().counterpart.get());
  if (!faces || !may_have_edge_rows(made)) return nullptr;
  const NodeSet own = select_nodes(interface["nodes"], *scene.model, pointer + "/nodes");
  SharpNodes edges = sharp_nodes_of(
      select_surface(interface["against"]["surface"].get<std::string>(), *scene.model, pointer),
      *scene.model);
  const std::map<int, std::set<int>> driven = driven_axes(scene.loads);
  const auto d = static_cast<std::size_t>(scene.model->dimension());
  if (moving_part(own, driven, d).nodes.empty()) edges.set = moving_part(edges.set, driven, d);
  if (edges.set.nodes.empty()) return nullptr;
  interface["name"] = made.name() + "_edges";
  if (interface.contains("parameters"))
    give_values(interface["parameters"], edges.set.nodes, own.nodes, *scene.model);
  auto counterpart = std::make_unique<EdgeRows>(*scene.model, edges.set.nodes, own,
                                                most_depth * edges.shortest_edge, *faces);
  return make_interface(interface, number, scene, edges.set, std::move(counterpart), made.name(),
                        edge_depth * edges.shortest_edge);
}

}  // namespace

void read_interfaces(Scene& scene) {
  const json& interfaces = scene.source["interfaces"];
  for (std::size_t i = 0; i < interfaces.size(); ++i) {
    const std::string pointer = at("/interfaces", i);
    const NodeSet own = select_nodes(interfaces[i]["nodes"], *scene.model, pointer + "/nodes");
    scene.interfaces.push_back(make_interface(interfaces[i], i, scene, own,
                                              read_counterpart(interfaces[i], own, *scene.model, pointer)));
  }
  for (std::size_t i = 0; i < interfaces.size(); ++i)
    if (auto edges = make_edge_rows(i, scene)) scene.interfaces.push_back(std::move(edges));
}

}  // namespace ilaw::host
