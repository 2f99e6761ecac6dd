// Any bytes as a scene: read, checked against the schema, and built with its laws; no step is run.
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/scene.hpp"
#include "scene/validation.hpp"

#include "base/scene_error.hpp"

#include <cstdint>
#include <cstdlib>
#include <string>

namespace {

using nlohmann::json;

// Small meshes only: a scene of a million nodes is right, and takes its time and memory.
bool is_small(const json& model) {
  double nodes = 0.0;
  for (const char* bodies : {"bars", "blocks"})
    for (const json& body : model.value(bodies, json::array())) {
      double own = 1.0;
      for (const json& count : body["elements"].is_array() ? body["elements"] : json{body["elements"]})
        own *= count.get<double>() + 1.0;
      nodes += own;
    }
  return nodes <= 1000.0;
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* /*argc*/, char*** /*argv*/) {
  return setenv("ILAW_PATH", ILAW_PLUGIN_FOLDER, 1);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  try {
    json source = ilaw::host::parse_scene(std::string(bytes, bytes + size));
    ilaw::host::validate_scene(source);
    if (is_small(source["model"])) ilaw::host::read_scene(std::move(source), "scene.json");
  } catch (const ilaw::host::SceneError&) {
  }
  return 0;
}
