// Impacts at their instants (the law impact) between bodies that several contacts move.
// SPDX-License-Identifier: BSD-3-Clause
#include "coupled_scene.hpp"

#include "support/law_runner.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace {

using coupled_scene::h;

ilaw::interface impact(double mu, double restitution, ilaw_delassus_form form) {
  return ilaw::testing::make_law(
      "impact", ilaw::testing::SetupBuilder({{{"friction", mu}, {"restitution", restitution}}, {}}, 3, form,
                                            ILAW_FRAME_GLOBAL));
}
ilaw::interface contact(double restitution) { return impact(0.0, restitution, ILAW_DELASSUS_FULL); }
// Between spheres, whose H is transverse.
ilaw::interface friction(double mu, double restitution) {
  return impact(mu, restitution, ILAW_DELASSUS_TRANSVERSE);
}

double stored_in(const coupled_scene::Scene& scene) {
  double stored = 0.0;
  for (std::size_t k = 0; k < scene.body.size(); ++k) stored += scene.energy[4 * k + ILAW_ENERGY_STORED];
  return stored;
}

// Equal points on a line between walls at 0 and 1, thrown at random. pace: their velocities over those of a
// run with the step h, so that a step is h pace.
struct Beads {
  Beads(double restitution, double pace, unsigned seed) : scene(contact(restitution), count) {
    ilaw::testing::Random random(seed);
    for (std::size_t i = 0; i < count; ++i) {
      place.push_back((static_cast<double>(i) + 0.5 + 0.4 * random()) / count);
      speed.push_back(random());
      scene.v[3 * i] = pace * speed[i];
      scene.add(static_cast<int>(i), static_cast<int>(i) - 1, 0.0, {1.0, 0.0, 0.0});
    }
    scene.add(count - 1, -1, 0.0, {-1.0, 0.0, 0.0});
    scene.initialise();
    x = place;
  }

  double energy() const { return scene.kinetic() + stored_in(scene); }
  ilaw_coupled_report step() {
    for (std::size_t i = 0; i < count; ++i) scene.gap[i] = i > 0 ? x[i] - x[i - 1] : x[i];
    scene.gap[count] = 1.0 - x[count - 1];
    const ilaw_coupled_report report = scene.step(0.0, 1e-15);
    for (std::size_t i = 0; i < count; ++i) x[i] += h * scene.v[3 * i];
    return report;
  }

  // Elastic beads of equal mass exchange their velocities: the set of places is that of beads that pass
  // through each other.
  std::vector<double> exact(double time) const {
    std::vector<double> found;
    for (std::size_t i = 0; i < count; ++i) {
      const double y = std::fabs(std::fmod(place[i] + speed[i] * time, 2.0));
      found.push_back(std::min(y, 2.0 - y));
    }
    std::sort(found.begin(), found.end());
    return found;
  }

  static constexpr int count = 6;
  coupled_scene::Scene scene;
  std::vector<double> place, speed, x;
};

// In a step far longer than the time between impacts beads may be jammed, so that impulses grow until they
// round: the report says by how much energies are off.
TEST(CoupledImpacts, NeverMakeEnergy) {
  for (const double restitution : {1.0, 0.9, 0.5})
    for (const double pace : {0.3, 1.0, 30.0, 300.0}) {
      Beads beads(restitution, pace, 7);
      const double first = beads.energy(), rounding = 1e-11 * first;
      double before = first, deepest = 0.0, off = 0.0;
      for (int n = 0; n < 2000; ++n) {
        const ilaw_coupled_report report = beads.step();
        const double now = beads.energy();
        ASSERT_LE(now - before, report.energy_error + (1e-14 + report.residual) * first)
            << "e " << restitution << ", pace " << pace << ", step " << n;
        before = now;
        off += report.energy_error;
        for (const double gap : beads.scene.gap)
          if (off <= rounding) deepest = std::max(deepest, -gap);
      }
      // Rounding of places up to 1, and of the impulses that make a step: 256 ulps pass for solved.
      EXPECT_LE(deepest, std::numeric_limits<double>::epsilon() * (16.0 + 256.0 * pace * h))
          << "e " << restitution << ", pace " << pace;
      if (pace < 300.0) {
        EXPECT_LE(off, rounding) << "e " << restitution << ", pace " << pace;
      }
      if (restitution == 1.0) {
        EXPECT_NEAR(before, first, off + 1e-12 * first) << "pace " << pace;
      }
    }
}

TEST(CoupledImpacts, OfSpheresWithFrictionNeverMakeEnergy) {
  for (const double restitution : {1.0, 0.7})
    for (const double mu : {0.1, 0.4}) {
      coupled_scene::Scene scene = coupled_scene::cube(friction(mu, restitution), 3);
      scene.form = ILAW_DELASSUS_TRANSVERSE;
      const double first = scene.kinetic();
      double before = first;
      for (int n = 0; n < 6; ++n) {
        const ilaw_coupled_report report = scene.step(0.0, 1e-13);
        EXPECT_LE(report.residual, 1e-13) << "mu " << mu << ", e " << restitution << ", step " << n;
        const double now = scene.kinetic() + stored_in(scene);
        EXPECT_LE(now, before + 1e-13 * first) << "mu " << mu << ", e " << restitution << ", step " << n;
        before = now;
      }
    }
}

// A sphere meets the floor at any part of a step: slides through the impact to v_x - mu (1 + e) w with the
// spin 5 mu (1 + e) w/(2 R), or leaves rolling at 5 v_x/7.
TEST(CoupledImpacts, OfASphereIsThatOfItsClosedForm) {
  constexpr double w = 3.0, slides = 2.0, e = 0.6;
  for (const double mu : {0.05, 0.5})
    for (double part = 0.0; part < 1.0; part += 0.09) {
      coupled_scene::Scene scene(friction(mu, e), 1);
      scene.form = ILAW_DELASSUS_TRANSVERSE;
      scene.add(0, -1, part * h * w, {0.0, 0.0, 1.0});
      scene.initialise();
      scene.v = {slides, 0.0, -w};
      for (int n = 0; n < 2; ++n) {
        scene.step(0.0, 1e-15);
        scene.gap[0] += h * scene.v[2];
      }
      const double lost = std::min(mu * (1.0 + e) * w, 2.0 * slides / 7.0);
      EXPECT_NEAR(scene.v[0], slides - lost, 1e-14) << "mu " << mu << ", part " << part;
      EXPECT_NEAR(scene.v[2], e * w, 1e-14) << "mu " << mu << ", part " << part;
      EXPECT_NEAR(scene.w[1], 2.5 * lost / coupled_scene::radius, 1e-13) << "mu " << mu << ", part " << part;
    }
}

// The mean error of a run over 2 time units.
double error_of(double step, unsigned seed) {
  Beads beads(1.0, step / h, seed);
  const int steps = static_cast<int>(2.0 / step);
  double error = 0.0;
  for (int n = 1; n <= steps; ++n) {
    beads.step();
    const std::vector<double> exact = beads.exact(n * step);
    for (std::size_t i = 0; i < beads.x.size(); ++i) error += std::fabs(beads.x[i] - exact[i]);
  }
  return error / (steps * Beads::count);
}

// Where no bead is in two impacts within two steps, the motion is exact. Runs with such a pair become rare as
// the step does.
TEST(CoupledImpacts, AreExactUnlessABodyHasTwoAtOnce) {
  constexpr unsigned runs = 40;
  for (const double step : {2.9e-3, 1.03e-3, 2.9e-4}) {
    unsigned other = 0;
    for (unsigned seed = 0; seed < runs; ++seed) other += error_of(step, seed) > 1e-11;
    EXPECT_LE(other, 200.0 * step * runs) << "step " << step;
  }
}

}  // namespace
