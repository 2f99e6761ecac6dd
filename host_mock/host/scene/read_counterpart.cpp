// SPDX-License-Identifier: BSD-3-Clause
#include "scene/readers.hpp"

#include "scene/json_text.hpp"
#include "scene/values.hpp"
#include "surface/counterpart.hpp"
#include "surface/mesh_surface.hpp"
#include "surface/mortar_surface.hpp"

#include <algorithm>
#include <optional>
#include <vector>

namespace ilaw::host {
namespace {

using nlohmann::json;

// The axis that an obstacle turns about: its own, or that of a sphere.
Eigen::Vector3d read_axis(const json& obstacle, int d, const std::string& pointer) {
  if (obstacle["type"] == "plane") return read_direction(obstacle["normal"], d, pointer + "/normal");
  if (obstacle.contains("axis")) return read_direction(obstacle["axis"], d, pointer + "/axis");
  if (d == 3) throw SceneError(pointer, "key 'axis' is missing, about which the sphere turns");
  return Eigen::Vector3d::UnitZ();
}

// "rate", "angles" or neither.
std::optional<Turning> read_turning(const json& obstacle, int d, const std::string& pointer) {
  const bool has_rate = obstacle.contains("rate"), has_angles = obstacle.contains("angles");
  const std::string key = pointer + (has_rate ? "/rate" : "/angles");
  if (obstacle["type"] == "sphere" && obstacle.contains("axis") && (d < 3 || !(has_rate || has_angles)))
    throw mistake(pointer + "/axis", obstacle["axis"].dump(),
                  d < 3 ? "none: discs turn in their plane" : "'rate' or 'angles' beside it");
  if (!has_rate && !has_angles) return {};
  if (has_rate && has_angles) throw mistake(pointer, "both 'rate' and 'angles'", "at most one of them");
  if (d == 1 || (d == 2 && obstacle["type"] == "plane"))
    throw mistake(key, obstacle["type"].dump() + " in " + std::to_string(d) + "D",
                  "none: it cannot turn and keep its shape");
  const Eigen::Vector3d axis = read_axis(obstacle, d, pointer);
  if (has_rate) return Turning(axis, obstacle["rate"].get<double>());
  return Turning(axis, read_table(obstacle["angles"], 1, key));
}

// The axis that a plane tilts about, through its point: across 2D, given in 3D.
Eigen::Vector3d read_tilt_axis(const json& tilt, int d, const std::string& pointer) {
  if (d == 2 && !tilt.contains("axis")) return Eigen::Vector3d::UnitZ();
  if (d == 2) throw mistake(pointer + "/axis", tilt["axis"].dump(), "none: a plane in 2D tilts in its plane");
  if (!tilt.contains("axis")) throw SceneError(pointer, "key 'axis' is missing, about which the plane tilts");
  return read_direction(tilt["axis"], d, pointer + "/axis");
}

std::unique_ptr<const Obstacle> read_tilting(const json& obstacle, int d, const Motion& motion,
                                             const std::string& pointer) {
  for (const char* key : {"rate", "angles"})
    if (obstacle.contains(key))
      throw mistake(pointer, std::string("both 'tilt' and '") + key + "'", "one of them");
  if (d == 1) throw mistake(pointer + "/tilt", "a plane in 1D", "none: it cannot tilt");
  const json& tilt = obstacle["tilt"];
  const Turning turning(read_tilt_axis(tilt, d, pointer + "/tilt"),
                        read_table(tilt["angles"], 1, pointer + "/tilt/angles"));
  return std::make_unique<Plane>(read_vector(obstacle["point"], d, pointer + "/point"),
                                 read_direction(obstacle["normal"], d, pointer + "/normal"), motion, turning,
                                 true);
}

std::unique_ptr<const Obstacle> read_obstacle(const json& obstacle, int d, const std::string& pointer) {
  const std::string type = obstacle["type"].get<std::string>();
  const Motion motion = read_motion(obstacle, d, pointer);
  if (type == "cylinder" && d != 3)
    throw mistake(pointer + "/type", "\"cylinder\" in " + std::to_string(d) + "D",
                  "a model in 3D (in 2D a sphere is a disc)");
  if (obstacle.contains("tilt")) return read_tilting(obstacle, d, motion, pointer);
  const std::optional<Turning> turning = read_turning(obstacle, d, pointer);
  if (type == "plane")
    return std::make_unique<Plane>(read_vector(obstacle["point"], d, pointer + "/point"),
                                   read_direction(obstacle["normal"], d, pointer + "/normal"), motion,
                                   turning);
  const bool is_sphere = type == "sphere";
  const std::string center = is_sphere ? "center" : "point";
  std::optional<Vector> axis;
  if (!is_sphere) axis = read_direction(obstacle["axis"], d, pointer + "/axis");
  return std::make_unique<Round>(read_vector(obstacle[center], d, pointer + "/" + center), axis,
                                 obstacle["radius"].get<double>(), motion, turning);
}

std::unique_ptr<Counterpart> read_partners(const json& against, const NodeSet& own, const Model& model,
                                           const std::string& pointer) {
  if (!against.contains("nodes") || !against.contains("normal"))
    throw mistake(pointer, against.dump(), "'nodes' and 'normal', or 'surface'");
  const Vector normal =
      read_direction(against["normal"], model.dimension(), pointer + "/normal").normalized();
  const std::vector<int> partners =
      select_partners(against["nodes"], own.nodes, model, normal, pointer + "/nodes").nodes;
  return std::make_unique<NodeCounterpart>(model, own.nodes, partners, normal);
}

std::unique_ptr<Counterpart> read_surface(const json& against, const NodeSet& own, const Model& model,
                                          const std::string& pointer) {
  const NodeSet& surface = select_surface(against["surface"].get<std::string>(), model, pointer + "/surface");
  for (const int node : surface.nodes)
    if (std::find(own.nodes.begin(), own.nodes.end(), node) != own.nodes.end())
      throw SceneError(
          pointer + "/surface",
          "node " + std::to_string(node) + " would meet its own facet, expected the surface of another body");
  const bool is_face = !own.facets.empty();
  const std::string discretization =
      against.value("discretization", is_face ? "dual_mortar" : "node_to_facet");
  if (discretization == "node_to_facet") return std::make_unique<MeshSurface>(model, own.nodes, surface);
  if (!is_face)
    throw mistake(pointer + "/discretization", against["discretization"].dump(),
                  "\"node_to_facet\", or a face with facets as the 'nodes' of the interface");
  return std::make_unique<MortarSurface>(model, own, surface);
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
  return read_surface(against, own, model, pointer + "/against");
}

}  // namespace ilaw::host
