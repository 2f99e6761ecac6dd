// SPDX-License-Identifier: BSD-3-Clause
#include "scene/scene.hpp"

#include "scene/json_text.hpp"
#include "scene/readers.hpp"
#include "scene/validation.hpp"
#include "scene/values.hpp"
#include "scene/warnings.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <memory>
#include <set>
#include <system_error>
#include <utility>
#include <vector>

namespace ilaw::host {
namespace {

using nlohmann::json;

void read_output(const json& output, Scene& scene) {
  scene.output.every = output.value("every", std::int64_t{1});
  const json balance = output.value("balance", json(false));
  scene.output.balance = balance == true;
  if (balance.is_string()) scene.output.energy = balance.get<std::string>();
  scene.output.contact = output.value("contact", false);
  scene.output.events = output.value("events", false);
  scene.output.fields = output.value("fields", std::int64_t{0});
  const json watch = output.value("watch", json::array());
  for (std::size_t k = 0; k < watch.size(); ++k) {
    for (const int node : select_nodes(watch[k], *scene.model, at("/output/watch", k)).nodes)
      if (std::find(scene.output.watch.begin(), scene.output.watch.end(), node) == scene.output.watch.end())
        scene.output.watch.push_back(node);
  }
  scene.output.forces = read_forces(output.value("forces", json::array()), scene);
}

PrestressSetup read_prestress(const json& given) {
  PrestressSetup setup;
  setup.ramp = given.value("ramp", setup.ramp);
  setup.tolerance = given.value("tolerance", setup.tolerance);
  setup.steps = given.value("steps", setup.steps);
  return setup;
}

void check_names(const Scene& scene) {
  std::set<std::string> seen;
  for (std::size_t i = 0; i < scene.interfaces.size(); ++i)
    if (const std::string& name = scene.interfaces[i]->name(); !seen.insert(name).second) {
      const bool is_own = scene.interfaces[i]->setup().edges_of.empty();
      throw mistake(is_own ? at("/interfaces", i) + "/name" : "/interfaces", "'" + name + "' twice",
                    is_own ? "a different name for each" : "another name: it is that of edge rows");
    }
}

std::string read_file(const std::filesystem::path& file) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  if (status.type() == std::filesystem::file_type::not_found)
    throw SceneError("no such file, expected a scene");
  if (std::filesystem::is_directory(status)) throw SceneError("found a folder, expected a scene");
  if (!error && !std::filesystem::is_regular_file(status))  // a pipe might never end
    throw SceneError("found something that is no file, expected a scene");
  std::ifstream stream(file, std::ios::binary);
  std::string text;
  if (const auto size = std::filesystem::file_size(file, error); !error) text.reserve(size);
  std::array<char, 1 << 16> part{};
  while (stream.read(part.data(), part.size()) || stream.gcount() > 0)
    text.append(part.data(), static_cast<std::size_t>(stream.gcount()));
  if (!stream.is_open() || stream.bad())
    throw SceneError(std::string("the file cannot be read: ") + std::strerror(errno));
  if (text.empty()) throw SceneError("the file is empty, expected a scene");
  return text;
}

}  // namespace

nlohmann::json read_scene_source(const std::filesystem::path& file) {
  nlohmann::json source = parse_scene(read_file(file));
  validate_scene(source);
  return source;
}

Scene read_scene(const std::filesystem::path& file) { return read_scene(read_scene_source(file), file); }

Scene read_scene(nlohmann::json source, const std::filesystem::path& file) {
  Scene scene;
  scene.file = file;
  scene.source = std::move(source);
  scene.title = scene.source.value("title", file.stem().string());
  scene.model = read_model(scene.source["model"], scene.file, scene.meshes);
  read_sets(scene.source.value("sets", json::object()), *scene.model);
  if (scene.source.contains("initial")) read_initial(scene.source["initial"], *scene.model);
  const std::vector<Spring> springs =
      read_springs(scene.source.value("springs", json::array()), *scene.model, scene.warnings);
  if (!springs.empty()) scene.model = std::make_unique<Sprung>(std::move(scene.model), springs);
  scene.model->heat(read_thermal(scene.source["model"], *scene.model));
  if (scene.source.contains("prestress")) scene.prestress = read_prestress(scene.source["prestress"]);
  const json loads = scene.source.value("loads", json::array());
  for (std::size_t i = 0; i < loads.size(); ++i)
    scene.loads.push_back(read_load(loads[i], *scene.model, at("/loads", i)));
  check_held_temperatures(scene);
  read_time(scene.source["time"], scene);
  if (std::any_of(springs.begin(), springs.end(), [](const Spring& spring) { return spring.damping > 0.0; }))
    scene.loads.push_back(std::make_unique<Dampers>(*scene.model, springs));  // after those with a number
  read_interfaces(scene);
  check_names(scene);
  read_output(scene.source.value("output", json::object()), scene);
  add_warnings(scene);
  return scene;
}

}  // namespace ilaw::host
