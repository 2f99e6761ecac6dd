// SPDX-License-Identifier: BSD-3-Clause
#include "stress/random_scene.hpp"

#include "contact/law_arguments.hpp"
#include "scene/arguments.hpp"
#include "stress/draw.hpp"
#include "stress/random_parts.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace ilaw::host {
namespace {

using nlohmann::json;

// A model that a scene may have; step: near the one that the scene will take, where it is known.
struct Body {
  json model;
  json interface_nodes;  // one entry per set of nodes that an interface may have
  int dimension;
  double mass, step;
};

class Scenery {
 public:
  Scenery(const LawBook& laws, const LawBook::Entry& law, std::uint64_t seed, const StressSize& size)
      : laws_(laws), law_(law), size_(size), draw_(seed) {}

  json make(std::uint64_t seed) {
    const Body body = random_body();
    const auto steps = std::max(1.0, draw_.magnitude(0.1, 1.0) * static_cast<double>(size_.steps));
    json scene = {{"title", "seed " + std::to_string(seed)}, {"model", body.model}};
    scene["time"] = random_time(body, steps);
    scene["loads"] = random_loads(body, body.step * steps);
    scene["interfaces"] = random_interfaces(body);
    if (!size_.is_plain) add_motion(scene, body);
    return scene;
  }

 private:
  double speed() { return draw_.chance(0.1) ? 0.0 : draw_.uniform(-1.0, 1.0) * draw_.magnitude(0.1, 3.0); }
  bool serves(int dimension) const {
    return ((law_.law->dimensions >> static_cast<unsigned>(dimension)) & 1U) != 0;
  }
  int any_dimension() {
    std::vector<int> served;
    for (const int d : {1, 2, 3})
      if (serves(d)) served.push_back(d);
    return draw_.one_of(served);
  }

  Body random_body() {
    const int kind = draw_.whole(0, 9);
    if (kind < 2 && serves(1)) return bars();
    if (kind == 2 && serves(2)) return rotating_spring();
    if (kind == 3 && serves(3)) return blocks();
    return points();
  }

  Body points() {
    const int d = any_dimension();
    const bool is_sprung = draw_.chance(0.4);
    const int count = std::max(1, static_cast<int>(draw_.magnitude(1.0, size_.nodes)));
    json points = json::array();
    double mass = 1.0, stiffest = 0.0;
    for (int i = 0; i < count; ++i) {
      mass = draw_.magnitude(1e-4, 1e4);
      json point = {{"mass", mass}, {"position", draw_.vector(d, 1.0)}, {"area", draw_.magnitude(1e-3, 1e3)}};
      if (draw_.chance(0.5)) point["position"][static_cast<std::size_t>(d - 1)] = 0.0;
      for (int c = 0; c < d; ++c) point["velocity"].push_back(speed());
      for (int c = 0; is_sprung && c < d; ++c) {
        const double stiffness = draw_.chance(0.3) ? 0.0 : draw_.magnitude(1e-2, 1e6);
        point["stiffness"].push_back(stiffness);
        stiffest = std::max(stiffest, stiffness / mass);
      }
      points.push_back(point);
    }
    const double step = stiffest > 0.0 ? 2.0 / std::sqrt(stiffest) : draw_.magnitude(1e-4, 1e-2);
    return {{{"type", "points"}, {"dimension", d}, {"points", points}}, json::array({"all"}), d, mass, step};
  }

  Body bars() {
    const int elements = draw_.whole(1, std::max(1, std::min(size_.nodes, 40)));
    const double length = draw_.magnitude(0.1, 10.0), young = draw_.magnitude(1.0, 1e6),
                 density = draw_.magnitude(1e-3, 1e3), section = draw_.magnitude(0.1, 1.0);
    const double gap = draw_.chance(0.5) ? 0.0 : draw_.uniform(0.0, 0.5);
    json bar = {{"name", "b"},    {"start", gap},       {"length", length},   {"elements", elements},
                {"young", young}, {"density", density}, {"section", section}, {"velocity", speed()}};
    return {{{"type", "bars"}, {"bars", json::array({bar})}},
            json::array({"b.left", "b"}),
            1,
            density * section * length / elements,
            length / elements * std::sqrt(density / young)};
  }

  Body rotating_spring() {
    const double mass = draw_.magnitude(1e-2, 1e2), stiffness = draw_.magnitude(1.0, 1e4);
    return {{{"type", "rotating_spring"},
             {"mass", mass},
             {"stiffness", stiffness},
             {"length", 1.0},
             {"position", {draw_.uniform(0.5, 1.2), draw_.uniform(0.0, 0.5)}},
             {"velocity", {speed(), speed()}}},
            json::array({"all"}),
            2,
            mass,
            2.0 / std::sqrt(stiffness / mass)};
  }

  Body blocks() {
    const int most = std::max(1, std::min(3, size_.nodes / 8));
    const double size = draw_.magnitude(0.05, 1.0), young = draw_.magnitude(1e2, 1e6),
                 density = draw_.magnitude(1.0, 1e3), poisson = draw_.uniform(0.0, 0.45);
    const int n = draw_.whole(1, most);
    const char* type = draw_.chance(0.5) ? "linear" : "neo_hookean";
    const double wave = std::sqrt(young / density);
    json velocity = json::array();
    for (int c = 0; c < 3; ++c) velocity.push_back(0.05 * wave * draw_.uniform(-1.0, 1.0));
    json block = {
        {"name", "b"},
        {"corner", {0.0, 0.0, draw_.chance(0.5) ? 0.0 : 0.02 * size}},
        {"size", {size, size, size}},
        {"elements", {n, n, n}},
        {"velocity", velocity},
        {"material", {{"type", type}, {"young", young}, {"poisson", poisson}, {"density", density}}}};
    return {{{"type", "blocks"}, {"blocks", json::array({block})}},
            json::array({"b.z_min"}),
            3,
            density * size * size * size / (n * n * n),
            0.5 * size / n / wave};
  }

  // A spring needs a step below its critical one; some are beyond it. Small steps leave time for little.
  json random_time(const Body& body, double steps) {
    const bool has_critical = body.model["type"] != "points" || body.model["points"][0].contains("stiffness");
    if (!has_critical) return {{"dt", body.step}, {"end", body.step * steps}};
    if (draw_.chance(0.03)) return {{"dt", body.step * draw_.uniform(1.0, 3.0)}, {"end", body.step * steps}};
    const double cfl = draw_.chance(0.3) ? 1.0 - draw_.magnitude(1e-4, 0.1) : draw_.uniform(0.1, 1.0);
    return {{"cfl", cfl}, {"end", body.step * cfl * steps}};
  }

  json random_loads(const Body& body, double end) {
    json loads = json::array();
    const std::vector<double> axis = draw_.direction(body.dimension);
    if (draw_.chance(0.5)) {
      const double gravity = draw_.magnitude(1e-3, 10.0) / std::max(1.0, end);
      loads.push_back({{"type", "gravity"}, {"acceleration", along_last_axis(body.dimension, -gravity)}});
    }
    if (draw_.chance(0.3)) {
      json history = json::array();
      for (double t = 0.0; history.size() < 4; t += draw_.uniform(0.1, 0.4) * end)
        history.push_back({t, body.mass * draw_.uniform(-3.0, 3.0) / end});
      loads.push_back({{"type", "force"}, {"nodes", {0}}, {"direction", axis}, {"history", history}});
    }
    for (int shocks = draw_.whole(0, 4); shocks > 0; --shocks)
      loads.push_back({{"type", "shock"},
                       {"nodes", {0}},
                       {"time", draw_.uniform(0.01, 0.99) * end},
                       {"impulse", draw_.vector(body.dimension, body.mass * draw_.magnitude(1e-4, 10.0))}});
    if (draw_.chance(0.15))
      loads.push_back({{"type", "damping"}, {"rate", draw_.magnitude(1e-3, 10.0) / end}});
    return loads;
  }

  json random_obstacle(const Body& body) {
    const int d = body.dimension;
    const bool is_oblique = d > 1 && draw_.chance(0.3);
    const std::vector<double> normal = is_oblique ? draw_.direction(d) : along_last_axis(d, 1.0);
    json obstacle = {{"type", "plane"}, {"point", draw_.vector(d, 0.0)}, {"normal", normal}};
    if (d > 1 && draw_.chance(0.25)) {
      const std::vector<double> center = along_last_axis(d, -5.0);
      obstacle = {{"type", "sphere"}, {"center", center}, {"radius", 5.0}};
      if (d == 3 && draw_.chance(0.5))
        obstacle = {{"type", "cylinder"}, {"point", center}, {"axis", {0.0, 1.0, 0.0}}, {"radius", 5.0}};
    }
    if (draw_.chance(0.15)) obstacle["velocity"] = draw_.vector(d, 1.0);
    return obstacle;
  }

  // Most draws are refused by laws whose parameters depend on each other: a few tries are made.
  json allowed_parameters(const LawBook::Entry& entry, const Body& body) {
    json made;
    for (int tries = 0; tries < 30; ++tries) {
      made = random_parameters(*entry.law, body.step, draw_);
      try {
        create_law(entry.law->id, read_arguments(made, 1, ""), {}, *entry.library, body.dimension);
        return made;
      } catch (const ilaw::error&) {
      }
    }
    return made;
  }

  json random_interface(const Body& body, const LawBook::Entry& entry, int number) {
    json interface = {{"law", entry.law->id},
                      {"library", std::filesystem::absolute(entry.library->path()).string()},
                      {"name", "i" + std::to_string(number)},
                      {"parameters", allowed_parameters(entry, body)}};
    interface["nodes"] = body.interface_nodes[static_cast<std::size_t>(
        draw_.chance(0.8) ? 0 : draw_.whole(0, static_cast<int>(body.interface_nodes.size()) - 1))];
    interface["obstacle"] = random_obstacle(body);
    return interface;
  }

  json random_interfaces(const Body& body) {
    json interfaces = json::array({random_interface(body, law_, 0)});
    if (draw_.chance(0.15))
      interfaces.push_back(random_interface(body, draw_.one_of(laws_.serving(body.dimension)), 1));
    return interfaces;
  }

  // Drawn after all else, so that the plain scene of a seed stays what it is.
  void add_motion(json& scene, const Body& body) {
    const DrawnScene drawn{body.dimension, body.step, scene["time"]["end"].get<double>()};
    json other;
    if (draw_.chance(0.4)) other = join_a_body(scene, drawn, draw_);
    if (!other.is_null() && draw_.chance(0.3)) {
      Body second = body;
      second.interface_nodes = json::array({other});
      const LawBook::Entry law = draw_.one_of(laws_.serving(body.dimension));
      scene["interfaces"].push_back(
          random_interface(second, law, static_cast<int>(scene["interfaces"].size())));
    }
    for (json& interface : scene["interfaces"])
      if (interface.contains("obstacle") && draw_.chance(0.7))
        set_in_motion(interface["obstacle"], drawn, draw_);
    if (draw_.chance(0.3)) drive_nodes(scene, drawn, draw_);
  }

  const LawBook& laws_;
  const LawBook::Entry& law_;
  const StressSize& size_;
  Draw draw_;
};

}  // namespace

LawBook::LawBook(const std::vector<std::string>& names) {
  if (names.empty())
    for (const std::string& file : ilaw::search()) libraries_.emplace_back(file);
  for (const std::string& name_or_path : names) libraries_.emplace_back(name_or_path);
  for (const ilaw::library& library : libraries_)
    for (std::uint32_t i = 0; i < library.plugin().law_count; ++i)
      if ((library.plugin().laws[i]->delassus_forms & ILAW_DELASSUS_SCALAR) != 0)
        all_.push_back({&library, library.plugin().laws[i]});
}

std::vector<LawBook::Entry> LawBook::serving(int dimension) const {
  std::vector<Entry> found;
  for (const Entry& entry : all_)
    if (((entry.law->dimensions >> static_cast<unsigned>(dimension)) & 1U) != 0) found.push_back(entry);
  return found;
}

json random_scene(const LawBook& laws, const LawBook::Entry& law, std::uint64_t seed,
                  const StressSize& size) {
  return Scenery(laws, law, seed, size).make(seed);
}

}  // namespace ilaw::host
