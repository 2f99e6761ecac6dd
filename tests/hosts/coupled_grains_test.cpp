// Solid spheres of any size with spins and moments (ilaw/coupled.h, the law rolling): closed forms of a ball
// on a plane and of two balls, and a pile with its energy, residual and symmetries. Central differences,
// contacts found anew in each step.
// SPDX-License-Identifier: BSD-3-Clause
#include "laws/rolling/spheres.hpp"
#include "support/coupled_problem.hpp"

namespace ilaw::testing {
namespace coupled_grains {
namespace {

constexpr double steps[] = {1e-3, 7.3e-4, 3.7e-4};  // share no factor
constexpr Vector up{0.0, 0.0, 1.0};

// The plane normal.x = offset, at rest at the points of contact.
struct Wall {
  Vector normal = up;
  double offset = 0.0;
  Vector spin{}, spin_before{};
};

struct Grains : CoupledProblem {
  Grains(const Parameters& parameters, double length_of_step)
      : CoupledProblem(make_law("rolling", SetupBuilder(parameters, 3, ILAW_DELASSUS_TRANSVERSE_SPIN,
                                                        ILAW_FRAME_GLOBAL)),
                       ILAW_DELASSUS_TRANSVERSE_SPIN) {
    h = length_of_step;
    options.most_sweeps = 1000;
    options.tolerance = 1e-14;
  }
  void add_grain(double mass, double radius, const Vector& x, const Vector& v = {}, const Vector& w = {}) {
    Body one{mass, 0.4 * mass * radius * radius, radius};
    one.x = x, one.v = v, one.w = w;
    add_body(one);
  }
  ilaw_coupled_report advance() {
    find_contacts();
    for (Body& one : body) one.v_before = one.v, one.w_before = one.w, one.v = one.v + h * pull;
    time += h;
    const ilaw_coupled_report report = solve();
    for (Body& one : body) one.x = one.x + h * one.v;
    dissipated += report.energy[ILAW_ENERGY_FRICTION] + report.energy[ILAW_ENERGY_IMPACT];
    work += report.work;
    iterations += report.sweeps;
    return report;
  }
  void run(double duration) {
    for (int k = 0; k < std::lround(duration / h); ++k) advance();
  }
  // Impulses of the last step are where this one begins.
  void find_contacts() {
    std::map<std::pair<int, int>, Contact> last;
    for (std::size_t k = 0; k < contact.size(); ++k) last[keys[k]] = contact[k];
    contact.clear(), ends.clear(), other_ends.clear(), keys.clear();
    const auto meet = [&](int a, int b, int wall, const Vector& n, double gap) {
      if (gap > reach) return;
      Contact& made = touch(a, b, n, gap);
      if (b < 0) {
        made.wall_spin = walls[static_cast<std::size_t>(wall)].spin;
        made.wall_spin_before = walls[static_cast<std::size_t>(wall)].spin_before;
      }
      keys.emplace_back(a, b < 0 ? -1 - wall : b);
      const auto found = last.find(keys.back());
      if (found == last.end()) return;
      if (begins_with_impulse) made.impulse = found->second.impulse;
      if (begins_with_moment) made.moment = found->second.moment;
    };
    for (int i = 0; i < static_cast<int>(body.size()); ++i) {
      for (int j = 0; j < i; ++j) {
        const Vector d = at(i).x - at(j).x;
        meet(i, j, 0, (1.0 / length(d)) * d, length(d) - at(i).radius - at(j).radius);
      }
      for (std::size_t p = 0; p < walls.size(); ++p)
        meet(i, -1, static_cast<int>(p), walls[p].normal,
             dot(walls[p].normal, at(i).x) - walls[p].offset - at(i).radius);
    }
  }
  double largest_speed() const {
    double most = 0.0;
    for (const Body& one : body) most = std::max(most, length(one.v) + one.radius * length(one.w));
    return most;
  }

  std::vector<Wall> walls;
  std::vector<std::pair<int, int>> keys;
  Vector pull{0.0, 0.0, -9.81};
  double reach = 0.0;  // contacts have gaps up to it
  bool begins_with_impulse = true, begins_with_moment = true;
  double dissipated = 0.0, work = 0.0;
  std::uint64_t iterations = 0;
};

constexpr double mass = 0.3, radius = 0.05, gravity = 9.81, inertia = 0.4 * mass * radius * radius;

// A ball on a floor.
Grains ball(const Parameters& parameters, double h) {
  Grains made(parameters, h);
  made.add_grain(mass, radius, {0.0, 0.0, radius});
  made.walls.push_back({});
  return made;
}

// The first iteration evaluates the law at the velocities without contact: the same bits.
TEST(CoupledRolling, FirstIterationHasTheBitsOfEvaluate) {
  for (const double h : steps) {
    const Parameters parameters = resistance(0.3, 0.002, 0.001);
    Grains one = ball(parameters, h);
    one.options.most_sweeps = 1;
    one.find_contacts();
    const Vector arm{0.0, 0.0, -radius}, v{1.0, -0.3, 0.0}, w{3.0, 5.0, -2.0}, w_before{-7.0, -11.0, 5.0};
    const Vector v_free = v + h * one.pull;
    one.body[0].v_before = v, one.body[0].w_before = w_before;
    one.body[0].v = v_free, one.body[0].w = w;
    one.solve();
    Spheres node(parameters, 1);
    node.velocity_step = node.position_step = h;
    node.h[0] = {1.0 / mass, 1.0 / mass + (1.0 / inertia) * radius * radius, radius * (1.0 / inertia),
                 1.0 / inertia, 1.0 / inertia};
    node.v_previous[0] = v + cross(w_before, arm), node.spin_previous[0] = w_before;
    node.v_free[0] = v_free + cross(w, arm), node.spin_free[0] = w;
    ASSERT_EQ(node.evaluate(), ILAW_OK);
    EXPECT_EQ(one.contact[0].impulse, node.r[0]) << h;
    EXPECT_EQ(one.contact[0].moment, node.m[0]) << h;
  }
}

// A roller below the ball that spins ever faster, by alpha t about y: the rolling moment rho M g drives the
// ball with 7/5 a = rho g/R. The roller gives rho M g times its angle, of which the ball keeps its kinetic
// energy.
TEST(CoupledRolling, RollerDrivesTheBall) {
  constexpr double rho = 0.002, alpha = 40.0, a = rho * gravity / (1.4 * radius);
  static_assert(alpha > 2.0 * a / radius);
  for (const double h : steps) {
    Grains one = ball(resistance(0.5, rho, 0.0), h);
    one.walls_spin = true;
    const auto count = std::lround(0.5 / h);
    for (long k = 1; k <= count; ++k) {
      one.walls[0].spin_before = one.walls[0].spin;
      one.walls[0].spin = {0.0, alpha * static_cast<double>(k) * h, 0.0};
      one.advance();
    }
    const double time = h * static_cast<double>(count),
                 given = rho * mass * gravity * 0.5 * alpha * time * time;
    EXPECT_NEAR(one.body[0].v[0], a * time, 1e-11) << "h " << h;
    EXPECT_NEAR(one.body[0].w[1], a * time / radius, 1e-10) << "h " << h;
    EXPECT_NEAR(one.dissipated, given - one.kinetic(), 1e-12 * given) << "h " << h;
    EXPECT_NEAR(one.work, one.kinetic() - given, 1e-12 * given) << "h " << h;
  }
}

// Grains on each other that spin about the vertical stop by twisting friction alone: their velocities are
// solved from the start, their spins are not.
TEST(CoupledRolling, ColumnStopsTwisting) {
  Grains tower(resistance(0.4, 0.1, 0.1), 1e-3);
  tower.walls.push_back({});
  tower.reach = 1e-9;
  for (int i = 0; i < 10; ++i) tower.add_grain(1.0, 0.5, {0.0, 0.0, 0.5 + i});
  tower.advance();
  for (std::size_t i = 0; i < 10; ++i) tower.body[i].w[2] = 1e-4 * static_cast<double>(1 + i);
  EXPECT_EQ(tower.advance().message, nullptr);
  for (const auto& one : tower.body) EXPECT_LE(length(one.w), 1e-12);
}

// ---- a pile
// --------------------------------------------------------------------------------------------------

constexpr double diameter = 0.02, tolerance = 1e-8;

// Linear map of positions, velocities and normals; spins turn with the determinant besides.
struct Map {
  Matrix rows{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  double sign = 1.0;
  Vector operator()(const Vector& a) const { return times(rows, a); }
  Vector of_spin(const Vector& a) const { return sign * (*this)(a); }
};

// 45 grains that fall on a floor, with any velocities and spins, in other units of length and axes.
Grains heap(double h, double unit = 1.0, const Map& map = {}) {
  const double size = unit * diameter;
  Grains made(resistance(0.3, 0.02 * size, 0.02 * size), h);
  made.options.tolerance = tolerance;
  made.pull = unit * map(made.pull);
  made.reach = 0.1 * size;
  Random within(7);
  for (int i = 0; i < 45; ++i) {
    const double r = size * within(0.35, 0.5);
    const Vector x =
        size * Vector{i % 3 + within(0.5, 0.52), i / 3 % 3 + within(0.5, 0.52), i / 9 + within(0.5, 0.52)};
    const Vector v = unit * Vector{within(-0.2, 0.2), within(-0.2, 0.2), within(-0.2, 0.0)};
    const Vector w{within(-20.0, 20.0), within(-20.0, 20.0), within(-20.0, 20.0)};
    made.add_grain(2500.0 * 4.18879 * r * r * r / (unit * unit * unit), r, map(x), map(v), map.of_spin(w));
  }
  made.walls.push_back({map(up), 0.0, {}, {}});
  return made;
}

TEST(CoupledHeap, SettlesAndMakesNoEnergy) {
  for (const double h : steps) {
    Grains all = heap(h);
    const double at_start = all.kinetic();
    std::size_t most_contacts = 0;
    for (int k = 0; k < std::lround(0.3 / h); ++k) {
      const double before = all.kinetic(), dissipated = all.dissipated,
                   half = 0.5 * h * dot(all.pull, all.momentum());
      const ilaw_coupled_report report = all.advance();
      ASSERT_LE(report.residual, tolerance) << "h " << h << ", step " << k << ": " << report.message;
      const double rounding = report.energy_error + 1e-14 * at_start,
                   fallen = half + 0.5 * h * dot(all.pull, all.momentum());
      ASSERT_LE(report.work, rounding) << "h " << h << ", step " << k;
      ASSERT_NEAR(report.work, dissipated - all.dissipated, rounding) << "h " << h << ", step " << k;
      ASSERT_NEAR(report.work, all.kinetic() - before - fallen, 1e-14 * at_start)
          << "h " << h << ", step " << k;
      most_contacts = std::max(most_contacts, all.contact.size());
    }
    EXPECT_GT(most_contacts, 70U);
  }
}

// Lengths in units of 2^-10 m: the same bits, times powers of two. A spin that were compared with velocities
// by its number alone would end iterations elsewhere.
TEST(CoupledHeap, UnitOfLengthChangesNothing) {
  Grains one = heap(1e-3), small = heap(1e-3, 1024.0);
  for (int k = 0; k < 100; ++k) {
    const ilaw_coupled_report a = one.advance(), b = small.advance();
    ASSERT_EQ(a.sweeps, b.sweeps) << "step " << k;
    ASSERT_EQ(a.residual, b.residual) << "step " << k;
  }
  for (std::size_t i = 0; i < one.body.size(); ++i) {
    EXPECT_EQ(1024.0 * one.body[i].v, small.body[i].v);
    EXPECT_EQ(one.body[i].w, small.body[i].w);
  }
}

TEST(CoupledHeap, TurnsWithTheFrameAndItsMirror) {
  for (const Map& map : {Map{{{{0.6, -0.8, 0.0}, {0.48, 0.36, -0.8}, {0.64, 0.48, 0.6}}}, 1.0},
                         Map{{{{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, -1.0}}) {
    Grains one = heap(steps[1]), other = heap(steps[1], 1.0, map);
    one.options.tolerance = other.options.tolerance = 1e-13;
    one.run(0.03), other.run(0.03);
    for (std::size_t i = 0; i < one.body.size(); ++i) {
      const auto &a = one.body[i], &b = other.body[i];
      EXPECT_LE(length(map(a.v) - b.v) + a.radius * length(map.of_spin(a.w) - b.w),
                2e-9 * one.largest_speed());
    }
    EXPECT_GT(std::count_if(one.contact.begin(), one.contact.end(),
                            [](const auto& c) { return c.moment != Vector{}; }),
              20);
  }
}

// 5 x 5 grains with 4 x 4 on top, held by friction and rolling resistance: at rest impulses and moments of
// the last step are those of this one.
TEST(CoupledHeap, WarmStartSavesIterations) {
  for (const double h : steps) {
    const auto iterations = [h](bool with_impulse, bool with_moment) {
      Grains all(resistance(0.8, 0.02 * diameter, 0.02 * diameter), h);
      all.options.tolerance = tolerance;
      all.reach = 0.1 * diameter;
      all.walls.push_back({});
      for (int layer = 0; layer < 2; ++layer)
        for (int i = 0; i < (5 - layer) * (5 - layer); ++i)
          all.add_grain(0.01, 0.5 * diameter,
                        diameter * Vector{i % (5 - layer) + 0.5 * layer, i / (5 - layer) + 0.5 * layer,
                                          0.5 + layer * std::sqrt(0.5)});
      for (int k = 0; k < 20; ++k) all.advance();
      all.begins_with_impulse = with_impulse, all.begins_with_moment = with_moment;
      const std::uint64_t before = all.iterations;
      for (int k = 0; k < 5; ++k) all.advance();
      EXPECT_LE(all.largest_speed(), 1e-7 * h * gravity);
      return all.iterations - before;
    };
    const std::uint64_t warm = iterations(true, true);
    EXPECT_LE(warm, 5U) << "h " << h;
    EXPECT_GT(iterations(true, false), 4 * warm) << "h " << h;
    EXPECT_GT(iterations(false, false), 4 * warm) << "h " << h;
  }
}

// Spheres on each other below one of 10,000 times their mass: without Newton steps two to six times the
// iterations.
TEST(CoupledHeap, ColumnUnderAWeightTakesNewtonSteps) {
  for (const double h : steps) {
    Grains all(resistance(0.4, 0.02, 0.02), h);
    all.options.tolerance = 1e-10;
    all.reach = 0.01;
    all.walls.push_back({});
    for (int i = 0; i < 10; ++i)
      all.add_grain(i == 9 ? 1e4 : 1.0, 0.5, {0.01 * (i % 2), 0.0, 0.5 + i * std::sqrt(1.0 - 1e-4)}, {},
                    {0.01 * i, 0.02 * (i % 3), 0.05 * (i % 5)});
    for (int k = 0; k < 3; ++k) {
      const ilaw_coupled_report report = all.advance();
      EXPECT_LE(report.residual, 1e-10) << "h " << h << ", step " << k;
      EXPECT_EQ(report.method, ILAW_METHOD_NEWTON) << "h " << h << ", step " << k;
    }
  }
}

}  // namespace
}  // namespace coupled_grains
}  // namespace ilaw::testing
