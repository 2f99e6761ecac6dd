// SPDX-License-Identifier: BSD-3-Clause
#include "results/checkpoint.hpp"

#include "scene/read_meshes.hpp"

#include <cstdint>
#include <sstream>
#include <stdexcept>
#include <utility>
#include <vector>

namespace ilaw::host {
namespace {

using nlohmann::json;

// Identity that must be the same for a checkpoint to fit: the scene, and the laws as they were loaded.
json identity_of(const Scene& scene) {
  json laws = json::array();
  for (const auto& interface : scene.interfaces)
    laws.push_back({{"law", interface->setup().law},
                    {"version", interface->library().plugin().version},
                    {"state_size", interface->info().state_size},
                    {"state_version", interface->info().state_version}});
  return {{"format", "ilaw checkpoint 11"},
          {"program", ILAW_VERSION},
          {"scene", scene.source},
          {"laws", laws},
          {"meshes", marks_of_files(scene.source["model"], scene.file)}};
}

using Bytes = std::vector<std::uint8_t>;

json binary_of(const std::string& bytes) { return json::binary({bytes.begin(), bytes.end()}); }

std::string text_of(const json& binary) {
  const auto& bytes = binary.get_binary();
  return {bytes.begin(), bytes.end()};
}

std::uint32_t checksum_of(const Bytes& bytes) {
  FileMark mark;
  mark.add(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return mark.checksum;
}

json as_json(const FileMark& mark) { return {{"size", mark.size}, {"checksum", mark.checksum}}; }
FileMark mark_of(const json& mark) {
  return {mark.at("size").get<std::uintmax_t>(), mark.at("checksum").get<std::uint32_t>()};
}

// The content that write_checkpoint put into the file; throws where the file has anything else.
json content_of(const std::string& file) {
  const json sealed = json::from_cbor(file);
  const Bytes& bytes = sealed.at("content").get_binary();
  if (checksum_of(bytes) != sealed.at("checksum").get<std::uint32_t>())
    throw std::runtime_error("the checksum does not fit");
  return json::from_cbor(bytes);
}

// The part of a scene that determines its steps, without their end and the keys of output and reading.
json cause_of(json scene) {
  for (const char* key : {"title", "doc", "units", "output", "expect", "exact", "converge", "study"})
    scene.erase(key);
  scene.at("time").erase("end");
  return scene;
}

// Where two values are not the same, and what is there now.
std::string differences(const json& was, const json& is) {
  std::string all;
  for (const json& change : json::diff(was, is))
    all += (all.empty() ? "" : ", ") + change.at("path").get<std::string>() + " is now " +
           change.value("value", json()).dump();
  return all;
}

void check_identity(const json& found, const json& expected) {
  for (const auto& [part, other] :
       {std::pair{"format", "of another format"}, std::pair{"program", "of another version of the program"},
        std::pair{"laws", "of other laws, or of other versions of them"},
        std::pair{"meshes", "of other meshes or points"}})
    if (const json was = found.value(part, json()); was != expected[part])
      throw std::runtime_error("is " + std::string(other) + " (" + differences(was, expected[part]) +
                               "), expected the very run that is to be resumed");
  const json was = cause_of(found.at("scene")), is = cause_of(expected.at("scene"));
  if (was != is)
    throw std::runtime_error(
        "is of another scene: " + json::diff(was, is)[0]["path"].get<std::string>() +
        " differs, expected no difference but in 'title', 'doc', 'units', 'output' and the "
        "'end' of 'time'");
}

constexpr const char* file_name = "checkpoint.cbor";

void check_files(const Checkpoint& checkpoint, const std::filesystem::path& folder) {
  check_begins_with(folder / "history.csv", checkpoint.history);
  if (checkpoint.events.size > 0) check_begins_with(folder / "events.csv", checkpoint.events);
  for (const json& field : checkpoint.fields)
    check_begins_with(folder / field.at("name").get<std::string>(), mark_of(field));
}

}  // namespace

void write_checkpoint(const Scene& scene, const Integrator& integrator, const Checkpoint& checkpoint,
                      const std::filesystem::path& folder) {
  std::ostringstream state;
  integrator.save(state);
  const json content = {{"identity", identity_of(scene)},
                        {"history", as_json(checkpoint.history)},
                        {"history_state", checkpoint.history_state},
                        {"events", as_json(checkpoint.events)},
                        {"touching", checkpoint.touching},
                        {"fields", checkpoint.fields},
                        {"state", binary_of(state.str())}};
  Bytes packed = json::to_cbor(content);
  const std::uint32_t checksum = checksum_of(packed);
  AtomicFile file(folder / file_name);
  json::to_cbor(json{{"checksum", checksum}, {"content", json::binary(std::move(packed))}},
                nlohmann::detail::output_adapter<char>(file.stream()));
  file.commit();
}

Checkpoint read_checkpoint(const Scene& scene, Integrator& integrator, const std::filesystem::path& folder,
                           const std::function<void(const Checkpoint&)>& take) {
  const std::filesystem::path path = folder / file_name;
  std::error_code ignored;
  if (!std::filesystem::exists(std::filesystem::symlink_status(path, ignored)))
    throw std::runtime_error(path.string() + ": found no checkpoint to resume from");
  json content;
  try {
    content = content_of(read_whole(path));
  } catch (const std::exception& error) {
    throw std::runtime_error(path.string() + ": the checkpoint is damaged (" + error.what() + ")");
  }
  Checkpoint checkpoint;
  try {
    check_identity(content["identity"], identity_of(scene));
    checkpoint = {mark_of(content.at("history")), content.at("fields"), content.at("history_state"),
                  mark_of(content.at("events")), content.at("touching")};
    std::istringstream state(text_of(content.at("state")));
    integrator.load(state);
    if (integrator.steps() > scene.steps)
      throw std::runtime_error("is at time " + json(integrator.time()).dump() +
                               " already, expected an 'end' of 'time' that is not before it");
    take(checkpoint);
  } catch (const std::exception& error) {
    throw std::runtime_error(path.string() + ": " + error.what());
  }
  check_files(checkpoint, folder);
  return checkpoint;
}

void clear_checkpoint(const std::filesystem::path& folder) { std::filesystem::remove(folder / file_name); }

}  // namespace ilaw::host
