// Results of a run: the summary, and the columns of the history.
#include "run_result.hpp"

#include "base/clock.hpp"

#include <chrono>

namespace ilaw::host::testing::summary {
namespace {

// A scene of one mass that slides on a floor, under the law.
json sliding_mass(const char* law, const json& parameters) {
  const json floor = law_on("all", ground(3), law, parameters);
  json scene = until(0.02, 0.01, scene_of_points({point(1, {0, 0, 0}, {0.1, 0, 0})}, {floor}));
  scene["output"]["watch"] = {0};
  return scene;
}

json summary_of(const json& scene) { return ran(scene).summary; }

// Every contact of every step is active or skipped, and has a status.
TEST(Summary, CountsActiveAndSkippedContacts) {
  json scene = shipped("block_impact");
  const auto nodes = 9 * 9 * 9 + 9 * 9;
  const json skipping = summary_of(scene);
  for (auto& interface : scene["interfaces"]) interface["skip"] = false;
  const json complete = summary_of(scene);
  const auto steps = skipping["steps"].get<std::int64_t>();
  for (const json& summary : {skipping, complete}) {
    const json& count = summary["execution"]["node_steps"];
    EXPECT_EQ(count["active"].get<std::int64_t>() + count["skipped"].get<std::int64_t>(), nodes * steps);
    std::int64_t sum = 0;
    for (const auto& [status, times] : summary["status_counts"].items()) sum += times.get<std::int64_t>();
    EXPECT_EQ(sum, nodes * steps);
  }
  EXPECT_EQ(complete["execution"]["node_steps"]["skipped"], 0);
  EXPECT_GT(skipping["execution"]["node_steps"]["skipped"], nodes * steps / 2);
  EXPECT_EQ(complete["status_counts"], skipping["status_counts"]);
  EXPECT_EQ(complete["execution"]["nodes_stored"][0], 9 * 9 * 9);
  EXPECT_LT(skipping["execution"]["nodes_stored"][0], 9 * 9 * 9);
}

TEST(Summary, TellsTheInterfacesShareAndMemory) {
  const json summary = summary_of(shipped("postit_test3"));
  const json& seconds = summary["seconds"];
  const double share = summary["execution"]["interface_share"];
  EXPECT_GT(share, 0.0);
  EXPECT_LT(share, 1.0);
  EXPECT_NEAR(share,
              seconds["interfaces"].get<double>() /
                  (seconds["interfaces"].get<double>() + seconds["internal_forces"].get<double>()),
              1e-12);
  EXPECT_GE(seconds["total"].get<double>(),
            seconds["interfaces"].get<double>() + seconds["internal_forces"].get<double>());
  // The state, with a window of 80 buckets, and some vectors beside it.
  const json& interface = summary["interfaces"][0];
  EXPECT_GE(interface["state_size"], 80);
  EXPECT_GE(interface["bytes_per_node"], 8 * interface["state_size"].get<int>());
  EXPECT_LE(interface["bytes_per_node"], 8 * interface["state_size"].get<int>() + 300);
}

// Unit masses on springs of k = 1e4, stable up to 2/sqrt(k H) = 0.02 where explicit.
json mass_on_spring(const char* integration, double dt) {
  json scene = sliding_mass("penalty", {{"stiffness", 1e4}});
  scene["model"]["points"][0]["velocity"] = {0, 0, -1};
  scene["time"] = {{"dt", dt}, {"end", 5 * dt}};
  scene["interfaces"][0]["parameters"]["integration"] = integration;
  return scene;
}

// In scenes of few nodes one step in 16 is timed for all: of what the steps take, the better part is told.
// The first steps, which load libraries and memory, are timed one by one and left out.
TEST(Clock, StepsThatAreTimedStandForThoseThatAreNot) {
  double share = 0.0;
  for (int attempt = 0; attempt < 5 && share < 0.25; ++attempt) {  // others may hold the processor
    Scene scene = scene_of(mass_on_spring("implicit", 1e-5));
    host::Integrator integrator = unaudited(scene);
    const auto told = [&integrator = integrator] {
      const PhaseSeconds seconds = integrator.seconds();
      return seconds.interfaces + seconds.internal_forces;
    };
    while (integrator.steps() < 160) integrator.step();
    const double before = told();
    const auto start = std::chrono::steady_clock::now();
    while (integrator.steps() < 6000) integrator.step();
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    share = (told() - before) / elapsed.count();
  }
  EXPECT_GT(share, 0.25);
}

// A phase far longer than those of small scenes was interrupted, and is no measure of the others.
TEST(Clock, AnInterruptionStandsForItself) {
  constexpr int weight = 16;
  constexpr double interrupted = 5e-4;
  const auto now = [] { return clock_seconds(CLOCK_MONOTONIC); };
  const double begin = now();
  Laps laps(weight);
  while (now() - begin < interrupted) continue;
  double seconds = 0.0;
  laps.add_to(seconds);
  EXPECT_GT(seconds, 0.9 * interrupted);
  EXPECT_LE(seconds, now() - begin);
  int weighted = 0;
  for (int k = 0; k < 100; ++k) {
    double passed = 0.0;
    const double start = now();
    laps.add_to(passed);
    while (now() - start < 1e-6) continue;
    laps.add_to(passed);
    weighted += passed > 2.0 * (now() - start) ? 1 : 0;
  }
  EXPECT_GT(weighted, 90);
  Laps untimed(0);
  seconds = 0.0;
  untimed.add_to(seconds);
  EXPECT_EQ(seconds, 0.0);
}

}  // namespace
}  // namespace ilaw::host::testing::summary
