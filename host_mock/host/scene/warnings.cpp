// SPDX-License-Identifier: BSD-3-Clause
#include "scene/warnings.hpp"

#include "base/words.hpp"
#include "model/elements.hpp"
#include "scene/json_text.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace ilaw::host {

using nlohmann::json;

namespace {

// Least time of a step of a small scene, and of each node of a larger one.
constexpr double seconds_per_step = 2e-7, seconds_per_node = 1e-8;

void warn_of_duration(Scene& scene) {
  constexpr double day = 86400.0;
  const double seconds =
      static_cast<double>(scene.steps) * (seconds_per_step + seconds_per_node * scene.model->node_count());
  if (seconds < day) return;
  scene.warnings.push_back(formatted("/time: found %.3g steps, which take some %.2g days or more",
                                     static_cast<double>(scene.steps), seconds / day));
}

}  // namespace

void warn_of_times(Scene& scene) {
  const double end = static_cast<double>(scene.steps) * scene.dt;
  const auto warn_if_late = [&](const json& parts, const char* key, const std::string& pointer) {
    for (std::size_t i = 0; i < parts.size(); ++i)
      if (parts[i].contains(key) && parts[i][key].get<double>() > end)
        scene.warnings.push_back(at(pointer, i) + "/" + key + ": found " + parts[i][key].dump() +
                                 ", after the end of the run, " + json(end).dump());
  };
  warn_if_late(scene.source.value("loads", json::array()), "time", "/loads");
  warn_if_late(scene.source["interfaces"], "birth", "/interfaces");
  const double wanted = scene.source["time"]["end"].get<double>();
  if (scene.dt > wanted * (1.0 + 1e-9))
    scene.warnings.push_back("/time/end: found " + json(wanted).dump() + ", less than one step, " +
                             json(scene.dt).dump() + ", which is taken all the same");
  warn_of_duration(scene);
  if (scene.output.every > scene.steps)
    scene.warnings.push_back("/output/every: found " + std::to_string(scene.output.every) +
                             ": the history has the last of " + std::to_string(scene.steps) + " steps alone");
}

namespace {

// A gap of some interface at the start, and where.
struct StartGaps {
  std::size_t below = 0, above = 0;  // nodes with gaps below and above the limits
  double least = 0.0, largest = 0.0;
  int deepest = -1, farthest = -1;  // their nodes
};

StartGaps gaps_at_start(const Scene& scene, const Interface& interface, double low, double high) {
  StartGaps found;
  const Dofs& start = scene.model->initial_displacement();
  interface.setup().counterpart->follow(start);
  for (std::size_t k = 0; k < interface.nodes().size(); ++k) {
    const double gap = interface.gap_at(static_cast<int>(k), start, scene.start_time());
    const int node = interface.nodes()[k];
    if (gap < low) ++found.below;
    if (gap > high) ++found.above;
    if (gap < found.least) {
      found.least = gap;
      found.deepest = node;
    }
    if (gap > found.largest) {
      found.largest = gap;
      found.farthest = node;
    }
  }
  return found;
}

}  // namespace

// The nearest point of a mesh surface comes from an iteration, so its gaps are rounded more.
void warn_of_start(Scene& scene) {
  const double rounding = 1e-12 * scene.model->position().cwiseAbs().maxCoeff(),
               rounding_of_surfaces = std::max(rounding, 1e-6 * shortest_edge(*scene.model));
  for (std::size_t i = 0; i < scene.interfaces.size(); ++i) {
    const Interface& interface = *scene.interfaces[i];
    const Counterpart& counterpart = *interface.setup().counterpart;
    const bool rigid = counterpart.partners().empty();
    const double limit = counterpart.shares_partners() ? rounding_of_surfaces : rounding;
    const StartGaps gaps = gaps_at_start(scene, interface, -limit, HUGE_VAL);
    if (gaps.below > 0)
      scene.warnings.push_back(at("/interfaces", i) + ": " + std::to_string(gaps.below) +
                               " node(s) start inside the " + (rigid ? "obstacle" : "other body") +
                               ", node " + std::to_string(gaps.deepest) + " by " + json(-gaps.least).dump());
  }
}

namespace {

// How far all of the model lies behind a plane; 0 where some of it does not.
double depth_behind(const FlatSurface& flat, const Model& model) {
  const Eigen::Index d = model.dimension();
  const Vector origin = flat.point + flat.displacement;
  double depth = 0.0;
  for (int node = 0; node < model.node_count(); ++node) {
    const auto x = model.position().segment(d * node, d) + model.initial_displacement().segment(d * node, d);
    const double gap = x.dot(flat.normal) - origin.dot(flat.normal);
    const double rounding = 1e-12 * (x.norm() + origin.norm());
    if (gap > rounding) return 0.0;
    if (gap < -rounding) depth = std::max(depth, -gap);
  }
  return depth;
}

}  // namespace

// A plane keeps bodies on the side that its normal points to. Where its own nodes lie on it, the rest of the
// model tells.
void warn_of_side(Scene& scene) {
  for (std::size_t i = 0; i < scene.interfaces.size(); ++i) {
    const Interface& interface = *scene.interfaces[i];
    const std::optional<FlatSurface> flat = interface.setup().counterpart->flat_at(scene.start_time());
    const double depth = flat ? depth_behind(*flat, *scene.model) : 0.0;
    if (!(depth > 0.0) || gaps_at_start(scene, interface, -1e-9 * depth, HUGE_VAL).below > 0) continue;
    scene.warnings.push_back(at("/interfaces", i) + "/obstacle/normal: all of the model lies behind the " +
                             "plane, by up to " + json(depth).dump() + ": does it point towards the bodies?");
  }
}

// The n-th node meets the n-th partner: lists in different orders pair what is far from each other.
void warn_of_partners(Scene& scene) {
  constexpr double most_edges = 0.5;
  const Model& model = *scene.model;
  const Eigen::Index d = model.dimension();
  const double edge = shortest_edge(model);
  for (std::size_t i = 0; i < scene.interfaces.size(); ++i) {
    const Interface& interface = *scene.interfaces[i];
    const std::vector<int>& partners = interface.setup().counterpart->partners();
    if (partners.empty() || interface.setup().counterpart->shares_partners()) continue;
    const std::string pointer = at("/interfaces", i) + "/against/nodes: ";
    std::set<int> seen(interface.nodes().begin(), interface.nodes().end());
    const auto twice = std::find_if(partners.begin(), partners.end(),
                                    [&](const int partner) { return !seen.insert(partner).second; });
    if (twice != partners.end())
      scene.warnings.push_back(
          pointer + "found node " + std::to_string(*twice) +
          " more than once in this list and 'nodes'. Contacts that share a node are solved together: right in a "
          "chain of bodies, a mistake where a node was listed twice");
    for (std::size_t k = 0; d > 1 && k < partners.size(); ++k) {
      const Vector x = model.position().segment(d * interface.nodes()[k], d) -
                       model.position().segment(d * partners[k], d);
      const Vector normal =
          interface.setup()
              .counterpart->contact_point(static_cast<int>(k), model.initial_displacement(), 0.0)
              .normal;
      const double aside = (x - x.dot(normal) * normal).norm();
      if (!(aside > most_edges * edge)) continue;
      scene.warnings.push_back(pointer + "node " + std::to_string(interface.nodes()[k]) +
                               " and its partner " + std::to_string(partners[k]) + " are " +
                               json(aside).dump() +
                               " apart along the interface: are both lists in the same order?");
      break;
    }
  }
}

// A bond is made where the bodies are: across a gap it pulls from afar.
void warn_of_open_bonds(Scene& scene) {
  constexpr double most_of_edge = 0.1;
  const double edge = shortest_edge(*scene.model);
  for (std::size_t i = 0; i < scene.interfaces.size(); ++i) {
    const Interface& interface = *scene.interfaces[i];
    const ilaw_instance_info& info = interface.info();
    const bool bonds = (info.capabilities & ILAW_CAN_ADHERE) && !(info.permissions & ILAW_MAY_SKIP_FRESH);
    if (!bonds || interface.setup().birth > 0.0) continue;
    const double offset = std::abs(interface.setup().common_gap_offset);
    const double limit = most_of_edge * (std::isfinite(edge) ? std::max(edge, offset) : offset);
    if (!(limit > 0.0)) continue;
    const StartGaps gaps = gaps_at_start(scene, interface, 0.0, limit);
    if (gaps.above > 0 && std::isfinite(gaps.largest))
      scene.warnings.push_back(at("/interfaces", i) + ": " + std::to_string(gaps.above) +
                               " node(s) start bonded across an open gap, node " +
                               std::to_string(gaps.farthest) + " across " + json(gaps.largest).dump());
  }
}

namespace {

bool has_memory_in_seconds(const ilaw_law& law) {
  for (std::uint32_t i = 0; i < law.parameter_count; ++i)
    if (std::string_view(law.parameters[i]->name) == "memory")
      return std::string_view(law.parameters[i]->unit) == "s";
  return false;
}

}  // namespace

// A window that holds hardly more than the impulse of one step.
void warn_of_memory(Scene& scene) {
  constexpr double least_steps = 2.0;
  for (std::size_t i = 0; i < scene.interfaces.size(); ++i) {
    const Interface& interface = *scene.interfaces[i];
    const auto& numbers = interface.setup().arguments.numbers;
    const auto memory = numbers.find("memory");
    const ilaw_law* law = interface.library().law(interface.setup().law);
    if (!law || memory == numbers.end() || !has_memory_in_seconds(*law)) continue;
    if (!(memory->second > 0.0) || memory->second >= least_steps * scene.dt) continue;
    scene.warnings.push_back(at("/interfaces", i) + "/parameters/memory: found " +
                             json(memory->second).dump() + ", less than two steps of " +
                             json(scene.dt).dump() + ": whether a load that is not smooth breaks the bond " +
                             "depends on where a step begins; only smaller steps help");
  }
}

// Constant strain locks far earlier than hexahedra do.
void warn_of_locking(Scene& scene) {
  constexpr double max_full_hexahedra = 0.49, max_full_tetrahedra = 0.4;
  const json& model = scene.source["model"];
  const auto warn = [&](const json& body, double limit, const std::string& pointer, const char* elements) {
    const json& poisson = body["material"]["poisson"];
    if (poisson.get<double>() > limit && body.value("element", "full") == "full")
      scene.warnings.push_back(pointer + "/material/poisson: found " + poisson.dump() + ", at which full " +
                               elements + " can hardly bend; \"element\": \"mean_dilatation\" can");
  };
  const json blocks = model.value("blocks", json::array());
  for (std::size_t k = 0; k < blocks.size(); ++k)
    warn(blocks[k], max_full_hexahedra, at("/model/blocks", k), "elements");
  for (std::size_t k = 0; k < scene.meshes.size(); ++k) {
    const bool has_tetrahedra = scene.meshes[k]["tetrahedra"].get<std::size_t>() > 0;
    warn(model["meshes"][k], has_tetrahedra ? max_full_tetrahedra : max_full_hexahedra,
         at("/model/meshes", k), has_tetrahedra ? "tetrahedra" : "elements");
  }
}

void warn_of_temperatures(Scene& scene) {
  for (std::size_t i = 0; i < scene.interfaces.size(); ++i) {
    const Interface& interface = *scene.interfaces[i];
    const InterfaceSetup& setup = interface.setup();
    if (!setup.heat || !setup.heat->obstacle_temperature) continue;
    if (interface.heat()->reads("counterpart_temperature")) continue;
    const json& found = scene.source["interfaces"][i]["obstacle"]["temperature"];
    scene.warnings.push_back(at("/interfaces", i) + "/obstacle/temperature: found " + found.dump() +
                             ", which law '" + setup.law + "' does not read: nothing is conducted");
  }
}

}  // namespace ilaw::host
