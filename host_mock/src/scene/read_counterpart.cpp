// SPDX-License-Identifier: BSD-3-Clause
#include "scene/read_counterpart.hpp"

#include "contact/mesh_surface.hpp"
#include "scene/json_text.hpp"
#include "scene/selection.hpp"
#include "scene/values.hpp"

#include <algorithm>

namespace ilaw::host {
namespace {

using nlohmann::json;

std::unique_ptr<const Obstacle> read_obstacle(const json& obstacle, int d, const std::string& pointer) {
  const std::string type = obstacle["type"].get<std::string>();
  const Motion motion = read_motion(obstacle, d, pointer);
  if (type == "plane")
    return std::make_unique<Plane>(read_vector(obstacle["point"], d, pointer + "/point"),
                                   read_direction(obstacle["normal"], d, pointer + "/normal"), motion);
  if (type == "sphere")
    return std::make_unique<Sphere>(read_vector(obstacle["center"], d, pointer + "/center"),
                                    obstacle["radius"].get<double>(), motion);
  if (d != 3)
    throw mistake(pointer + "/type", "\"cylinder\" in " + std::to_string(d) + "D",
                  "a model in 3D (in 2D a sphere is a disc)");
  return std::make_unique<Cylinder>(read_vector(obstacle["point"], d, pointer + "/point"),
                                    read_direction(obstacle["axis"], d, pointer + "/axis"),
                                    obstacle["radius"].get<double>(), motion);
}

std::unique_ptr<Counterpart> read_partners(const json& against, const NodeSet& own, const Model& model,
                                           const std::string& pointer) {
  if (!against.contains("nodes") || !against.contains("normal"))
    throw mistake(pointer, against.dump(), "'nodes' and 'normal', or 'surface'");
  const NodeSet partners = select_nodes(against["nodes"], model, pointer + "/nodes");
  if (partners.nodes.size() != own.nodes.size())
    throw mistake(pointer + "/nodes", std::to_string(partners.nodes.size()) + " nodes",
                  "one for each of the " + std::to_string(own.nodes.size()) + " nodes of the interface");
  for (std::size_t k = 0; k < own.nodes.size(); ++k)
    if (own.nodes[k] == partners.nodes[k])
      throw SceneError(pointer + "/nodes",
                       "node " + std::to_string(own.nodes[k]) + " would meet itself, expected another node");
  const Vector normal =
      read_direction(against["normal"], model.dimension(), pointer + "/normal").normalized();
  return std::make_unique<NodeCounterpart>(model, own.nodes, partners.nodes, normal);
}

std::unique_ptr<Counterpart> read_surface(const std::string& name, const NodeSet& own, const Model& model,
                                          const std::string& pointer) {
  const NodeSet& surface = select_surface(name, model, pointer);
  for (const int node : surface.nodes)
    if (std::find(own.nodes.begin(), own.nodes.end(), node) != own.nodes.end())
      throw SceneError(pointer, "node " + std::to_string(node) +
                                    " would meet its own facet, expected the surface of another body");
  return std::make_unique<MeshSurface>(model, own.nodes, surface);
}

}  // namespace

std::unique_ptr<Counterpart> read_counterpart(const json& interface, const NodeSet& own, const Model& model,
                                              const std::string& pointer) {
  require_one_of(interface, "obstacle", "against", "'obstacle' (rigid) and 'against' (another body)",
                 pointer);
  if (interface.contains("obstacle"))
    return std::make_unique<RigidCounterpart>(
        model, own.nodes, read_obstacle(interface["obstacle"], model.dimension(), pointer + "/obstacle"));
  const json& against = interface["against"];
  if (!against.contains("surface")) return read_partners(against, own, model, pointer + "/against");
  return read_surface(against["surface"].get<std::string>(), own, model, pointer + "/against/surface");
}

}  // namespace ilaw::host
