// The `ilaw` program as a user meets it: exit codes, messages, files.
#include "host_runner.hpp"
#include "program_runner.hpp"

#include <nlohmann/json.hpp>

#include <csignal>
#include <sstream>
#include <thread>

namespace ilaw::host::testing {
namespace {

const std::string ball = std::string(ILAW_SCENES) + "/bouncing_ball.json";

TEST(Program, RunsASceneAndLeavesHistoryAndSummary) {
  const auto folder = fresh_folder();
  const Outcome outcome = run_program("run " + ball + " --out " + folder.string());
  EXPECT_EQ(outcome.code, 0) << outcome.output;
  std::istringstream history(text_of(folder / "history.csv"));
  std::string header, row;
  std::getline(history, header);
  EXPECT_EQ(header.substr(0, 46), "time,n0.u0,n0.v0,n0.r0,n0.gap,n0.status,n1.u0,");
  int rows = 0;
  while (std::getline(history, row)) ++rows;
  EXPECT_EQ(rows, 2500);
  const nlohmann::json summary = nlohmann::json::parse(text_of(folder / "summary.json"));
  EXPECT_EQ(summary["steps"], 2500);
  EXPECT_EQ(summary["dt"], 1e-3);
  for (const char* key : {"kinetic", "internal", "external_work", "interface_work", "balance_error"})
    EXPECT_TRUE(summary["energy"].contains(key)) << key;
  for (const char* key : {"total", "internal_forces", "interfaces", "output"})
    EXPECT_TRUE(summary["seconds"].contains(key)) << key;
  EXPECT_GE(summary["penetration_max"], 0.0);
  EXPECT_EQ(summary["status_counts"]["closed"].get<int>() + summary["status_counts"]["free"].get<int>(),
            7500);
  EXPECT_FALSE(std::filesystem::exists(folder / "history.csv.partial"));
}

TEST(Program, TellsBadInputFromFailureByItsExitCode) {
  const auto folder = fresh_folder();
  EXPECT_EQ(run_program("").code, 2);
  EXPECT_EQ(run_program("walk").code, 2);
  EXPECT_EQ(run_program("run " + ball).code, 2);
  const Outcome missing = run_program("run nowhere.json --out " + (folder / "a").string());
  EXPECT_EQ(missing.code, 2);
  EXPECT_EQ(missing.output, "ilaw: nowhere.json: /: the file cannot be read\n");
  EXPECT_FALSE(std::filesystem::exists(folder / "a"));
  EXPECT_EQ(run_program("run " + ball + " --out " + ball).code, 2);
  EXPECT_EQ(run_program("describe no_such_law").code, 2);
  EXPECT_EQ(run_program("plot " + folder.string()).code, 2);
  for (const char* command : {"", "run", "plot", "list", "describe"}) {
    const Outcome help = run_program(std::string(command) + " --help");
    EXPECT_EQ(help.code, 0);
    EXPECT_NE(help.output.find("Example: "), std::string::npos) << command;
  }
}

TEST(Program, FailsWithCodeOneWhereTheMotionOverflows) {
  const auto folder = fresh_folder();
  std::ofstream(folder / "scene.json") << R"({"model": {"type": "points", "dimension": 1,
    "points": [{"mass": 1e-300, "position": [1.0]}]}, "time": {"dt": 1.0, "end": 3.0},
    "loads": [{"type": "force", "nodes": [0], "direction": [1e300], "history": [[0.0, 1.0]]}], "interfaces": []})";
  const Outcome outcome =
      run_program("run " + (folder / "scene.json").string() + " --out " + folder.string());
  EXPECT_EQ(outcome.code, 1) << outcome.output;
  EXPECT_NE(outcome.output.find("diverged"), std::string::npos) << outcome.output;
}

// Ctrl-C ends the run at the end of a step, with whole files that say so. No progress bar without a terminal.
TEST(Program, LeavesWholeFilesWhenInterrupted) {
  const auto folder = fresh_folder();
  nlohmann::json scene = nlohmann::json::parse(text_of(ball));
  scene["time"]["end"] = 1e6;
  scene["output"]["every"] = 1000;
  std::ofstream(folder / "scene.json") << scene.dump();
  const pid_t child =
      start_program({"run", (folder / "scene.json").string(), "--out", folder.string()}, folder / "messages");
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  kill(child, SIGINT);
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 1);
  const nlohmann::json summary = nlohmann::json::parse(text_of(folder / "summary.json"));
  EXPECT_TRUE(summary["interrupted"]);
  const std::string history = text_of(folder / "history.csv");
  EXPECT_EQ(history.back(), '\n');
  const auto rows = std::count(history.begin(), history.end(), '\n') - 1;
  EXPECT_EQ(rows, summary["steps"].get<std::int64_t>() / 1000);
  const std::string messages = text_of(folder / "messages");
  EXPECT_NE(messages.find("interrupted at step"), std::string::npos);
  EXPECT_EQ(messages.find('\r'), std::string::npos);
}

TEST(Program, DrawsAHistory) {
  const auto folder = fresh_folder();
  ASSERT_EQ(run_program("run " + ball + " --out " + folder.string()).code, 0);
  const Outcome outcome = run_program("plot " + folder.string());
  EXPECT_EQ(outcome.code, 0) << outcome.output;
  EXPECT_EQ(text_of(folder / "history.png").substr(1, 3), "PNG");
  EXPECT_NE(text_of(folder / "history.svg").find("<svg"), std::string::npos);
}

TEST(Program, ListsAndDescribesLaws) {
  const Outcome list = run_program("list");
  EXPECT_EQ(list.code, 0);
  for (const char* law : {"contact", "coulomb", "postit"})
    EXPECT_NE(list.output.find(law), std::string::npos);
  const Outcome described = run_program("describe postit --json");
  const nlohmann::json postit = nlohmann::json::parse(described.output);
  EXPECT_EQ(postit["laws"][0]["id"], "postit");
  EXPECT_EQ(postit["laws"][0]["parameters"].size(), 8U);
  EXPECT_EQ(postit["laws"][0]["parameters"][0]["default"], "inf");
  EXPECT_NE(run_program("describe postit").output.find("tangent_influence"), std::string::npos);
}

}  // namespace
}  // namespace ilaw::host::testing
