// The `ilaw` program as a user sees it: exit codes, messages, files.
#include "host_runner.hpp"

#include <pty.h>

#include <csignal>
#include <regex>
#include <thread>

namespace ilaw::host::testing::program {
namespace {

const std::string ball = scene_files::named("bouncing_ball.json").string();

// refusals.json has the answers to bad input.
TEST(Program, TellsBadInputFromFailureByItsExitCode) {
  for (const char* command : {"", "walk", "describe no_such_law"})
    EXPECT_EQ(run_program(command).code, 2) << command;
  for (const char* command : {"run ", "converge "})  // a folder in which nobody can make a file
    EXPECT_THAT(run_program(command + ball + " --out /proc"), Exits(2, StartsWith("ilaw: --out /proc: ")));
  for (const char* command :
       {"", "run", "plot", "view", "converge", "study", "list", "describe", "stress", "check", "bench"})
    EXPECT_THAT(run_program(std::string(command) + " --help"), Exits(0, HasSubstr("Example: "))) << command;
}

// Whole or not at all, as every file; a device is not replaced by a file.
TEST(Program, WritesTheReportOfACheck) {
  const auto folder = fresh_folder();
  const auto report_to = [&](const std::string& file) {
    return run_program("check " ILAW_PLUGIN_FOLDER "/contact.so --only library-opens --junit " + file,
                       "cd " + folder.string() + "; ");
  };
  EXPECT_EQ(report_to("report.xml").code, 0);
  EXPECT_THAT(text_of(folder / "report.xml"), HasSubstr("</testsuite>"));
  EXPECT_FALSE(fs::exists(folder / "report.xml.partial"));
  EXPECT_THAT(report_to("none/report.xml"), Exits(1, HasSubstr("none/report.xml")));
  EXPECT_THAT(report_to("/dev/full"), Exits(2, StartsWith("ilaw: /dev/full: not a regular file")));
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
  // Written at once: what is left in the buffer at the end is not refused any more.
  EXPECT_THAT(run_command(ILAW_PROGRAM " check --rules >/dev/full"), Exits(1, ::testing::_));
}

TEST(Program, SaysWhyASceneCannotBeRead) {
  if (geteuid() == 0) GTEST_SKIP() << "root may read everything";
  const auto folder = fresh_folder();
  const std::string file = written(shipped("bouncing_ball"), folder);
  fs::permissions(file, fs::perms::none);
  EXPECT_EQ(run_program("run " + file + " --out " + folder.string()).output,
            "ilaw: " + file + ": the file cannot be read: Permission denied\n");
}

// 0 where no rule is broken, 1 where one is, 2 where there is nothing to check. Findings: tests/check.
TEST(Program, ChecksALibrary) {
  const Outcome sound = run_program("check coulomb --law coulomb --only mirror --json");
  EXPECT_EQ(sound.code, 0) << sound.output;
  EXPECT_EQ(json::parse(sound.output).at(0).at("result"), "passed");
  EXPECT_THAT(run_program("check " ILAW_ODD_STATUS " --only status-meaning"),
              Exits(1, HasSubstr("seen:    status 42")));
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
    EXPECT_THAT(outcome.output, HasSubstr(said));
  }
  EXPECT_THAT(run_program("check --rules").output, HasSubstr("| `purity-twice` | "));
}

// The same checks and exit codes without a host.
TEST(Program, ChecksALibraryByAProgramOfItsOwn) {
  const std::string program = ILAW_CHECK_PROGRAM;
  const Outcome sound = run_command(program + " coulomb --law coulomb --only mirror --json");
  EXPECT_EQ(sound.code, 0) << sound.output;
  EXPECT_EQ(json::parse(sound.output).at(0).at("result"), "passed");
  EXPECT_EQ(run_command(program + " " ILAW_ODD_STATUS " --only status-meaning").code, 1);
  EXPECT_THAT(run_command(program + " no_such_law"), Exits(2, StartsWith("ilaw-check: ")));
  EXPECT_THAT(run_command(program + " --help"), Exits(0, HasSubstr("Example: ilaw-check ")));
  EXPECT_EQ(run_command(program + " --rules >/dev/full").code, 1);
}

// A pipe whose reader has gone is an output that cannot be written, no end by a signal.
TEST(Program, SaysThatItsReaderHasLeft) {
  const std::string folder = fresh_folder().string(),
                    scene = scene_files::named("impact_oscillator.json").string();
  const Outcome outcome = run_command("(exec 3>&1; (sleep 0.3; " ILAW_PROGRAM " run " + scene + " --out " +
                                      folder + " 2>&3; echo code $? >&3) | true)");
  EXPECT_THAT(outcome.output, HasSubstr("ilaw: standard output: cannot be written"));
  EXPECT_THAT(outcome.output, HasSubstr("code 1\n"));
}

// As nohup starts it.
TEST(Program, GoesOnAtAHangUpThatIsIgnored) {
  const auto folder = fresh_folder();
  std::signal(SIGHUP, SIG_IGN);
  const pid_t child = start_program(
      {"run", written(shipped("bouncing_ball"), folder), "--out", folder.string()}, folder / "messages");
  std::signal(SIGHUP, SIG_DFL);
  int status = 0;
  while (waitpid(child, &status, WNOHANG) == 0) {
    kill(child, SIGHUP);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_EQ(WEXITSTATUS(status), 0) << text_of(folder / "messages");
}

// ---- progress -------------------------------------------------------------------------------------------

// The output of a command on a terminal of its own.
std::string said_on_terminal(std::vector<std::string> words) {
  int terminal = -1;
  const pid_t child = forkpty(&terminal, nullptr, nullptr, nullptr);
  if (child == 0) {
    std::vector<char*> arguments = {const_cast<char*>(ILAW_PROGRAM)};
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    execv(ILAW_PROGRAM, arguments.data());
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

json long_ball(double end) {
  json scene = shipped("bouncing_ball");
  scene["time"]["end"] = end;
  scene["output"] = {{"every", 100000}};
  return scene;
}

// A bar with its part done, the rate and the time left, redrawn in place and wiped in the end, before the
// line that stays.
TEST(Program, ShowsItsProgressOnATerminalOnly) {
  const auto folder = fresh_folder();
  const std::string file = written(long_ball(300.0), folder);
  const std::string said = said_on_terminal({"run", file, "--out", folder.string()});
  const std::regex bar(
      "\\r\033\\[Krun \\[(#*)(\\.*)\\] +([0-9]+) %  [0-9.e+]+ steps/s  [0-9.]+ (s|min|h) left ");
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
  const auto wiped = said.rfind("\r\033[K"), result = said.find("steps to time 300");
  ASSERT_NE(wiped, std::string::npos);
  ASSERT_NE(result, std::string::npos) << said;
  EXPECT_LT(wiped, result);
  const Outcome piped = run_program("run " + file + " --out " + folder.string());
  EXPECT_EQ(piped.code, 0);
  EXPECT_THAT(piped.output, Not(HasSubstr("\r")));
  EXPECT_EQ(std::count(piped.output.begin(), piped.output.end(), '\n'), 1);
}

std::vector<json> objects_in(const std::string& lines) {
  std::vector<json> found;
  std::istringstream stream(lines);
  for (std::string line; std::getline(stream, line);)
    if (line.starts_with("{\"task\"")) found.push_back(json::parse(line));
  return found;
}

// Every long command tells the same of its work to machines, and ends with all of it.
TEST(Program, TellsItsProgressInLinesOfJson) {
  const auto folder = fresh_folder();
  const std::string seal = (fs::path(ILAW_SOURCE) / "host_mock/scenes/prestressed_seal.json").string(),
                    file = written(long_ball(50.0), folder), out = " --out " + folder.string() + "/";
  const std::map<std::string, std::string> commands = {
      {"run", "run " + file + out + "run"},
      {"runs", "run " + file + " --set /time/end=40,50 --threads 2" + out + "runs"},
      {"stress", "stress --scenes 5 --steps 50"},
      {"check", "check contact --only info-within --only info-same"},
      {"study", "study " + ball + " --law contact --levels 2 --repetitions 1" + out + "study"},
      {"converge", "converge " + ball + " --levels 2" + out + "converge"},
      {"prestress", "run " + seal + out + "prestress"}};
  for (const auto& [task, command] : commands) {
    const Outcome told = run_program(command + " --json-lines");
    EXPECT_EQ(told.code, 0) << told.output;
    std::vector<json> lines = objects_in(told.output);
    std::erase_if(lines, [&](const json& line) { return line["task"] != task; });
    ASSERT_FALSE(lines.empty()) << told.output;
    for (std::size_t k = 0; k < lines.size(); ++k) {
      EXPECT_GT(lines[k]["per_second"], 0.0) << lines[k];
      EXPECT_GE(lines[k]["done"], lines[k > 0 ? k - 1 : 0]["done"]) << lines[k];
    }
    EXPECT_GT(lines.back()["percent"], 99.0) << lines.back();
    const Outcome silent = run_program(command);
    EXPECT_TRUE(objects_in(silent.output).empty()) << silent.output;
  }
  const std::vector<json> runs = objects_in(run_program(commands.at("runs") + " --json-lines").output);
  EXPECT_EQ(runs.back()["done"], 90000) << "steps of both runs, which are processes";
}

TEST(Program, DrawsNothingForAShortRun) {
  const auto folder = fresh_folder();
  EXPECT_EQ(said_on_terminal({"run", ball, "--out", folder.string()}).find('['), std::string::npos);
}

TEST(Program, ListsAndDescribesLaws) {
  const Outcome list = run_program("list");
  EXPECT_EQ(list.code, 0);
  for (const char* law : {"contact", "coulomb", "postit"})
    EXPECT_THAT(list.output, HasSubstr(law)) << "law " << law;
  const Outcome described = run_program("describe postit --json");
  const json postit = json::parse(described.output);
  EXPECT_EQ(postit["laws"][0]["id"], "postit");
  EXPECT_EQ(postit["laws"][0]["parameters"].size(), 8U);
  EXPECT_EQ(postit["laws"][0]["parameters"][0]["default"], "inf");
  EXPECT_EQ(postit["laws"][0]["capabilities"], json({"adhere", "hold_bonds"}));
  for (const auto& variable : postit["laws"][0]["state_variables"])
    EXPECT_EQ(!variable["flags"].empty(), variable["name"] == "window") << variable;
  const std::string text = run_program("describe postit").output;
  for (const char* part : {"tangent_influence", "\n  can: adhere, hold_bonds\n", "history, internal"})
    EXPECT_THAT(text, HasSubstr(part)) << part;
  const json coulomb = json::parse(run_program("describe coulomb --json").output)["laws"][0];
  for (const auto& parameter : coulomb["parameters"])
    EXPECT_EQ(parameter["axes"], parameter["name"] == "activation" ? json::array() : json::array({"time"}));
  EXPECT_THAT(run_program("describe coulomb").output, HasSubstr("  or per_node, table over time  "));
}

// The constructor of this library ends the process that loads it.
TEST(Program, DescribesWithoutRunningTheLibrary) {
  const fs::path folder = fs::path(::testing::TempDir()) / ("ilaw_described_" + std::to_string(getpid()));
  fs::create_directories(folder);
  const std::string library = (folder / "aborts.so").string(), path = "ILAW_PATH=" + folder.string() + " ";
  fs::copy_file(ILAW_GOOD_LAW, library);
  ASSERT_EQ(std::system((ILAW_DESCRIBE " " + library).c_str()), 0);
  fs::copy_file(ILAW_ABORTING_LAW, library, fs::copy_options::overwrite_existing);
  EXPECT_THAT(run_program("describe aborts", path), Exits(0, HasSubstr("\nzero - Nothing\n")));
  const Outcome list = run_program("list", path);
  EXPECT_THAT(list.output, HasSubstr("zero  "));
  EXPECT_THAT(list.output, Not(HasSubstr("refused")));
  // Without the file its code must run, in a process of its own.
  fs::remove(folder / "aborts.json");
  EXPECT_EQ(run_program("describe aborts", path).code, 1);
  EXPECT_THAT(run_program("list", path).output, HasSubstr("its code crashed: Aborted"));
  std::ofstream(folder / "aborts.json") << "{";
  EXPECT_EQ(run_program("describe aborts", path).code, 2);
  EXPECT_THAT(run_program("list", path).output,
              HasSubstr("refused: " + (folder / "aborts.json").string() + ": no JSON"));
  fs::remove_all(folder);
}

}  // namespace
}  // namespace ilaw::host::testing::program
