// vfric.f of api/abaqus, called by a stub of Abaqus/Explicit as its manual says, against closed forms.
// SPDX-License-Identifier: BSD-3-Clause
#include "support/matchers.hpp"

#include <array>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

extern "C" {
void stub_increment(const char* interaction, int length, int dimension, int count, double time, double dt,
                    const double* mass, const double* load, const double* pressing, const double* normal,
                    double* v, int constant_count, const double* constants, int state_count, double* state,
                    double* f);
void stub_error(char* text);
}

namespace {

using namespace ilaw::testing::matchers;
constexpr double rounding = ILAW_ABAQUS_ROUNDING;  // of the numbers of Abaqus
// The block of the manual's verification of VFRIC [in, lbf, s]: of it a column of section 1 over 1 node.
constexpr double mass = 7.3e-4, pressure = 2000.0, speed = 200.0, mu = 0.15;

// Points on a plane, all alike. A law is created once for each interaction, as in Abaqus.
struct Points {
  std::string interaction = "COULOMB";
  std::vector<double> constants{mu};
  int dimension = 3, count = 4, state_size = 8;
  std::vector<double> normal{0, 0, 1};
  double dt = 1e-6, time = 0.0;
  std::vector<double> v, load, f, state;

  Points& begin(const std::vector<double>& velocity, const std::vector<double>& pull) {
    for (int k = 0; k < count; ++k) {
      v.insert(v.end(), velocity.begin(), velocity.end());
      load.insert(load.end(), pull.begin(), pull.end());
    }
    f.resize(v.size());
    state.resize(static_cast<std::size_t>(state_size * count));
    return *this;
  }
  std::string step() {
    const std::vector<double> masses(static_cast<std::size_t>(count), mass),
        pressing(masses.size(), pressure);
    time += dt;
    stub_increment(interaction.c_str(), static_cast<int>(interaction.size()), dimension, count, time, dt,
                   masses.data(), load.data(), pressing.data(), normal.data(), v.data(),
                   static_cast<int>(constants.size()), constants.data(), state_size, state.data(), f.data());
    char text[513];
    stub_error(text);
    return text;
  }
  double speed_of(int k) const {
    double squared = 0.0;
    for (int c = 0; c < dimension; ++c)
      squared += std::pow(v[static_cast<std::size_t>(dimension * k + c)], 2);
    return std::sqrt(squared);
  }
  // Runs until the first point stops: {time, distance}.
  std::array<double, 2> slide() {
    double distance = 0.0;
    while (speed_of(0) > 1e-5 * speed && time < 1e-2) {
      EXPECT_EQ(step(), "");
      distance += dt * speed_of(0);
    }
    return {time, distance};
  }
};

struct Vfric : ::testing::Test {
  Vfric() { setenv("ILAW_PATH", ILAW_PLUGIN_FOLDER, 1); }
};

// v0/a and v0^2/(2a) with a = mu p/m: 4.866e-4 s, 4.866e-2 in, as in the manual. Then it rests.
TEST_F(Vfric, BlockStopsAsInManual) {
  const double a = mu * pressure / mass;
  for (const double dt : {1e-6, 0.7e-6, 1.3e-6}) {
    Points block;
    block.dt = dt;
    const auto [time, distance] = block.begin({speed, 0, 0}, {0, 0, 0}).slide();
    EXPECT_NEAR(time, speed / a, 2 * dt);
    EXPECT_NEAR(distance, speed * speed / (2 * a), 2 * speed * dt);
    for (int n = 0; n < 10; ++n) block.step();
    for (int k = 0; k < block.count; ++k) EXPECT_LE(block.speed_of(k), rounding * speed) << k;
  }
}

// The coefficient mu_k + (mu_s - mu_k) exp(-c v). With y = exp(c v), y' = -c A (mu_k y + mu_s - mu_k), A =
// p/m.
TEST_F(Vfric, FrictionFallsWithSpeed) {
  const double mu_k = 0.05, c = 0.01, A = pressure / mass, ratio = (mu - mu_k) / mu_k;
  const double stops = std::log((std::exp(c * speed) + ratio) / (1 + ratio)) / (c * A * mu_k);
  double error[2];
  for (int i : {0, 1}) {
    Points block;
    block.interaction = "RATE";
    block.constants = {mu, mu_k, c};
    block.dt = i == 0 ? 2e-6 : 1e-6;
    error[i] = std::abs(block.begin({speed, 0, 0}, {0, 0, 0}).slide()[0] - stops);
    EXPECT_LT(error[i], 3 * block.dt);
  }
}

// Below mu p the force is the load, to the digits that Abaqus has, and nothing moves.
TEST_F(Vfric, SticksBelowLimit) {
  Points block;
  const double load = 0.9 * mu * pressure;
  block.begin({0, 0, 0}, {load * 0.6, load * 0.8, 0});
  for (int n = 0; n < 100; ++n) {
    ASSERT_EQ(block.step(), "");
    for (std::size_t i = 0; i < block.f.size(); ++i)
      ASSERT_NEAR(block.f[i], -block.load[i], 4 * rounding * load) << n;
  }
  EXPECT_LE(block.speed_of(0), rounding * load / mass * block.dt * 100);
  // Above it accelerates by what is left.
  for (double& component : block.load) component *= 1.5;
  for (int n = 0; n < 50; ++n) block.step();
  EXPECT_NEAR(block.speed_of(0), 50 * block.dt * (0.9 * 1.5 - 1) * mu * pressure / mass, 1e-4 * speed);
}

// A node that rests has the static coefficient, though the slip predicted without friction is none of rest.
TEST_F(Vfric, RestHasStaticCoefficient) {
  Points block;
  block.interaction = "REST";
  block.constants = {mu, 0.05, 1e30};
  const double load = 0.9 * mu * pressure;
  block.begin({0, 0, 0}, {0, 0, 0});
  for (int n = 0; n < 100; ++n) {
    for (double& component : block.load) component = 0.0;
    for (int k = 0; k < block.count; ++k) block.load[static_cast<std::size_t>(3 * k)] = load * n / 99;
    ASSERT_EQ(block.step(), "");
  }
  EXPECT_LE(block.speed_of(0), rounding * speed);
}

// A node has no velocity before if it begins to touch, has rested, or comes back after it was open; the
// predicted slip of a load below the limit is none.
TEST_F(Vfric, RestsWhateverItDidBefore) {
  for (const double decay : {1e9, 1.0})
    for (const char* before : {"nothing", "a slide and a rest", "a slide and a flight"}) {
      Points block;
      block.interaction = "AGAIN" + std::to_string(decay);
      block.constants = {mu, 0.05, decay};
      const double load = 0.9 * mu * pressure;
      block.begin({0, 0, 0}, {0, 0, 0});
      const auto set = [&](std::vector<double>& of, double along) {
        for (std::size_t i = 0; i < of.size(); i += 3) of[i] = along;
      };
      const std::string story = before;
      if (story != "nothing") {
        set(block.v, speed);
        for (int n = 0; n < 3; ++n) ASSERT_EQ(block.step(), "");
        set(block.v, 0.0);
        for (int n = story == "a slide and a rest" ? 1 : 0; n > 0; --n) ASSERT_EQ(block.step(), "");
        if (story == "a slide and a flight") block.time += 10 * block.dt;
      }
      set(block.load, load);
      for (int n = 0; n < 5; ++n) {
        ASSERT_EQ(block.step(), "");
        EXPECT_NEAR(block.f[0], -load, 4 * rounding * load) << decay << " after " << before << ", " << n;
      }
    }
}

// What holds without saying so slides at the predicted speed, with the kinetic coefficient.
TEST_F(Vfric, PredictsForALawWithoutStatus) {
  setenv("ILAW_PATH", ILAW_SILENT, 1);
  Points block;
  block.interaction = "SILENT";
  block.constants = {mu, 0.05, 1e9};
  block.begin({0, 0, 0}, {0.9 * mu * pressure, 0, 0});
  ASSERT_EQ(block.step(), "");
  EXPECT_NEAR(block.f[0], -0.05 * pressure, 4 * rounding * pressure);
}

// On a plane that lies askew a slide keeps its direction; in two dimensions it stops like that in three.
TEST_F(Vfric, AnyAxesAndDimensions) {
  Points askew, plane;
  askew.normal = {2.0 / 3, -1.0 / 3, 2.0 / 3};
  askew.begin({speed / 3, 2 * speed / 3, 0}, {0, 0, 0});
  const std::vector<double> before = askew.v;
  for (int n = 0; n < 100; ++n) askew.step();
  const double a = mu * pressure / mass, initial = speed * std::sqrt(5.0) / 3;
  EXPECT_NEAR(askew.speed_of(0), initial - a * 100 * askew.dt, 100 * rounding * initial);
  EXPECT_NEAR(askew.v[1], 2 * askew.v[0], 100 * rounding * initial);
  plane.interaction = "PLANE";
  plane.dimension = 2;
  plane.normal = {0, 1};
  const auto [time, distance] = plane.begin({speed, 0}, {0, 0}).slide();
  EXPECT_NEAR(time, speed / a, 2 * plane.dt);
}

// Friction p (mu_s - (mu_s - mu_d) s/D) brakes by s'' = k^2 s - a, so s = a/k^2 (1 - cosh k t) + v/k sinh k
// t. The slip is in the state of the node; each has its own speed.
TEST_F(Vfric, SlipWeakeningKeepsItsState) {
  const double mu_d = 0.05, critical = 0.1, end = 2e-4;
  const double a = mu * pressure / mass, k = std::sqrt((mu - mu_d) * pressure / (mass * critical));
  for (const double dt : {2e-6, 1e-6, 0.5e-6}) {
    Points points;
    points.interaction = "WEAKENING";
    points.constants = {mu, mu_d, critical};
    points.dt = dt;
    points.begin({speed, 0, 0}, {0, 0, 0});
    for (int node = 0; node < points.count; ++node)
      points.v[static_cast<std::size_t>(3 * node)] *= 1 + 0.1 * node;
    while (points.time < end - dt / 2) ASSERT_EQ(points.step(), "");
    for (int node = 0; node < points.count; ++node) {
      const double v = speed * (1 + 0.1 * node);
      const double slip = a / (k * k) * (1 - std::cosh(k * end)) + v / k * std::sinh(k * end);
      EXPECT_NEAR(points.state[static_cast<std::size_t>(8 * node + 4)], slip, 0.6 * a * end * dt) << dt;
    }
  }
}

TEST_F(Vfric, SaysWhyItStops) {
  Points few;
  few.state_size = 3;
  EXPECT_EQ(few.begin({speed, 0, 0}, {0, 0, 0}).step(),
            "VFRIC, law of ilaw: the law needs 4 state variables per node (*DEPVAR)");
  Points negative;
  negative.interaction = "OTHER";
  negative.constants = {-0.1};
  EXPECT_THAT(negative.begin({speed, 0, 0}, {0, 0, 0}).step(), HasSubstr("'friction'"));
}

}  // namespace
