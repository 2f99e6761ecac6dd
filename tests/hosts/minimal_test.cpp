// The minimal host (host_mock/minimal) beside `ilaw run`: the same bits on all scenes that it can read.
// SPDX-License-Identifier: BSD-3-Clause
#include "support/program.hpp"
#include "support/scene_files.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <random>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace ilaw::testing::matchers;
using namespace ilaw::testing::programs;
using nlohmann::json;
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

std::string history_of_ilaw(const fs::path& scene, const fs::path& out, const std::string& options = "") {
  const Outcome outcome =
      run_command(ILAW_PROGRAM " run " + scene.string() + options + " --out " + out.string());
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

// Random scenes that both can read.
class RandomScene {
 public:
  explicit RandomScene(std::uint32_t seed) : random_(seed), d_(1 + below(3)) {}

  json make() {
    json points = json::array(), loads = json::array(), interfaces = json::array();
    const std::size_t n = 1 + below(8), cut = below(n + 1), law = below(std::size(laws_) - (d_ == 1 ? 2 : 0));
    for (std::size_t k = 0; k < n; ++k) points.push_back(point());
    if (below(3) > 0) loads.push_back({{"type", "gravity"}, {"acceleration", vector(1.0)}});
    loads.push_back({{"type", "force"},
                     {"nodes", {below(n)}},
                     {"direction", vector(1.0)},
                     {"history", {{0.0, 0.0}, {0.1, uniform(-9.0, 9.0)}, {0.3, 0.0}}}});
    for (std::size_t k = below(3); k > 0; --k)
      loads.push_back({{"type", "shock"},
                       {"nodes", {below(n)}},
                       {"time", 0.05 * static_cast<double>(k)},
                       {"impulse", vector(1.0)}});
    for (const auto& [first, end] : {std::pair{std::size_t{0}, cut}, {cut, n}}) {
      json nodes = json::array();
      for (std::size_t k = first; k < end; ++k) nodes.push_back(k);
      if (!nodes.empty())
        interfaces.push_back({{"law", laws_[law].first},
                              {"parameters", json::parse(laws_[law].second)},
                              {"nodes", nodes},
                              {"obstacle", obstacle()}});
    }
    json watch = json::array();
    for (std::size_t k = 0; k < n; ++k) watch.push_back(k);
    return {{"model", {{"type", "points"}, {"dimension", d_}, {"points", points}}},
            {"time", {{"dt", below(2) ? 1e-3 : 7.3e-4}, {"end", 0.25}}},
            {"loads", loads},
            {"interfaces", interfaces},
            {"output", {{"watch", watch}, {"every", 1 + below(5)}}}};
  }

 private:
  std::size_t below(std::size_t end) { return random_() % end; }
  double uniform(double low, double high) { return low + (high - low) * (random_() / 4294967296.0); }
  json vector(double size) {
    json made = json::array();
    for (std::size_t c = 0; c < d_; ++c) made.push_back(uniform(-size, size));
    return made;
  }
  json point() {
    json made = {{"mass", std::exp(uniform(-4.0, 4.0))},
                 {"area", uniform(0.1, 1.0)},
                 {"position", vector(0.3)},
                 {"velocity", vector(2.0)}};
    if (below(3) == 0)
      for (std::size_t c = 0; c < d_; ++c)
        made["stiffness"].push_back(made["mass"].get<double>() * uniform(0.0, 500.0));
    return made;
  }
  json obstacle() {
    json made = {{"type", "plane"}, {"point", vector(0.3)}, {"normal", vector(1.0)}};
    if (below(2)) made = {{"type", "sphere"}, {"center", vector(0.5)}, {"radius", uniform(0.05, 0.5)}};
    if (below(2)) made["velocity"] = vector(1.0);
    return made;
  }

  static constexpr std::pair<const char*, const char*> laws_[] = {  // the last two have no form in 1D
      {"contact", R"({"restitution": 0.4})"},
      {"impact", R"({"restitution": 0.7, "friction": 0.3})"},
      {"coulomb", R"({"friction": 0.4, "restitution": 0.3})"},
      {"cohesive", R"({"strength": 30.0, "toughness": 0.7, "friction": 0.2})"},
      {"postit", R"({"efficiency_decrease": 3.0, "adhesion_limit": "inf", "memory": 0.05})"},
      {"tie", R"({"strength": 0.5, "memory": 0.1})"},
      {"penalty", R"({"stiffness": 1e4, "integration": "implicit", "damping": 10.0})"},
      {"slip_weakening", R"({"friction": 0.6, "dynamic_friction": 0.2, "critical_slip": 0.1})"},
      {"rccm", R"({"normal_stiffness": 1e3, "tangential_stiffness": 500.0, "adhesion_energy": 0.5,
                   "viscosity": 0.05, "friction": 0.4})"}};
  std::mt19937 random_;
  std::size_t d_;
};

TEST(MinimalHost, GivesTheSameBitsOnRandomScenes) {
  const fs::path folder = folder_of("random");
  for (std::uint32_t seed = 1; seed <= 60; ++seed) {
    std::ofstream(folder / "scene.json") << RandomScene(seed).make();
    const Outcome outcome = run_minimal(folder / "scene.json", folder / "minimal");
    ASSERT_EQ(outcome.code, 0) << outcome.output << RandomScene(seed).make();
    ASSERT_EQ(text_of(folder / "minimal/history.csv"),
              history_of_ilaw(folder / "scene.json", folder / "ilaw"))
        << RandomScene(seed).make();
    fs::remove_all(folder / "ilaw");
  }
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
                    reference = history_of_ilaw(folder / "scene.json", folder / "ilaw", " --tolerance 1e-14");
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
