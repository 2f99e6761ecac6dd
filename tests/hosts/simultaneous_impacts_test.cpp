// Impacts with restitution at several contacts of a body in one step: which of them act, and with which
// rebound, is decided without the impulses of the others (v_smooth of ilaw.h).
// SPDX-License-Identifier: BSD-3-Clause
#include "coupled_scene.hpp"

#include "support/law_runner.hpp"

#include <gtest/gtest.h>
#include <ilaw/arrays.hpp>
#include <ilaw/coupled.hpp>
#include <ilaw/loader.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace {

using Vector = std::array<double, 3>;

ilaw::interface law_of(const std::string& law, double e, double mu, ilaw_delassus_form form) {
  const ilaw::testing::Parameters given{{{"restitution", e}, {"friction", mu}}, {}};
  return ilaw::testing::make_law(law, ilaw::testing::SetupBuilder(given, 3, form, ILAW_FRAME_GLOBAL));
}

// Bodies that do not turn much: gaps are advanced by the velocity of each contact along its normal.
struct Bodies {
  Bodies(ilaw::interface law_of_all, ilaw_delassus_form form_of_all, std::size_t count, double time_step)
      : law(std::move(law_of_all)), form(form_of_all), h(time_step), v(count), w(count) {}

  void add(std::int32_t a, std::int32_t b, double distance, Vector n, Vector at = {}) {
    body.push_back(a);
    counterpart.push_back(b);
    gap.push_back(distance);
    normal.push_back(n);
    arm.push_back(at);
  }
  void initialise() {
    impulse.assign(body.size(), {});
    state.assign(law.info().state_size * body.size(), 0.0);
    ASSERT_EQ(law.initialise(batch()), ILAW_OK);
  }

  void advance(double gravity = 0.0) {
    const std::vector<Vector> v_before = v, w_before = w;
    for (Vector& velocity : v) velocity[2] -= h * gravity;
    ilaw_bodies b = coupled_scene::bodies_of(v.size(), ilaw::input(&inverse_mass, 0, 0), v[0].data(),
                                             v_before[0].data(), v[0].data());
    const ilaw_batch contacts = batch();
    ilaw_contacts c = ilaw::contacts_of(law, form, contacts, body.data(), counterpart.data());
    if (form == ILAW_DELASSUS_FULL) {
      b.inverse_inertia = ilaw::input(inverse_inertia.data(), 0, 1);
      b.spin_free = ilaw::input(w[0].data(), 3, 1);
      b.spin_previous = ilaw::input(w_before[0].data(), 3, 1);
      b.spin = ilaw::output(w[0].data(), 3, 1);
      c.arm = c.counterpart_arm = ilaw::input(arm[0].data(), 3, 1);
    }
    ilaw_coupled_options options{};
    options.tolerance = 1e-14;
    solver.solve(b, c, options);
    time += h;
    for (std::size_t k = 0; k < gap.size(); ++k) gap[k] += h * approach(k);
  }

  ilaw_batch batch() {
    ilaw_batch b = coupled_scene::batch_of(law, body.size(), h, inverse_mass, inverse_mass, normal[0].data(),
                                           state, impulse[0].data());
    b.time = time;
    b.gap = ilaw::input(gap.data(), 1, 0);
    return b;
  }
  // Velocity of a contact along its normal.
  double approach(std::size_t k) const {
    double sum = 0.0;
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t next = (c + 1) % 3, last = (c + 2) % 3;
      const auto velocity = [&](std::int32_t i) {
        if (i < 0) return 0.0;
        const auto b = static_cast<std::size_t>(i);
        return v[b][c] + w[b][next] * arm[k][last] - w[b][last] * arm[k][next];
      };
      sum += normal[k][c] * (velocity(body[k]) - velocity(counterpart[k]));
    }
    return sum;
  }
  double largest_spin() const {
    double most = 0.0;
    for (const Vector& spin : w)
      for (const double x : spin) most = std::max(most, std::fabs(x));
    return most;
  }

  ilaw::interface law;
  ilaw_delassus_form form;
  double h, inverse_mass = 1.0, time = 0.0;
  std::array<double, 6> inverse_inertia{6.0, 6.0, 6.0, 0.0, 0.0, 0.0};  // of a unit cube of 1 kg
  std::vector<Vector> v, w;
  std::vector<std::int32_t> body, counterpart;
  std::vector<double> gap, state;
  std::vector<Vector> normal, arm, impulse;
  ilaw::coupled solver;
};

// A unit box of 1 kg above a floor, with 2, 4 or 9 contacts at its lower face.
Bodies box(ilaw::interface law, ilaw_delassus_form form, int contacts, double distance, double time_step) {
  Bodies made(std::move(law), form, 1, time_step);
  constexpr double a = 0.375;
  const std::vector<double> along = contacts == 9 ? std::vector{-a, 0.0, a} : std::vector{-a, a};
  const std::vector<double> across = contacts == 2 ? std::vector{0.0} : along;
  for (const double x : along)
    for (const double y : across) made.add(0, -1, distance, {0.0, 0.0, 1.0}, {x, y, -0.5});
  made.initialise();
  return made;
}

// Whatever part of a step the gap is, a box that lands flat leaves flat with e times its speed: at once, or
// with the second impulse of `impact`, whose friction needs one tangential entry of H: a box that does not
// turn.
TEST(SimultaneousImpacts, LeaveFlatWithRestitution) {
  for (const std::string law : {"coulomb", "impact"})
    for (const int contacts : {2, 4, 9})
      for (const double mu : {0.0, 0.5})
        for (const double e : {1.0, 0.9, 0.5}) {
          const bool turns = mu == 0.0 || law == "coulomb";
          double worst = 0.0, worst_spin = 0.0;
          for (int part = 0; part <= 100; ++part) {
            const ilaw_delassus_form form = turns ? ILAW_DELASSUS_FULL : ILAW_DELASSUS_SCALAR;
            Bodies scene = box(law_of(law, e, mu, form), form, contacts, 1e-5 * part, 1e-3);
            scene.v[0] = {0.0, 0.0, -1.0};
            for (int n = 0; n < 3; ++n) scene.advance();
            worst = std::max(worst, std::hypot(scene.v[0][0], scene.v[0][1], scene.v[0][2] - e));
            worst_spin = std::max(worst_spin, scene.largest_spin());
          }
          EXPECT_LE(worst, 1e-9) << law << ", " << contacts << " contacts, mu " << mu << ", e " << e;
          EXPECT_LE(worst_spin, 1e-9) << law << ", " << contacts << " contacts, mu " << mu << ", e " << e;
        }
}

// A box dropped from 0.5 bounces to e^2 of that height, to the first order of the step.
TEST(SimultaneousImpacts, OfADroppedBoxReachESquaredOfItsHeight) {
  constexpr double g = 10.0, height = 0.5;
  for (const double dt : {3.1e-3, 2e-3, 1.3e-3, 1e-3, 7e-4, 4.1e-4, 2.3e-4})
    for (const double e : {1.0, 0.8, 0.5}) {
      Bodies scene = box(law_of("coulomb", e, 0.5, ILAW_DELASSUS_FULL), ILAW_DELASSUS_FULL, 4, height, dt);
      scene.v[0][2] = 0.5 * dt * g;
      double highest = 0.0;
      bool landed = false;
      while (!landed || scene.v[0][2] > 0.0) {
        scene.advance(g);
        landed = landed || scene.v[0][2] > 0.0;
        if (landed) highest = std::max(highest, scene.gap[0]);
      }
      // The impact is early by up to a step, where the box is up to h w above the floor.
      EXPECT_NEAR(highest, e * e * height, 2.0 * dt * std::sqrt(2.0 * g * height)) << dt << ", e " << e;
      EXPECT_LE(scene.largest_spin(), 1e-9) << dt << ", e " << e;
    }
}

// A point falls into the middle of a symmetric groove and rises as it fell.
TEST(SimultaneousImpacts, InAGrooveKeepThePointInTheMiddle) {
  const double s = std::sqrt(0.5);
  for (const double mu : {0.0, 0.3})
    for (int drop = 0; drop < 12; ++drop) {
      Bodies scene(law_of("coulomb", 0.9, mu, ILAW_DELASSUS_SCALAR), ILAW_DELASSUS_SCALAR, 1, 1e-3);
      const double distance = 1e-4 * (1.0 + 0.61 * drop);
      scene.add(0, -1, distance, {s, 0.0, s});
      scene.add(0, -1, distance, {-s, 0.0, s});
      scene.initialise();
      scene.v[0] = {0.0, 0.0, -1.0};
      for (int n = 0; n < 4; ++n) scene.advance();
      EXPECT_NEAR(scene.v[0][2], 0.9, 1e-12) << drop;
      EXPECT_NEAR(scene.v[0][0], 0.0, 1e-12) << drop;
    }
}

// A ball strikes a row of `count - 1` balls that touch. Where Newton's restitution holds at each contact that
// lands, the row moves on together: with k balls in it and equal masses m r_1 (1 + 1/k) = 1 + e.
TEST(SimultaneousImpacts, OfACradleMoveTheRowTogether) {
  for (const int count : {2, 3, 5})
    for (const double e : {1.0, 0.5})
      for (const double part : {0.0, 0.3, 0.85}) {
        Bodies scene(law_of("coulomb", e, 0.0, ILAW_DELASSUS_SCALAR), ILAW_DELASSUS_SCALAR,
                     static_cast<std::size_t>(count), 1e-3);
        for (int i = 1; i < count; ++i) scene.add(i, i - 1, i == 1 ? 1e-3 * part : 0.0, {1.0, 0.0, 0.0});
        scene.initialise();
        scene.v[0] = {1.0, 0.0, 0.0};
        for (int n = 0; n < 3; ++n) scene.advance();
        const double k = count - 1, r = (1.0 + e) * k / (k + 1.0);
        EXPECT_NEAR(scene.v[0][0], 1.0 - r, 1e-12) << count << ", e " << e << ", part " << part;
        for (int i = 1; i < count; ++i)
          EXPECT_NEAR(scene.v[static_cast<std::size_t>(i)][0], r / k, 1e-12)
              << count << ", e " << e << ", part " << part << ", ball " << i;
      }
}

}  // namespace
