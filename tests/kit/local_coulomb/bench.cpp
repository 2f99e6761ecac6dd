// Time per local problem of each kind, in cache; google-benchmark prints ns per problem as items.
#include "draw.hpp"

#include <benchmark/benchmark.h>

#include <vector>

namespace {

using ilaw::kit::local_coulomb;

std::vector<local_coulomb> coupled(double friction, double floor) {
  ilaw::testing::Draw draw(1);
  std::vector<local_coulomb> problems(1024);
  for (local_coulomb& p : problems) {
    draw.fill_coupled(p, floor);
    draw.fill_pressed_velocity(p, 1.0);
    p.mu[0] = p.mu[1] = friction;
  }
  return problems;
}

void solve(benchmark::State& state, double friction, double floor) {
  const std::vector<local_coulomb> problems = coupled(friction, floor);
  double r[3];
  for (auto _ : state)
    for (const local_coulomb& p : problems) {
      ilaw::kit::solve(p, r);
      benchmark::DoNotOptimize(r);
    }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(problems.size()));
}

BENCHMARK_CAPTURE(solve, mostly_slip, 0.3, 0.5);
BENCHMARK_CAPTURE(solve, half_stick, 1.5, 0.5);
BENCHMARK_CAPTURE(solve, nearly_singular, 0.3, 1e-3);

}  // namespace

BENCHMARK_MAIN();
