// Problems of coupled contacts that plain iterations do not solve: long columns, masses that are far apart, a
// heavy course on a wall, redundant contacts, facets.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <ilaw/arrays.hpp>
#include <ilaw/coupled.hpp>
#include <ilaw/loader.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "coupled_scene.hpp"

namespace {

using coupled_scene::create;
using Point = std::array<double, 3>;

// Bodies of any mass, and contacts of one law between them.
struct Assembly {
  explicit Assembly(ilaw::interface law_of_all, bool turns)
      : law(std::move(law_of_all)), rotate(turns), form(turns ? ILAW_DELASSUS_FULL : ILAW_DELASSUS_SCALAR) {}

  void add_body(double mass, double inertia, const Point& v_free) {
    inverse_mass.push_back(1.0 / mass);
    const double j = inertia > 0.0 ? 1.0 / inertia : 0.0;
    inverse_inertia.insert(inverse_inertia.end(), {j, j, j, 0.0, 0.0, 0.0});
    v.insert(v.end(), v_free.begin(), v_free.end());
  }
  void add(const std::vector<std::int32_t>& bodies, const std::vector<double>& weights,
           const std::vector<std::int32_t>& others, const std::vector<double>& other_weights,
           const Point& arm = {}, const Point& other_arm = {}) {
    body.insert(body.end(), bodies.begin(), bodies.end());
    weight.insert(weight.end(), weights.begin(), weights.end());
    counterpart.insert(counterpart.end(), others.begin(), others.end());
    other_weight.insert(other_weight.end(), other_weights.begin(), other_weights.end());
    normal.insert(normal.end(), {0.0, 0.0, 1.0});
    arms.insert(arms.end(), arm.begin(), arm.end());
    other_arms.insert(other_arms.end(), other_arm.begin(), other_arm.end());
    body_count = static_cast<std::uint32_t>(bodies.size());
    counterpart_count = static_cast<std::uint32_t>(others.size());
    ++count;
  }
  void add(std::int32_t a, std::int32_t b, const Point& arm = {}, const Point& other_arm = {}) {
    add({a}, {1.0}, {b}, {1.0}, arm, other_arm);
  }

  ilaw_coupled_report solve(double tolerance, std::uint32_t most, bool weighted = false) {
    const double gap = 0.0, area = 1.0;
    impulse.resize(normal.size());
    status.assign(count, ILAW_BROKEN);
    velocity = v;
    std::vector<double> spin(v.size()), state(law.info().state_size * count + 1), still(v.size());
    ilaw_batch batch =
        coupled_scene::batch_of(law, count, 1e-3, gap, area, normal.data(), state, impulse.data());
    batch.status = status.data();
    batch.status_stride = 1;
    law.initialise(batch);
    ilaw_bodies bodies = coupled_scene::bodies_of(v.size() / 3, ilaw::input(inverse_mass.data(), 1, 0),
                                                  v.data(), still.data(), velocity.data());
    if (rotate) {
      bodies.inverse_inertia = ilaw::input(inverse_inertia.data(), 6, 1);
      bodies.spin_free = bodies.spin_previous = ilaw::input(still.data(), 3, 1);
      bodies.spin = ilaw::output(spin.data(), 3, 1);
    }
    ilaw_contacts contacts = ilaw::contacts_of(law, form, batch, body.data(), counterpart.data());
    contacts.arm = ilaw::input(arms.data(), 3, 1);
    contacts.counterpart_arm = ilaw::input(other_arms.data(), 3, 1);
    if (weighted) {
      contacts.body_count = body_count;
      contacts.counterpart_count = counterpart_count;
      const std::int64_t numbers = weight_size;
      contacts.weight_size = weight_size;
      contacts.body_weight = ilaw::input(weight.data(), body_count * numbers, 1);
      contacts.counterpart_weight = ilaw::input(other_weight.data(), counterpart_count * numbers, 1);
    }
    ilaw_coupled_options options{};
    options.tolerance = tolerance;
    options.most_sweeps = most;
    options.speed = speed;
    return ilaw::coupled().solve(bodies, contacts, options);
  }
  // Velocity of a contact with weights.
  Point relative(std::size_t k) const {
    Point u{};
    const auto add = [&](const std::vector<std::int32_t>& bodies, const std::vector<double>& weights,
                         std::size_t entries, double sign) {
      for (std::size_t e = k * entries; e < (k + 1) * entries; ++e)
        for (std::size_t c = 0; c < 3 && bodies[e] >= 0; ++c)
          u[c] += sign * weights[e] * velocity[3 * static_cast<std::size_t>(bodies[e]) + c];
    };
    add(body, weight, body_count, 1.0);
    add(counterpart, other_weight, counterpart_count, -1.0);
    return u;
  }
  double largest_velocity() const {
    double largest = 0.0;
    for (const double x : velocity) largest = std::max(largest, std::fabs(x));
    return largest;
  }

  ilaw::interface law;
  bool rotate;
  ilaw_delassus_form form;
  double speed = 0.0;
  std::size_t count = 0;
  std::uint32_t body_count = 1, counterpart_count = 1, weight_size = 1;
  std::vector<std::int32_t> body, counterpart;
  std::vector<std::uint8_t> status;
  std::vector<double> weight, other_weight, normal, arms, other_arms, impulse, v, velocity, inverse_mass,
      inverse_inertia;
};

ilaw::interface friction(bool rotate, double mu) {
  return create("coulomb", rotate ? ILAW_DELASSUS_FULL : ILAW_DELASSUS_SCALAR, {{"friction", mu}});
}

// 400 balls, too many for 200 iterations: the report counts them and says so in a sentence.
TEST(CoupledConvergence, NamesWhatIsNotSolved) {
  Assembly column(friction(false, 0.3), false);
  for (int i = 0; i < 400; ++i) {
    column.add_body(i == 7 ? 4.0 : 1.0, 0.0, {0.0, 0.0, -1e-2});
    column.add(i, i - 1);
  }
  const ilaw_coupled_report report = column.solve(1e-12, 200);
  EXPECT_GT(report.residual, 1e-12);
  EXPECT_EQ(report.island_contacts, 400);
  EXPECT_DOUBLE_EQ(report.mass_ratio, 4.0);
  EXPECT_GT(report.energy_error, 0.0);
  ASSERT_NE(report.message, nullptr);
  const std::string message = report.message;
  EXPECT_NE(message.find("contacts are not solved after"), std::string::npos) << message;
  EXPECT_NE(message.find("(law 'coulomb') is off by"), std::string::npos) << message;
  EXPECT_NE(message.find("400 contacts are coupled, with masses of 1:4"), std::string::npos) << message;
  EXPECT_EQ(report.other_law, nullptr);
}

// Anderson's iterates jump, and some of them are far off: the best impulses are returned, wherever they end.
TEST(CoupledConvergence, GivesNoWorseImpulsesForMoreIterations) {
  double least = 1.0;
  for (std::uint32_t most = 40; most < 400; most += 9) {
    Assembly column(friction(false, 0.3), false);
    for (int i = 0; i < 400; ++i) {
      column.add_body(i % 7 == 3 ? 400.0 : 1.0, 0.0, {0.01 * std::sin(3.0 * i), 0.0, -1e-2});
      column.add(i, i - 1);
    }
    const ilaw_coupled_report report = column.solve(1e-14, most);
    EXPECT_LE(report.residual, 5.0 * least) << most;
    least = std::min(least, report.residual);
  }
}

// Both budgets end within the first splitting, whose impulses are given back: more of it are better ones.
TEST(CoupledConvergence, KeepsASplittingThatEndsUnsolved) {
  const auto solved = [](std::uint32_t most) {
    Assembly column(friction(false, 0.3), false);
    for (int i = 0; i < 400; ++i) {
      column.add_body(1.0, 0.0, {0.01 * std::sin(3.0 * i), 0.0, -1e-2});
      column.add(i, i - 1);
    }
    const ilaw_coupled_report report = column.solve(1e-14, most);
    EXPECT_EQ(report.method, static_cast<std::uint32_t>(ILAW_METHOD_DOUGLAS_RACHFORD)) << most;
    return report.residual;
  };
  const double early = solved(310), late = solved(370);
  EXPECT_GT(late, 1e-14);
  EXPECT_LE(late, 0.8 * early);
}

// Bodies that fly together have relative velocities of rounding alone: beside their speed, given or their
// own, these are none.
TEST(CoupledConvergence, IgnoresRoundingBelowTheSpeed) {
  for (const double speed : {0.0, 1.0}) {
    Assembly chain(create("tie", ILAW_DELASSUS_SCALAR), false);
    for (int i = 0; i < 30; ++i) {
      chain.add_body(1.0 + i, 0.0, {std::nextafter(1.0, 1.0 + (i % 3 - 1)), 0.0, 0.0});
      if (i > 0) chain.add(i, i - 1);
    }
    chain.speed = speed;
    const ilaw_coupled_report report = chain.solve(1e-14, 1000);
    EXPECT_TRUE(report.residual <= 1e-14 && report.sweeps <= 2) << report.sweeps;
  }
}

// A chain of masses 1 and 1e7 in turn keeps its momentum and moves as one.
TEST(CoupledConvergence, TiesMassesOfOneToTenMillion) {
  Assembly chain(create("tie", ILAW_DELASSUS_SCALAR), false);
  double momentum = 0.0, mass = 0.0;
  for (int i = 0; i < 20; ++i) {
    const double m = i % 2 == 0 ? 1e7 : 1.0, speed = std::sin(1.0 + i);
    chain.add_body(m, 0.0, {speed, 0.0, 0.0});
    momentum += m * speed;
    mass += m;
    if (i > 0) chain.add(i, i - 1);
  }
  const ilaw_coupled_report report = chain.solve(1e-12, 1000);
  EXPECT_EQ(report.message, nullptr) << report.message;
  for (std::size_t i = 0; i < chain.velocity.size(); i += 3)
    EXPECT_NEAR(chain.velocity[i], momentum / mass, 1e-6) << "body " << i / 3;
}

// A light body that stops two heavy ones has impulses of their mass ratio: no sign of incompatible laws.
TEST(CoupledConvergence, BlamesNoLawForAMassRatio) {
  Assembly chain(create("tie", ILAW_DELASSUS_SCALAR), false);
  for (const double speed : {1.0, 0.0, -1.0})
    chain.add_body(speed == 0.0 ? 1.0 : 1e12, 0.0, {speed, 0.0, 0.0});
  chain.add(1, 0);
  chain.add(2, 1);
  const ilaw_coupled_report report = chain.solve(1e-12, 1000);
  EXPECT_GT(report.speed, 1e9 * report.first_speed);
  EXPECT_EQ(report.law, nullptr) << report.law;
}

// Bricks in running bond, four corners at each bed joint; the top course weighs ten thousand times the
// others.
TEST(CoupledConvergence, HoldsAWallUnderAHeavyCourse) {
  constexpr int courses = 6, length = 5;
  Assembly wall(friction(true, 0.6), true);
  std::vector<std::vector<std::pair<std::int32_t, double>>> bricks(courses);
  for (int j = 0; j < courses; ++j)
    for (int i = 0; i < length + j % 2; ++i) {
      const double x = 2.0 * i - j % 2, m = j == courses - 1 ? 1e4 : 1.0;
      const auto number = static_cast<std::int32_t>(wall.inverse_mass.size());
      wall.add_body(m, 0.4 * m, {0.0, 0.0, -1e-2});
      bricks[static_cast<std::size_t>(j)].emplace_back(number, x);
      const auto corners = [&](std::int32_t below, double other_x, double from, double to) {
        for (const double at : {from, to})
          for (const double y : {-0.5, 0.5})
            wall.add(number, below, {at - x, y, -0.3}, {at - other_x, y, 0.3});
      };
      if (j == 0) corners(-1, 0.0, x - 1.0, x + 1.0);
      for (const auto& [below, other_x] : bricks[static_cast<std::size_t>(std::max(j, 1) - 1)])
        if (j > 0 && std::fabs(x - other_x) < 1.5)
          corners(below, other_x, std::max(x, other_x) - 1.0, std::min(x, other_x) + 1.0);
    }
  const ilaw_coupled_report report = wall.solve(1e-9, 20000);
  EXPECT_EQ(report.message, nullptr) << report.message;
  EXPECT_LE(wall.largest_velocity(), 1e-8 * 1e-2);
  double weight = 0.0, carried = 0.0;
  for (const double inverse : wall.inverse_mass) weight += 1e-2 / inverse;
  for (std::size_t k = 0; k < wall.count; ++k)
    if (wall.counterpart[k] < 0) carried += wall.impulse[3 * k + 2];
  EXPECT_NEAR(carried, weight, 1e-8 * weight);
}

// A heavy box on a light one, four corners each: gravity in each step, from the forces of the last one.
struct Boxes {
  explicit Boxes(double ratio) : boxes(friction(true, 0.5), true) {
    for (const double m : {1.0, ratio}) boxes.add_body(m, m / 6.0, {0.0, 0.0, -g * h});
    for (const double x : {-0.5, 0.5})
      for (const double y : {-0.5, 0.5}) {
        boxes.add(0, -1, {x, y, -0.5});
        boxes.add(1, 0, {x, y, -0.5}, {x, y, 0.5});
      }
  }
  // Largest velocity that is left, over that of a step of gravity; sets whether the solver is content.
  double step(std::uint32_t most, bool& solved) {
    for (std::size_t i = 2; i < boxes.v.size(); i += 3)
      boxes.v[i] = (boxes.velocity.empty() ? 0.0 : boxes.velocity[i]) - g * h;
    solved = boxes.solve(1e-10, most).message == nullptr;
    return boxes.largest_velocity() / (g * h);
  }
  static constexpr double g = 10.0, h = 1e-3;
  Assembly boxes;
};

TEST(CoupledConvergence, HoldsAHeavyBoxOnALightOne) {
  const std::vector<std::pair<double, std::uint32_t>> cases{{1.0, 20},   {1e2, 20},   {1.0, 1000},
                                                            {1e2, 1000}, {1e4, 1000}, {1e6, 1000}};
  for (const auto& [ratio, most] : cases) {
    Boxes boxes(ratio);
    double fallen = 0.0;
    for (int n = 0; n < 120; ++n) {
      bool solved = false;
      EXPECT_LE(boxes.step(most, solved), most < 1000 ? 1e-3 : 1e-7)
          << ratio << ", " << most << ", step " << n;
      EXPECT_TRUE(solved || most < 1000) << ratio << ", " << most << ", step " << n;
      fallen -= Boxes::h * boxes.boxes.velocity[5];
    }
    EXPECT_NEAR(fallen, 0.0, most < 1000 ? 1e-8 : 1e-12)
        << "of an edge of 1, ratio " << ratio << ", most " << most;
    double weight = 0.0;
    for (std::size_t k = 0; k < 8; k += 2) weight += boxes.boxes.impulse[3 * k + 2];  // at the floor
    EXPECT_NEAR(weight, (1.0 + ratio) * Boxes::g * Boxes::h,
                (most < 1000 ? 1e-4 : 1e-9) * (1.0 + ratio) * Boxes::g * Boxes::h)
        << "ratio " << ratio;
  }
}

// Two meshes of 5 x 5 and 4 x 4 cells, the nodes of each on facets of the other: more contacts than needed.
TEST(CoupledConvergence, SolvesBothSidesOfTwoMeshes) {
  Assembly meshes(friction(false, 0.3), false);
  const std::array<int, 2> cells{5, 4};
  for (std::size_t mesh = 0; mesh < 2; ++mesh)
    for (int i = 0; i < (cells[mesh] + 1) * (cells[mesh] + 1); ++i)
      meshes.add_body(
          1.0 / cells[mesh], 0.0,
          {0.1 * std::sin(i), 0.05 * std::cos(3.0 * i), (mesh == 0 ? -1.0 : 1.0) + 0.3 * std::sin(7.0 * i)});
  const std::array<int, 2> first{0, 36};
  for (std::size_t mesh = 0; mesh < 2; ++mesh) {
    const int n = cells[mesh], m = cells[1 - mesh];
    for (int i = 0; i <= n; ++i)
      for (int j = 0; j <= n; ++j) {
        const double x = static_cast<double>(i * m) / n, y = static_cast<double>(j * m) / n;
        const int a = std::min(static_cast<int>(x), m - 1), b = std::min(static_cast<int>(y), m - 1);
        const double u = x - a, w = y - b;
        const int node = first[mesh] + i * (n + 1) + j;
        const auto corner = [&](int p, int q) { return first[1 - mesh] + (a + p) * (m + 1) + b + q; };
        const std::vector<std::int32_t> facet{corner(0, 0), corner(0, 1), corner(1, 0), corner(1, 1)};
        const std::vector<double> weights{(1 - u) * (1 - w), (1 - u) * w, u * (1 - w), u * w};
        // The normal points from the second mesh into the first.
        if (mesh == 0)
          meshes.add({node, -1, -1, -1}, {1.0, 0.0, 0.0, 0.0}, facet, weights);
        else
          meshes.add(facet, weights, {node, -1, -1, -1}, {1.0, 0.0, 0.0, 0.0});
      }
  }
  const ilaw_coupled_report report = meshes.solve(1e-10, 5000, true);
  EXPECT_EQ(report.message, nullptr) << report.message;
  constexpr double speed = 1.3, known = 1e-9 * speed;
  for (std::size_t k = 0; k < meshes.count; ++k) {
    const Point v = meshes.relative(k);
    const double* r = &meshes.impulse[3 * k];
    const double pull = std::hypot(r[0], r[1]), slip = std::hypot(v[0], v[1]);
    EXPECT_GE(r[2], 0.0) << k;
    EXPECT_GE(v[2], -known) << k;
    EXPECT_LE(r[2] * v[2], known) << k;
    EXPECT_LE(pull, 0.3 * r[2] * (1.0 + 1e-12)) << k;
    EXPECT_LE((0.3 * r[2] - pull) * slip, known) << k;               // it sticks, or friction is at its limit
    EXPECT_LE(r[0] * v[0] + r[1] * v[1], known - pull * slip) << k;  // against the slip
  }
}

// Facets of one node each, and one with the same node twice, are pairs of bodies.
TEST(CoupledConvergence, FacetsOfOneNodeArePairs) {
  Assembly pairs(friction(false, 0.3), false), facets(friction(false, 0.3), false);
  for (int i = 0; i < 6; ++i) {
    const Point v{0.01 * i, 0.0, -1e-2};
    pairs.add_body(1.0 + i, 0.0, v);
    facets.add_body(1.0 + i, 0.0, v);
    pairs.add(i, i - 1);
    facets.add({i, i}, {0.25, 0.75}, {i - 1, -1}, {1.0, 0.0});
  }
  EXPECT_LE(pairs.solve(1e-13, 1000).residual, 1e-13);
  EXPECT_LE(facets.solve(1e-13, 1000, true).residual, 1e-13);
  for (std::size_t i = 0; i < pairs.velocity.size(); ++i)
    EXPECT_NEAR(pairs.velocity[i], facets.velocity[i], 1e-11) << i;
  for (std::size_t i = 0; i < pairs.impulse.size(); ++i)
    EXPECT_NEAR(pairs.impulse[i], facets.impulse[i], 1e-10) << i;
}

// Nodes with axes of their own: the matrices of a node that a side names twice add up, here to the identity.
TEST(CoupledConvergence, AddsTheMatricesOfANodeNamedTwice) {
  const std::vector<double> identity{1, 0, 0, 0, 1, 0, 0, 0, 1}, none(9, 0.0);
  const std::vector<double> part{0.3, -0.2, 0.5, 0.1, 0.6, -0.4, 0.7, 0.2, 0.9};
  std::vector<double> both = part, once = identity;
  for (std::size_t c = 0; c < 9; ++c) both.push_back(identity[c] - part[c]);
  once.insert(once.end(), none.begin(), none.end());
  Assembly pairs(friction(true, 0.3), true), facets(friction(true, 0.3), true);
  pairs.rotate = facets.rotate = false;
  facets.weight_size = 9;
  for (int i = 0; i < 4; ++i) {
    const Point v{0.01 * i, -0.02, -1e-2};
    pairs.add_body(1.0 + i, 0.0, v);
    facets.add_body(1.0 + i, 0.0, v);
    pairs.add(i, i - 1);
    facets.add({i, i}, both, {i - 1, -1}, once);
  }
  pairs.solve(1e-13, 1000);
  facets.solve(1e-13, 1000, true);
  for (std::size_t i = 0; i < pairs.impulse.size(); ++i)
    EXPECT_NEAR(pairs.impulse[i], facets.impulse[i], 1e-10) << i;
}

// Balls high up are reached last: each column is an island, and its contacts stick at the end.
TEST(CoupledConvergence, GivesTheLastStatusOfEachIsland) {
  Assembly columns(friction(false, 0.3), false);
  for (int column = 0; column < 2; ++column)
    for (int i = 0; i < 250; ++i) {
      const auto number = static_cast<std::int32_t>(columns.inverse_mass.size());
      columns.add_body(1.0, 0.0, {0.0, 0.0, -1e-2});
      columns.add(number, i > 0 ? number - 1 : -1);
    }
  EXPECT_LE(columns.solve(1e-12, 2000).residual, 1e-12);
  for (std::size_t k = 0; k < columns.count; ++k) EXPECT_EQ(columns.status[k], ILAW_STICK) << k;
}

// Two columns of which one takes longer, in either order.
TEST(CoupledConvergence, NamesTheMethodOfTheSlowestIsland) {
  const auto columns = [](const std::vector<int>& heights) {
    Assembly made(friction(false, 0.3), false);
    for (const int height : heights)
      for (int i = 0; i < height; ++i) {
        const auto number = static_cast<std::int32_t>(made.inverse_mass.size());
        made.add_body(1.0, 0.0, {0.0, 0.0, -1e-2});
        made.add(number, i > 0 ? number - 1 : -1);
      }
    return made.solve(1e-12, 2000);
  };
  const ilaw_coupled_report low = columns({50}), high = columns({400});
  ASSERT_NE(low.method, high.method);
  ASSERT_NE(low.sweeps, high.sweeps);
  const std::uint32_t slowest = low.sweeps > high.sweeps ? low.method : high.method;
  EXPECT_EQ(columns({50, 400}).method, slowest);
  EXPECT_EQ(columns({400, 50}).method, slowest);
}

// By the lever: a node on the middle of a beam of two nodes feels half of their masses.
TEST(CoupledConvergence, AFacetSharesTheImpulseByWeights) {
  Assembly facet(create("contact", ILAW_DELASSUS_SCALAR), false);
  facet.add_body(1.0, 0.0, {0.0, 0.0, -1.0});
  facet.add_body(2.0, 0.0, {0.0, 0.0, 0.0});
  facet.add_body(4.0, 0.0, {0.0, 0.0, 0.0});
  facet.add({0, -1}, {1.0, 0.0}, {1, 2}, {0.25, 0.75});
  facet.solve(1e-14, 100, true);
  const double h = 1.0 + 0.0625 / 2.0 + 0.5625 / 4.0, r = 1.0 / h;
  EXPECT_NEAR(facet.impulse[2], r, 1e-14);
  EXPECT_NEAR(facet.velocity[5], -0.25 * r / 2.0, 1e-14);
  EXPECT_NEAR(facet.velocity[8], -0.75 * r / 4.0, 1e-14);
}

// Five iterations do not reach the top of the column.
TEST(CoupledConvergence, NamesTheWorstContactWhereNoneIsSolved) {
  Assembly column(friction(false, 0.3), false);
  for (int i = 0; i < 40; ++i) {
    column.add_body(1.0, 0.0, {0.0, 0.0, -1e-2});
    column.add(i, i - 1);
  }
  const ilaw_coupled_report report = column.solve(1e-12, 5);
  EXPECT_GT(report.residual, 1e-12);
  EXPECT_EQ(report.worst_group, 0);
  EXPECT_GE(report.worst_contact, 0);
  EXPECT_EQ(report.method, static_cast<std::uint32_t>(ILAW_METHOD_CONJUGATE));
}

// A body between two walls that begin to approach each other, beside a heavy one on a wall of its own: the
// walls' law is named, not that of the largest impulse. Ties to walls that moved before have another branch,
// in which their impulse does no work: then nothing is said of the laws.
TEST(CoupledConvergence, NamesIncompatibleLawsAtOneBody) {
  Assembly pinched(create("tie", ILAW_DELASSUS_SCALAR), false),
      heavy(create("contact", ILAW_DELASSUS_SCALAR), false);
  const std::vector<double> walls{0.0, 0.0, 1.0, 0.0, 0.0, -1.0}, inverse_mass{1.0, 1e-18};
  std::vector<double> v{0.0, 0.0, 0.0, 0.0, 0.0, -1.0}, impulse(6), heavy_impulse(3), state(64),
      normal{0, 0, 1, 0, 0, 1};
  const double gap = 0.0, area = 1.0;
  const std::vector<std::int32_t> body{0, 0, 1}, wall{-1, -1, -1};
  using coupled_scene::batch_of;
  const ilaw_batch ties = batch_of(pinched.law, 2, 1e-3, gap, area, normal.data(), state, impulse.data()),
                   contact =
                       batch_of(heavy.law, 1, 1e-3, gap, area, normal.data(), state, heavy_impulse.data());
  ASSERT_EQ(pinched.law.initialise(ties), ILAW_OK);
  ilaw_contacts first = ilaw::contacts_of(pinched.law, ILAW_DELASSUS_SCALAR, ties, body.data(), wall.data());
  first.wall_velocity = ilaw::input(walls.data(), 3, 1);
  const std::vector<double> still(3);
  first.wall_previous = ilaw::input(still.data(), 0, 1);
  const ilaw_contacts second =
      ilaw::contacts_of(heavy.law, ILAW_DELASSUS_SCALAR, contact, body.data() + 2, wall.data());
  const std::vector<double> v_free = v;
  const ilaw_bodies bodies = coupled_scene::bodies_of(2, ilaw::input(inverse_mass.data(), 1, 0),
                                                      v_free.data(), v_free.data(), v.data());
  const ilaw_contacts* groups[] = {&first, &second};
  ilaw::coupled solver;
  const ilaw_coupled_report report = solver.solve(bodies, groups, {});
  ASSERT_NE(report.law, nullptr) << report.speed / report.first_speed;
  EXPECT_STREQ(report.law, "tie");
  EXPECT_STREQ(report.other_law, "tie");

  first.wall_previous = {};
  std::fill(impulse.begin(), impulse.end(), 0.0);
  const ilaw_coupled_report moving = solver.solve(bodies, groups, {});
  EXPECT_EQ(moving.law, nullptr);
  EXPECT_NE(moving.message, nullptr);
}

}  // namespace
