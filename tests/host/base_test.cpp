// Clocks that leave most steps out, exceptions of workers, sums between rows, and the time to read a scene.
#include "base/clock.hpp"
#include "base/parallel.hpp"
#include "host_runner.hpp"
#include "results/forces.hpp"
#include "scene/validation.hpp"

#include <omp.h>

#include <chrono>
#include <new>

namespace ilaw::host::testing::base {
namespace {

// In scenes of few nodes one step in 16 is timed for all: of what the steps take, the better part is told.
// The first steps, which load libraries and memory, are timed one by one and left out.
TEST(Clock, StepsThatAreTimedStandForThoseThatAreNot) {
  double share = 0.0;
  for (int attempt = 0; attempt < 5 && share < 0.25; ++attempt) {  // others may hold the processor
    Scene scene = scene_of(R"({"model": {"type": "points", "dimension": 1, "points": [
        {"mass": 1, "position": [0], "velocity": [-1]}]}, "time": {"dt": 1e-5, "end": 1}, "interfaces": [{"nodes": "all",
        "law": "penalty", "parameters": {"stiffness": 1e4, "integration": "implicit"},
        "obstacle": {"type": "plane", "point": [0], "normal": [1]}}]})");
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

// The last chunk is a worker's.
TEST(Parallel, ThrowsHereWhatAWorkerThrows) {
  omp_set_num_threads(2);
  std::vector<int> done(8, 0);
  EXPECT_THROW(for_each_chunk(8, 1,
                              [&](std::ptrdiff_t c, auto, auto) {
                                if (c == 7) throw std::bad_alloc();
                                done[static_cast<std::size_t>(c)] = 1;
                              }),
               std::bad_alloc);
  omp_set_num_threads(1);
  EXPECT_EQ(std::count(done.begin(), done.end(), 1), 7);
}

// A run that ends between two rows has told of all its steps.
TEST(Forces, BetweenRowsAreInTheSummary) {
  auto [scene, integrator] = simulation_of(R"({
    "model": {"type": "points", "dimension": 1, "points": [{"mass": 2, "position": [0]}]},
    "time": {"dt": 0.013, "end": 1}, "loads": [{"type": "gravity", "name": "weight", "acceleration": [-10]}],
    "interfaces": [], "output": {"every": 20, "forces": ["weight"]}})");
  Forces forces(scene, integrator);
  const double start = integrator.velocity()[0];
  for (int step = 0; step < 7; ++step) {
    integrator.step();
    forces.add_step(integrator);
  }
  EXPECT_NEAR(forces.summary()["weight"]["impulse"][0].get<double>(), 2 * (integrator.velocity()[0] - start),
              1e-14);
}

// Scenes have a point, an element or a table row a line: reading four times as many takes four times as long,
// and would take sixteen if each looked at those before it.
TEST(ParseScene, TakesTimeInProportionToTheText) {
  const auto seconds_for = [](int count) {
    std::string text = R"({"points": [{"mass": 1})";
    for (int k = 1; k < count; ++k) text += R"(, {"mass": 1})";
    text += "]}";
    double least = 1e9;  // others may hold the processor's cache
    for (int attempt = 0; attempt < 3; ++attempt) {
      const double start = clock_seconds(CLOCK_THREAD_CPUTIME_ID);
      EXPECT_EQ(parse_scene(text)["points"].size(), static_cast<std::size_t>(count));
      least = std::min(least, clock_seconds(CLOCK_THREAD_CPUTIME_ID) - start);
    }
    return least;
  };
  EXPECT_LT(seconds_for(60000), 8.0 * seconds_for(15000));
}

}  // namespace
}  // namespace ilaw::host::testing::base
