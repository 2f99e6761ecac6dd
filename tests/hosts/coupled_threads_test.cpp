// Threads of ilaw_coupled_solve: the bits of one. A program of its own, so that the thread sanitizer need not
// build all others.
#include "support/coupled_problem.hpp"

#include <thread>

namespace ilaw::testing {
namespace {

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
// floor touch: colors of one contact each. Conjugate iterations are among those that are allowed.
CoupledProblem lattice(const Case& of, int side = 22) {
  const int count = side * side * side;
  CoupledProblem made(coupled_law(of.law, of.form, {{"friction", 0.3}}), of.form,
                      static_cast<std::size_t>(count + (of.has_drum ? 1 : 0)));
  Random random(5);
  for (CoupledProblem::Body& one : made.body) one.v = random.vector(0.01), one.w = random.vector(0.01);
  const std::array<int, 3> stride{1, side, side * side};
  for (int i = 0; i < count; ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      Vector n{};
      n[c] = 1.0;
      const bool is_outside = i / stride[c] % side == 0;
      if (is_outside && c == 1) continue;
      const int floor = of.has_drum && c == 2 ? count : -1;
      made.touch(i, is_outside ? floor : i - stride[c], n, 1e-5 * random());
    }
  made.options.tolerance = 1e-12;
  made.options.most_sweeps = 15;
  return made;
}

// Starts threads for each part, of which the host has `most`.
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

class CoupledThreads : public ::testing::TestWithParam<Case> {};

// Those of the solver, and three of the host, which has fewer.
TEST_P(CoupledThreads, GiveTheBitsOfOne) {
  CoupledProblem one = lattice(GetParam());
  const ilaw_coupled_report expected = one.step(10.0);
  for (const std::uint32_t of_host : {0U, 1U, 2U, 3U})
    for (const std::uint32_t threads : of_host > 0 ? std::vector{3U} : std::vector{1U, 2U, 3U}) {
      GIVEN(of_host, threads);
      CoupledProblem other = lattice(GetParam());
      Pool pool(of_host);
      other.options.threads = threads;
      if (of_host > 0) other.options.pool = &pool.given;
      const ilaw_coupled_report report = other.step(10.0);
      EXPECT_EQ(pool.asked, of_host > 0 ? 3U : 0U);
      EXPECT_TRUE(other.velocities() == one.velocities() && other.spins() == one.spins());
      for (std::size_t k = 0; k < one.contact.size(); ++k) {
        const CoupledProblem::Contact &a = one.contact[k], &b = other.contact[k];
        ASSERT_TRUE(a.impulse == b.impulse && a.moment == b.moment && a.energy == b.energy &&
                    a.status == b.status)
            << k;
      }
      EXPECT_EQ(report.residual, expected.residual);
      EXPECT_EQ(report.sweeps, expected.sweeps);
      EXPECT_EQ(report.worst_contact, expected.worst_contact);
    }
  CoupledProblem small = lattice(GetParam(), 4);
  Pool none(1);
  none.given.run = nullptr;
  small.options.pool = &none.given;
  EXPECT_THROW(small.step(10.0), ilaw::coupled_error);
}

TEST_P(CoupledThreads, NameTheBadContactsOfOne) {
  std::vector<std::int64_t> first;
  for (const std::uint32_t threads : {0U, 2U}) {
    CoupledProblem grains = lattice(GetParam());
    grains.options.threads = threads;
    grains.options.most_sweeps = 10;
    for (const std::size_t k : {std::size_t{7000}, std::size_t{20000}}) grains.contact[k].gap = nan_value;
    const ilaw_coupled_report report = grains.step(10.0);
    first.push_back(report.bad_contact);
    EXPECT_EQ(report.bad_count, 2);
  }
  EXPECT_EQ(first[0], first[1]);
}

INSTANTIATE_TEST_SUITE_P(Forms, CoupledThreads, ::testing::ValuesIn(cases),
                         [](const auto& of) { return std::string(of.param.name); });

}  // namespace
}  // namespace ilaw::testing
