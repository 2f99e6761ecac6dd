// The cost of an iteration of coupled contacts, and of a solve besides: grains on a lattice, each a
// little off its place, with friction and transverse H.
//
// Usage: ilaw_bench_coupled_cost GRAINS... Prints nanoseconds per contact, of one thread's processor time,
// then of the clock with a thread per processor: medians of some runs.
// SPDX-License-Identifier: BSD-3-Clause
#include "support/coupled_problem.hpp"

#include <cstdio>
#include <ctime>
#include <thread>

namespace {

using namespace ilaw::testing;

constexpr double radius = 0.5, spacing = 0.995;
constexpr int runs = 7;

double seconds(std::uint32_t threads) {
  std::timespec now{};
  clock_gettime(threads == 1 ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Solve {
  double seconds, iterations;
};

struct Pile : CoupledProblem {
  explicit Pile(int grains);
  // From rest, to a tolerance or for so many iterations. Neither energies nor statuses are asked for.
  Solve solve_anew(double tolerance, std::uint32_t most_sweeps, std::uint32_t threads);
  std::vector<Body> start;
};

Pile::Pile(int grains)
    : CoupledProblem(coupled_law("coulomb", ILAW_DELASSUS_TRANSVERSE, {{"friction", 0.3}}),
                     ILAW_DELASSUS_TRANSVERSE) {
  const int side = static_cast<int>(std::lround(std::cbrt(grains)));
  Random random(1);
  for (int i = 0; i < side * side * side; ++i) {
    Body grain{1.0, radius * radius / 2.5, radius};
    grain.x = spacing * Vector{1.0 * (i % side), 1.0 * (i / side % side), 1.0 * (i / side / side)} +
              random.vector(0.004);
    grain.v = random.vector(0.01) - Vector{0.0, 0.0, h * 10.0}, grain.w = random.vector(0.01);
    grain.v_before = grain.v, grain.w_before = grain.w;
    add_body(grain);
  }
  const std::array<int, 3> next{1, side, side * side};
  for (int i = 0; i < side * side * side; ++i) {
    if (i < side * side) touch(i, -1, {0.0, 0.0, 1.0});
    for (std::size_t c = 0; c < 3; ++c) {
      if (i / next[c] % side == 0) continue;
      const Vector d = at(i).x - at(i - next[c]).x;
      touch(i, i - next[c], (1.0 / length(d)) * d, length(d) - 2.0 * radius);
    }
  }
  start = body;
}

Solve Pile::solve_anew(double tolerance, std::uint32_t most_sweeps, std::uint32_t threads) {
  body = start;
  for (Contact& one : contact) one.impulse = {};
  options.tolerance = tolerance;
  options.most_sweeps = most_sweeps;
  options.threads = threads;
  ilaw_batch b = batch();
  b.energy = {};
  b.status = nullptr;
  const double begin = seconds(threads);
  const ilaw_coupled_report report = solve(b);
  return {seconds(threads) - begin, static_cast<double>(report.sweeps)};
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

// An iteration: of solves that end after 5 and 55. The rest of a solve: of one that ends at a tolerance,
// since one that does not is explained.
void measure(Pile& pile, std::uint32_t threads) {
  constexpr std::uint32_t few = 5, many = 55;
  constexpr double never = 1e-300, soon = 0.1;
  std::vector<double> each, once;
  const double unit = 1e9 / static_cast<double>(pile.contact.size());
  for (int run = 0; run < runs; ++run) {
    const double more = pile.solve_anew(never, many, threads).seconds;
    each.push_back((more - pile.solve_anew(never, few, threads).seconds) / (many - few) * unit);
  }
  for (int run = 0; run < runs; ++run) {
    const Solve whole = pile.solve_anew(soon, many, threads);
    once.push_back(whole.seconds * unit - whole.iterations * median(each));
  }
  std::printf("%zu grains, %zu contacts, %u threads: an iteration %.1f ns a contact, once a solve %.0f ns\n",
              pile.body.size(), pile.contact.size(), threads, median(each), median(once));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: ilaw_bench_coupled_cost GRAINS...\n");
    return 2;
  }
  const std::uint32_t processors = std::thread::hardware_concurrency();
  for (int i = 1; i < argc; ++i) {
    Pile pile(std::atoi(argv[i]));
    measure(pile, 1);
    if (processors > 1) measure(pile, processors);
  }
  return 0;
}
