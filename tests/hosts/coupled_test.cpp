// Contacts that share bodies (ilaw/coupled.h) against what is known without them: weight, momentum, energy,
// and the same contacts on two ranks. Other orders, threads and problems: python/test_solver_machine.py.
// SPDX-License-Identifier: BSD-3-Clause
#include "coupled_scene.hpp"

#include "support/program.hpp"

#include <gtest/gtest.h>
#include <ilaw/coupled.hpp>
#include <ilaw/loader.hpp>

#include <algorithm>
#include <barrier>
#include <cmath>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

namespace {

using namespace coupled_scene;
using ilaw::testing::Random;

TEST(Coupled, TiedGrainsBecomeOneBody) {
  Scene scene = cube(tie(), 3);
  const double before = scene.kinetic();
  std::vector<double> momentum(3);
  for (std::size_t i = 0; i < scene.v.size(); ++i) momentum[i % 3] += scene.v[i];
  double kinetic = before;
  for (int n = 0; n < 10; ++n) {
    const ilaw_coupled_report report = scene.step(0.0, 1e-13);
    EXPECT_EQ(report.message, nullptr) << report.message;
    EXPECT_LE(scene.kinetic(), kinetic * (1.0 + 1e-11)) << "step " << n;
    kinetic = scene.kinetic();
  }
  for (std::size_t c = 0; c < 3; ++c) {
    double after = 0.0;
    for (std::size_t i = c; i < scene.v.size(); i += 3) after += scene.v[i];
    EXPECT_NEAR(after, momentum[c], 1e-12) << "momentum along " << c;
  }
  EXPECT_LE(scene.largest_slip(), 1e-11);
  EXPECT_GT(kinetic, 0.01 * before) << "what they have as one mechanism stays";
}

std::vector<double> velocities_after(Scene& scene, double tolerance, std::uint32_t most_sweeps = 5000) {
  for (int n = 0; n < 3; ++n) scene.step(g, tolerance, most_sweeps);
  std::vector<double> all = scene.v;
  all.insert(all.end(), scene.w.begin(), scene.w.end());
  return all;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::fabs(a[i] - b[i]));
  return largest;
}

// Two ranks as two threads: bodies 0 to 27 with those of the other as copies behind, each contact on one
// rank.
struct Ranks {
  std::barrier<> meet{2};
  std::vector<double> posted[2];
};

struct Rank {
  Ranks* all;
  int number;
  std::vector<std::int32_t> local_of;  // of a body's number

  std::vector<double> other(const double* values, std::int64_t count) {
    all->posted[number].assign(values, values + count);
    all->meet.arrive_and_wait();
    std::vector<double> read = all->posted[1 - number];
    all->meet.arrive_and_wait();
    return read;
  }
};

ilaw_exchange exchange_of(Rank& rank) {
  ilaw_exchange exchange{};
  exchange.struct_size = sizeof exchange;
  exchange.context = &rank;
  // Both number all bodies, so that what the other posts has the same bodies; rank 0 is added first on both.
  exchange.sum_bodies = [](void* context, double* values, std::int64_t components) {
    Rank& self = *static_cast<Rank*>(context);
    std::vector<double> global(self.local_of.size() * static_cast<std::size_t>(components));
    const auto width = static_cast<std::size_t>(components);
    for (std::size_t i = 0; i < self.local_of.size(); ++i)
      for (std::size_t c = 0; c < width; ++c)
        global[i * width + c] = values[static_cast<std::size_t>(self.local_of[i]) * width + c];
    const std::vector<double> other = self.other(global.data(), static_cast<std::int64_t>(global.size()));
    for (std::size_t i = 0; i < self.local_of.size(); ++i)
      for (std::size_t c = 0; c < width; ++c)
        values[static_cast<std::size_t>(self.local_of[i]) * width + c] =
            global[i * width + c] + other[i * width + c];
  };
  exchange.largest = [](void* context, double* values, std::int64_t count) {
    const std::vector<double> other = static_cast<Rank*>(context)->other(values, count);
    for (std::size_t i = 0; i < other.size(); ++i) values[i] = std::max(values[i], other[i]);
  };
  exchange.sum = [](void* context, double* values, std::int64_t count) {
    const std::vector<double> other = static_cast<Rank*>(context)->other(values, count);
    for (std::size_t i = 0; i < other.size(); ++i) values[i] += other[i];
  };
  return exchange;
}

// The rank's share of a scene: its own bodies first, the contacts whose body it owns.
void run_rank(Ranks& ranks, int number, const Scene& whole, ilaw::interface (*law)(),
              std::vector<double>& velocities, ilaw_coupled_report& report) {
  const std::int32_t count = static_cast<std::int32_t>(whole.v.size() / 3), half = 11;
  Rank rank{&ranks, number, {}};
  const std::int32_t owned = number == 0 ? half : count - half;
  for (std::int32_t i = 0; i < count; ++i)
    rank.local_of.push_back(number == 0 ? i : i < half ? owned + i : i - half);
  Scene part(law(), static_cast<std::size_t>(count));
  part.form = whole.form;
  for (std::int32_t i = 0; i < count; ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      const auto to = static_cast<std::size_t>(3 * rank.local_of[static_cast<std::size_t>(i)]) + c;
      part.v[to] = part.v_before[to] = whole.v[static_cast<std::size_t>(3 * i) + c];
      part.w[to] = part.w_before[to] = whole.w[static_cast<std::size_t>(3 * i) + c];
    }
  for (std::size_t k = 0; k < whole.body.size(); ++k)
    if ((whole.body[k] < half) == (number == 0))
      part.add(rank.local_of[static_cast<std::size_t>(whole.body[k])],
               whole.counterpart[k] < 0 ? -1 : rank.local_of[static_cast<std::size_t>(whole.counterpart[k])],
               0.0, {whole.normal[3 * k], whole.normal[3 * k + 1], whole.normal[3 * k + 2]});
  part.initialise();
  const ilaw_exchange exchange = exchange_of(rank);
  ilaw_coupled_options options{};
  options.tolerance = 1e-11;
  options.exchange = &exchange;
  const ilaw_batch batch = part.batch();
  const ilaw_contacts contacts = part.contacts(batch);
  const ilaw_contacts* groups[] = {&contacts};
  ilaw_bodies bodies = part.bodies();
  bodies.owned_count = owned;
  report = part.solver.solve(bodies, groups, options);
  velocities.clear();
  for (const std::vector<double>* of : {&part.v, &part.w})
    for (const std::int32_t local : rank.local_of)
      for (std::size_t c = 0; c < 3; ++c)
        velocities.push_back((*of)[3 * static_cast<std::size_t>(local) + c]);
}

void expect_ranks_agree(ilaw::interface (*law)(), std::uint32_t form,
                        Scene (*scene_of)(ilaw::interface, unsigned, std::uint32_t) = cube) {
  const auto made = [&] {  // and a sphere that touches nothing
    Scene scene = scene_of(law(), 11, form);
    scene.v.insert(scene.v.end(), {1.0, 2.0, 3.0});
    for (auto* vectors : {&scene.w, &scene.v_before, &scene.w_before}) vectors->resize(scene.v.size(), 0.5);
    return scene;
  };
  Scene whole = made();
  const Scene start = made();
  const ilaw_coupled_report alone = whole.step(0.0, 1e-11);
  Ranks ranks;
  std::vector<double> found[2];
  ilaw_coupled_report reports[2];
  std::thread second(run_rank, std::ref(ranks), 1, std::cref(start), law, std::ref(found[1]),
                     std::ref(reports[1]));
  run_rank(ranks, 0, start, law, found[0], reports[0]);
  second.join();
  std::vector<double> motion = whole.v;
  motion.insert(motion.end(), whole.w.begin(), whole.w.end());
  EXPECT_EQ(found[0], found[1]) << "copies differ from what their owners have";
  EXPECT_LE(largest_difference(found[0], motion), 1e-9);
  EXPECT_LE(alone.residual, 1e-11);
  EXPECT_LE(reports[0].residual, 1e-11);
  EXPECT_EQ(reports[0].sweeps, reports[1].sweeps);
  EXPECT_EQ(reports[0].residual, reports[1].residual);
  EXPECT_NEAR(reports[0].work + reports[1].work, alone.work, 1e-9 * std::fabs(alone.work));
}

TEST(Coupled, RanksAgreeToTheTolerance) {
  expect_ranks_agree(
      +[] { return friction(0.4); }, ILAW_DELASSUS_FULL);
  expect_ranks_agree(rolling, ILAW_DELASSUS_TRANSVERSE_SPIN);
}

// A chain that hangs, of bonds of which some break and shed their load on others across the border.
TEST(Coupled, RanksBreakTheSameBonds) {
  const auto chain = [](ilaw::interface law, unsigned seed, std::uint32_t form) {
    Scene scene(std::move(law), 27);
    scene.form = form;
    for (int i = 0; i < 27; ++i) scene.add(i, i - 1, 0.0, {0, 0, 1});
    Random random(seed);
    for (double& x : scene.v) x = random();
    scene.initialise();
    return scene;
  };
  expect_ranks_agree(
      +[] {
        return create("tie", ILAW_DELASSUS_FULL, {{"strength", 4.0}});
      },
      ILAW_DELASSUS_FULL, chain);
}

TEST(Coupled, RefusesWhatItCannotSolve) {
  Scene scene = cube(friction(0.0), 1);
  const std::vector<double> before = scene.v;
  scene.counterpart[4] = 27;
  try {
    scene.step(0.0, 1e-6);
    FAIL() << "a body that is not there";
  } catch (const ilaw::error& error) {
    EXPECT_STREQ(error.what(), "a contact names a body that is not there");
  }
  EXPECT_EQ(scene.v, before);
  scene.counterpart[4] = scene.body[4];
  EXPECT_THROW(scene.step(0.0, 1e-6), ilaw::error);
}

// Spheres: the matrix in the host's axes and the two values of it are the same H.
TEST(Coupled, TransverseMassesGiveWhatFullOnesGive) {
  const auto made = [](const char* law, std::uint32_t form) {
    const bool rubs = std::string(law) == "coulomb";
    Scene scene = cube(create(law, form,
                              rubs ? std::vector{std::pair{"friction", 0.4}}
                                   : std::vector<std::pair<const char*, double>>{}),
                       7);
    scene.form = form;
    for (auto* vectors : {&scene.normal, &scene.arm, &scene.other_arm})
      for (std::size_t k = 0; k < vectors->size(); k += 3) {  // out of the axes, by turns of 3-4-5
        double* a = &(*vectors)[k];
        const double x = 0.6 * a[0] - 0.8 * a[1], y = 0.8 * a[0] + 0.6 * a[1];
        const double x_2 = 0.6 * x - 0.8 * a[2], z = 0.8 * x + 0.6 * a[2];
        a[0] = x_2, a[1] = y, a[2] = z;
      }
    scene.initialise();
    return scene;
  };
  for (const char* law : {"coulomb", "tie"}) {
    Scene full = made(law, ILAW_DELASSUS_FULL), transverse = made(law, ILAW_DELASSUS_TRANSVERSE);
    // Few sweeps: not because both have converged.
    EXPECT_LE(largest_difference(velocities_after(full, 1e-2, 10), velocities_after(transverse, 1e-2, 10)),
              1e-12)
        << law;
  }
  Scene aside = made("tie", ILAW_DELASSUS_TRANSVERSE);
  aside.arm[3 * 5] += 1e-3;
  try {
    aside.step(0.0, 1e-6);
    FAIL() << "an arm aside";
  } catch (const ilaw::error& error) {
    EXPECT_STREQ(error.what(), "delassus_form is transverse, and an arm is not along the normal");
  }
}

TEST(Coupled, NamesContactsWithBadInputAndSolvesTheOthers) {
  Scene scene = cube(friction(0.0), 1);
  scene.gap[5] = std::nan("");
  const ilaw_coupled_report report = scene.step(0.0, 1e-10);
  EXPECT_EQ(report.bad_count, 1);
  EXPECT_EQ(report.bad_group, 0);
  EXPECT_EQ(report.bad_contact, 5);
  EXPECT_LE(report.residual, 1e-10);
  EXPECT_EQ(scene.impulse[15], 0.0);
}

// host_mock/minimal/grains.c, a host in C: a thousand grains fall into a box. docs/comparisons.md has larger
// ones.
TEST(Coupled, PileSettlesWithoutSinkingIntoItself) {
  setenv("ILAW_PATH", ILAW_PLUGIN_FOLDER, 1);
  const auto [code, output] =
      ilaw::testing::programs::run_command(ILAW_grains_c " coulomb 1000 250 15 5e-3 10");
  ASSERT_EQ(code, 0) << output;
  double overlap = 1.0, kinetic = 1.0, residual = 1.0, sweeps = 0.0, step = 0.0;
  int contacts = 0;
  ASSERT_EQ(
      std::sscanf(output.c_str(),
                  "overlap %lf kinetic %lf residual %lf sweeps %lf contacts %d cpu [s] %*f, a step [ms] %lf,",
                  &overlap, &kinetic, &residual, &sweeps, &contacts, &step),
      6)
      << output;
  EXPECT_LE(overlap, 0.01) << "of a diameter";
  EXPECT_LE(kinetic, 0.01) << "of the energy of the fall";
  EXPECT_GE(contacts, 3000) << "a grain in a pile has some three of its own";
  EXPECT_LE(sweeps, 15.0);
}

}  // namespace
