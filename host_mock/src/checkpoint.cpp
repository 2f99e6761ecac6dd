// SPDX-License-Identifier: BSD-3-Clause
#include "checkpoint.hpp"

#include <fstream>
#include <sstream>
#include <stdexcept>

namespace ilaw::host {
namespace {

using nlohmann::json;

// What must be the same for a checkpoint to fit: the scene, and the laws as they were loaded.
json identity_of(const Scene& scene) {
  json laws = json::array();
  for (const auto& interface : scene.interfaces)
    laws.push_back({{"law", interface->setup().law},
                    {"version", interface->library().plugin().version},
                    {"state_size", interface->info().state_size}});
  return {
      {"format", "ilaw checkpoint 1"}, {"program", ILAW_VERSION}, {"scene", scene.source}, {"laws", laws}};
}

}  // namespace

void write_checkpoint(const Scene& scene, const Integrator& integrator, const Checkpoint& checkpoint,
                      const std::filesystem::path& folder) {
  std::ostringstream state;
  integrator.save(state);
  const std::string bytes = state.str();
  json content = {{"identity", identity_of(scene)},
                  {"history_size", checkpoint.history_size},
                  {"fields", checkpoint.fields},
                  {"state", json::binary({bytes.begin(), bytes.end()})}};
  AtomicFile file(folder / "checkpoint.cbor");
  json::to_cbor(content, nlohmann::detail::output_adapter<char>(file.stream()));
  file.commit();
}

Checkpoint read_checkpoint(const Scene& scene, Integrator& integrator, const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / "checkpoint.cbor";
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error(path.string() + ": found no checkpoint to resume from");
  const json content = json::from_cbor(file, true, false);
  if (content.is_discarded() || !content.is_object() || !content.contains("identity") ||
      !content.contains("state") || !content["state"].is_binary())
    throw std::runtime_error(path.string() + ": the checkpoint is damaged");
  const json identity = identity_of(scene);
  for (const char* part : {"format", "program", "laws", "scene"})
    if (content["identity"].value(part, json()) != identity[part])
      throw std::runtime_error(path.string() + ": is of another " + part +
                               ", expected the very run that is to be resumed");
  const auto& bytes = content["state"].get_binary();
  std::istringstream state(std::string(bytes.begin(), bytes.end()));
  integrator.load(state);
  return {content.at("history_size").get<std::uintmax_t>(), content.at("fields")};
}

}  // namespace ilaw::host
