// The `ilaw` program as a user sees it: exit codes, messages, files.
#include "host_runner.hpp"
#include "program_runner.hpp"

#include <nlohmann/json.hpp>

#include <pty.h>

#include <csignal>
#include <regex>
#include <set>
#include <sstream>
#include <thread>

namespace ilaw::host::testing {
namespace {

const std::string ball = scene_files::named("bouncing_ball.json").string();

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
  EXPECT_EQ(missing.output, "ilaw: nowhere.json: no such file, expected a scene\n");
  EXPECT_FALSE(std::filesystem::exists(folder / "a"));
  EXPECT_NE(run_program("run " + ball + " --out " + ball).output.find("expected a folder (Not a directory)"),
            std::string::npos);
  for (const char* command : {"run ", "converge "}) {  // a folder in which nobody can make a file
    const Outcome unwritable = run_program(command + ball + " --out /proc");
    EXPECT_EQ(unwritable.code, 2);
    EXPECT_EQ(unwritable.output.find("ilaw: --out /proc: "), 0U) << unwritable.output;
  }
  EXPECT_EQ(run_program("describe no_such_law").code, 2);
  const Outcome empty = run_program("plot " + folder.string());
  EXPECT_EQ(empty.code, 2);
  EXPECT_EQ(empty.output, "ilaw: " + (folder / "history.csv").string() +
                              ": found no such file, expected the history of watched nodes that `ilaw run "
                              "SCENE --out " +
                              folder.string() + "` writes\n");
  EXPECT_EQ(run_program("plot " + ball).output,
            "ilaw: " + ball + ": found a file, expected a folder that `ilaw run SCENE --out FOLDER` wrote\n");
  for (const char* command :
       {"", "run", "plot", "converge", "study", "list", "describe", "stress", "check", "bench"}) {
    const Outcome help = run_program(std::string(command) + " --help");
    EXPECT_EQ(help.code, 0);
    EXPECT_NE(help.output.find("Example: "), std::string::npos) << command;
  }
}

// Whole or not at all, as every file; a device is not replaced by a file.
TEST(Program, WritesTheReportOfACheck) {
  const auto folder = fresh_folder();
  const auto report_to = [&](const std::string& file) {
    return run_program("check " ILAW_PLUGIN_FOLDER "/contact.so --only library-opens --junit " + file,
                       "cd " + folder.string() + "; ");
  };
  EXPECT_EQ(report_to("report.xml").code, 0);
  EXPECT_NE(text_of(folder / "report.xml").find("</testsuite>"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder / "report.xml.partial"));
  const Outcome nowhere = report_to("none/report.xml");
  EXPECT_EQ(nowhere.code, 1);
  EXPECT_NE(nowhere.output.find("none/report.xml"), std::string::npos) << nowhere.output;
  const Outcome device = report_to("/dev/full");
  EXPECT_EQ(device.code, 2);
  EXPECT_EQ(device.output.find("ilaw: /dev/full: not a regular file"), 0U) << device.output;
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/full"));
  // Written at once: what is left in the buffer at the end is not refused any more.
  EXPECT_EQ(run_command(ILAW_PROGRAM " check --rules >/dev/full").code, 1);
}

TEST(Program, SaysWhyASceneCannotBeRead) {
  const auto folder = fresh_folder();
  const auto output_of = [&](const std::string& scene) {
    return run_program("run " + scene + " --out " + (folder / "out").string()).output;
  };
  EXPECT_EQ(output_of(folder.string()), "ilaw: " + folder.string() + ": found a folder, expected a scene\n");
  const std::string file = (folder / "scene.json").string();
  std::ofstream(file).close();
  EXPECT_EQ(output_of(file), "ilaw: " + file + ": the file is empty, expected a scene\n");
  if (geteuid() != 0) {  // root may read everything
    std::filesystem::permissions(file, std::filesystem::perms::none);
    EXPECT_EQ(output_of(file), "ilaw: " + file + ": the file cannot be read: Permission denied\n");
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

// 0 where no rule is broken, 1 where one is, 2 where there is nothing to check. What is found: tests/check.
TEST(Program, ChecksALibrary) {
  const Outcome sound = run_program("check coulomb --law coulomb --only mirror --json");
  EXPECT_EQ(sound.code, 0) << sound.output;
  EXPECT_EQ(nlohmann::json::parse(sound.output).at(0).at("result"), "passed");
  const Outcome odd = run_program("check " ILAW_ODD_STATUS " --only status-meaning");
  EXPECT_EQ(odd.code, 1) << odd.output;
  EXPECT_NE(odd.output.find("seen:    status 42"), std::string::npos) << odd.output;
  for (const char* wrong :
       {"check", "check no_such_law", "check coulomb --only nonsense", "check coulomb --law tie"})
    EXPECT_EQ(run_program(wrong).code, 2) << wrong;
  EXPECT_EQ(run_program("check coulomb --only mirror --junit /dev/full/report.xml").code, 1);
  EXPECT_EQ(
      run_program("check coulomb --only mirror --seed 4 --seed 5 --parameters '{\"friction\": \"inf\"}'")
          .code,
      0);
  const std::pair<const char*, const char*> refused[] = {
      {"'{\"friction\": -0.5}'", "law 'coulomb' refuses the parameters: "},
      {"'{\"friction\": [1]}'", "parameter 'friction' is [1], expected a number, \"inf\" or a text"},
      {"'{\"friction\"'", "--parameters: found no JSON object"},
      {"no_such_file", "no_such_file: cannot be read"}};
  for (const auto& [parameters, said] : refused) {
    const Outcome outcome =
        run_program(std::string("check coulomb --only mirror --parameters ") + parameters);
    EXPECT_EQ(outcome.code, 2) << outcome.output;
    EXPECT_NE(outcome.output.find(said), std::string::npos) << outcome.output;
  }
  EXPECT_NE(run_program("check --rules").output.find("| `purity-twice` | "), std::string::npos);
}

// The same checks and exit codes without a host.
TEST(Program, ChecksALibraryByAProgramOfItsOwn) {
  const std::string program = ILAW_CHECK_PROGRAM;
  const Outcome sound = run_command(program + " coulomb --law coulomb --only mirror --json");
  EXPECT_EQ(sound.code, 0) << sound.output;
  EXPECT_EQ(nlohmann::json::parse(sound.output).at(0).at("result"), "passed");
  EXPECT_EQ(run_command(program + " " ILAW_ODD_STATUS " --only status-meaning").code, 1);
  const Outcome nothing = run_command(program + " no_such_law");
  EXPECT_EQ(nothing.code, 2);
  EXPECT_EQ(nothing.output.find("ilaw-check: "), 0U) << nothing.output;
  const Outcome help = run_command(program + " --help");
  EXPECT_EQ(help.code, 0);
  EXPECT_NE(help.output.find("Example: ilaw-check "), std::string::npos) << help.output;
  EXPECT_EQ(run_command(program + " --rules >/dev/full").code, 1);
}

// What is misspelt is named, rather than what is missing for it.
TEST(Program, NamesWhatItDoesNotKnow) {
  const auto first_line = [](const std::string& arguments) {
    const std::string output = run_program(arguments).output;
    return output.substr(0, output.find('\n'));
  };
  EXPECT_EQ(
      first_line("rnu"),
      "ilaw: found 'rnu', expected one of run, plot, table, converge, study, stress, list, describe, check, "
      "bench, --help, --version");
  EXPECT_EQ(
      first_line("run " + ball + " --outt here"),
      "ilaw: found '--outt', expected one of --help, --out, --checkpoint-every, --resume, --threads, --set");
  EXPECT_EQ(first_line("run " + ball), "ilaw: --out is required");
  EXPECT_EQ(first_line("run " + ball + " --out here --threads 0"),
            "ilaw: --threads: Value 0 not in range 1 to 1024");
  EXPECT_EQ(first_line("run " + ball + " --out here --checkpoint-every 0").size(),
            std::string("ilaw: --checkpoint-every: Value 0 not in range 1 to 1000000000000000").size());
}

// The law is not blamed for the velocities that it is given.
TEST(Program, FailsWithCodeOneWhereTheMotionOverflows) {
  const auto folder = fresh_folder();
  std::ofstream(folder / "scene.json") << R"({"model": {"type": "points", "dimension": 1,
    "points": [{"mass": 1e-300, "position": [1.0]}]}, "time": {"dt": 1.0, "end": 3.0},
    "loads": [{"type": "force", "nodes": [0], "direction": [1e300], "history": [[0.5, 0.0], [1.5, 1.0]]}],
    "interfaces": [{"law": "contact", "nodes": "all", "skip": false,
                    "obstacle": {"type": "plane", "point": [0], "normal": [1]}}]})";
  const Outcome outcome =
      run_program("run " + (folder / "scene.json").string() + " --out " + folder.string());
  EXPECT_EQ(outcome.code, 1) << outcome.output;
  EXPECT_NE(outcome.output.find("the motion diverged: velocity inf at node 0, step 1, time 1.0"),
            std::string::npos)
      << outcome.output;
}

// A library that breaks its promise is named, with the node.
// Two points at a plane, of which a library sees the second.
Outcome run_with(const std::string& library) {
  const auto folder = fresh_folder();
  std::ofstream(folder / "scene.json") << R"({"model": {"type": "points", "dimension": 1, "points": [
      {"mass": 1, "position": [1]}, {"mass": 1, "position": [0]}]}, "time": {"dt": 0.5, "end": 1},
    "interfaces": [{"name": "floor", "law": "zero", "library": ")"
                                       << library << R"(", "nodes": [1], "skip": false,
                    "obstacle": {"type": "plane", "point": [0], "normal": [1]}}]})";
  return run_program("run " + (folder / "scene.json").string() + " --out " + folder.string());
}

// The report names a node that is none: it must not lead anywhere.
TEST(Program, FailsWithCodeOneWhereALawMakesUpABadNode) {
  const Outcome outcome = run_with(ILAW_ODD_NODE);
  EXPECT_EQ(outcome.code, 1) << outcome.output;
  EXPECT_NE(outcome.output.find("interface 'floor' (law 'zero', library " ILAW_ODD_NODE
                                "): it named node 1099511627776, which is none of the batch"),
            std::string::npos)
      << outcome.output;
}

TEST(Program, FailsWithCodeOneWhereALawGivesAnUnknownStatus) {
  const Outcome outcome = run_with(ILAW_ODD_STATUS);
  EXPECT_EQ(outcome.code, 1) << outcome.output;
  EXPECT_NE(outcome.output.find("interface 'floor' (law 'zero', library " ILAW_ODD_STATUS
                                "): found status 42 at node 1, expected 0 to 7"),
            std::string::npos)
      << outcome.output;
}

TEST(Program, TellsWarningsAndRuns) {
  const auto folder = fresh_folder();
  nlohmann::json scene = nlohmann::json::parse(text_of(ball));
  scene["output"]["every"] = 5000;
  const std::string file = (folder / "scene.json").string();
  std::ofstream(file) << scene.dump();
  const Outcome outcome = run_program("run " + file + " --out " + folder.string());
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.output.find("ilaw: " + file + ": warning: /output/every: found 5000"), 0U)
      << outcome.output;
  EXPECT_EQ(nlohmann::json::parse(text_of(folder / "summary.json"))["warnings"].size(), 1U);
}

// What an earlier run left and this one does not replace would be taken for its own.
// A pipe whose reader has gone is an output that cannot be written, no end by a signal.
TEST(Program, SaysThatItsReaderHasLeft) {
  const std::string folder = fresh_folder().string(),
                    scene = scene_files::named("impact_oscillator.json").string();
  const Outcome outcome = run_command("(exec 3>&1; (sleep 0.3; " ILAW_PROGRAM " run " + scene + " --out " +
                                      folder + " 2>&3; echo code $? >&3) | true)");
  EXPECT_NE(outcome.output.find("ilaw: standard output: cannot be written"), std::string::npos)
      << outcome.output;
  EXPECT_NE(outcome.output.find("code 1\n"), std::string::npos) << outcome.output;
}

TEST(Program, RemovesTheFieldsOfAnEarlierRun) {
  const auto folder = fresh_folder();
  nlohmann::json scene = nlohmann::json::parse(text_of(ball));
  const std::string file = (folder / "scene.json").string(),
                    command = "run " + file + " --out " + folder.string();
  scene["output"]["fields"] = 1000;
  std::ofstream(file) << scene.dump();
  ASSERT_EQ(run_program(command).code, 0);
  ASSERT_TRUE(std::filesystem::exists(folder / "fields_000002.vtu"));
  std::ofstream(folder / "fields_of_mine.vtu") << "mine";
  scene["output"].erase("fields");
  std::ofstream(file) << scene.dump();
  ASSERT_EQ(run_program(command).code, 0);
  EXPECT_FALSE(std::filesystem::exists(folder / "fields.vtu.series"));
  EXPECT_FALSE(std::filesystem::exists(folder / "fields_000002.vtu"));
  EXPECT_TRUE(std::filesystem::exists(folder / "fields_of_mine.vtu"));
}

class Stopped : public ::testing::TestWithParam<int> {};

// Ctrl-C and kill end the run at the end of a step, with whole files that say so. No progress bar without a
// terminal.
TEST_P(Stopped, LeavesWholeFiles) {
  const auto folder = fresh_folder();
  nlohmann::json scene = nlohmann::json::parse(text_of(ball));
  scene["time"]["end"] = 1e6;
  scene["output"]["every"] = 1000;
  scene["output"]["fields"] = 100000;
  std::ofstream(folder / "scene.json") << scene.dump();
  const pid_t child =
      start_program({"run", (folder / "scene.json").string(), "--out", folder.string()}, folder / "messages");
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  EXPECT_FALSE(std::filesystem::exists(folder / "history.csv"));  // not whole yet
  kill(child, GetParam());
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 1);
  const nlohmann::json summary = nlohmann::json::parse(text_of(folder / "summary.json"));
  EXPECT_TRUE(summary["interrupted"]);
  const auto steps = summary["steps"].get<std::int64_t>();
  const std::string history = text_of(folder / "history.csv");
  EXPECT_EQ(history.back(), '\n');
  EXPECT_EQ(std::count(history.begin(), history.end(), '\n') - 1, steps / 1000);
  const nlohmann::json series = nlohmann::json::parse(text_of(folder / "fields.vtu.series"));
  EXPECT_EQ(series["files"].size(), 1U + static_cast<std::size_t>(steps / 100000));
  for (const auto& file : series["files"])
    EXPECT_TRUE(std::filesystem::exists(folder / file["name"].get<std::string>()));
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    EXPECT_NE(entry.path().extension(), ".partial") << entry.path();
  const std::string messages = text_of(folder / "messages");
  EXPECT_NE(messages.find("interrupted at step"), std::string::npos);
  EXPECT_EQ(messages.find('\r'), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(Program, Stopped, ::testing::Values(SIGINT, SIGTERM),
                         [](const auto& drawn) { return std::string(sigabbrev_np(drawn.param)); });

// ---- progress -------------------------------------------------------------------------------------------

// What a run says on a terminal of its own.
std::string said_on_terminal(const std::string& scene, const std::filesystem::path& folder) {
  int terminal = -1;
  const pid_t child = forkpty(&terminal, nullptr, nullptr, nullptr);
  if (child == 0) {
    execl(ILAW_PROGRAM, ILAW_PROGRAM, "run", scene.c_str(), "--out", folder.c_str(), nullptr);
    _exit(127);
  }
  std::string said;
  std::array<char, 4096> buffer{};
  for (ssize_t got; (got = read(terminal, buffer.data(), buffer.size())) > 0;)
    said.append(buffer.data(), static_cast<std::size_t>(got));
  close(terminal);
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 0) << said;
  return said;
}

// A bar with its part done and the time left, redrawn in place and wiped in the end, before the line that
// stays.
TEST(Program, ShowsItsProgressOnATerminalOnly) {
  const auto folder = fresh_folder();
  nlohmann::json scene = nlohmann::json::parse(text_of(ball));
  scene["time"]["end"] = 200.0;
  scene["output"] = {{"every", 100000}};
  std::ofstream(folder / "scene.json") << scene.dump();
  const std::string file = (folder / "scene.json").string();
  const std::string said = said_on_terminal(file, folder);
  const std::regex bar("\\r\\[(#*)(\\.*)\\] +([0-9]+) %  [0-9]+ s left ");
  int last = -1;
  std::ptrdiff_t bars = 0;
  for (std::sregex_iterator found(said.begin(), said.end(), bar), end; found != end; ++found, ++bars) {
    const int percent = std::stoi((*found)[3]);
    EXPECT_GE(percent, last);
    EXPECT_LE(percent, 100);
    EXPECT_EQ((*found)[1].length() + (*found)[2].length(), 30);
    EXPECT_NEAR(static_cast<double>((*found)[1].length()), 0.3 * percent, 1.2);
    last = percent;
  }
  EXPECT_GE(bars, 1) << "too fast a machine, or no bar: " << said;
  const auto wiped = said.rfind("\r\033[K"), result = said.find("steps to time 200");
  ASSERT_NE(wiped, std::string::npos);
  ASSERT_NE(result, std::string::npos) << said;
  EXPECT_LT(wiped, result);
  const Outcome piped = run_program("run " + file + " --out " + folder.string());
  EXPECT_EQ(piped.code, 0);
  EXPECT_EQ(piped.output.find('\r'), std::string::npos);
  EXPECT_EQ(std::count(piped.output.begin(), piped.output.end(), '\n'), 1);
}

TEST(Program, DrawsNothingForAShortRun) {
  const auto folder = fresh_folder();
  EXPECT_EQ(said_on_terminal(ball, folder).find('['), std::string::npos);
}

TEST(Program, DrawsAHistory) {
  const auto folder = fresh_folder();
  ASSERT_EQ(run_program("run " + ball + " --out " + folder.string()).code, 0);
  const Outcome outcome = run_program("plot " + folder.string());
  EXPECT_EQ(outcome.code, 0) << outcome.output;
  EXPECT_EQ(text_of(folder / "history.png").substr(1, 3), "PNG");
  EXPECT_NE(text_of(folder / "history.svg").find("<svg"), std::string::npos);
  // Elsewhere, if asked to.
  std::filesystem::create_directories(folder / "pictures");
  const std::string elsewhere = "plot " + folder.string() + " --out " + (folder / "pictures").string();
  ASSERT_EQ(run_program(elsewhere).code, 0);
  EXPECT_EQ(text_of(folder / "pictures" / "history.png").substr(1, 3), "PNG");
  EXPECT_EQ(run_program(elsewhere + "/nowhere").code, 2);
}

TEST(Program, ListsAndDescribesLaws) {
  const Outcome list = run_program("list");
  EXPECT_EQ(list.code, 0);
  for (const char* law : {"contact", "coulomb", "postit"})
    EXPECT_NE(list.output.find(law), std::string::npos) << "law " << law;
  const Outcome described = run_program("describe postit --json");
  const nlohmann::json postit = nlohmann::json::parse(described.output);
  EXPECT_EQ(postit["laws"][0]["id"], "postit");
  EXPECT_EQ(postit["laws"][0]["parameters"].size(), 8U);
  EXPECT_EQ(postit["laws"][0]["parameters"][0]["default"], "inf");
  EXPECT_EQ(postit["laws"][0]["capabilities"], nlohmann::json({"adhere"}));
  for (const auto& variable : postit["laws"][0]["state_variables"])
    EXPECT_EQ(!variable["flags"].empty(), variable["name"] == "window") << variable;
  const std::string text = run_program("describe postit").output;
  for (const char* part : {"tangent_influence", "\n  can: adhere\n", "history, internal"})
    EXPECT_NE(text.find(part), std::string::npos) << part << " in " << text;
  const nlohmann::json coulomb =
      nlohmann::json::parse(run_program("describe coulomb --json").output)["laws"][0];
  for (const auto& parameter : coulomb["parameters"])
    EXPECT_EQ(parameter["axes"],
              parameter["name"] == "activation" ? nlohmann::json::array() : nlohmann::json::array({"time"}));
  EXPECT_NE(run_program("describe coulomb").output.find("  or per_node, table over time  "),
            std::string::npos);
}

// The constructor of this library ends the process that loads it.
TEST(Program, DescribesWithoutRunningTheLibrary) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::path(::testing::TempDir()) / ("ilaw_described_" + std::to_string(getpid()));
  fs::create_directories(folder);
  const std::string library = (folder / "aborts.so").string(), path = "ILAW_PATH=" + folder.string() + " ";
  fs::copy_file(ILAW_GOOD_LAW, library);
  ASSERT_EQ(std::system((ILAW_DESCRIBE " " + library).c_str()), 0);
  fs::copy_file(ILAW_ABORTING_LAW, library, fs::copy_options::overwrite_existing);
  const Outcome described = run_program("describe aborts", path);
  EXPECT_EQ(described.code, 0);
  EXPECT_NE(described.output.find("\nzero - Nothing\n"), std::string::npos) << described.output;
  const Outcome list = run_program("list", path);
  EXPECT_NE(list.output.find("zero  "), std::string::npos) << list.output;
  EXPECT_EQ(list.output.find("refused"), std::string::npos) << list.output;
  // Without the file its code must run, in a process of its own.
  fs::remove(folder / "aborts.json");
  EXPECT_EQ(run_program("describe aborts", path).code, 1);
  EXPECT_NE(run_program("list", path).output.find("its code crashed: Aborted"), std::string::npos);
  std::ofstream(folder / "aborts.json") << "{";
  EXPECT_EQ(run_program("describe aborts", path).code, 2);
  EXPECT_NE(
      run_program("list", path).output.find("refused: " + (folder / "aborts.json").string() + ": no JSON"),
      std::string::npos);
  fs::remove_all(folder);
}

// Columns stand below each other, however long a name is.
TEST(Program, AlignsColumns) {
  std::istringstream list(run_program("list").output);
  std::set<std::size_t> files;
  for (std::string line; std::getline(list, line);)
    if (line.find("search path") != 0) files.insert(line.find("/"));
  EXPECT_EQ(files.size(), 1U);
}

}  // namespace
}  // namespace ilaw::host::testing
