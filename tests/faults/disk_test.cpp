// A disk that fails, or a process that is killed, in the middle of whatever a run writes: what has a file's
// name is complete, the program says what failed, and the run can be ended afterwards.
#include "faults/faults.hpp"

#include <functional>
#include <random>
#include <set>

namespace ilaw::host::testing {
namespace {

// A short run that writes all there is, and its files when nothing fails.
struct Reference {
  std::string scene;
  std::map<std::string, std::string> files;
};

json shortened(const std::string& name, double end) {
  json scene = shipped(name);
  scene["time"]["end"] = end;
  scene["output"]["every"] = 1;
  scene["output"]["fields"] = 50;
  scene["output"]["balance"] = true;
  return scene;
}

std::string command_for(const Reference& reference, const fs::path& folder) {
  return "run " + reference.scene + " --out " + folder.string() + " --checkpoint-every 40";
}

Reference reference_of(const json& scene) {
  Reference reference{written(scene, fresh_folder()), {}};
  const auto folder = fresh_folder();
  const Outcome outcome = run_program(command_for(reference, folder));
  EXPECT_EQ(outcome.code, 0) << outcome.output;
  reference.files = files_in(folder);
  return reference;
}

// The summary without what is a run's own: when it was, and how often the disk was asked.
json without_times(const std::string& summary) {
  json all = json::parse(summary);
  for (const char* key : {"seconds", "execution"}) all.erase(key);
  return all;
}

// Empty where a folder holds what the reference does, to the byte.
std::string difference(const std::map<std::string, std::string>& found, const Reference& reference) {
  for (const auto& [name, text] : reference.files) {
    if (!found.count(name)) return name + " is missing";
    const bool same = name == "summary.json" ? without_times(found.at(name)) == without_times(text)
                                             : found.at(name) == text;
    if (!same) return name + " differs";
  }
  return found.size() == reference.files.size() ? "" : "more files than in the reference";
}

// Empty where all that has a final name is complete.
std::string incomplete(const std::map<std::string, std::string>& found, const Reference& reference) {
  for (const auto& [name, text] : found) {
    if (name.ends_with(".partial") || name == "ilaw.lock") continue;
    if (!reference.files.count(name)) return name + " is no file of a run";
    const std::string& whole = reference.files.at(name);
    const bool good = name == "history.csv" ? !text.empty() && text.back() == '\n' && whole.starts_with(text)
                      : name.ends_with(".vtu")                               ? text == whole
                      : name.ends_with(".series") || name.ends_with(".json") ? json::accept(text)
                                                                             : !text.empty();
    if (!good) return name + " is not complete";
  }
  if (found.count("fields.vtu.series"))
    for (const json& field : json::parse(found.at("fields.vtu.series"))["files"])
      if (!found.count(field["name"])) return field["name"].get<std::string>() + " is in the series alone";
  return "";
}

struct Fault {
  std::string call;
  long n;
  std::string how;
};

// The n-th call with its fault; n = 0: how many calls there are.
Outcome run_with(const Fault& fault, const std::string& command, const fs::path& folder,
                 const fs::path& count = {}) {
  return run_program(command, "LD_PRELOAD=" ILAW_INJECT_LIBRARY " ILAW_INJECT=" + folder.string() + ":" +
                                  fault.call + ":" + std::to_string(fault.n) + ":" + fault.how +
                                  " ILAW_INJECT_COUNT=" + count.string() + " ");
}

long calls_of(const std::string& call, const Reference& reference) {
  const auto folder = fresh_folder(), count = fresh_folder() / "count";
  EXPECT_EQ(run_with({call, 0, "fail"}, command_for(reference, folder), folder, count).code, 0);
  return std::stol(text_of(count));
}

// The first, the last and some between.
std::set<long> sample(long calls, std::size_t count, std::mt19937& engine) {
  std::set<long> chosen{1, calls};
  while (chosen.size() < count && static_cast<long>(chosen.size()) < calls)
    chosen.insert(std::uniform_int_distribution<long>(1, calls)(engine));
  return chosen;
}

// Empty where the program took the fault as it must.
std::string survives(const Fault& fault, const Reference& reference) {
  const auto folder = fresh_folder();
  const std::string command = command_for(reference, folder);
  const Outcome outcome = run_with(fault, command, folder);
  std::map<std::string, std::string> found = files_in(folder);
  if (const std::string text = incomplete(found, reference); !text.empty()) return text;
  const bool was_killed = fault.how == "kill";
  if (outcome.code == 0 || was_killed == (outcome.code == 1 || outcome.code == 2))
    return "exit code " + std::to_string(outcome.code) + ": " + outcome.output;
  if (!was_killed && outcome.output.find(folder.string() + "/") == std::string::npos)
    return "no file is named: " + outcome.output;
  if (outcome.output.find("vtk") != std::string::npos) return "VTK speaks: " + outcome.output;
  const Outcome again = run_program(command + (found.count("checkpoint.cbor") ? " --resume" : ""));
  if (again.code != 0) return "cannot be ended: " + again.output;
  return difference(files_in(folder), reference);
}

class Disk : public ::testing::TestWithParam<std::pair<std::string, json>> {};

TEST_P(Disk, ThatFailsAnywhereLosesNothing) {
  const Reference reference = reference_of(GetParam().second);
  std::mt19937 engine(70);
  int faults = 0;
  for (const auto& [call, how] : std::vector<std::pair<std::string, std::string>>{{"write", "fail"},
                                                                                  {"write", "full"},
                                                                                  {"open", "fail"},
                                                                                  {"fsync", "fail"},
                                                                                  {"rename", "fail"},
                                                                                  {"any", "kill"}}) {
    const long calls = calls_of(call, reference);
    ASSERT_GT(calls, 5) << call;
    for (const long n : sample(calls, call == "any" ? 10 : 5, engine)) {
      ++faults;
      ASSERT_EQ(survives({call, n, how}, reference), "")
          << call << " " << n << " of " << calls << ": " << how;
    }
  }
  EXPECT_GE(faults, 30);
}

INSTANTIATE_TEST_SUITE_P(Faults, Disk,
                         ::testing::Values(std::pair{"bouncing_ball", shortened("bouncing_ball", 0.2)},
                                           std::pair{"two_bars", shortened("two_bars", 1.0)}),
                         [](const auto& drawn) { return drawn.param.first; });

// ---- what a loss of power leaves ------------------------------------------------------------------------

void overwrite(const fs::path& file, std::size_t first, std::size_t count) {
  std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
  stream.seekp(static_cast<std::streamoff>(first));
  stream << std::string(count, '\0');
}

struct Lost {
  std::string name;
  std::function<void(const fs::path&)> damage;
  std::string said;  // by --resume
};

class Power : public ::testing::TestWithParam<Lost> {};

// A checkpoint is replaced by rename, and no run goes on from files that are not as it says.
TEST_P(Power, ThatFailsIsNoticed) {
  const Reference reference = reference_of(shortened("bouncing_ball", 0.2));
  const auto folder = fresh_folder();
  ASSERT_EQ(run_program(command_for(reference, folder)).code, 0);
  GetParam().damage(folder);
  EXPECT_THAT(run_program(command_for(reference, folder) + " --resume"),
              Exits(2, HasSubstr(folder.string() + "/" + GetParam().said)));
}

const Lost faults_power[] = {
    {"PageOfHistory", [](const auto& folder) { overwrite(folder / "history.csv", 4096, 4096); },
     "history.csv: found other bytes, expected the first "},
    {"EndOfHistory",
     [](const auto& folder) {
       const auto size = fs::file_size(folder / "history.csv");
       overwrite(folder / "history.csv", size - 1000, 1000);
     },
     "history.csv: found other bytes"},
    {"FirstField", [](const auto& folder) { fs::remove(folder / "fields_000000.vtu"); },
     "fields_000000.vtu: No such file or directory, expected the first "},
    {"LastField", [](const auto& folder) { fs::remove(folder / "fields_000004.vtu"); },
     "fields_000004.vtu: No such file or directory"},
    {"PageOfField", [](const auto& folder) { overwrite(folder / "fields_000004.vtu", 100, 512); },
     "fields_000004.vtu: found other bytes"},
    {"Checkpoint", [](const auto& folder) { fs::resize_file(folder / "checkpoint.cbor", 100); },
     "checkpoint.cbor: the checkpoint is damaged"},
    {"PageOfCheckpoint", [](const auto& folder) { overwrite(folder / "checkpoint.cbor", 50, 50); },
     "checkpoint.cbor: the checkpoint is damaged"}};
INSTANTIATE_TEST_SUITE_P(Faults, Power, ::testing::ValuesIn(faults_power),
                         [](const auto& drawn) { return drawn.param.name; });

}  // namespace
}  // namespace ilaw::host::testing
