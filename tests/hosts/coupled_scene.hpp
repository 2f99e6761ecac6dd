// coupled_scene.hpp - equal spheres with rotation and contacts of one law, solved together by ilaw/coupled.h.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "support/random.hpp"

#include <gtest/gtest.h>
#include <ilaw/arrays.hpp>
#include <ilaw/coupled.hpp>
#include <ilaw/loader.hpp>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace coupled_scene {

constexpr double h = 1e-3, g = 10.0, radius = 0.5;

inline ilaw::interface create(const std::string& name, std::uint32_t form,
                              const std::vector<std::pair<const char*, double>>& numbers = {},
                              std::uint32_t dimension = 3) {
  std::vector<ilaw_argument> arguments(numbers.size());
  std::vector<const ilaw_argument*> pointers;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    arguments[i].struct_size = sizeof arguments[i];
    arguments[i].name = numbers[i].first;
    arguments[i].number = numbers[i].second;
    pointers.push_back(&arguments[i]);
  }
  ilaw_setup setup{};
  setup.struct_size = sizeof setup;
  setup.dimension = dimension;
  setup.delassus_form = form;
  setup.frame = ILAW_FRAME_GLOBAL;
  setup.numbers = ILAW_NUMBERS_DOUBLE;
  setup.arguments = pointers.data();
  setup.argument_count = static_cast<std::uint32_t>(pointers.size());
  return {ilaw::library(ILAW_PLUGIN_FOLDER "/" + name + ".so"), "", setup};
}

// Contacts with one gap and area, whose other arrays stand contact by contact.
inline ilaw_batch batch_of(const ilaw::interface& law, std::size_t count, double step, const double& gap,
                           const double& area, const double* normal, std::vector<double>& state,
                           double* impulse) {
  const auto states = static_cast<std::int64_t>(law.info().state_size);
  ilaw_batch batch{};
  batch.struct_size = sizeof batch;
  batch.node_count = static_cast<std::int64_t>(count);
  batch.time = batch.velocity_step = batch.position_step = step;
  batch.gap = ilaw::input(&gap, 0, 0);
  batch.area = ilaw::input(&area, 0, 0);
  batch.normal = ilaw::input(normal, 3, 1);
  batch.state_in = ilaw::input(state.data(), states, 1);
  batch.state_out = ilaw::output(state.data(), states, 1);
  batch.impulse = ilaw::output(impulse, 3, 1);
  return batch;
}

// Bodies that do not turn, in three dimensions.
inline ilaw_bodies bodies_of(std::size_t count, const ilaw_input& inverse_mass, const double* v_free,
                             const double* v_previous, double* velocity) {
  ilaw_bodies bodies{};
  bodies.struct_size = sizeof bodies;
  bodies.dimension = 3;
  bodies.count = bodies.owned_count = static_cast<std::int64_t>(count);
  bodies.inverse_mass = inverse_mass;
  bodies.v_free = ilaw::input(v_free, 3, 1);
  bodies.v_previous = ilaw::input(v_previous, 3, 1);
  bodies.velocity = ilaw::output(velocity, 3, 1);
  return bodies;
}

// Equal spheres with rotation, and contacts between them and with walls, all of one law.
struct Scene {
  explicit Scene(ilaw::interface law_of_all, std::size_t count)
      : law(std::move(law_of_all)), v(3 * count), w(3 * count), v_before(3 * count), w_before(3 * count) {}

  void add(std::int32_t a, std::int32_t b, double distance, const std::vector<double>& n) {
    body.push_back(a);
    counterpart.push_back(b);
    gap.push_back(distance);
    for (const double component : n) {
      normal.push_back(component);
      arm.push_back(-radius * component);
      other_arm.push_back(radius * component);
    }
    impulse.resize(3 * body.size());
    moment.resize(3 * body.size());
    energy.resize(4 * body.size());
  }

  void initialise() {
    state.resize(law.info().state_size * body.size());
    ASSERT_EQ(law.initialise(batch()), ILAW_OK);
  }

  ilaw_batch batch() {
    ilaw_batch b = batch_of(law, body.size(), h, area, area, normal.data(), state, impulse.data());
    b.time = time;
    b.gap = ilaw::input(gap.data(), 1, 0);
    if (form == ILAW_DELASSUS_TRANSVERSE_SPIN) b.moment = ilaw::output(moment.data(), 3, 1);
    b.energy = ilaw::output(energy.data(), 4, 1);
    return b;
  }

  ilaw_bodies bodies() {
    ilaw_bodies b =
        bodies_of(v.size() / 3, ilaw::input(&inverse_mass, 0, 0), v.data(), v_before.data(), v.data());
    b.inverse_inertia = ilaw::input(&inverse_inertia, 0, 0);
    b.spin_free = ilaw::input(w.data(), 3, 1);
    b.spin_previous = ilaw::input(w_before.data(), 3, 1);
    b.spin = ilaw::output(w.data(), 3, 1);
    return b;
  }

  ilaw_contacts contacts(const ilaw_batch& of) {
    ilaw_contacts c = ilaw::contacts_of(law, form, of, body.data(), counterpart.data());
    c.arm = ilaw::input(arm.data(), 3, 1);
    c.counterpart_arm = ilaw::input(other_arm.data(), 3, 1);
    return c;
  }

  // One step at fixed positions, with gravity.
  ilaw_coupled_report step(double gravity, double tolerance, std::uint32_t most_sweeps = 5000) {
    v_before = v;
    w_before = w;
    time += h;
    for (std::size_t i = 2; i < v.size(); i += 3) v[i] -= h * gravity;
    const ilaw_batch b = batch();
    const ilaw_contacts c = contacts(b);
    ilaw_coupled_options options{};
    options.tolerance = tolerance;
    options.most_sweeps = most_sweeps;
    options.threads = threads;
    options.pool = pool;
    return solver.solve(bodies(), c, options);
  }

  double kinetic() const {
    double twice = 0.0;
    for (const double x : v) twice += x * x / inverse_mass;
    for (const double x : w) twice += x * x / inverse_inertia;
    return 0.5 * twice;
  }
  // The largest component of the velocities between bodies, at contacts of two.
  double largest_slip() const {
    double largest = 0.0;
    for (std::size_t k = 0; k < body.size(); ++k)
      for (std::size_t c = 0; c < 3; ++c) {
        const auto at = [&](std::int32_t i, const std::vector<double>& from_centre) {
          const std::size_t j = 3 * static_cast<std::size_t>(i), next = (c + 1) % 3, last = (c + 2) % 3;
          return v[j + c] + w[j + next] * from_centre[3 * k + last] - w[j + last] * from_centre[3 * k + next];
        };
        largest = std::max(largest, std::fabs(at(body[k], arm) - at(counterpart[k], other_arm)));
      }
    return largest;
  }
  double largest_velocity() const {
    double largest = 0.0;
    for (const double x : v) largest = std::max(largest, std::fabs(x));
    return largest;
  }

  ilaw::interface law;
  std::uint32_t form = ILAW_DELASSUS_FULL, threads = 0;
  const ilaw_threads* pool = nullptr;
  ilaw::coupled solver;
  std::vector<double> v, w, v_before, w_before;
  std::vector<std::int32_t> body, counterpart;
  std::vector<double> gap, normal, arm, other_arm, impulse, moment, state, energy;
  double inverse_mass = 0.5, inverse_inertia = 2.5 * inverse_mass / (radius * radius), area = 1.0, time = 0.0;
};

inline ilaw::interface friction(double mu) {
  return create("coulomb", ILAW_DELASSUS_FULL, {{"friction", mu}});
}
// The law of spheres whose contacts have moments.
inline ilaw::interface rolling() {
  return create(
      "rolling", ILAW_DELASSUS_TRANSVERSE_SPIN,
      {{"friction", 0.4}, {"rolling_friction", 0.05 * radius}, {"twisting_friction", 0.02 * radius}});
}
inline ilaw::interface tie() { return create("tie", ILAW_DELASSUS_FULL); }

// 27 spheres in a cube, one against the next along the axes; `law` between them.
inline Scene cube(ilaw::interface law, unsigned seed, std::uint32_t form = ILAW_DELASSUS_FULL) {
  Scene scene(std::move(law), 27);
  scene.form = form;
  for (int i = 0; i < 27; ++i) {
    const int at[3] = {i % 3, i / 3 % 3, i / 9};
    const int stride[3] = {1, 3, 9};
    for (int c = 0; c < 3; ++c) {
      std::vector<double> n(3);
      n[static_cast<std::size_t>(c)] = 1.0;
      if (at[c] > 0) scene.add(i, i - stride[c], 0.0, n);
    }
  }
  ilaw::testing::Random random(seed);
  for (double& x : scene.v) x = random();
  for (double& x : scene.w) x = random();
  scene.initialise();
  return scene;
}

}  // namespace coupled_scene
