// SPDX-License-Identifier: BSD-3-Clause
#include "stress/random_parts.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

namespace ilaw::host {
namespace {

using nlohmann::json;

double speed_of(Draw& draw) { return draw.uniform(-1.0, 1.0) * draw.magnitude(0.1, 3.0); }

// Rows of time and values: to and fro along one direction, or from place to place.
json random_table(int width, double reach, double end, Draw& draw) {
  const int pieces = draw.whole(2, 12);
  const bool to_and_fro = draw.chance(0.5);
  const std::vector<double> amplitude = draw.vector(width, reach);
  json rows = json::array();
  for (int k = 0; k <= pieces; ++k) {
    const double time = end * (k - (k > 0 ? draw.uniform(0.0, 0.5) : 0.0)) / pieces;
    std::vector<double> value = k == 0 || to_and_fro ? amplitude : draw.vector(width, reach);
    for (double& component : value) component *= k == 0 ? 0.0 : (k % 2 == 1 ? 1.0 : -1.0);
    json row = json::array({time});
    for (const double component : value) row.push_back(component);
    rows.push_back(row);
  }
  return rows;
}

json random_path(const DrawnScene& drawn, double speed, double farthest, Draw& draw) {
  const double reach = std::min(farthest, 0.1 * std::abs(speed) * drawn.end);
  return random_table(drawn.dimension, reach, drawn.end, draw);
}

// Up to half a radian in a step, which nobody resolves; most often far less.
void turn(json& obstacle, const DrawnScene& drawn, Draw& draw) {
  const double rate = draw.magnitude(1e-6, draw.chance(0.2) ? 0.5 : 1e-2) / drawn.step;
  if (draw.chance(0.6))
    obstacle["rate"] = draw.chance(0.5) ? rate : -rate;
  else
    obstacle["angles"] = random_table(1, 0.1 * rate * drawn.end, drawn.end, draw);
  if (obstacle["type"] == "sphere" && drawn.dimension == 3) obstacle["axis"] = draw.direction(3);
}

bool can_turn(const json& obstacle, int dimension) {
  return dimension == 3 || (dimension == 2 && obstacle["type"] != "plane");
}

// ---- second bodies ----

json numbers(int first, int count) {
  json list = json::array();
  for (int k = 0; k < count; ++k) list.push_back(first + k);
  return list;
}

double gap_of(double size, Draw& draw) { return draw.chance(0.5) ? 0.0 : size * draw.uniform(-0.02, 0.3); }

json normal_of(int dimension, Draw& draw) {
  return draw.chance(0.4) ? draw.direction(dimension) : along_last_axis(dimension, 1.0);
}

json below(const json& place, const json& normal, double gap) {
  json moved = json::array();
  for (std::size_t c = 0; c < place.size(); ++c)
    moved.push_back(place[c].get<double>() - gap * normal[c].get<double>());
  return moved;
}

// Each point lies on the next one; sweeps over long columns take long.
void pile(json& scene, const json& normal, Draw& draw) {
  json& points = scene["model"]["points"];
  const int count = static_cast<int>(points.size());
  for (std::size_t k = 1; k < points.size(); ++k)
    points[k]["position"] = below(points[k - 1]["position"], normal, gap_of(0.5, draw));
  scene["interfaces"][0]["nodes"] = numbers(0, count - 1);
  scene["interfaces"][0]["against"] = {{"nodes", numbers(1, count - 1)}, {"normal", normal}};
}

// As many points again, each below one of those there are.
void double_points(json& scene, const json& normal, const DrawnScene& drawn, Draw& draw) {
  json& points = scene["model"]["points"];
  const int count = static_cast<int>(points.size());
  const double gap = gap_of(1.0, draw), lighter = draw.magnitude(1e-3, 1e3);
  for (int k = 0; k < count; ++k) {
    json partner = points[static_cast<std::size_t>(k)];
    const double mass = partner["mass"].get<double>() * lighter * draw.magnitude(0.5, 2.0);
    partner["mass"] = mass;
    partner["position"] = below(partner["position"], normal, gap);
    for (json& component : partner["velocity"]) component = draw.chance(0.3) ? 0.0 : speed_of(draw);
    if (partner.contains("stiffness"))
      for (json& stiffness : partner["stiffness"])
        stiffness = draw.chance(0.5) ? 0.0 : mass * draw.magnitude(1e-6, 3.9) / (drawn.step * drawn.step);
    points.push_back(partner);
  }
  scene["interfaces"][0]["nodes"] = numbers(0, count);
  scene["interfaces"][0]["against"] = {{"nodes", numbers(count, count)}, {"normal", normal}};
}

json join_points(json& scene, const DrawnScene& drawn, Draw& draw) {
  constexpr int longest_pile = 20;
  const int count = static_cast<int>(scene["model"]["points"].size());
  for (json& interface : scene["interfaces"]) interface["nodes"] = numbers(0, count);
  const json normal = normal_of(drawn.dimension, draw);
  if (count > 1 && count <= longest_pile && draw.chance(0.3)) {
    pile(scene, normal, draw);
    return numbers(count - 1, 1);
  }
  double_points(scene, normal, drawn, draw);
  return numbers(count, count);
}

// A bar to the left, whose waves need as long or longer from node to node.
json join_bar(json& scene, const DrawnScene& drawn, Draw& draw) {
  json& bars = scene["model"]["bars"];
  const double young = bars[0]["young"].get<double>() * draw.magnitude(1e-3, 1e3),
               density = bars[0]["density"].get<double>() * draw.magnitude(1e-3, 1e3);
  const int elements = draw.whole(1, 2 * bars[0]["elements"].get<int>());
  const double length = elements * drawn.step * std::sqrt(young / density) * draw.uniform(1.0, 2.0);
  const double start =
      bars[0]["start"].get<double>() - length - gap_of(bars[0]["length"].get<double>(), draw);
  bars.push_back({{"name", "c"},
                  {"start", start},
                  {"length", length},
                  {"elements", elements},
                  {"young", young},
                  {"density", density},
                  {"section", bars[0]["section"].get<double>() * draw.magnitude(0.1, 10.0)},
                  {"velocity", draw.chance(0.3) ? 0.0 : speed_of(draw)}});
  scene["interfaces"][0]["nodes"] = "b.left";
  scene["interfaces"][0]["against"] = {{"nodes", "c.right"}, {"normal", {1.0}}};
  return "c.left";
}

// A block below, with a mesh that matches or with one of its own, on which the first one may not find room.
json join_block(json& scene, Draw& draw) {
  const json& upper = scene["model"]["blocks"][0];
  const bool matches = draw.chance(0.4);
  const double size = upper["size"][0].get<double>();
  const int n = upper["elements"][0].get<int>(), across = matches ? n : draw.whole(1, 4),
            height = draw.whole(1, 3);
  json lower = upper;
  lower["name"] = "c";
  json& material = lower["material"];
  const double softer = draw.magnitude(0.1, 1.0), wave_ratio = std::sqrt(softer);
  material["young"] = material["young"].get<double>() * softer;
  if (draw.chance(0.3)) material["type"] = "linear";
  // Elements are no smaller than waves are slower.
  const double least = std::max(wave_ratio * size / n * across, matches ? size : 0.0);
  const double width = matches ? size : std::max(least, size * draw.uniform(0.7, 2.0));
  const double corner_x = matches ? 0.0 : draw.uniform(-0.5, 0.0) * width,
               corner_y = matches ? 0.0 : draw.uniform(-0.5, 0.0) * width;
  const double tall = height * wave_ratio * size / n * draw.uniform(1.0, 2.0);
  const double top = upper["corner"][2].get<double>() - gap_of(0.1 * size, draw);
  lower["corner"] = {corner_x, corner_y, top - tall};
  lower["size"] = {width, width, tall};
  lower["elements"] = {across, across, height};
  for (json& component : lower["velocity"]) component = component.get<double>() * draw.uniform(-1.0, 1.0);
  json against = {{"surface", "c.z_max"}}, nodes = "b.z_min";
  if (matches && draw.chance(0.5)) {
    const int layer = (n + 1) * (n + 1);
    nodes = numbers(0, layer);
    against = {{"nodes", numbers(layer * (n + 1) + layer * height, layer)}, {"normal", {0.0, 0.0, 1.0}}};
  } else if (height == 1) {  // a third of them
    against["discretization"] = "node_to_facet";
  }
  scene["model"]["blocks"].push_back(lower);
  scene["interfaces"][0]["nodes"] = nodes;
  scene["interfaces"][0]["against"] = against;
  return "c.z_min";
}

// ---- driven nodes ----

// A bar or a block is driven by its far end, unless an interface has that, too.
std::vector<json> ends_of(const json& scene) {
  const json& model = scene["model"];
  const bool is_bar = model["type"] == "bars";
  std::vector<json> ends;
  for (const json& body : model[is_bar ? "bars" : "blocks"]) {
    const std::string name = body["name"].get<std::string>();
    const std::string end =
        name + (is_bar ? (name == "b" ? ".right" : ".left") : (name == "b" ? ".z_max" : ".z_min"));
    const auto has_it = [&](const json& interface) {
      return interface["nodes"] == name || interface["nodes"] == end;
    };
    if (std::none_of(scene["interfaces"].begin(), scene["interfaces"].end(), has_it)) ends.emplace_back(end);
  }
  return ends;
}

// A point that has a spring to the first one.
json far_end_of_a_spring(json& scene, const DrawnScene& drawn, Draw& draw) {
  json& points = scene["model"]["points"];
  const int count = static_cast<int>(points.size());
  for (json& interface : scene["interfaces"])
    if (interface["nodes"] == "all") interface["nodes"] = numbers(0, count);
  json far = points[0];
  for (json& component : far["position"]) component = component.get<double>() + draw.uniform(0.1, 1.0);
  for (json& component : far["velocity"]) component = 0.0;
  points.push_back(far);
  const double stiffest = far["mass"].get<double>() / (drawn.step * drawn.step);
  scene["springs"] = {{{"nodes", {0}}, {"to", {count}}, {"stiffness", stiffest * draw.magnitude(1e-6, 0.2)}}};
  if (draw.chance(0.3)) scene["springs"][0]["damping"] = draw.magnitude(1e-6, 0.1) * drawn.step * stiffest;
  return numbers(count, 1);
}

// How fast and how far nodes are driven: blocks stand no more than a part of their size.
struct Drive {
  double speed, farthest;
};

Drive drive_of(const json& model) {
  if (model["type"] != "blocks") return {1.0, 1.0};
  const json &block = model["blocks"][0], &material = block["material"];
  const double wave = std::sqrt(material["young"].get<double>() / material["density"].get<double>());
  return {0.1 * wave, 0.1 * block["size"][2].get<double>()};
}

}  // namespace

void set_in_motion(json& obstacle, const DrawnScene& drawn, Draw& draw) {
  if (draw.chance(0.4)) {
    obstacle.erase("velocity");
    obstacle["path"] = random_path(drawn, draw.magnitude(0.1, 3.0), 1.0, draw);
  }
  if (can_turn(obstacle, drawn.dimension) && draw.chance(0.7)) turn(obstacle, drawn, draw);
}

json join_a_body(json& scene, const DrawnScene& drawn, Draw& draw) {
  const std::string type = scene["model"]["type"].get<std::string>();
  if (type == "rotating_spring") return {};
  scene["interfaces"][0].erase("obstacle");
  if (type == "points") return join_points(scene, drawn, draw);
  return type == "bars" ? join_bar(scene, drawn, draw) : join_block(scene, draw);
}

void drive_nodes(json& scene, const DrawnScene& drawn, Draw& draw) {
  const std::string type = scene["model"]["type"].get<std::string>();
  if (type == "rotating_spring") return;
  const std::vector<json> ends =
      type == "points" ? std::vector<json>{far_end_of_a_spring(scene, drawn, draw)} : ends_of(scene);
  const Drive drive = drive_of(scene["model"]);
  for (const json& nodes : ends) {
    json motion = {{"type", "motion"}, {"nodes", nodes}};
    if (draw.chance(0.8)) motion["path"] = random_path(drawn, drive.speed, drive.farthest, draw);
    if (drawn.dimension > 1 && draw.chance(0.3)) motion["axes"] = {draw.whole(0, drawn.dimension - 1)};
    scene["loads"].push_back(motion);
  }
}

}  // namespace ilaw::host
