// Nothing but its own checkpoint will do for a run to go on from. That it goes on to the same bits, of every
// shipped scene and law, is a relation ("resumed", relations_test.cpp); faults/run_folder_test.py interrupts
// anywhere.
#include "results/checkpoint.hpp"
#include "base/bytes.hpp"
#include "host_runner.hpp"

#include <cstring>
#include <new>

namespace ilaw::host::testing {
namespace {

// Nothing to go on from is bad input, found before anything ran: nothing is written.
TEST(Checkpoint, OfNoRunOrAnotherOneIsRefused) {
  const auto folder = fresh_folder();
  const json scene = shipped("postit_test3");
  const std::string file = written(scene, folder), out = " --out " + folder.string();
  const std::string path = (folder / "checkpoint.cbor").string();
  EXPECT_THAT(run_program("run " + file + out + " --resume"),
              Exits(2, HasSubstr(path + ": found no checkpoint to resume from")));
  EXPECT_EQ(run_program("run " + file + " --resume --out " + (folder / "new").string()).code, 2);
  EXPECT_FALSE(fs::exists(folder / "new"));
  ASSERT_EQ(run_program("run " + file + out + " --checkpoint-every 500").code, 0);
  json other = scene;
  other["interfaces"][0]["parameters"]["memory"] = 0.081;
  written(other, folder);
  EXPECT_THAT(run_program("run " + file + out + " --resume"),
              Exits(2, HasSubstr(path + ": is of another scene: /interfaces/0/parameters/memory differs")));
  written(scene, folder);
  fs::remove(folder / "history.csv");
  EXPECT_THAT(run_program("run " + file + out + " --resume"),
              Exits(2, HasSubstr("history.csv: No such file or directory, expected the first ")));
  std::ofstream(folder / "history.csv") << "time\n";
  EXPECT_THAT(run_program("run " + file + out + " --resume").output,
              HasSubstr("history.csv: found 5 bytes, expected"));
  std::ofstream(folder / "checkpoint.cbor") << "damaged";
  EXPECT_EQ(run_program("run " + file + out + " --resume").code, 2);
  EXPECT_EQ(run_program("run " + file + out + " --checkpoint-every 0").code, 2);
}

// The mark of a history of a few bytes, which is written here.
FileMark history_in(const fs::path& folder) {
  std::ofstream(folder / "history.csv") << "time\n";
  FileMark mark;
  mark.add("time\n", 5);
  return mark;
}

// Cut short anywhere, or with one bit turned anywhere, it is told apart from a good one, by name; the program
// then fails without a crash.
TEST(Checkpoint, DamagedAnywhereIsRefused) {
  const auto folder = fresh_folder();
  auto [scene, integrator] = simulation_of(shipped("bouncing_ball"));
  for (int k = 0; k < 100; ++k) integrator.step();
  write_checkpoint(scene, integrator, {history_in(folder), json::array()}, folder);
  const std::string good = text_of(folder / "checkpoint.cbor");
  EXPECT_EQ(read_checkpoint(scene, integrator, folder).history, history_in(folder));
  const auto refusal_of = [&](const std::string& bytes) -> std::string {
    std::ofstream(folder / "checkpoint.cbor", std::ios::binary) << bytes;
    try {
      read_checkpoint(scene, integrator, folder);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "not refused";
  };
  const std::string wanted = (folder / "checkpoint.cbor").string() + ": the checkpoint is damaged";
  const auto expect_refused = [&](const std::string& bytes) {
    const std::string refusal = refusal_of(bytes);
    EXPECT_EQ(refusal.substr(0, wanted.size()), wanted) << refusal;
  };
  std::mt19937 engine(32);
  std::uniform_int_distribution<std::size_t> node_index(0, good.size() - 1);
  for (int k = 0; k < 300; ++k) {
    expect_refused(good.substr(0, node_index(engine)));
    std::string turned = good;
    turned[node_index(engine)] ^= static_cast<char>(1 << (k % 8));
    expect_refused(turned);
  }
  expect_refused("");
  expect_refused("what is this");
  expect_refused(good + "x");
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

TEST(Checkpoint, HoldsAllBitsOfExtendedSums) {
  const long double tenth = 1.0L / 10.0L;
  for (const long double value : {tenth, -3.0L * tenth, 1e300L * tenth, 0.0L, -HUGE_VALL, 1.0L + 0x1p-63L}) {
    std::stringstream bytes;
    write_value(bytes, value);
    long double read = 7.0L;
    read_value(bytes, read);
    EXPECT_EQ(read, value);
  }
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
      read_checkpoint(scene, integrator, folder);
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
}  // namespace ilaw::host::testing
