// A pile of grains of different size with rolling and twisting resistance (ilaw/coupled.h): its energy,
// residual and symmetries.
// SPDX-License-Identifier: BSD-3-Clause
#include "coupled_grains.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>

namespace {

using namespace coupled_grains;

constexpr double diameter = 0.02, tolerance = 1e-10;
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

// 45 grains over a floor within four walls, with any velocities and spins, in other units of length and axes.
Grains pile(double h, double unit = 1.0, const Map& map = {}) {
  const double size = unit * diameter;
  Grains made(resistance(0.4, 0.05 * size, 0.02 * size), h);
  made.options.tolerance = tolerance;
  made.pull = unit * map(pull);
  made.reach = 0.1 * size;
  std::mt19937 bits(7);
  const auto within = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(bits);
  };
  for (int i = 0; i < 45; ++i) {
    const double r = size * within(0.35, 0.5);
    const Vector x =
        size * Vector{i % 3 + within(0.5, 0.52), i / 3 % 3 + within(0.5, 0.52), i / 9 + within(0.5, 0.52)};
    const Vector v = unit * Vector{within(-0.2, 0.2), within(-0.2, 0.2), within(-0.2, 0.0)};
    const Vector w{within(-20.0, 20.0), within(-20.0, 20.0), within(-20.0, 20.0)};
    const double m = 2500.0 * 4.18879 * r * r * r / (unit * unit * unit);
    made.grains.push_back({m, r, map(x), map(v), map.of_spin(w)});
  }
  for (const Vector& n : {Vector{0, 0, 1}, Vector{1, 0, 0}, Vector{0, 1, 0}})
    made.walls.push_back({map(n), 0.0, {}, {}});
  for (const Vector& n : {Vector{-1, 0, 0}, Vector{0, -1, 0}})
    made.walls.push_back({map(n), -3.1 * size, {}, {}});
  return made;
}

double largest_speed(const Grains& of) {
  double most = 0.0;
  for (const Grain& grain : of.grains)
    most = std::max(most, length(grain.v) + grain.radius * length(grain.w));
  return most;
}

TEST(CoupledPile, SettlesAndMakesNoEnergy) {
  for (const double h : {1e-3, 7.3e-4, 3.7e-4}) {
    Grains all = pile(h);
    const double at_start = all.kinetic();
    std::size_t most_contacts = 0;
    for (int k = 0; k < std::lround(0.5 / h); ++k) {
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
    EXPECT_GT(most_contacts, 120U);
    std::printf("h %g: speed %g, iterations %llu, contacts %zu\n", h, largest_speed(all),
                static_cast<unsigned long long>(all.iterations), most_contacts);
  }
}

// After some collisions: bits, iterations and moments.
TEST(CoupledPile, SameInputGivesTheSameBits) {
  Grains one = pile(1e-3), two = pile(1e-3);
  one.run(0.1), two.run(0.1);
  EXPECT_EQ(one.impulse, two.impulse);
  EXPECT_EQ(one.moment, two.moment);
  EXPECT_EQ(one.iterations, two.iterations);
  for (std::size_t i = 0; i < one.grains.size(); ++i) {
    EXPECT_EQ(one.grains[i].v, two.grains[i].v);
    EXPECT_EQ(one.grains[i].w, two.grains[i].w);
  }
}

// Lengths in units of 2^-10 m: the same bits, times powers of two. A spin that were compared with velocities
// by its number alone would end iterations elsewhere.
TEST(CoupledPile, UnitOfLengthChangesNothing) {
  Grains one = pile(1e-3), small = pile(1e-3, 1024.0);
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

TEST(CoupledPile, TurnsWithTheFrameAndItsMirror) {
  for (const Map& map : {turned, mirrored})
    for (const double h : {1e-3, 7.3e-4, 3.7e-4}) {
      Grains one = pile(h), other = pile(h, 1.0, map);
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
      std::printf("h %g: off %g of %g\n", h, off, largest_speed(one));
    }
}

// A pile at rest: impulses and moments of the last step are those of this one.
TEST(CoupledPile, WarmStartSavesIterations) {
  const auto iterations = [](bool with_impulse, bool with_moment) {
    Grains all = pile(1e-3);
    all.run(0.5);
    all.begins_with_impulse = with_impulse, all.begins_with_moment = with_moment;
    const std::uint64_t before = all.iterations;
    all.run(0.1);
    return all.iterations - before;
  };
  const std::uint64_t warm = iterations(true, true), half = iterations(true, false),
                      cold = iterations(false, false);
  std::printf("warm %d half %d cold %d\n", int(warm), int(half), int(cold));
  EXPECT_LT(2 * warm, cold);
  EXPECT_LT(2 * warm, half);
}

}  // namespace
