// SPDX-License-Identifier: BSD-3-Clause
#include "scene/readers.hpp"

#include "base/words.hpp"
#include "scene/json_text.hpp"
#include "scene/scene.hpp"
#include "scene/values.hpp"

#include <algorithm>
#include <set>
#include <string>

namespace ilaw::host {
namespace {

using nlohmann::json;

// The objects that a name may mean.
class Named {
 public:
  explicit Named(const Scene& scene) : scene_(scene) {
    for (std::size_t i = 0; i < scene.interfaces.size(); ++i) {
      const std::string& name = scene.interfaces[i]->name();
      ForceSetup& force = add(name);
      force.interface = static_cast<int>(i);
      for (std::size_t k = i + 1; k < scene.interfaces.size(); ++k)
        if (scene.interfaces[k]->setup().edges_of == name) force.other_side = static_cast<int>(k);
    }
    const json loads = scene.source.value("loads", json::array());
    for (std::size_t i = 0; i < loads.size(); ++i)
      if (loads[i].contains("name")) add_load(loads[i]["name"].get<std::string>(), i);
    const json springs = scene.source.value("springs", json::array());
    for (std::size_t i = 0; i < springs.size(); ++i)
      if (springs[i].contains("name")) add_springs(springs[i], at("/springs", i));
    for (const auto& [name, set] : scene.model->sets()) add_driven(name, set);
  }

  const ForceSetup& find(const std::string& name, const std::string& pointer) const {
    const auto is_named = [&](const ForceSetup& one) { return one.name == name; };
    const auto found = std::find_if(all_.begin(), all_.end(), is_named);
    if (found == all_.end())
      throw mistake(pointer, "\"" + name + "\"",
                    "the name of an interface, of a load, of springs, or of a set that a motion drives: " +
                        known(name));
    if (std::find_if(found + 1, all_.end(), is_named) != all_.end())
      throw mistake(pointer, "\"" + name + "\", which means several things", "a name for one of them alone");
    return *found;
  }

 private:
  ForceSetup& add(const std::string& name) {
    all_.push_back({name, -1, -1, {}, {}, {}, {}});
    return all_.back();
  }

  ForceSetup& add_once(const std::string& name, const std::string& pointer) {
    for (const ForceSetup& one : all_)
      if (one.name == name)
        throw mistake(pointer + "/name", "'" + name + "' twice",
                      "a name that no interface, no load and no other springs have");
    return add(name);
  }

  void add_load(const std::string& name, std::size_t load) {
    add_once(name, at("/loads", load)).loads = {load};
  }

  void add_springs(const json& springs, const std::string& pointer) {
    std::vector<std::string> given_before;
    add_once(springs["name"].get<std::string>(), pointer).springs =
        read_springs(json::array({springs}), *scene_.model, given_before);
  }

  // The reaction of what holds or moves nodes of a set.
  void add_driven(const std::string& name, const NodeSet& set) {
    std::vector<std::size_t> loads;
    const std::set<int> own(set.nodes.begin(), set.nodes.end());
    for (std::size_t k = 0; k < scene_.loads.size(); ++k) {
      const std::vector<int>& driven = scene_.loads[k]->prescribed_nodes();
      if (std::any_of(driven.begin(), driven.end(), [&](int node) { return own.count(node) > 0; }))
        loads.push_back(k);
    }
    if (loads.empty()) return;
    ForceSetup& force = add(name);
    force.loads = loads;
    force.nodes = set.nodes;
  }

  std::string known(const std::string& wanted) const {
    std::vector<std::string> names;
    for (const ForceSetup& one : all_) names.push_back(one.name);
    return names.empty() ? "the scene has none" : joined(names) + suggestion(wanted, names);
  }

  const Scene& scene_;
  std::vector<ForceSetup> all_;
};

}  // namespace

std::vector<ForceSetup> read_forces(const json& forces, const Scene& scene) {
  std::vector<ForceSetup> found;
  const Named named(scene);
  for (std::size_t k = 0; k < forces.size(); ++k) {
    const std::string pointer = at("/output/forces", k);
    const bool plain = forces[k].is_string();
    ForceSetup force = named.find((plain ? forces[k] : forces[k]["of"]).get<std::string>(),
                                  plain ? pointer : pointer + "/of");
    if (std::any_of(found.begin(), found.end(), [&](const auto& one) { return one.name == force.name; }))
      throw mistake(pointer, "'" + force.name + "' twice", "each once");
    if (!plain && forces[k].contains("about")) {
      if (scene.model->dimension() == 1)
        throw mistake(pointer + "/about", forces[k]["about"].dump(), "none: forces on a line have no moment");
      force.about = read_vector(forces[k]["about"], scene.model->dimension(), pointer + "/about");
    }
    found.push_back(std::move(force));
  }
  return found;
}

}  // namespace ilaw::host
