// Threads of ilaw_coupled_solve: the bits of one. A program of its own, so that the thread sanitizer need not
// build all others.
#include "coupled_scene.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <thread>
#include <vector>

namespace {

using namespace coupled_scene;

struct Case {
  const char *name, *law;
  std::uint32_t form;
  bool has_drum = false;
};
constexpr Case cases[] = {{"Spheres", "coulomb", ILAW_DELASSUS_TRANSVERSE},
                          {"Spins", "rolling", ILAW_DELASSUS_TRANSVERSE_SPIN},
                          {"Tensors", "coulomb", ILAW_DELASSUS_FULL},
                          {"Drum", "coulomb", ILAW_DELASSUS_TRANSVERSE, true}};

// Grains on a lattice, a little off their places, that fall onto a floor and along a side: enough of them
// that blocks exceed the cache and passes over bodies are shared. The drum is a body that all grains of the
// floor touch: colors of one contact each.
Scene lattice(const Case& of, int side = 22) {
  Scene scene(create(of.law, of.form, {{"friction", 0.3}}),
              static_cast<std::size_t>(side) * static_cast<std::size_t>(side * side) + (of.has_drum ? 1 : 0));
  scene.form = of.form;
  ilaw::testing::Random random(5);
  for (double& v : scene.v) v = 0.01 * random();
  for (double& w : scene.w) w = 0.01 * random();
  const std::array<int, 3> stride{1, side, side * side};
  for (int i = 0; i < side * side * side; ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      std::vector<double> normal(3, 0.0);
      normal[c] = 1.0;
      const bool is_outside = i / stride[c] % side == 0;
      if (is_outside && c == 1) continue;
      const int floor = of.has_drum && c == 2 ? side * side * side : -1;
      scene.add(i, is_outside ? floor : i - stride[c], 1e-5 * random(), normal);
    }
  return scene;
}

// Conjugate ones among them.
constexpr std::uint32_t most_iterations = 15;

class CoupledThreads : public ::testing::TestWithParam<Case> {};

TEST_P(CoupledThreads, GiveTheBitsOfOne) {
  Scene one = lattice(GetParam());
  const ilaw_coupled_report expected = one.step(g, 1e-12, most_iterations);
  for (const std::uint32_t threads : {1U, 2U, 3U}) {
    SCOPED_TRACE(threads);
    Scene scene = lattice(GetParam());
    scene.threads = threads;
    const ilaw_coupled_report report = scene.step(g, 1e-12, most_iterations);
    EXPECT_TRUE(scene.impulse == one.impulse);
    EXPECT_TRUE(scene.moment == one.moment);
    EXPECT_TRUE(scene.v == one.v);
    EXPECT_TRUE(scene.w == one.w);
    EXPECT_TRUE(scene.energy == one.energy);
    EXPECT_EQ(report.residual, expected.residual);
    EXPECT_EQ(report.sweeps, expected.sweeps);
    EXPECT_EQ(report.worst_contact, expected.worst_contact);
  }
}

// Starts threads for each part, of which the host has two, or more than asked.
struct Pool {
  explicit Pool(std::uint32_t at_most) : most(at_most) {
    given.struct_size = sizeof given;
    given.context = this;
    given.run = [](void* context, std::uint32_t threads, ilaw_work_function part, void* work) {
      Pool& pool = *static_cast<Pool*>(context);
      pool.asked = threads;
      const std::uint32_t count = std::min(threads, pool.most);
      std::vector<std::thread> others;
      for (std::uint32_t t = 1; t < count; ++t) others.emplace_back(part, work, t, count);
      part(work, 0, count);
      for (std::thread& other : others) other.join();
    };
  }
  ilaw_threads given{};
  std::uint32_t most, asked = 0;
};

TEST_P(CoupledThreads, OfTheHostGiveTheBitsOfOne) {
  Scene one = lattice(GetParam());
  one.step(g, 1e-12, most_iterations);
  for (const std::uint32_t most : {1U, 2U, 3U}) {
    Scene scene = lattice(GetParam());
    Pool pool(most);
    scene.threads = 3;
    scene.pool = &pool.given;
    scene.step(g, 1e-12, most_iterations);
    EXPECT_EQ(pool.asked, 3U);
    EXPECT_TRUE(scene.impulse == one.impulse && scene.v == one.v && scene.w == one.w) << most;
  }
  Scene scene = lattice(GetParam(), 4);
  Pool none(1);
  none.given.run = nullptr;
  scene.pool = &none.given;
  EXPECT_THROW(scene.step(g, 1e-12), ilaw::coupled_error);
}

TEST_P(CoupledThreads, NameTheBadContactsOfOne) {
  std::vector<std::int64_t> first, count;
  for (const std::uint32_t threads : {0U, 2U}) {
    Scene scene = lattice(GetParam());
    scene.threads = threads;
    for (const std::size_t contact : {std::size_t{7000}, std::size_t{20000}})
      scene.gap[contact] = std::numeric_limits<double>::quiet_NaN();
    const ilaw_coupled_report report = scene.step(g, 1e-12, 10);
    first.push_back(report.bad_contact);
    count.push_back(report.bad_count);
  }
  EXPECT_EQ(count[0], 2);
  EXPECT_EQ(count[1], 2);
  EXPECT_EQ(first[0], first[1]);
}

INSTANTIATE_TEST_SUITE_P(Forms, CoupledThreads, ::testing::ValuesIn(cases),
                         [](const auto& of) { return std::string(of.param.name); });

}  // namespace
