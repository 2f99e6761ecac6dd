// Laws that break their promises: each ends the run with its name, its library and the step, and no exit code
// 0.
#include "faults/faults.hpp"

#include <chrono>
#include <csignal>
#include <thread>

namespace ilaw::host::testing {
namespace {

// Two points, of which the law sees the second; it breaks its promise in the third step. coupled: in the loop
// of contacts that share nodes.
json scene_with_broken_law(bool coupled) {
  json scene = json::parse(R"({"model": {"type": "points", "dimension": 1, "points": [
      {"mass": 1, "position": [1]}, {"mass": 1, "position": [0.25]}]}, "time": {"dt": 1, "end": 5},
    "interfaces": [{"name": "floor", "law": "broken", "nodes": [1], "skip": false,
                    "obstacle": {"type": "plane", "point": [0], "normal": [1]}}]})");
  scene["interfaces"][0]["library"] = ILAW_BROKEN_LAW;
  if (coupled)
    scene["interfaces"].push_back({{"name", "roof"},
                                   {"law", "contact"},
                                   {"nodes", {1}},
                                   {"obstacle", {{"type", "plane"}, {"point", {9.0}}, {"normal", {-1.0}}}}});
  return scene;
}

Outcome run_breaking(const std::string& promise, bool coupled) {
  return run_scene(scene_with_broken_law(coupled), fresh_folder(), "", "ILAW_BROKEN=" + promise + " ");
}

struct Broken {
  std::string promise, said;
};

class BrokenLaw : public ::testing::TestWithParam<Broken> {};

TEST_P(BrokenLaw, IsNamedAndEndsTheRun) {
  for (const bool coupled : {false, true}) {
    const Outcome outcome = run_breaking(GetParam().promise, coupled);
    EXPECT_EQ(outcome.code, 1) << outcome.output;
    EXPECT_THAT(outcome.output, HasSubstr(GetParam().said));
    for (const char* part : {"law 'broken'", "library " ILAW_BROKEN_LAW, "interface 'floor'", "step "})
      EXPECT_THAT(outcome.output, HasSubstr(part)) << part;
    EXPECT_THAT(outcome.output, Not(HasSubstr("\033"))) << "coupled " << coupled;
  }
}

const Broken faults_broken_law[] = {
    {"status", "after step 2, time 2: interface 'floor' (law 'broken', library " ILAW_BROKEN_LAW
               "): found status 200 at node 1, expected 0 to 7"},
    {"bad_input", "node 1: found the status of bad input, but no code that says so"},
    {"negative_energy", "node 1: found a dissipated energy of -0.5, expected none below 0"},
    {"nan_energy", "node 1: found the energy nan, expected a number"},
    {"nan_impulse", "found the impulse nan, expected a finite one"},
    {"nan_step", "it reported the stable step nan s, expected none below 0"},
    {"negative_step", "it reported the stable step -0.500000 s, expected none below 0"},
    {"rounding", "it changed how the processor rounds"},
    {"traps", "it changed how the processor rounds"},
    {"code", "it returned the code 57, which ABI 1 does not know"},
    {"negative_code", "code -3, no reason given"},
    {"bad_node", "1099511627776"},
    {"wild_reason", "(the library gave a reason that is no readable text)"},
    {"steering_text", "(the library gave a reason that is no readable text)"},
    {"throw", "it threw an exception: what it threw"},
    {"throw_number", "it threw an exception"},
    {"abort", "crashed: Aborted in step 3"},
    {"crash", "crashed: Segmentation fault in step 3"},
    {"stack", "crashed: Segmentation fault in step 3"},
    {"exit", "ended the program in step 3"}};
INSTANTIATE_TEST_SUITE_P(Faults, BrokenLaw, ::testing::ValuesIn(faults_broken_law),
                         [](const auto& drawn) { return drawn.param.promise; });

// Nothing of the above is said of a law that keeps its promises.
TEST(BrokenLaw, ThatKeepsItsPromisesRuns) {
  for (const bool coupled : {false, true}) EXPECT_EQ(run_breaking("nothing", coupled).code, 0);
}

// Energy from nowhere: found in random scenes, which are kept with one node and without what does not matter.
TEST(BrokenLaw, ThatPushesFailsTheStress) {
  const auto folder = fresh_folder();
  const std::string path = fs::path(ILAW_BROKEN_LAW).parent_path().string();
  const auto stress = [&](const char* promise) {
    return run_program("stress --law broken_law --scenes 3 --steps 40 --nodes 20 --keep " + folder.string(),
                       "ILAW_BROKEN=" + std::string(promise) + " ILAW_PATH=" + path + " ");
  };
  const Outcome pushed = stress("push");
  EXPECT_EQ(pushed.code, 1);
  EXPECT_THAT(pushed.output, HasSubstr("seed 1 (broken) failed: energy added by interfaces: found "));
  const json kept = json_of(folder / "broken_1.json");
  EXPECT_THAT(kept["doc"].get<std::string>(), StartsWith("energy added by interfaces: found ")) << kept;
  EXPECT_EQ(kept["model"]["points"].size(), 1U) << kept;
  EXPECT_EQ(kept["interfaces"].size(), 1U) << kept;
  const Outcome sound = stress("nothing");
  EXPECT_EQ(sound.code, 0) << sound.output;
}

TEST(BrokenLaw, ThatHangsEndsAtTheSecondInterrupt) {
  const auto folder = fresh_folder();
  const std::string scene = written(scene_with_broken_law(false), folder);
  setenv("ILAW_BROKEN", "hang", 1);
  const pid_t child = start_program({"run", scene, "--out", (folder / "out").string()}, folder / "messages");
  unsetenv("ILAW_BROKEN");
  for (int k = 0; k < 5000 && !fs::exists(folder / "out" / "history.csv.partial"); ++k)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  int status = 0;
  EXPECT_EQ(waitpid(child, &status, WNOHANG), 0);
  kill(child, SIGINT);
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  EXPECT_EQ(waitpid(child, &status, WNOHANG), 0);
  kill(child, SIGTERM);
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFSIGNALED(status));
  EXPECT_THAT(text_of(folder / "messages"), Not(HasSubstr("broken")));
}

// One run of a sweep crashes; the others have their results, and the crash has the law's name.
TEST(BrokenLaw, ThatCrashesEndsOneRunOfASweep) {
  const auto folder = fresh_folder();
  const Outcome swept = run_program("run " + written(scene_with_broken_law(false), folder) + " --out " +
                                        (folder / "all").string() + " --set /time/end=2,5,1 --threads 2",
                                    "ILAW_BROKEN=crash ");
  EXPECT_THAT(swept, Exits(1, HasSubstr("law 'broken' of interface 'floor' (library " ILAW_BROKEN_LAW
                                        ") crashed: Segmentation fault in step 3")));
  EXPECT_THAT(swept.output, HasSubstr("3 runs, 1 failed; "));
  for (const auto& [name, is_there] : {std::pair{"end=2", true}, {"end=5", false}, {"end=1", true}})
    EXPECT_EQ(fs::exists(folder / "all" / name / "summary.json"), is_there) << name;
}

// Such a library does not take the others with it.
TEST(BrokenLaw, ThatEndsTheProgramWhenItIsLoadedIsListedAsRefused) {
  const auto folder = fresh_folder();
  fs::copy(ILAW_BROKEN_LAW, folder / "broken.so");
  const std::string path = "ILAW_PATH=" + folder.string() + ":" ILAW_PLUGIN_FOLDER " ILAW_BROKEN=";
  for (const auto& [promise, said] : {std::pair{"abort_at_load", "its code crashed: Aborted"},
                                      std::pair{"exit_at_load", "its code ended the program with code 0"}}) {
    EXPECT_THAT(run_program("list", path + promise + " "),
                Exits(0, AllOf(HasSubstr("refused: " + (folder / "broken.so").string() + ": " + said),
                               HasSubstr("coulomb.so"))));
    EXPECT_THAT(run_program("describe broken", path + promise + " "), Exits(1, HasSubstr(said)));
    EXPECT_THAT(run_breaking(promise, false),
                Exits(1, HasSubstr("law 'broken' (library " ILAW_BROKEN_LAW ")")));
  }
}

}  // namespace
}  // namespace ilaw::host::testing
