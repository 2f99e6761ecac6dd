// The cost of an iteration of coupled contacts, and of a solve besides: grains on a lattice, each a
// little off its place, with friction and transverse H.
//
// Usage: ilaw_bench_coupled_cost GRAINS... Prints nanoseconds per contact, of one thread's processor time,
// then of the clock with a thread per processor: medians of some runs.
// SPDX-License-Identifier: BSD-3-Clause
#include <ilaw/arrays.hpp>
#include <ilaw/coupled.hpp>
#include <ilaw/loader.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <random>
#include <thread>
#include <vector>

namespace {

constexpr double radius = 0.5, spacing = 0.995, step = 1e-3;
constexpr int runs = 7;

double seconds(std::uint32_t threads) {
  std::timespec now{};
  clock_gettime(threads == 1 ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Pile {
  explicit Pile(int grains);
  struct Solve {
    double seconds, iterations;
  };
  // From rest, to a tolerance or for so many iterations.
  Solve solve(const ilaw::interface& law, double tolerance, std::uint32_t most_sweeps, std::uint32_t threads);

  std::vector<double> v, w, velocity, spin, gap, normal, arm, other_arm, impulse;
  std::vector<std::int32_t> body, counterpart;
  ilaw::coupled solver;
};

Pile::Pile(int grains) {
  const int side = static_cast<int>(std::lround(std::cbrt(grains)));
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<std::array<double, 3>> x;
  for (int i = 0; i < side * side * side; ++i)
    x.push_back({spacing * (i % side) + 0.004 * uniform(random),
                 spacing * (i / side % side) + 0.004 * uniform(random),
                 spacing * (i / side / side) + 0.004 * uniform(random)});
  for (int i = 0; i < 3 * side * side * side; ++i) {
    v.push_back(0.01 * uniform(random) - (i % 3 == 2 ? step * 10.0 : 0.0));
    w.push_back(0.01 * uniform(random));
  }
  velocity = v;
  spin = w;
  const auto add = [&](std::int32_t a, std::int32_t b, const std::array<double, 3>& d) {
    const double length = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    body.push_back(a);
    counterpart.push_back(b);
    gap.push_back(b < 0 ? 0.0 : length - 2.0 * radius);
    for (const double c : d) {
      normal.push_back(c / length);
      arm.push_back(-radius * c / length);
      other_arm.push_back(radius * c / length);
    }
  };
  const std::array<int, 3> stride{1, side, side * side};
  for (int i = 0; i < side * side * side; ++i) {
    if (i < side * side) add(i, -1, {0.0, 0.0, 1.0});
    for (std::size_t c = 0; c < 3; ++c)
      if (i / stride[c] % side > 0) {
        const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(i - stride[c]);
        add(i, i - stride[c], {x[a][0] - x[b][0], x[a][1] - x[b][1], x[a][2] - x[b][2]});
      }
  }
  impulse.resize(normal.size());
}

Pile::Solve Pile::solve(const ilaw::interface& law, double tolerance, std::uint32_t most_sweeps,
                        std::uint32_t threads) {
  const double inverse_mass = 1.0, inverse_inertia = 2.5 / (radius * radius);
  std::fill(impulse.begin(), impulse.end(), 0.0);
  ilaw_batch batch{};
  batch.struct_size = sizeof batch;
  batch.node_count = static_cast<std::int64_t>(body.size());
  batch.time = batch.velocity_step = batch.position_step = step;
  batch.gap = ilaw::input(gap.data(), 1, 0);
  batch.normal = ilaw::input(normal.data(), 3, 1);
  batch.impulse = ilaw::output(impulse.data(), 3, 1);
  ilaw_bodies bodies{};
  bodies.struct_size = sizeof bodies;
  bodies.dimension = 3;
  bodies.count = bodies.owned_count = static_cast<std::int64_t>(v.size() / 3);
  bodies.inverse_mass = ilaw::input(&inverse_mass, 0, 0);
  bodies.inverse_inertia = ilaw::input(&inverse_inertia, 0, 0);
  bodies.v_free = bodies.v_previous = ilaw::input(v.data(), 3, 1);
  bodies.spin_free = bodies.spin_previous = ilaw::input(w.data(), 3, 1);
  bodies.velocity = ilaw::output(velocity.data(), 3, 1);
  bodies.spin = ilaw::output(spin.data(), 3, 1);
  ilaw_contacts contacts =
      ilaw::contacts_of(law, ILAW_DELASSUS_TRANSVERSE, batch, body.data(), counterpart.data());
  contacts.arm = ilaw::input(arm.data(), 3, 1);
  contacts.counterpart_arm = ilaw::input(other_arm.data(), 3, 1);
  ilaw_coupled_options options{};
  options.tolerance = tolerance;
  options.most_sweeps = most_sweeps;
  options.threads = threads;
  const double start = seconds(threads);
  const ilaw_coupled_report report = solver.solve(bodies, contacts, options);
  return {seconds(threads) - start, static_cast<double>(report.sweeps)};
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

ilaw::interface friction() {
  ilaw_argument friction{};
  friction.struct_size = sizeof friction;
  friction.name = "friction";
  friction.number = 0.3;
  const ilaw_argument* arguments[] = {&friction};
  ilaw_setup setup{};
  setup.struct_size = sizeof setup;
  setup.dimension = 3;
  setup.delassus_form = ILAW_DELASSUS_TRANSVERSE;
  setup.frame = ILAW_FRAME_GLOBAL;
  setup.numbers = ILAW_NUMBERS_DOUBLE;
  setup.arguments = arguments;
  setup.argument_count = 1;
  return {ilaw::library("coulomb"), "", setup};
}

// An iteration: of solves that end after 5 and 55. The rest of a solve: of one that ends at a tolerance,
// since one that does not is explained.
void measure(Pile& pile, const ilaw::interface& law, std::uint32_t threads) {
  constexpr std::uint32_t few = 5, many = 55;
  constexpr double never = 1e-300, soon = 0.1;
  std::vector<double> each, once;
  const double unit = 1e9 / static_cast<double>(pile.body.size());
  for (int run = 0; run < runs; ++run) {
    const double more = pile.solve(law, never, many, threads).seconds;
    each.push_back((more - pile.solve(law, never, few, threads).seconds) / (many - few) * unit);
  }
  for (int run = 0; run < runs; ++run) {
    const Pile::Solve whole = pile.solve(law, soon, many, threads);
    once.push_back(whole.seconds * unit - whole.iterations * median(each));
  }
  std::printf("%zu grains, %zu contacts, %u threads: an iteration %.1f ns a contact, once a solve %.0f ns\n",
              pile.v.size() / 3, pile.body.size(), threads, median(each), median(once));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: ilaw_bench_coupled_cost GRAINS...\n");
    return 2;
  }
  const ilaw::interface law = friction();
  const std::uint32_t processors = std::thread::hardware_concurrency();
  for (int i = 1; i < argc; ++i) {
    Pile pile(std::atoi(argv[i]));
    measure(pile, law, 1);
    if (processors > 1) measure(pile, law, processors);
  }
  return 0;
}
