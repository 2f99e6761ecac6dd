// SPDX-License-Identifier: BSD-3-Clause
#include "results/checkpoint.hpp"

#include "base/files.hpp"

#include <cstdint>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <utility>
#include <vector>

namespace ilaw::host {
namespace {

using nlohmann::json;

// What must be the same for a checkpoint to fit: the scene, and the laws as they were loaded.
json identity_of(const Scene& scene) {
  json laws = json::array();
  for (const auto& interface : scene.interfaces)
    laws.push_back({{"law", interface->setup().law},
                    {"version", interface->library().plugin().version},
                    {"state_size", interface->info().state_size},
                    {"state_version", interface->info().state_version}});
  return {
      {"format", "ilaw checkpoint 3"}, {"program", ILAW_VERSION}, {"scene", scene.source}, {"laws", laws}};
}

using Bytes = std::vector<std::uint8_t>;

json binary_of(const std::string& bytes) { return json::binary({bytes.begin(), bytes.end()}); }

std::string text_of(const json& binary) {
  const auto& bytes = binary.get_binary();
  return {bytes.begin(), bytes.end()};
}

// FNV-1a: tells a damaged file, not a forged one.
std::uint64_t checksum_of(const Bytes& bytes) {
  std::uint64_t sum = 0xcbf29ce484222325;
  for (const std::uint8_t byte : bytes) sum = (sum ^ byte) * 0x100000001b3;
  return sum;
}

// What write_checkpoint put into the file; throws where that is not what it finds.
json content_of(std::istream& file) {
  const json sealed = json::from_cbor(file);
  const Bytes& bytes = sealed.at("content").get_binary();
  if (checksum_of(bytes) != sealed.at("checksum").get<std::uint64_t>())
    throw std::runtime_error("the checksum does not fit");
  return json::from_cbor(bytes);
}

void check_identity(const json& found, const json& expected) {
  for (const auto& [part, other] :
       {std::pair{"format", "of another format"}, std::pair{"program", "of another version of the program"},
        std::pair{"laws", "of other laws, or of other versions of them"},
        std::pair{"scene", "of another scene"}})
    if (found.value(part, json()) != expected[part])
      throw std::runtime_error("is " + std::string(other) + ", expected the very run that is to be resumed");
}

}  // namespace

void write_checkpoint(const Scene& scene, const Integrator& integrator, const Checkpoint& checkpoint,
                      const std::filesystem::path& folder) {
  std::ostringstream state;
  integrator.save(state);
  const json content = {{"identity", identity_of(scene)},        {"history_size", checkpoint.history_size},
                        {"fields", checkpoint.fields},           {"history", binary_of(checkpoint.history)},
                        {"events_size", checkpoint.events_size}, {"events", binary_of(checkpoint.events)},
                        {"state", binary_of(state.str())}};
  Bytes packed = json::to_cbor(content);
  const std::uint64_t checksum = checksum_of(packed);
  AtomicFile file(folder / "checkpoint.cbor");
  json::to_cbor(json{{"checksum", checksum}, {"content", json::binary(std::move(packed))}},
                nlohmann::detail::output_adapter<char>(file.stream()));
  file.commit();
}

Checkpoint read_checkpoint(const Scene& scene, Integrator& integrator, const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / "checkpoint.cbor";
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error(path.string() + ": found no checkpoint to resume from");
  json content;
  try {
    content = content_of(file);
  } catch (const std::exception& error) {
    throw std::runtime_error(path.string() + ": the checkpoint is damaged (" + error.what() + ")");
  }
  try {
    check_identity(content["identity"], identity_of(scene));
    std::istringstream state(text_of(content["state"]));
    integrator.load(state);
    return {content.at("history_size").get<std::uintmax_t>(), content.at("fields"),
            text_of(content.at("history")), content.at("events_size").get<std::uintmax_t>(),
            text_of(content.at("events"))};
  } catch (const std::exception& error) {
    throw std::runtime_error(path.string() + ": " + error.what());
  }
}

}  // namespace ilaw::host
