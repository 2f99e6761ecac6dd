// Walls and belts with velocities of their own, over a step and before it, at bodies of all kinds.
// SPDX-License-Identifier: BSD-3-Clause
#include "coupled_scene.hpp"

#include "support/law_runner.hpp"

#include <gtest/gtest.h>
#include <ilaw/arrays.hpp>
#include <ilaw/coupled.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

namespace coupled_walls {
namespace {

using ilaw::testing::cross;
using ilaw::testing::dot;
using ilaw::testing::Random;
using ilaw::testing::Vector;

constexpr double restitution = 0.6, tangential_restitution = 0.3, h = 1e-3;

enum class Kind { points, spheres, rigid, facets };

struct Side {
  std::vector<std::int32_t> bodies;
  std::vector<double> weights;
  Vector arm{};
};

struct Contact {
  Side side, other;
  Vector normal{}, wall{}, wall_before{}, impulse{};
};

// Vectors of all contacts or bodies, one after another.
std::vector<double> flat(const std::vector<Vector>& vectors) {
  std::vector<double> numbers;
  for (const Vector& one : vectors) numbers.insert(numbers.end(), one.begin(), one.end());
  return numbers;
}

class Walls {
 public:
  Walls(Kind kind_of_bodies, unsigned seed) : kind(kind_of_bodies), random_(seed) {
    for (std::vector<Vector>* vectors : {&v, &w, &v_before, &w_before})
      for (std::size_t b = 0; b < body_count; ++b) vectors->push_back(any());
    if (kind == Kind::points)
      for (std::vector<Vector>* spins : {&w, &w_before}) spins->assign(body_count, {});
  }

  // other: -1 at a wall.
  void add(std::int32_t body, std::int32_t other, const Vector& normal) {
    Contact contact{side_of(body, normal), side_of(other, normal), normal, any(), any()};
    contacts.push_back(contact);
  }

  ilaw_coupled_report solve(const std::string& law, const ilaw::testing::Parameters& parameters,
                            double gap = 0.0) {
    const std::uint32_t form = kind == Kind::points    ? ILAW_DELASSUS_SCALAR
                               : kind == Kind::spheres ? ILAW_DELASSUS_TRANSVERSE
                                                       : ILAW_DELASSUS_FULL;
    const ilaw::interface interface =
        ilaw::testing::make_law(law, ilaw::testing::SetupBuilder(parameters, 3, form, ILAW_FRAME_GLOBAL));
    const std::vector<double> normals = of_contacts([](const Contact&c) { return c.normal; }),
                              walls = of_contacts([](const Contact&c) { return c.wall; }),
                              walls_before = of_contacts([](const Contact&c) { return c.wall_before; }),
                              arms = of_contacts([](const Contact&c) { return c.side.arm; }),
                              other_arms = of_contacts([](const Contact&c) { return c.other.arm; });
    std::vector<double> impulses(normals.size()), state(interface.info().state_size * contacts.size() + 1);
    const double area = 1.0;
    const ilaw_batch batch = coupled_scene::batch_of(interface, contacts.size(), h, gap, area, normals.data(),
                                                     state, impulses.data());
    std::vector<std::int32_t> body, other;
    std::vector<double> weight, other_weight;
    for (const Contact& c : contacts) {
      body.insert(body.end(), c.side.bodies.begin(), c.side.bodies.end());
      weight.insert(weight.end(), c.side.weights.begin(), c.side.weights.end());
      other.insert(other.end(), c.other.bodies.begin(), c.other.bodies.end());
      other_weight.insert(other_weight.end(), c.other.weights.begin(), c.other.weights.end());
    }
    ilaw_contacts group = ilaw::contacts_of(interface, form, batch, body.data(), other.data());
    group.arm = ilaw::input(arms.data(), 3, 1);
    group.counterpart_arm = ilaw::input(other_arms.data(), 3, 1);
    if (has_wall) group.wall_velocity = ilaw::input(walls.data(), 3, 1);
    if (has_wall_before) group.wall_previous = ilaw::input(walls_before.data(), 3, 1);
    if (kind == Kind::facets) {
      group.body_count = group.counterpart_count = 2;
      group.body_weight = ilaw::input(weight.data(), 2, 1);
      group.counterpart_weight = ilaw::input(other_weight.data(), 2, 1);
    }
    const std::vector<double> v_free = flat(v), w_free = flat(w), v_previous = flat(v_before),
                              w_previous = flat(w_before);
    std::vector<double> velocity = v_free, spin = w_free;
    ilaw_bodies bodies = coupled_scene::bodies_of(body_count, ilaw::input(inverse_mass.data(), 1, 0),
                                                  v_free.data(), v_previous.data(), velocity.data());
    if (kind != Kind::points) {
      bodies.inverse_inertia =
          kind == Kind::spheres ? ilaw::input(inverse_mass.data(), 1, 0) : ilaw::input(tensors.data(), 6, 1);
      bodies.spin_free = ilaw::input(w_free.data(), 3, 1);
      bodies.spin_previous = ilaw::input(w_previous.data(), 3, 1);
      bodies.spin = ilaw::output(spin.data(), 3, 1);
    }
    ilaw_coupled_options options{};
    options.tolerance = 1e-14;
    const ilaw_coupled_report report = ilaw::coupled().solve(bodies, group, options);
    for (std::size_t b = 0; b < body_count; ++b)
      for (std::size_t c = 0; c < 3; ++c) v[b][c] = velocity[3 * b + c], w[b][c] = spin[3 * b + c];
    for (std::size_t k = 0; k < contacts.size(); ++k)
      std::copy_n(&impulses[3 * k], 3, contacts[k].impulse.begin());
    return report;
  }

  // Relative velocity of a contact, from coupled.h: sum w_i (v_i + spin_i x arm) of both sides, less the
  // wall's.
  Vector velocity(const Contact& c) const { return relative(c, v, w, wall_of(c)); }
  Vector velocity_before(const Contact& c) const {
    return relative(c, v_before, w_before, has_wall_before ? c.wall_before : wall_of(c));
  }
  // Momentum that the impulses of all contacts give a body.
  Vector momentum(std::int32_t body) const {
    Vector sum{};
    for (const Contact& c : contacts)
      for (const auto& [side, sign] : {std::pair{&c.side, 1.0}, std::pair{&c.other, -1.0}})
        for (std::size_t i = 0; i < side->bodies.size(); ++i)
          for (std::size_t a = 0; a < 3 && side->bodies[i] == body; ++a)
            sum[a] += sign * side->weights[i] * c.impulse[a];
    return sum;
  }

  static constexpr std::size_t body_count = 3;
  Kind kind;
  bool has_wall = true, has_wall_before = true;  // which velocities the call has
  std::vector<Contact> contacts;
  std::vector<Vector> v, w, v_before, w_before;
  std::array<double, body_count> inverse_mass{0.5, 1.3, 0.2};

 private:
  Vector wall_of(const Contact& c) const { return has_wall ? c.wall : Vector{}; }
  Vector any() { return random_.vector(); }
  // Arms of spheres are along the normal.
  Side side_of(std::int32_t body, const Vector& normal) {
    const double along = random_();
    const Vector arm = kind == Kind::points ? Vector{}
                       : kind == Kind::spheres
                           ? Vector{along * normal[0], along * normal[1], along * normal[2]}
                           : any();
    if (kind != Kind::facets) return {{body}, {1.0}, arm};
    return {{body, body == 1 ? 2 : -1}, {0.25, 0.75}, arm};
  }
  template <class Part>
  std::vector<double> of_contacts(const Part& part) const {
    std::vector<Vector> vectors;
    for (const Contact& c : contacts) vectors.push_back(part(c));
    return flat(vectors);
  }
  Vector relative(const Contact& c, const std::vector<Vector>& linear, const std::vector<Vector>& angular,
                  const Vector& wall) const {
    Vector u{-wall[0], -wall[1], -wall[2]};
    for (const auto& [side, sign] : {std::pair{&c.side, 1.0}, std::pair{&c.other, -1.0}})
      for (std::size_t i = 0; i < side->bodies.size(); ++i) {
        if (side->bodies[i] < 0) continue;
        const auto b = static_cast<std::size_t>(side->bodies[i]);
        const Vector turning = cross(angular[b], side->arm);
        for (std::size_t a = 0; a < 3; ++a) u[a] += sign * side->weights[i] * (linear[b][a] + turning[a]);
      }
    return u;
  }

  std::vector<double> tensors{1.0, 2.0, 1.5,  0.1, -0.2, 0.3, 0.7, 0.4, 0.6,
                              0.0, 0.1, -0.1, 3.0, 2.0,  4.0, 0.5, 0.2, 0.1};
  Random random_;
};

constexpr Kind kinds[] = {Kind::points, Kind::spheres, Kind::rigid, Kind::facets};
const ilaw::testing::Parameters newton{{{"restitution", restitution}}, {{"activation", "moreau"}}};

// Two walls at one body, one at each of the others, and a belt between two bodies.
Walls five_contacts(Kind kind, unsigned seed) {
  Walls walls(kind, seed);
  walls.add(0, -1, {0.0, 0.0, 1.0});
  walls.add(0, -1, {1.0, 0.0, 0.0});
  walls.add(1, -1, {0.0, 0.6, 0.8});
  walls.add(2, -1, {-0.8, 0.6, 0.0});
  walls.add(1, 0, {0.0, 1.0, 0.0});
  return walls;
}

// Newton's restitution: u_n >= -e u_n^- and r_n >= 0, one of them an equality (Moreau 1988), where u is
// relative to the wall of each contact. A contact that was opening turns round at most (kit/contact.hpp).
TEST(CoupledWalls, ReboundFromTheirOwnVelocities) {
  for (const Kind kind : kinds) {
    int pressed = 0;
    for (unsigned seed = 0; seed < 60; ++seed) {
      Walls walls = five_contacts(kind, seed);
      walls.has_wall_before = seed % 3 > 0;
      const std::vector<Vector> v_free = walls.v;
      const ilaw_coupled_report report = walls.solve("contact", newton);
      ASSERT_LE(report.residual, 1e-14) << "seed " << seed;
      for (const Contact& c : walls.contacts) {
        const double before = dot(walls.velocity_before(c), c.normal),
                     target = before < 0.0 ? -restitution * before : -before,
                     beyond = dot(walls.velocity(c), c.normal) - target, push = dot(c.impulse, c.normal);
        EXPECT_GE(beyond, -1e-12) << "kind " << static_cast<int>(kind) << ", seed " << seed;
        EXPECT_GE(push, 0.0);
        EXPECT_LE(std::min(beyond, push), 1e-12) << "kind " << static_cast<int>(kind) << ", seed " << seed;
        pressed += push > 0.0;
      }
      for (std::size_t b = 0; b < Walls::body_count; ++b)
        for (std::size_t a = 0; a < 3; ++a)
          EXPECT_NEAR(walls.v[b][a] - v_free[b][a],
                      walls.inverse_mass[b] * walls.momentum(static_cast<std::int32_t>(b))[a], 1e-12);
    }
    EXPECT_GT(pressed, 100);
    EXPECT_LT(pressed, 250);
  }
}

// The work of an impulse is r.(u^- + u)/2 with the velocities of its contact, also at a wall that moved
// before and stands still in the step, for which a call has wall_previous alone.
TEST(CoupledWalls, ReportTheWorkAtTheirContacts) {
  for (const Kind kind : kinds)
    for (unsigned seed = 0; seed < 20; ++seed) {
      Walls walls = five_contacts(kind, seed);
      walls.has_wall_before = seed % 3 > 0;
      walls.has_wall = seed % 3 < 2;
      const ilaw_coupled_report report = walls.solve("contact", newton);
      double work = 0.0;
      for (const Contact& c : walls.contacts)
        work += 0.5 * dot(c.impulse, walls.velocity(c)) + 0.5 * dot(c.impulse, walls.velocity_before(c));
      EXPECT_NEAR(report.work, work, 1e-12) << "kind " << static_cast<int>(kind) << ", seed " << seed;
    }
}

// Stuck by friction, a sphere leaves its wall with -e u_n^- and -e_t u_t^-.
TEST(CoupledWalls, TurnSpheresByTheirOwnVelocities) {
  const ilaw::testing::Parameters rough{
      {{"friction", 1e3}, {"restitution", restitution}, {"tangential_restitution", tangential_restitution}},
      {{"activation", "moreau"}}};
  for (const Kind kind : {Kind::points, Kind::spheres}) {
    int stuck = 0;
    for (unsigned seed = 0; seed < 60; ++seed) {
      Walls walls(kind, seed);
      walls.v = walls.v_before, walls.w = walls.w_before;
      walls.add(0, -1, {0.0, 0.0, 1.0});
      walls.add(1, -1, {1.0, 0.0, 0.0});
      walls.add(2, -1, {0.0, 0.6, -0.8});
      for (Contact& c : walls.contacts)  // velocities far from those before are kept from adding energy
        for (std::size_t a = 0; a < 3; ++a) c.wall[a] = c.wall_before[a] + 0.02 * c.wall[a];
      walls.solve("coulomb", rough);
      for (const Contact& c : walls.contacts) {
        const Vector before = walls.velocity_before(c), after = walls.velocity(c);
        if (dot(before, c.normal) > -0.1) continue;
        ++stuck;
        for (std::size_t a = 0; a < 3; ++a) {
          const double normal = dot(before, c.normal) * c.normal[a], tangential = before[a] - normal;
          EXPECT_NEAR(after[a], -restitution * normal - tangential_restitution * tangential, 1e-12)
              << "kind " << static_cast<int>(kind) << ", seed " << seed;
        }
      }
    }
    EXPECT_GT(stuck, 40);
  }
}

// With H of the contact itself, its law solves a single one in the first iteration, and the second sees that.
TEST(CoupledWalls, SolveOneContactByItsOwnInertia) {
  for (const Kind kind : kinds)
    for (unsigned seed = 0; seed < 10; ++seed) {
      Walls walls(kind, seed);
      walls.v = walls.v_before, walls.w = walls.w_before;
      walls.add(1, 0, {0.0, 0.6, 0.8});
      walls.has_wall_before = false;
      const ilaw_coupled_report report = walls.solve("tie", {});
      EXPECT_LE(report.sweeps, 2U) << "kind " << static_cast<int>(kind) << ", seed " << seed;
      const Vector left = walls.velocity(walls.contacts[0]);
      EXPECT_LE(dot(left, left), 1e-26) << "kind " << static_cast<int>(kind) << ", seed " << seed;
    }
}

// From a distance of h, a wall with a speed of 3 passes 2 of it on; those that go away or come too slowly
// touch nothing.
TEST(CoupledWalls, ReachBodiesByTheirOwnVelocities) {
  for (const Kind kind : kinds) {
    Walls walls(kind, 1);
    for (std::vector<Vector>* still : {&walls.v, &walls.w, &walls.v_before, &walls.w_before})
      still->assign(Walls::body_count, {});
    for (std::int32_t b = 0; b < 3; ++b) {
      walls.add(b, -1, {0.0, 0.0, 1.0});
      Contact& c = walls.contacts.back();
      c.side = {{b}, {1.0}, {}};
      if (kind == Kind::facets) c.side = {{b, -1}, {1.0, 0.0}, {}};
      c.wall = c.wall_before = {0.0, 0.0, std::array{-3.0, 3.0, 0.9}[static_cast<std::size_t>(b)]};
    }
    walls.solve("contact", {{}, {{"activation", "predictive"}}}, h);
    for (std::size_t b = 0; b < 3; ++b)
      EXPECT_NEAR(walls.v[b][2], b == 1 ? 2.0 : 0.0, 1e-14)
          << "kind " << static_cast<int>(kind) << ", body " << b;
  }
}

}  // namespace
}  // namespace coupled_walls
