// Scenes, folders and streams that are meant ill, or by mistake.
#include "faults/faults.hpp"

#include <sys/stat.h>

#include <chrono>
#include <csignal>
#include <thread>

namespace ilaw::host::testing {
namespace {

const std::string ball = scene_files::named("bouncing_ball.json").string();

// ---- streams --------------------------------------------------------------------------------------------

TEST(Streams, ThatTakeNothingAreNoSuccess) {
  const auto folder = fresh_folder();
  for (const std::string& command :
       {"run " + ball + " --out " + folder.string(), std::string("list"), std::string("describe contact"),
        std::string("--version"), std::string("--help")}) {
    // stdout alone is full: run_program reads what follows it.
    EXPECT_THAT(run_program(command + " 2>&1 >/dev/full #"),
                Exits(1, StartsWith("ilaw: standard output: cannot be written")))
        << command;
  }
  EXPECT_TRUE(fs::exists(folder / "summary.json"));
}

// No message of a program without stdout or stderr lands in a file that it opens.
TEST(Streams, ThatAreClosedTurnNoMessageIntoResults) {
  json scene = shipped("bouncing_ball");
  scene["time"]["end"] = 0.05;
  scene["output"]["every"] = 1;
  const auto whole = fresh_folder();
  ASSERT_EQ(run_scene(scene, whole).code, 0);
  scene["loads"].push_back(
      {{"type", "shock"}, {"nodes", {0}}, {"time", 9.0}, {"impulse", {0.0}}});  // a warning
  for (const char* closed : {" >&- 2>&- <&- #", " >&- #", " 2>&- #"}) {
    const auto folder = fresh_folder();
    const std::string file = written(scene, folder);
    EXPECT_EQ(run_program("run " + file + " --out " + (folder / "out").string() + closed).code, 0) << closed;
    EXPECT_EQ(text_of(folder / "out" / "history.csv"), text_of(whole / "history.csv")) << closed;
    EXPECT_TRUE(json::accept(text_of(folder / "out" / "summary.json"))) << closed;
  }
}

TEST(Streams, ShowNoControlCharacters) {
  const auto folder = fresh_folder();
  json scene = shipped("bouncing_ball");
  scene["title"] = "a \033[2J title \u009b1m";
  EXPECT_THAT(run_scene(scene, folder), Exits(0, StartsWith("a \\x1b[2J title \\x9b1m: 2500 steps")));
  const auto odd = folder / "no\033[2Jthing.json";
  EXPECT_THAT(run_program("run '" + odd.string() + "' --out " + (folder / "out").string()),
              Exits(2, Not(HasSubstr("\033"))));
}

// ---- folders --------------------------------------------------------------------------------------------

// Whatever a link in the folder leads to stays as it is.
TEST(Folder, HasNoLinkThatIsFollowed) {
  const auto folder = fresh_folder(), out = folder / "out";
  const auto precious = folder / "precious";
  std::ofstream(precious) << "precious";
  json scene = shipped("bouncing_ball");
  scene["time"]["end"] = 0.1;
  scene["output"]["fields"] = 50;
  const std::string command =
      "run " + written(scene, folder) + " --out " + out.string() + " --checkpoint-every 50";
  for (const char* suffix : {"", ".partial"})
    for (const char* name :
         {"history.csv", "summary.json", "checkpoint.cbor", "fields_000000.vtu", "fields.vtu.series"}) {
      fs::remove_all(out);
      fs::create_directories(out);
      fs::create_symlink(precious, out / (std::string(name) + suffix));
      const Outcome outcome = run_program(command);
      EXPECT_EQ(outcome.code, 0) << name << suffix << outcome.output;
      ASSERT_EQ(text_of(precious), "precious") << name << suffix;
      EXPECT_TRUE(fs::is_regular_file(fs::symlink_status(out / name))) << name;
    }
  fs::create_symlink(precious, out / "ilaw.lock");
  EXPECT_THAT(run_program(command), Exits(2, HasSubstr("ilaw.lock: found a symbolic link, expected a file")));
  fs::remove(out / "ilaw.lock");
  fs::rename(out / "history.csv", folder / "history.csv");
  fs::create_symlink(folder / "history.csv", out / "history.csv");
  const std::string before = text_of(folder / "history.csv");
  EXPECT_THAT(run_program(command + " --resume"),
              Exits(2, HasSubstr("history.csv: found a symbolic link, expected a file")));
  EXPECT_EQ(text_of(folder / "history.csv"), before);
}

// A file may be called what is no UTF-8, which JSON cannot hold.
TEST(Folder, MayHaveAnyName) {
  const auto folder = fresh_folder();
  const auto scene = folder / "caf\xe9.json";
  fs::copy(ball, scene);
  const Outcome outcome = run_program("run " + scene.string() + " --out " + (folder / "\xff").string());
  EXPECT_EQ(outcome.code, 0) << outcome.output;
  EXPECT_TRUE(json::accept(text_of(folder / "\xff" / "summary.json")));
}

// ---- scenes ---------------------------------------------------------------------------------------------

TEST(Scene, ThatIsAPipeIsRefused) {
  const auto folder = fresh_folder();
  ASSERT_EQ(mkfifo((folder / "scene.json").c_str(), 0666), 0);
  EXPECT_THAT(run_program("run " + (folder / "scene.json").string() + " --out " + (folder / "out").string(),
                          "timeout 10 "),
              Exits(2, HasSubstr("found something that is no file, expected a scene")));
}

TEST(Scene, IsToldWhichFoldersAreNotSearched) {
  const auto folder = fresh_folder();
  const auto open = folder / "open";
  fs::create_directories(open);
  fs::copy(ILAW_BROKEN_LAW, open / "contact.so");
  fs::permissions(open, fs::perms::all);
  const std::string path = "ILAW_PATH=" + open.string() + ":relative:" ILAW_PLUGIN_FOLDER " ";
  for (const std::string& command :
       {"run " + ball + " --out " + folder.string(), std::string("list"), std::string("describe contact")}) {
    EXPECT_THAT(run_program(command, path),
                Exits(0, AllOf(HasSubstr("ILAW_PATH: " + open.string() +
                                         " is not searched, since every user may write there"),
                               Not(HasSubstr("Breaks a promise")))));
  }
}

TEST(Scene, ThatNoMemoryHoldsIsRefusedBeforeItIsMade) {
  const auto folder = fresh_folder();
  json scene = shipped("block_impact");
  scene["model"]["blocks"][0]["elements"] = {700, 700, 700};
  EXPECT_THAT(
      run_scene(scene, folder, "", "ulimit -v 8000000; "),
      Exits(2, HasSubstr("/model/blocks: found 3.445e+08 nodes, which take 99.2 GB of memory or more, "
                         "expected at most the 8.19 GB that there are")));
  scene = shipped("two_bars");
  for (json& bar : scene["model"]["bars"]) bar["elements"] = 100000000;
  EXPECT_THAT(run_scene(scene, folder, "", "ulimit -v 8000000; "),
              Exits(2, HasSubstr("/model/bars: found 2e+08 nodes")));
}

TEST(Scene, ThatTakesYearsWarns) {
  const auto folder = fresh_folder();
  json scene = shipped("bouncing_ball");
  scene["time"] = {{"dt", 1e-9}, {"end", 1e6}};
  EXPECT_THAT(
      run_scene(scene, folder, "", "timeout -s INT 1 "),
      Exits(124, HasSubstr("warning: /time: found 1e+15 steps, which take some 2.7e+03 days or more")));
}

}  // namespace
}  // namespace ilaw::host::testing
