// Threads of ilaw_coupled_solve: the bits of one. A program of its own, so that the thread sanitizer need not
// build all others.
#include "support/law_runner.hpp"

#include <ilaw/coupled.hpp>

#include <thread>
#include <tuple>

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
struct Lattice {
  explicit Lattice(const Case& of, int side = 22)
      : law(make_law(of.law, SetupBuilder({{{"friction", 0.3}}, {}}, 3, of.form, ILAW_FRAME_GLOBAL))),
        form(of.form) {
    const int count = side * side * side;
    Random random(5);
    v.resize(static_cast<std::size_t>(count + (of.has_drum ? 1 : 0)));
    w.resize(v.size());
    for (std::size_t i = 0; i < v.size(); ++i) v[i] = random.vector(0.01), w[i] = random.vector(0.01);
    const std::array<int, 3> stride{1, side, side * side};
    for (int i = 0; i < count; ++i)
      for (std::size_t c = 0; c < 3; ++c) {
        const bool is_outside = i / stride[c] % side == 0;
        if (is_outside && c == 1) continue;
        normal.push_back({});
        normal.back()[c] = 1.0;
        body.push_back(i);
        other.push_back(!is_outside ? i - stride[c] : of.has_drum && c == 2 ? count : -1);
        gap.push_back(1e-5 * random());
      }
    for (const Vector& n : normal) arm.push_back(-0.5 * n), other_arm.push_back(0.5 * n);
    impulse.resize(normal.size()), moment.resize(normal.size()), energy.resize(normal.size());
    status.resize(normal.size());
    options.tolerance = 1e-12;
    options.most_sweeps = 15;
  }
  // A step of 1e-3 s in a gravity of 10.
  ilaw_coupled_report fall() {
    static const double inverse_mass = 0.5, inverse_inertia[6] = {5.0, 5.0, 5.0, 0.0, 0.0, 0.0};
    const auto input = [](const auto& a) { return ilaw::input(a.front().data(), 3, 1); };
    const auto output = [](auto& a) {
      return ilaw::output(a.front().data(), static_cast<std::int64_t>(a.front().size()), 1);
    };
    const std::vector<Vector> v_before = v, w_before = w;
    for (Vector& one : v) one[2] -= 1e-2;
    ilaw_bodies bodies{};
    bodies.struct_size = sizeof bodies;
    bodies.dimension = 3;
    bodies.count = bodies.owned_count = static_cast<std::int64_t>(v.size());
    bodies.inverse_mass = ilaw::input(&inverse_mass, 0, 0);
    bodies.inverse_inertia = ilaw::input(inverse_inertia, 0, form == ILAW_DELASSUS_FULL ? 1 : 0);
    bodies.v_free = input(v), bodies.v_previous = input(v_before), bodies.velocity = output(v);
    bodies.spin_free = input(w), bodies.spin_previous = input(w_before), bodies.spin = output(w);
    ilaw_batch batch{};
    batch.struct_size = sizeof batch;
    batch.node_count = static_cast<std::int64_t>(gap.size());
    batch.time = batch.velocity_step = batch.position_step = 1e-3;
    batch.gap = ilaw::input(gap.data(), 1, 0);
    batch.normal = input(normal);
    batch.impulse = output(impulse), batch.energy = output(energy);
    if (form == ILAW_DELASSUS_TRANSVERSE_SPIN) batch.moment = output(moment);
    batch.status = status.data();
    batch.status_stride = 1;
    ilaw_contacts contacts =
        ilaw::contacts_of(law, static_cast<ilaw_delassus_form>(form), batch, body.data(), other.data());
    contacts.arm = input(arm), contacts.counterpart_arm = input(other_arm);
    return solver.solve(bodies, contacts, options);
  }
  // All that is found.
  auto found() const { return std::tie(v, w, impulse, moment, energy, status); }

  ilaw::interface law;
  std::uint32_t form;
  std::vector<Vector> v, w, normal, arm, other_arm, impulse, moment;
  std::vector<std::array<double, ILAW_ENERGY_COUNT>> energy;
  std::vector<double> gap;
  std::vector<std::int32_t> body, other;
  std::vector<std::uint8_t> status;
  ilaw_coupled_options options{};
  ilaw::coupled solver;
};

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
  Lattice one(GetParam());
  const ilaw_coupled_report expected = one.fall();
  for (const std::uint32_t of_host : {0U, 1U, 2U, 3U})
    for (const std::uint32_t threads : of_host > 0 ? std::vector{3U} : std::vector{1U, 2U, 3U}) {
      GIVEN(of_host, threads);
      Lattice other(GetParam());
      Pool pool(of_host);
      other.options.threads = threads;
      if (of_host > 0) other.options.pool = &pool.given;
      const ilaw_coupled_report report = other.fall();
      EXPECT_EQ(pool.asked, of_host > 0 ? 3U : 0U);
      EXPECT_TRUE(other.found() == one.found());
      EXPECT_EQ(report.residual, expected.residual);
      EXPECT_EQ(report.sweeps, expected.sweeps);
      EXPECT_EQ(report.worst_contact, expected.worst_contact);
    }
  Lattice small(GetParam(), 4);
  Pool none(1);
  none.given.run = nullptr;
  small.options.pool = &none.given;
  EXPECT_THROW(small.fall(), ilaw::coupled_error);
}

TEST_P(CoupledThreads, NameTheBadContactsOfOne) {
  std::vector<std::int64_t> first;
  for (const std::uint32_t threads : {0U, 2U}) {
    Lattice grains(GetParam());
    grains.options.threads = threads;
    grains.options.most_sweeps = 10;
    for (const std::size_t k : {std::size_t{7000}, std::size_t{20000}}) grains.gap[k] = nan_value;
    const ilaw_coupled_report report = grains.fall();
    first.push_back(report.bad_contact);
    EXPECT_EQ(report.bad_count, 2);
  }
  EXPECT_EQ(first[0], first[1]);
}

INSTANTIATE_TEST_SUITE_P(Forms, CoupledThreads, ::testing::ValuesIn(cases),
                         [](const auto& of) { return std::string(of.param.name); });

}  // namespace
}  // namespace ilaw::testing
