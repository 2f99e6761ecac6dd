// Scenes, folders and streams that are meant ill, or by mistake.
#include "faults/faults.hpp"

#include <sys/stat.h>

#include <chrono>
#include <csignal>
#include <thread>

namespace ilaw::host::testing {
namespace {

using nlohmann::json;

const std::string ball = scene_files::named("bouncing_ball.json").string();

Outcome run_scene(const json& scene, const std::filesystem::path& folder, const std::string& before = "") {
  return run_program("run " + written(scene, folder).string() + " --out " + (folder / "out").string(),
                     before);
}

// ---- streams --------------------------------------------------------------------------------------------

TEST(Streams, ThatTakeNothingAreNoSuccess) {
  const auto folder = empty_folder();
  for (const std::string& command :
       {"run " + ball + " --out " + folder.string(), std::string("list"), std::string("describe contact"),
        std::string("--version"), std::string("--help")}) {
    // stdout alone is full: run_program reads what follows it.
    const Outcome outcome = run_program(command + " 2>&1 >/dev/full #");
    EXPECT_EQ(outcome.code, 1) << command;
    EXPECT_EQ(outcome.output.find("ilaw: standard output: cannot be written"), 0U) << outcome.output;
  }
  EXPECT_TRUE(std::filesystem::exists(folder / "summary.json"));
}

// No message of a program without stdout or stderr lands in a file that it opens.
TEST(Streams, ThatAreClosedTurnNoMessageIntoResults) {
  json scene = shipped_scene("bouncing_ball");
  scene["time"]["end"] = 0.05;
  scene["output"]["every"] = 1;
  const auto whole = empty_folder();
  ASSERT_EQ(run_scene(scene, whole).code, 0);
  scene["loads"].push_back(
      {{"type", "shock"}, {"nodes", {0}}, {"time", 9.0}, {"impulse", {0.0}}});  // a warning
  for (const char* closed : {" >&- 2>&- <&- #", " >&- #", " 2>&- #"}) {
    const auto folder = empty_folder();
    const std::string file = written(scene, folder).string();
    EXPECT_EQ(run_program("run " + file + " --out " + (folder / "out").string() + closed).code, 0) << closed;
    EXPECT_EQ(text_of(folder / "out" / "history.csv"), text_of(whole / "out" / "history.csv")) << closed;
    EXPECT_TRUE(json::accept(text_of(folder / "out" / "summary.json"))) << closed;
  }
}

TEST(Streams, ShowNoControlCharacters) {
  const auto folder = empty_folder();
  json scene = shipped_scene("bouncing_ball");
  scene["title"] = "a \033[2J title \u009b1m";
  const Outcome outcome = run_scene(scene, folder);
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.output.find("a \\x1b[2J title \\x9b1m: 2500 steps"), 0U) << outcome.output;
  const auto odd = folder / "no\033[2Jthing.json";
  const Outcome missing = run_program("run '" + odd.string() + "' --out " + (folder / "out").string());
  EXPECT_EQ(missing.code, 2);
  EXPECT_EQ(missing.output.find('\033'), std::string::npos);
}

// ---- folders --------------------------------------------------------------------------------------------

TEST(Folder, IsOfOneRunAtATime) {
  const auto folder = empty_folder(), out = folder / "out";
  json scene = shipped_scene("bouncing_ball");
  scene["time"]["end"] = 1e6;
  scene["output"]["every"] = 1000;
  const std::string file = written(scene, folder).string();
  const pid_t first = start_program({"run", file, "--out", out.string()}, folder / "messages");
  for (int k = 0; k < 5000 && !std::filesystem::exists(out / "history.csv.partial"); ++k)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  const std::string held =
      "ilaw: --out " + out.string() + ": in use by process " + std::to_string(first) + " on ";
  for (const std::string& command : {"run " + ball, "converge " + ball, "run " + file + " --resume"}) {
    const Outcome second = run_program(command + " --out " + out.string());
    EXPECT_EQ(second.code, 2) << command;
    EXPECT_EQ(second.output.find(held), 0U) << second.output;
  }
  EXPECT_TRUE(std::filesystem::exists(out / "history.csv.partial"));
  kill(first, SIGTERM);
  int status = 0;
  waitpid(first, &status, 0);
  EXPECT_FALSE(std::filesystem::exists(out / "ilaw.lock"));
  EXPECT_EQ(run_program("run " + ball + " --out " + out.string()).code, 0);
}

// A process that was killed leaves its lock, which holds nobody back.
TEST(Folder, OfAKilledRunIsFree) {
  const auto folder = empty_folder();
  std::ofstream(folder / "ilaw.lock") << "process 1 on nowhere\n";
  EXPECT_EQ(run_program("run " + ball + " --out " + folder.string()).code, 0);
}

// Whatever a link in the folder leads to stays as it is.
TEST(Folder, HasNoLinkThatIsFollowed) {
  const auto folder = empty_folder(), out = folder / "out";
  const auto precious = folder / "precious";
  std::ofstream(precious) << "precious";
  json scene = shipped_scene("bouncing_ball");
  scene["time"]["end"] = 0.1;
  scene["output"]["fields"] = 50;
  const std::string command =
      "run " + written(scene, folder).string() + " --out " + out.string() + " --checkpoint-every 50";
  for (const char* suffix : {"", ".partial"})
    for (const char* name : {"history.csv", "summary.json", "checkpoint.cbor", "checkpoint.previous.cbor",
                             "fields_000000.vtu", "fields.vtu.series"}) {
      std::filesystem::remove_all(out);
      std::filesystem::create_directories(out);
      std::filesystem::create_symlink(precious, out / (std::string(name) + suffix));
      const Outcome outcome = run_program(command);
      EXPECT_EQ(outcome.code, 0) << name << suffix << outcome.output;
      ASSERT_EQ(text_of(precious), "precious") << name << suffix;
      EXPECT_TRUE(std::filesystem::is_regular_file(std::filesystem::symlink_status(out / name))) << name;
    }
  std::filesystem::create_symlink(precious, out / "ilaw.lock");
  const Outcome locked = run_program(command);
  EXPECT_EQ(locked.code, 2);
  EXPECT_NE(locked.output.find("ilaw.lock: found a symbolic link, expected a file"), std::string::npos)
      << locked.output;
  std::filesystem::remove(out / "ilaw.lock");
  std::filesystem::rename(out / "history.csv", folder / "history.csv");
  std::filesystem::create_symlink(folder / "history.csv", out / "history.csv");
  const std::string before = text_of(folder / "history.csv");
  const Outcome resumed = run_program(command + " --resume");
  EXPECT_EQ(resumed.code, 2);
  EXPECT_NE(resumed.output.find("history.csv: found a symbolic link, expected a file"), std::string::npos)
      << resumed.output;
  EXPECT_EQ(text_of(folder / "history.csv"), before);
}

// A picture that gnuplot could not end does not stand under its name.
TEST(Folder, HasNoPictureThatIsCutShort) {
  const auto folder = empty_folder();
  ASSERT_EQ(run_program("run " + ball + " --out " + folder.string()).code, 0);
  const Outcome full = run_program("plot " + folder.string(), "ulimit -f 48; ");  // 24 KiB
  EXPECT_EQ(full.code, 1) << full.output;
  for (const char* name : {"history.svg", "history.png.drawn", "history.svg.drawn"})
    EXPECT_FALSE(std::filesystem::exists(folder / name)) << name;
  std::filesystem::remove(folder / "history.png");  // which is small enough
  std::ofstream(folder / "precious") << "precious";
  for (const char* name : {"history.png", "history.svg.drawn"})
    std::filesystem::create_symlink(folder / "precious", folder / name);
  EXPECT_EQ(run_program("plot " + folder.string()).code, 0);
  EXPECT_EQ(text_of(folder / "precious"), "precious");
  EXPECT_EQ(text_of(folder / "history.png").substr(1, 3), "PNG");
  EXPECT_FALSE(std::filesystem::exists(folder / "history.svg.drawn"));
}

// A file may be called what is no UTF-8, which JSON cannot hold.
TEST(Folder, MayHaveAnyName) {
  const auto folder = empty_folder();
  const auto scene = folder / "caf\xe9.json";
  std::filesystem::copy(ball, scene);
  const Outcome outcome = run_program("run " + scene.string() + " --out " + (folder / "\xff").string());
  EXPECT_EQ(outcome.code, 0) << outcome.output;
  EXPECT_TRUE(json::accept(text_of(folder / "\xff" / "summary.json")));
}

// ---- scenes ---------------------------------------------------------------------------------------------

TEST(Scene, ThatIsAPipeIsRefused) {
  const auto folder = empty_folder();
  ASSERT_EQ(mkfifo((folder / "scene.json").c_str(), 0666), 0);
  const Outcome outcome = run_program(
      "run " + (folder / "scene.json").string() + " --out " + (folder / "out").string(), "timeout 10 ");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.output.find("found something that is no file, expected a scene"), std::string::npos)
      << outcome.output;
}

TEST(Scene, LoadsNoLibraryByAPathAsItsLaw) {
  const auto folder = empty_folder();
  std::filesystem::copy(ILAW_BROKEN_LAW, folder / "evil.so");
  for (const std::string& law :
       {std::string("../evil"), (folder / "evil.so").string(), std::string("evil/../x")}) {
    json scene = shipped_scene("bouncing_ball");
    scene["interfaces"][0]["law"] = law;
    const Outcome outcome = run_scene(scene, folder, "ILAW_BROKEN=abort_at_load ");
    EXPECT_EQ(outcome.code, 2);
    EXPECT_NE(outcome.output.find("/interfaces/0/law: found \"" + law + "\""), std::string::npos)
        << outcome.output;
  }
}

TEST(Scene, IsToldWhichFoldersAreNotSearched) {
  const auto folder = empty_folder();
  const auto open = folder / "open";
  std::filesystem::create_directories(open);
  std::filesystem::copy(ILAW_BROKEN_LAW, open / "contact.so");
  std::filesystem::permissions(open, std::filesystem::perms::all);
  const std::string path = "ILAW_PATH=" + open.string() + ":relative:" ILAW_PLUGIN_FOLDER " ";
  for (const std::string& command :
       {"run " + ball + " --out " + folder.string(), std::string("list"), std::string("describe contact")}) {
    const Outcome outcome = run_program(command, path);
    EXPECT_EQ(outcome.code, 0) << outcome.output;
    EXPECT_NE(outcome.output.find("ILAW_PATH: " + open.string() +
                                  " is not searched, since every user may write there"),
              std::string::npos)
        << outcome.output;
    EXPECT_EQ(outcome.output.find("Breaks a promise"), std::string::npos) << outcome.output;
  }
}

TEST(Scene, ThatNoMemoryHoldsIsRefusedBeforeItIsMade) {
  const auto folder = empty_folder();
  json scene = shipped_scene("block_impact");
  scene["model"]["blocks"][0]["elements"] = {700, 700, 700};
  const Outcome blocks = run_scene(scene, folder, "ulimit -v 8000000; ");
  EXPECT_EQ(blocks.code, 2);
  EXPECT_NE(blocks.output.find("/model/blocks: found 3.445e+08 nodes, which take 99.2 GB of memory or more, "
                               "expected at most the 8.19 GB that there are"),
            std::string::npos)
      << blocks.output;
  scene = shipped_scene("two_bars");
  for (json& bar : scene["model"]["bars"]) bar["elements"] = 100000000;
  const Outcome bars = run_scene(scene, folder, "ulimit -v 8000000; ");
  EXPECT_EQ(bars.code, 2);
  EXPECT_NE(bars.output.find("/model/bars: found 2e+08 nodes"), std::string::npos) << bars.output;
}

// What a double cannot hold is no result.
TEST(Scene, WhoseEnergyOverflowsDiverged) {
  const auto folder = empty_folder();
  json scene = shipped_scene("bouncing_ball");
  scene["model"]["points"][0]["velocity"] = {1e200};
  const Outcome speed = run_scene(scene, folder);
  EXPECT_EQ(speed.code, 1) << speed.output;
  EXPECT_NE(speed.output.find("the motion diverged: velocity"), std::string::npos) << speed.output;
  EXPECT_NE(json::parse(text_of(folder / "out" / "summary.json"))["failure"], "");
  scene["model"]["points"][0]["velocity"] = {1e150};
  scene["model"]["points"][0]["mass"] = 1e100;
  const Outcome energy = run_scene(scene, folder);
  EXPECT_EQ(energy.code, 1) << energy.output;
  EXPECT_NE(energy.output.find("the motion diverged: the kinetic energy is inf"), std::string::npos)
      << energy.output;
}

TEST(Scene, WithAnAbsurdDirectionIsRefused) {
  const auto folder = empty_folder();
  json scene = shipped_scene("bouncing_ball");
  for (const double length : {1e300, 1e-300, -1e155}) {
    scene["interfaces"][0]["obstacle"]["normal"] = {length};
    const Outcome outcome = run_scene(scene, folder);
    EXPECT_EQ(outcome.code, 2) << "length " << length;
    EXPECT_NE(outcome.output.find("/interfaces/0/obstacle/normal: found " +
                                  scene["interfaces"][0]["obstacle"]["normal"].dump() +
                                  ", expected a direction with a length of 1e-150 to 1e150"),
              std::string::npos)
        << outcome.output;
  }
  scene["interfaces"][0]["obstacle"]["normal"] = {1e149};
  EXPECT_EQ(run_scene(scene, folder).code, 0);
}

TEST(Scene, ThatTakesYearsWarns) {
  const auto folder = empty_folder();
  json scene = shipped_scene("bouncing_ball");
  scene["time"] = {{"dt", 1e-9}, {"end", 1e6}};
  const Outcome outcome = run_scene(scene, folder, "timeout -s INT 1 ");
  EXPECT_EQ(outcome.code, 124) << outcome.output;
  EXPECT_NE(outcome.output.find("warning: /time: found 1e+15 steps, which take some 2.7e+03 days or more"),
            std::string::npos)
      << outcome.output;
}

}  // namespace
}  // namespace ilaw::host::testing
