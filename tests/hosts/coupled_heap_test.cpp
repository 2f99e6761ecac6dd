// A pile of grains of different size with rolling and twisting resistance (ilaw/coupled.h): its energy,
// residual and symmetries.
// SPDX-License-Identifier: BSD-3-Clause
#include "coupled_grains.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace {

using namespace coupled_grains;

constexpr double diameter = 0.02, tolerance = 1e-8;
constexpr double heap_steps[] = {1e-3, 7.3e-4, 3.7e-4};  // share no factor
constexpr Vector pull{0.0, 0.0, -9.81};

// Linear map of positions, velocities and normals; spins turn with the determinant besides.
struct Map {
  std::array<Vector, 3> rows{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  double sign = 1.0;
  Vector operator()(const Vector& a) const { return {dot(rows[0], a), dot(rows[1], a), dot(rows[2], a)}; }
  Vector of_spin(const Vector& a) const { return sign * (*this)(a); }
};
const Map turned{{{{0.6, -0.8, 0.0}, {0.48, 0.36, -0.8}, {0.64, 0.48, 0.6}}}, 1.0};
const Map mirrored{{{{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, -1.0};

// 45 grains that fall on a floor, with any velocities and spins, in other units of length and axes.
Grains heap(double h, double unit = 1.0, const Map& map = {}) {
  const double size = unit * diameter;
  Grains made(resistance(0.3, 0.02 * size, 0.02 * size), h);
  made.options.tolerance = tolerance;
  made.pull = unit * map(pull);
  made.reach = 0.1 * size;
  Random within(7);
  for (int i = 0; i < 45; ++i) {
    const double r = size * within(0.35, 0.5);
    const Vector x =
        size * Vector{i % 3 + within(0.5, 0.52), i / 3 % 3 + within(0.5, 0.52), i / 9 + within(0.5, 0.52)};
    const Vector v = unit * Vector{within(-0.2, 0.2), within(-0.2, 0.2), within(-0.2, 0.0)};
    const Vector w{within(-20.0, 20.0), within(-20.0, 20.0), within(-20.0, 20.0)};
    const double m = 2500.0 * 4.18879 * r * r * r / (unit * unit * unit);
    made.grains.push_back({m, r, map(x), map(v), map.of_spin(w)});
  }
  made.walls.push_back({map({0, 0, 1}), 0.0, {}, {}});
  return made;
}

double largest_speed(const Grains& of) {
  double most = 0.0;
  for (const Grain& grain : of.grains)
    most = std::max(most, length(grain.v) + grain.radius * length(grain.w));
  return most;
}

TEST(CoupledHeap, SettlesAndMakesNoEnergy) {
  for (const double h : heap_steps) {
    Grains all = heap(h);
    const double at_start = all.kinetic();
    std::size_t most_contacts = 0;
    for (int k = 0; k < std::lround(0.3 / h); ++k) {
      const double before = all.kinetic(), dissipated_before = all.dissipated;
      double falls = 0.0;
      for (const Grain& grain : all.grains) falls -= 0.5 * h * grain.mass * dot(all.pull, grain.v);
      const ilaw_coupled_report report = all.step();
      for (const Grain& grain : all.grains) falls -= 0.5 * h * grain.mass * dot(all.pull, grain.v);
      ASSERT_LE(report.residual, tolerance) << "h " << h << ", step " << k << ": " << report.message;
      const double rounding = report.energy_error + 1e-14 * at_start;
      ASSERT_LE(report.work, rounding) << "h " << h << ", step " << k;
      ASSERT_NEAR(report.work, dissipated_before - all.dissipated, rounding) << "h " << h << ", step " << k;
      ASSERT_NEAR(report.work, all.kinetic() - before + falls, 1e-14 * at_start)
          << "h " << h << ", step " << k;
      most_contacts = std::max(most_contacts, all.body.size());
    }
    EXPECT_GT(most_contacts, 70U);
  }
}

// Lengths in units of 2^-10 m: the same bits, times powers of two. A spin that were compared with velocities
// by its number alone would end iterations elsewhere.
TEST(CoupledHeap, UnitOfLengthChangesNothing) {
  Grains one = heap(1e-3), small = heap(1e-3, 1024.0);
  for (int k = 0; k < 100; ++k) {
    const ilaw_coupled_report a = one.step(), b = small.step();
    ASSERT_EQ(a.sweeps, b.sweeps) << "step " << k;
    ASSERT_EQ(a.residual, b.residual) << "step " << k;
  }
  for (std::size_t i = 0; i < one.grains.size(); ++i) {
    EXPECT_EQ(1024.0 * one.grains[i].v, small.grains[i].v);
    EXPECT_EQ(one.grains[i].w, small.grains[i].w);
  }
}

TEST(CoupledHeap, TurnsWithTheFrameAndItsMirror) {
  for (const Map& map : {turned, mirrored})
    for (const double h : heap_steps) {
      Grains one = heap(h), other = heap(h, 1.0, map);
      one.options.tolerance = other.options.tolerance = 1e-13;
      one.run(0.03), other.run(0.03);
      double off = 0.0;
      std::size_t moments = 0;
      for (std::size_t i = 0; i < one.grains.size(); ++i) {
        const Grain &a = one.grains[i], &b = other.grains[i];
        off = std::max({off, length(map(a.v) - b.v), a.radius * length(map.of_spin(a.w) - b.w)});
      }
      for (const Vector& m : one.moment) moments += m != Vector{};
      EXPECT_LE(off, 1e-9 * largest_speed(one)) << "h " << h << ", sign " << map.sign;
      EXPECT_GT(moments, 20U);
    }
}

// 5 x 5 grains with 4 x 4 on top, held by friction and rolling resistance.
Grains stump(double h) {
  Grains made(resistance(0.8, 0.02 * diameter, 0.02 * diameter), h);
  made.options.tolerance = tolerance;
  made.reach = 0.1 * diameter;
  made.walls.push_back({});
  for (int layer = 0; layer < 2; ++layer)
    for (int i = 0; i < (5 - layer) * (5 - layer); ++i) {
      const Vector place{i % (5 - layer) + 0.5 * layer, i / (5 - layer) + 0.5 * layer,
                         0.5 + layer * std::sqrt(0.5)};
      made.grains.push_back({0.01, 0.5 * diameter, diameter * place, {}, {}});
    }
  return made;
}

// At rest impulses and moments of the last step are those of this one.
TEST(CoupledHeap, WarmStartSavesIterations) {
  for (const double h : heap_steps) {
    const auto iterations = [h](bool with_impulse, bool with_moment) {
      Grains all = stump(h);
      for (int k = 0; k < 20; ++k) all.step();
      all.begins_with_impulse = with_impulse, all.begins_with_moment = with_moment;
      const std::uint64_t before = all.iterations;
      for (int k = 0; k < 5; ++k) all.step();
      EXPECT_LE(largest_speed(all), 1e-7 * h * length(pull));
      return all.iterations - before;
    };
    const std::uint64_t warm = iterations(true, true), half = iterations(true, false),
                        cold = iterations(false, false);
    EXPECT_LE(warm, 5U) << "h " << h;
    EXPECT_GT(half, 4 * warm) << "h " << h;
    EXPECT_GT(cold, 4 * warm) << "h " << h;
  }
}

// Spheres on each other below one of 10,000 times their mass: without Newton steps two to six times the
// iterations.
TEST(CoupledHeap, ColumnUnderAWeightTakesNewtonSteps) {
  for (const double h : heap_steps) {
    Grains all(resistance(0.4, 0.02, 0.02), h);
    all.options.tolerance = 1e-10;
    all.reach = 0.01;
    all.walls.push_back({});
    for (int i = 0; i < 10; ++i)
      all.grains.push_back({i == 9 ? 1e4 : 1.0,
                            0.5,
                            {0.01 * (i % 2), 0.0, 0.5 + i * std::sqrt(1.0 - 1e-4)},
                            {},
                            {0.01 * i, 0.02 * (i % 3), 0.05 * (i % 5)}});
    for (int k = 0; k < 3; ++k) {
      const ilaw_coupled_report report = all.step();
      EXPECT_LE(report.residual, 1e-10) << "h " << h << ", step " << k;
      EXPECT_EQ(report.method, ILAW_METHOD_NEWTON) << "h " << h << ", step " << k;
    }
  }
}

}  // namespace
