// Nothing but its own checkpoint will do for a run to go on from. That it goes on to the same bits, of every
// shipped scene and law, is a relation ("resumed", relations_test.cpp); faults/run_folder_test.py interrupts
// anywhere.
#include "results/checkpoint.hpp"
#include "base/bytes.hpp"
#include "host_runner.hpp"

#include <cstring>
#include <new>

namespace ilaw::host::testing::checkpoint {
namespace {

// The mark of a history of a few bytes, which is written here.
FileMark history_in(const fs::path& folder) {
  std::ofstream(folder / "history.csv") << "time\n";
  FileMark mark;
  mark.add("time\n", 5);
  return mark;
}

// A checkpoint with one value of its content changed, under a checksum that fits.
std::string resealed(const std::string& bytes, const std::string& pointer, const json& value) {
  json content = json::from_cbor(json::from_cbor(bytes)["content"].get_binary());
  content.at(json::json_pointer(pointer)) = value;
  std::vector<std::uint8_t> packed = json::to_cbor(content);
  FileMark mark;
  mark.add(reinterpret_cast<const char*>(packed.data()), packed.size());
  const std::vector<std::uint8_t> sealed =
      json::to_cbor(json{{"checksum", mark.checksum}, {"content", json::binary(std::move(packed))}});
  return {sealed.begin(), sealed.end()};
}

// All is read before any file is renamed.
TEST(Checkpoint, ThatCannotBeReadLeavesTheFolder) {
  json scene = shipped("postit_test3");
  scene["time"]["end"] = 0.3;
  scene["output"] = {{"every", 5}, {"watch", {0}}, {"events", true}};
  const auto folder = fresh_folder();
  const std::string command =
      "run " + written(scene, folder) + " --out " + folder.string() + " --checkpoint-every 100";
  ASSERT_EQ(run_program(command).code, 0);
  const std::string good = text_of(folder / "checkpoint.cbor");
  const auto files_of = [&] {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::directory_iterator(folder))
      files[entry.path().filename().string()] = text_of(entry.path());
    return files;
  };
  for (const char* part : {"/history_state/late_sums", "/history_state", "/touching"}) {
    std::ofstream(folder / "checkpoint.cbor", std::ios::binary) << resealed(good, part, 3);
    const auto before = files_of();
    EXPECT_THAT(run_program(command + " --resume"), Exits(2, HasSubstr("checkpoint.cbor"))) << part;
    EXPECT_EQ(files_of(), before) << part;
  }
}

// The file holds no bytes that lay in memory before: equal sums and counts give equal bytes.
TEST(Checkpoint, OfEqualAccountsIsEqualBytes) {
  std::array<std::string, 2> written;
  for (const int byte : {0, 1}) {
    alignas(Accounts) std::array<unsigned char, sizeof(Accounts)> room;
    room.fill(static_cast<unsigned char>(0xFF * byte));
    asm volatile("" : : "r"(room.data()) : "memory");  // what a constructor leaves alone is kept
    const auto* accounts = new (room.data()) Accounts;
    std::ostringstream bytes;
    accounts->save(bytes);
    written[static_cast<std::size_t>(byte)] = bytes.str();
    accounts->~Accounts();
  }
  EXPECT_EQ(written[0], written[1]);
}

// A law that reads states in another way says so by its state_version, whatever its library's version.
TEST(Checkpoint, OfAnotherLawOrStateVersionIsRefused) {
  const auto folder = fresh_folder();
  Scene scene = scene_of(shipped("postit_test3").dump());
  Integrator integrator = integrator_of(scene);
  write_checkpoint(scene, integrator, {history_in(folder), json::array()}, folder);
  const std::string good = text_of(folder / "checkpoint.cbor");
  const auto refusal_of = [&](const std::string& key, const json& value) -> std::string {
    std::ofstream(folder / "checkpoint.cbor", std::ios::binary)
        << resealed(good, "/identity/laws/0/" + key, value);
    try {
      read_checkpoint(scene, integrator, folder, [](const Checkpoint&) {});
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  };
  const std::uint32_t version = scene.interfaces[0]->info().state_version;
  EXPECT_EQ(refusal_of("state_version", version), "");
  for (const auto& [key, value] : std::multimap<std::string, json>{{"state_version", version + 1},
                                                                   {"state_version", version - 1},
                                                                   {"state_size", 1},
                                                                   {"version", "0.0.1"},
                                                                   {"law", "tie"}}) {
    const std::string reason = refusal_of(key, value);
    EXPECT_THAT(reason, HasSubstr("is of other laws"));
    EXPECT_THAT(reason, HasSubstr("/0/" + key + " is now "));
  }
}

}  // namespace
}  // namespace ilaw::host::testing::checkpoint
