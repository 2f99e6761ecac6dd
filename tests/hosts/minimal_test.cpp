// The minimal host (host_mock/minimal) beside `ilaw run`: the same bits on all scenes that it can read.
// SPDX-License-Identifier: BSD-3-Clause
#include "support/program.hpp"
#include "support/scene_files.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

namespace {

using namespace ilaw::testing::matchers;
using namespace ilaw::testing::programs;
namespace fs = std::filesystem;

fs::path folder_of(const std::string& name) {
  const fs::path folder = fs::path(::testing::TempDir()) / ("minimal_" + name);
  fs::remove_all(folder);
  fs::create_directories(folder);
  return folder;
}

Outcome run_minimal(const fs::path& scene, const fs::path& out) {
  setenv("ILAW_PATH", ILAW_PLUGIN_FOLDER, 1);
  return run_command(ILAW_MINIMAL_PROGRAM " " + scene.string() + " " + out.string());
}

std::string history_of_ilaw(const fs::path& scene, const fs::path& out) {
  const Outcome outcome = run_command(ILAW_PROGRAM " run " + scene.string() + " --out " + out.string());
  EXPECT_EQ(outcome.code, 0) << outcome.output;
  return text_of(out / "history.csv");
}

// `ilaw run` adds columns that a scene asks for by "balance" and "forces".
std::string first_columns(const std::string& table, std::ptrdiff_t count) {
  std::istringstream lines(table);
  std::string cut;
  for (std::string line; std::getline(lines, line);) {
    std::size_t end = 0;
    for (std::ptrdiff_t k = 0; k < count && end != std::string::npos; ++k)
      end = line.find(',', end + (k > 0));
    cut += line.substr(0, end) + '\n';
  }
  return cut;
}

std::ptrdiff_t column_count(const std::string& table) {
  const std::string head = table.substr(0, table.find('\n'));
  return 1 + std::count(head.begin(), head.end(), ',');
}

void write_scene(const fs::path& file, const std::string& interfaces) {
  std::ofstream(file) << R"({"model": {"type": "points", "dimension": 3, "points": [
      {"mass": 1.0, "position": [0.3, 0.2, 1.2], "velocity": [-1.0, -0.5, 0.2]},
      {"mass": 2.0, "position": [0.3, 0.2, 1.3], "velocity": [0.1, 0.0, -1.0], "stiffness": [0.0, 3.0, 0.0]},
      {"mass": 0.5, "position": [0.3, 0.2, 1.4]}]},
    "time": {"dt": 1e-3, "end": 0.6}, "loads": [{"type": "gravity", "acceleration": [-1.0, -2.0, -10.0]}],
    "interfaces": [)" + interfaces +
                             R"(], "output": {"watch": [0, 1, 2]}})";
}

// The number of scenes may grow; a scene that is no longer read, or has other bits, is a fault.
TEST(MinimalHost, GivesTheBitsOfIlawRun) {
  constexpr int measured = 19;
  int read = 0;
  for (const fs::path& scene : scene_files::all()) {
    const fs::path folder = folder_of(scene.stem().string());
    const Outcome outcome = run_minimal(scene, folder / "minimal");
    if (outcome.code == 2) {
      EXPECT_THAT(outcome.output, AllOf(HasSubstr(": found "), HasSubstr(", expected ")));
      continue;
    }
    ASSERT_EQ(outcome.code, 0) << outcome.output;
    ++read;
    const std::string own = text_of(folder / "minimal/history.csv");
    EXPECT_GT(std::count(own.begin(), own.end(), '\n'), 400) << scene;
    EXPECT_TRUE(own == first_columns(history_of_ilaw(scene, folder / "ilaw"), column_count(own))) << scene;
  }
  EXPECT_GE(read, measured);
}

TEST(MinimalHost, GivesTheSameBitsOnMovingSpheres) {
  const fs::path folder = folder_of("spheres");
  write_scene(folder / "scene.json", R"(
    {"law": "coulomb", "parameters": {"friction": 0.2}, "nodes": [0, 2],
     "obstacle": {"type": "sphere", "center": [0.0, 0.0, 0.0], "radius": 1.0, "velocity": [0.0, 0.1, 0.3]}},
    {"law": "cohesive", "parameters": {"strength": 10.0, "toughness": 1.0}, "nodes": [1],
     "obstacle": {"type": "sphere", "center": [0.3, 0.2, 0.2], "radius": 1.1}})");
  const Outcome outcome = run_minimal(folder / "scene.json", folder / "minimal");
  ASSERT_EQ(outcome.code, 0) << outcome.output;
  EXPECT_EQ(text_of(folder / "minimal/history.csv"), history_of_ilaw(folder / "scene.json", folder / "ilaw"));
}

std::vector<double> numbers_of(const std::string& table) {
  std::istringstream cells(table.substr(table.find('\n')));
  std::vector<double> numbers;
  for (double number = 0.0; cells >> number;) {
    numbers.push_back(number);
    if (cells.peek() == ',') cells.get();
  }
  return numbers;
}

// A corner, and a bond to a node that is in contact itself.
TEST(MinimalHost, SolvesContactsThatShareNodes) {
  const fs::path folder = folder_of("corner");
  write_scene(folder / "scene.json", R"(
    {"name": "floor", "law": "coulomb", "parameters": {"friction": 0.3}, "nodes": "all",
     "obstacle": {"type": "plane", "point": [0.0, 0.0, 1.2], "normal": [0.0, 0.0, 1.0]}},
    {"name": "wall", "law": "coulomb", "parameters": {"friction": 0.2, "restitution": 0.5}, "nodes": [0, 1],
     "obstacle": {"type": "plane", "point": [0.1, 0.0, 0.0], "normal": [1.0, 0.0, 0.0], "velocity": [0.0, 0.1, 0.0]}},
    {"name": "bond", "law": "cohesive", "parameters": {"strength": 100.0, "toughness": 1.0}, "nodes": [1],
     "against": {"nodes": [2], "normal": [0.0, 0.0, 1.0]}})");
  const Outcome outcome = run_minimal(folder / "scene.json", folder / "minimal");
  ASSERT_EQ(outcome.code, 0) << outcome.output;
  const std::string own = text_of(folder / "minimal/history.csv"),
                    reference = history_of_ilaw(folder / "scene.json", folder / "ilaw");
  EXPECT_EQ(own.substr(0, own.find('\n')), reference.substr(0, reference.find('\n')));
  const std::vector<double> found = numbers_of(own), wanted = numbers_of(reference);
  ASSERT_EQ(found.size(), wanted.size());
  ASSERT_GT(found.size(), 600 * 20);
  for (std::size_t i = 0; i < found.size(); ++i) ASSERT_NEAR(found[i], wanted[i], 1e-12) << "number " << i;
}

TEST(MinimalHost, NamesWhatItRefuses) {
  const fs::path folder = folder_of("refusals");
  const auto refusal_of = [&](const std::string& interface) {
    write_scene(folder / "scene.json", interface);
    const Outcome outcome = run_minimal(folder / "scene.json", folder / "out");
    EXPECT_EQ(outcome.code, 2) << outcome.output;
    return outcome.output;
  };
  const std::string plane =
      R"("obstacle": {"type": "plane", "point": [0.0, 0.0, 0.0], "normal": [0.0, 0.0, 1.0]}})";
  EXPECT_THAT(refusal_of(R"({"law": "coulomb", "parameters": {"fricton": 0.2}, "nodes": "all", )" + plane),
              HasSubstr("fricton"));
  EXPECT_THAT(refusal_of(R"({"law": "coulomb", "parameters": {"friction": -1.0}, "nodes": "all", )" + plane),
              HasSubstr("-1"));
  EXPECT_THAT(refusal_of(R"({"law": "contact", "nodes": [0, 3], )" + plane),
              HasSubstr("/interfaces/0/nodes: found 3, expected a node of 0 to 2"));
  EXPECT_THAT(refusal_of(R"({"law": "contact", "nodes": [0], "tangent": [1.0, 0.0, 0.0], )" + plane),
              HasSubstr("/interfaces/0: found \"tangent\", expected one of name, law"));
  EXPECT_THAT(refusal_of(R"({"law": "contact", "nodes": [0]})"), HasSubstr("obstacle"));
  EXPECT_THAT(refusal_of(R"({"law": "contact", "nodes": "some", )" + plane),
              HasSubstr("/interfaces/0/nodes"));
  EXPECT_EQ(run_minimal(folder / "none.json", folder / "out").code, 2);
  EXPECT_THAT(run_command(ILAW_MINIMAL_PROGRAM " --help"), Exits(0, HasSubstr("Example: ilaw-minimal")));
  EXPECT_THAT(run_command(ILAW_MINIMAL_PROGRAM),
              Exits(2, HasSubstr("found 0 arguments, expected SCENE.json FOLDER")));
}

}  // namespace
