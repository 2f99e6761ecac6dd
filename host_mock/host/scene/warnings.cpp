// SPDX-License-Identifier: BSD-3-Clause
#include "scene/warnings.hpp"

#include "base/words.hpp"
#include "model/elements.hpp"
#include "scene/json_text.hpp"
#include "scene/values.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace ilaw::host {
namespace {

using nlohmann::json;

std::string number(double value) { return json(value).dump(); }
std::string node(int index) { return "node " + std::to_string(index); }

// ---- times ----------------------------------------------------------------------------------------------

void warn_of_duration(Scene& scene) {
  // Least time of a step of a small scene, and of each node of a larger one.
  constexpr double seconds_per_step = 2e-7, seconds_per_node = 1e-8, day = 86400.0;
  const double seconds =
      static_cast<double>(scene.steps) * (seconds_per_step + seconds_per_node * scene.model->node_count());
  if (seconds < day) return;
  scene.warnings.push_back(formatted("/time: found %.3g steps, which take some %.2g days or more",
                                     static_cast<double>(scene.steps), seconds / day));
}

// Times at which nothing can happen any more.
void warn_of_times(Scene& scene) {
  const double end = static_cast<double>(scene.steps) * scene.dt;
  const auto warn_if_late = [&](const json& parts, const char* key, const std::string& pointer) {
    for (std::size_t i = 0; i < parts.size(); ++i)
      if (parts[i].contains(key) && parts[i][key].get<double>() > end)
        scene.warnings.push_back(at(pointer, i) + "/" + key + ": found " + parts[i][key].dump() +
                                 ", after the end of the run, " + number(end));
  };
  warn_if_late(scene.source.value("loads", json::array()), "time", "/loads");
  warn_if_late(scene.source["interfaces"], "birth", "/interfaces");
  const double wanted = scene.source["time"]["end"].get<double>();
  if (scene.dt > wanted * (1.0 + 1e-9))
    scene.warnings.push_back("/time/end: found " + number(wanted) + ", less than one step, " +
                             number(scene.dt) + ", which is taken all the same");
  warn_of_duration(scene);
  if (scene.output.every > scene.steps)
    scene.warnings.push_back("/output/every: found " + std::to_string(scene.output.every) +
                             ": the history has the last of " + std::to_string(scene.steps) + " steps alone");
}

// ---- interfaces: each gives the text of its warning, or none
// -----------------------------------------------

const Counterpart& counterpart_of(const Interface& interface) { return *interface.setup().counterpart; }

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
    if (interface.setup().is_left_out(static_cast<int>(k))) continue;
    const double gap = interface.gap_at(static_cast<int>(k), start, scene.start_time());
    if (gap < low) ++found.below;
    if (gap > high) ++found.above;
    if (gap < found.least) found.least = gap, found.deepest = interface.nodes()[k];
    if (gap > found.largest) found.largest = gap, found.farthest = interface.nodes()[k];
  }
  return found;
}

// Most laws throw such nodes out. The nearest point of a mesh surface comes from an iteration, so its gaps
// are rounded more.
std::string overlap(const Scene& scene, const Interface& interface, const json&) {
  const double rounding = 1e-12 * scene.model->position().cwiseAbs().maxCoeff(),
               limit = counterpart_of(interface).shares_partners()
                           ? std::max(rounding, 1e-6 * shortest_edge(*scene.model))
                           : rounding;
  const StartGaps gaps = gaps_at_start(scene, interface, -limit, HUGE_VAL);
  if (gaps.below == 0) return "";
  return std::to_string(gaps.below) + " node(s) start inside the " +
         (counterpart_of(interface).partners().empty() ? "obstacle, " : "other body, ") + node(gaps.deepest) +
         " by " + number(-gaps.least);
}

// How far all of the model lies behind a plane; 0 where some of it does not.
double depth_behind(const FlatSurface& flat, const Model& model) {
  const Vector origin = flat.point + flat.displacement;
  double depth = 0.0;
  for (int k = 0; k < model.node_count(); ++k) {
    const Vector x = model.position(k, model.initial_displacement());
    const double gap = x.dot(flat.normal) - origin.dot(flat.normal);
    const double rounding = 1e-12 * (x.norm() + origin.norm());
    if (gap > rounding) return 0.0;
    if (gap < -rounding) depth = std::max(depth, -gap);
  }
  return depth;
}

// A plane keeps bodies on the side that its normal points to. Where its own nodes lie on it, the rest of the
// model tells.
std::string wrong_side(const Scene& scene, const Interface& interface, const json&) {
  const std::optional<FlatSurface> flat = counterpart_of(interface).flat_at(scene.start_time());
  const double depth = flat ? depth_behind(*flat, *scene.model) : 0.0;
  if (!(depth > 0.0) || gaps_at_start(scene, interface, -1e-9 * depth, HUGE_VAL).below > 0) return "";
  return "all of the model lies behind the plane, by up to " + number(depth) +
         ": does it point towards the bodies?";
}

bool has_pairs(const Interface& interface) {
  return !counterpart_of(interface).partners().empty() && !counterpart_of(interface).shares_partners();
}

std::string partner_twice(const Scene&, const Interface& interface, const json&) {
  if (!has_pairs(interface)) return "";
  std::set<int> seen(interface.nodes().begin(), interface.nodes().end());
  for (const int partner : counterpart_of(interface).partners())
    if (!seen.insert(partner).second)
      return "found " + node(partner) +
             " more than once in this list and 'nodes'. Contacts that share a node are solved together: right "
             "in a chain of bodies, a mistake where a node was listed twice";
  return "";
}

// The n-th node meets the n-th partner: lists in different orders pair what is far from each other.
std::string partner_aside(const Scene& scene, const Interface& interface, const json&) {
  constexpr double most_edges = 0.5;
  const Model& model = *scene.model;
  if (!has_pairs(interface) || model.dimension() == 1) return "";
  const std::vector<int>& partners = counterpart_of(interface).partners();
  const double spacing = spacing_of(partners, model);
  for (std::size_t k = 0; k < partners.size(); ++k) {
    const int own = interface.nodes()[k];
    const Vector x = model.position(own) - model.position(partners[k]),
                 normal = counterpart_of(interface)
                              .contact_point(static_cast<int>(k), model.initial_displacement(), 0.0)
                              .normal;
    const double aside = (x - x.dot(normal) * normal).norm();
    if (aside > most_edges * spacing)
      return node(own) + " and its partner " + std::to_string(partners[k]) + " are " + number(aside) +
             " apart along the interface: are both lists in the same order?";
  }
  return "";
}

// A bond is made where the bodies are: across a gap it pulls from afar.
std::string open_bond(const Scene& scene, const Interface& interface, const json&) {
  constexpr double most_of_edge = 0.1;
  const double edge = shortest_edge(*scene.model);
  if (!interface.bonds_at_start()) return "";
  const double offset = std::abs(interface.setup().common_gap_offset);
  const double limit = most_of_edge * (std::isfinite(edge) ? std::max(edge, offset) : offset);
  if (!(limit > 0.0)) return "";
  const StartGaps gaps = gaps_at_start(scene, interface, 0.0, limit);
  if (gaps.above == 0 || !std::isfinite(gaps.largest)) return "";
  return std::to_string(gaps.above) + " node(s) start bonded across an open gap, " + node(gaps.farthest) +
         " across " + number(gaps.largest);
}

std::string left_out(const Scene&, const Interface& interface, const json&) {
  const std::vector<std::uint8_t>& left = interface.setup().left_out;
  const auto first = std::find(left.begin(), left.end(), 1);
  if (first == left.end()) return "";
  return std::to_string(std::count(first, left.end(), 1)) +
         " node(s) have nothing of the other face below them at the start, " +
         node(interface.nodes()[static_cast<std::size_t>(first - left.begin())]) +
         " first: they have no bond, and no contact by this interface";
}

bool has_memory_in_seconds(const ilaw_law& law) {
  for (std::uint32_t i = 0; i < law.parameter_count; ++i)
    if (std::string_view(law.parameters[i]->name) == "memory")
      return std::string_view(law.parameters[i]->unit) == "s";
  return false;
}

// A node that sticks goes along a chord on a plane, and along a tangent on a round surface.
std::string fast_turn(const Scene& scene, const Interface& interface, const json& source) {
  constexpr double most_of_turn = 0.1, most_of_radius = 0.01;
  if (!source.contains("obstacle")) return "";
  const double rate = source["obstacle"].value("rate", 0.0), in_a_step = std::abs(rate) * scene.dt,
               spread = 0.5 * in_a_step * std::abs(rate) * scene.dt * static_cast<double>(scene.steps);
  if (source["obstacle"]["type"] == "plane")
    return in_a_step > most_of_turn
               ? "found " + number(rate) + ", by which the plane turns by " + formatted("%.2g", in_a_step) +
                     " in a step: friction has the direction of half of it"
               : "";
  if (!interface.bonds_at_once() || !(spread > most_of_radius)) return "";
  return "found " + number(rate) + ": bonds on a round obstacle that turns move away from its axis, by " +
         formatted("%.2g", spread) + " of their distance until the end, and half as much at half the step";
}

// Units of seconds tell what a law keeps.
std::string time_in_prestress(const Scene& scene, const Interface& interface, const json&) {
  const ilaw_law* law = interface.library().law(interface.setup().law);
  if (!scene.prestress || !law) return "";
  const auto is_time = [](const auto* one) { return one->unit && std::string_view(one->unit) == "s"; };
  const auto& given = interface.setup().arguments.numbers;
  const bool keeps =
      std::any_of(law->parameters, law->parameters + law->parameter_count,
                  [&](const ilaw_parameter* one) {
                    const auto at = given.find(one->name);
                    return is_time(one) && at != given.end() && at->second > 0.0;
                  }) ||
      std::any_of(law->state_variables, law->state_variables + law->state_variable_count, is_time);
  return keeps
             ? "law '" + interface.setup().law +
                   "' keeps time, and the steps of the prestress count: what it remembers at time 0 depends "
                   "on how many they were"
             : "";
}

// A window that holds hardly more than the impulse of one step.
std::string short_memory(const Scene& scene, const Interface& interface, const json&) {
  constexpr double least_steps = 2.0;
  const auto& numbers = interface.setup().arguments.numbers;
  const auto memory = numbers.find("memory");
  const ilaw_law* law = interface.library().law(interface.setup().law);
  if (!law || memory == numbers.end() || !has_memory_in_seconds(*law)) return "";
  if (!(memory->second > 0.0) || memory->second >= least_steps * scene.dt) return "";
  return "found " + number(memory->second) + ", less than two steps of " + number(scene.dt) +
         ": whether a load that is not smooth breaks the bond depends on where a step begins; only smaller "
         "steps help";
}

std::string unread_temperature(const Scene&, const Interface& interface, const json& source) {
  const InterfaceSetup& setup = interface.setup();
  if (!setup.heat || !setup.heat->obstacle_temperature) return "";
  if (interface.heat()->reads("counterpart_temperature")) return "";
  return "found " + source["obstacle"]["temperature"].dump() + ", which law '" + setup.law +
         "' does not read: nothing is conducted";
}

// Nodes that are not chosen from a face have the area of all faces there, as a vector: on an edge that is the
// area on no face.
std::string area_of_edges(const Model& model, const std::vector<int>& nodes, const std::vector<double>& areas,
                          double factor) {
  std::set<std::pair<int, double>> of_faces;
  for (const auto& [name, set] : model.sets())
    for (std::size_t k = 0; k < set.nodes.size() && !set.facets.empty(); ++k)
      of_faces.emplace(set.nodes[k], factor * set.areas[k]);
  if (of_faces.empty()) return "";
  for (std::size_t k = 0; k < nodes.size(); ++k)
    if (!of_faces.contains({nodes[k], areas[k]}))
      return node(nodes[k]) + " lies on an edge, where all faces together have the area " + number(areas[k]) +
             ", and no face has it: name one face with \"of\"";
  return "";
}

std::string area_of_law(const Scene& scene, const Interface& interface, const json&) {
  if (!(interface.info().inputs & ILAW_INPUT_AREA) || counterpart_of(interface).shares_partners()) return "";
  const InterfaceSetup& setup = interface.setup();
  return area_of_edges(*scene.model, setup.nodes, setup.areas, setup.area_factor);
}

// Turon, Davila, Camanho, Costa, Engineering Fracture Mechanics 74 (2007): the failure zone of length
// E G/strength^2 needs three elements. Silent where bodies have different moduli.
std::string coarse_zone(const Scene& scene, const Interface& interface, const json&) {
  constexpr double least_elements = 3.0;
  const auto& numbers = interface.setup().arguments.numbers;
  const auto strength = numbers.find("strength"), toughness = numbers.find("toughness");
  std::set<double> moduli;
  for (const char* kind : {"blocks", "meshes"})
    for (const json& body : scene.source["model"].value(kind, json::array()))
      moduli.insert(body["material"]["young"].get<double>());
  if (moduli.size() != 1 || strength == numbers.end() || toughness == numbers.end()) return "";
  const double zone = *moduli.begin() * toughness->second / (strength->second * strength->second),
               edge = shortest_edge(*scene.model);
  const bool breaks = zone > 0.0;  // neither a bond of infinite strength nor one without toughness has a zone
  if (!breaks || !(least_elements * edge > zone)) return "";
  return "found " + number(strength->second) + ", at which the failure zone is " + number(zone) +
         " long, and the shortest edge of an element is " + number(edge) +
         ": fracture follows the mesh unless the zone has three elements";
}

struct InterfaceWarning {
  const char* key;  // below the interface
  std::string (*text)(const Scene&, const Interface&, const json& source);
};
constexpr InterfaceWarning interface_warnings[] = {{"", overlap},
                                                   {"/obstacle/normal", wrong_side},
                                                   {"/against/nodes", partner_twice},
                                                   {"/against/nodes", partner_aside},
                                                   {"", open_bond},
                                                   {"", left_out},
                                                   {"/obstacle/rate", fast_turn},
                                                   {"", time_in_prestress},
                                                   {"/parameters/memory", short_memory},
                                                   {"/obstacle/temperature", unread_temperature},
                                                   {"/nodes", area_of_law},
                                                   {"/parameters/strength", coarse_zone}};

// ---- loads ----------------------------------------------------------------------------------------------

// Two motions that differ drive one axis of a node: the last one does.
void warn_of_motions(Scene& scene) {
  const auto motion = [&](std::size_t k) {
    json load = scene.source["loads"][k];
    for (const char* key : {"name", "nodes", "axes"}) load.erase(key);
    return load;
  };
  std::map<std::pair<int, int>, std::size_t> driven;  // by node and axis
  std::set<std::pair<std::size_t, std::size_t>> alike;
  for (std::size_t k = 0; k < scene.loads.size(); ++k)
    for (const int node_index : scene.loads[k]->prescribed_nodes())
      for (const int axis : scene.loads[k]->prescribed_axes()) {
        const std::size_t first = driven.emplace(std::pair{node_index, axis}, k).first->second;
        if (first == k || alike.contains({first, k})) continue;
        if (motion(first) == motion(k)) {
          alike.insert({first, k});
          continue;
        }
        scene.warnings.push_back(at("/loads", k) + ": " + node(node_index) +
                                 " has another motion along axis " + std::to_string(axis) + " by " +
                                 at("/loads", first) + ": the last one drives it");
        return;
      }
}

void warn_of_heated_edges(Scene& scene) {
  const json loads = scene.source.value("loads", json::array());
  for (std::size_t k = 0; k < loads.size(); ++k) {
    if (loads[k]["type"] != "heat_flux") continue;
    const std::string pointer = at("/loads", k) + "/nodes";
    const NodeSet set = select_nodes(loads[k].value("nodes", json("all")), *scene.model, pointer);
    const std::string text = area_of_edges(*scene.model, set.nodes, set.areas, 1.0);
    if (!text.empty()) scene.warnings.push_back(pointer + ": " + text);
  }
}

void warn_of_fields(Scene& scene) {
  const json fields = scene.source.value("fields", json::object());
  for (const auto& [name, value] : fields.items()) {
    const auto reads = [&of = name](const auto& interface) {
      const ilaw_law* law = interface->library().law(interface->setup().law);
      return law && std::any_of(law->parameters, law->parameters + law->parameter_count,
                                [&](const ilaw_parameter* one) {
                                  return of == one->name && (one->flags & ILAW_FLAG_FIELD);
                                });
    };
    if (std::none_of(scene.interfaces.begin(), scene.interfaces.end(), reads))
      scene.warnings.push_back("/fields/" + name + ": no law of this scene has a field of that name");
  }
}

// ---- bodies ---------------------------------------------------------------------------------------------

// Full elements close to incompressibility can hardly bend. Constant strain locks far earlier than hexahedra
// do.
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

}  // namespace

void add_warnings(Scene& scene) {
  warn_of_times(scene);
  for (const InterfaceWarning& warning : interface_warnings)
    for (std::size_t i = 0; i < scene.source["interfaces"].size(); ++i)
      if (const std::string text = warning.text(scene, *scene.interfaces[i], scene.source["interfaces"][i]);
          !text.empty())
        scene.warnings.push_back(at("/interfaces", i) + warning.key + ": " + text);
  warn_of_motions(scene);
  warn_of_heated_edges(scene);
  warn_of_fields(scene);
  warn_of_locking(scene);
}

}  // namespace ilaw::host
