// Contacts that share bodies (ilaw/coupled.h) against what is known without them: weight, momentum, levers,
// and what the report says of problems that plain iterations do not solve. coupled_made_test.cpp draws
// problems from their solutions, python/test_solver_machine.py draws calls.
// SPDX-License-Identifier: BSD-3-Clause
#include "support/coupled_problem.hpp"
#include "support/program.hpp"

#include <functional>

namespace ilaw::testing {
namespace {

using Body = CoupledProblem::Body;
using Contact = CoupledProblem::Contact;

constexpr double g = 10.0;

ilaw::interface friction(double mu, std::uint32_t form = ILAW_DELASSUS_FULL) {
  return coupled_law("coulomb", form, {{"friction", mu}});
}
ilaw::interface tie(std::uint32_t form = ILAW_DELASSUS_FULL) { return coupled_law("tie", form); }

ilaw_coupled_report solve(CoupledProblem& problem, double tolerance, std::uint32_t most = 5000) {
  problem.options.tolerance = tolerance;
  problem.options.most_sweeps = most;
  return problem.solve();
}

// Points above each other that fall at 0.01, with friction.
CoupledProblem column(
    int count, const std::function<double(int)>& mass_of = [](int) { return 1.0; }, double aside = 0.0) {
  CoupledProblem made(friction(0.3, ILAW_DELASSUS_SCALAR), ILAW_DELASSUS_SCALAR);
  std::vector<Body> points(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    points[static_cast<std::size_t>(i)].mass = mass_of(i);
    points[static_cast<std::size_t>(i)].v = {aside * std::sin(3.0 * i), 0.0, -1e-2};
  }
  stack(made, points);
  return made;
}

// Points one after another with rigid bonds, and their velocities along x.
CoupledProblem chain(const std::vector<std::pair<double, double>>& masses_and_speeds) {
  CoupledProblem made(tie(ILAW_DELASSUS_SCALAR), ILAW_DELASSUS_SCALAR);
  for (const auto& [mass, speed] : masses_and_speeds) {
    Body point;
    point.mass = mass;
    point.v = {speed, 0.0, 0.0};
    const std::int32_t here = made.add_body(point);
    if (here > 0) made.touch(here, here - 1, {0.0, 0.0, 1.0});
  }
  return made;
}

void expect_same(const CoupledProblem& a, const CoupledProblem& b, double tolerance) {
  for (std::size_t i = 0; i < a.body.size(); ++i) {
    EXPECT_THAT(a.body[i].v, VectorNear(b.body[i].v, tolerance)) << i;
    EXPECT_THAT(a.body[i].w, VectorNear(b.body[i].w, tolerance)) << i;
  }
}

// host_mock/minimal/grains.c, a host in C: a thousand grains fall into a box. docs/comparisons.md has larger
// ones.
TEST(Coupled, PileSettlesWithoutSinkingIntoItself) {
  setenv("ILAW_PATH", ILAW_PLUGIN_FOLDER, 1);
  const auto [code, output] = programs::run_command(ILAW_grains_c " coulomb 1000 250 15 5e-3 10");
  ASSERT_EQ(code, 0) << output;
  double overlap = 1.0, kinetic = 1.0, residual = 1.0, iterations = 0.0;
  int contacts = 0;
  ASSERT_EQ(std::sscanf(output.c_str(), "overlap %lf kinetic %lf residual %lf sweeps %lf contacts %d",
                        &overlap, &kinetic, &residual, &iterations, &contacts),
            5)
      << output;
  EXPECT_LE(overlap, 0.01) << "of a diameter";
  EXPECT_LE(kinetic, 0.01) << "of the energy of the fall";
  EXPECT_GE(contacts, 3000) << "a grain in a pile has some three of its own";
  EXPECT_LE(iterations, 15.0);
}

// A gap of rounding is closed: the law moreau would let a node through that is not in touch.
TEST(Coupled, GapOfRoundingIsNone) {
  for (const double gap : {0.0, 1e-16, 1e-14}) {
    CoupledProblem point(coupled_law("contact", ILAW_DELASSUS_SCALAR, {}, {{"activation", "moreau"}}),
                         ILAW_DELASSUS_SCALAR, 1);
    point.body[0].v = point.body[0].v_before = {0.0, 0.0, -1e-2};
    point.touch(0, -1, {0.0, 0.0, 1.0}, gap);
    solve(point, 1e-10);
    EXPECT_EQ(point.body[0].v[2], gap > 1e-15 ? -1e-2 : 0.0) << gap;
  }
}

// ---- what the report says ---------------------------------------------------------------------------------

// 400 balls, too many for 200 iterations, and 40, too many for five.
TEST(CoupledReport, NamesWhatIsNotSolved) {
  CoupledProblem high = column(400, [](int i) { return i == 7 ? 4.0 : 1.0; });
  const ilaw_coupled_report report = solve(high, 1e-12, 200);
  EXPECT_GT(report.residual, 1e-12);
  EXPECT_EQ(report.island_contacts, 400);
  EXPECT_DOUBLE_EQ(report.mass_ratio, 4.0);
  EXPECT_GT(report.energy_error, 0.0);
  ASSERT_NE(report.message, nullptr);
  for (const char* part : {"contacts are not solved after", "(law 'coulomb') is off by",
                           "400 contacts are coupled, with masses of 1:4"})
    EXPECT_THAT(report.message, HasSubstr(part));
  EXPECT_EQ(report.other_law, nullptr);
  CoupledProblem low = column(40);
  const ilaw_coupled_report early = solve(low, 1e-12, 5);
  EXPECT_EQ(early.worst_group, 0);
  EXPECT_GE(early.worst_contact, 0);
  EXPECT_EQ(early.method, static_cast<std::uint32_t>(ILAW_METHOD_CONJUGATE));
}

// A law that refuses a node from its 300th call on.
const ilaw_law* tired = nullptr;
int calls = 0;
std::int32_t refuses_later(const ilaw_instance* instance, const ilaw_batch* batch, ilaw_report* report) {
  const std::int32_t code = tired->evaluate(instance, batch, report);
  if (++calls < 300) return code;
  batch->status[0] = ILAW_BAD_INPUT;
  report->bad_count = 1;
  report->first_bad_node = 0;
  report->reason = "too tired";
  return ILAW_BAD_NODES;
}
// Also in an island, which is iterated apart from the others.
TEST(CoupledReport, CountsContactsThatAreRefusedLate) {
  for (const bool has_islands : {false, true}) {
    CoupledProblem high = column(400);
    if (has_islands) high.touch(high.add_body({}), -1, {0.0, 0.0, 1.0});
    high.options.tolerance = 1e-12;
    high.options.most_sweeps = 200;
    const ilaw_batch batch = high.batch();
    ilaw_contacts contacts = high.contacts(batch);
    tired = contacts.law, calls = 0;
    ilaw_law law = *tired;
    law.evaluate = refuses_later;
    contacts.law = &law;
    const ilaw_coupled_report report = high.solver.solve(high.bodies(), contacts, high.options);
    EXPECT_GT(report.bad_count, 0) << has_islands;
    EXPECT_STREQ(report.reason, "too tired");
  }
}

// Anderson's iterates jump, and some of them are far off: the best impulses are returned, wherever they end.
TEST(CoupledReport, IsNoWorseForMoreIterations) {
  double least = 1.0;
  for (std::uint32_t most = 40; most < 400; most += 9) {
    CoupledProblem high = column(
        400, [](int i) { return i % 7 == 3 ? 400.0 : 1.0; }, 0.01);
    const ilaw_coupled_report report = solve(high, 1e-14, most);
    EXPECT_LE(report.residual, 5.0 * least) << most;
    least = std::min(least, report.residual);
  }
}

// Both budgets end within the first splitting, whose impulses are given back: more of it are better ones.
TEST(CoupledReport, IsOfASplittingThatEndsUnsolved) {
  const auto residual = [](std::uint32_t most) {
    CoupledProblem high = column(
        400, [](int) { return 1.0; }, 0.01);
    const ilaw_coupled_report report = solve(high, 1e-14, most);
    EXPECT_EQ(report.method, static_cast<std::uint32_t>(ILAW_METHOD_DOUGLAS_RACHFORD)) << most;
    return report.residual;
  };
  const double early = residual(310), late = residual(370);
  EXPECT_GT(late, 1e-14);
  EXPECT_LE(late, 0.8 * early);
}

// Bodies that fly together have relative velocities of rounding alone: beside their speed, given or their
// own, these are none.
TEST(CoupledReport, IgnoresRoundingBelowTheSpeed) {
  for (const double speed : {0.0, 1.0}) {
    std::vector<std::pair<double, double>> flying;
    for (int i = 0; i < 30; ++i) flying.emplace_back(1.0 + i, std::nextafter(1.0, 1.0 + (i % 3 - 1)));
    CoupledProblem together = chain(flying);
    together.options.speed = speed;
    const ilaw_coupled_report report = solve(together, 1e-14);
    EXPECT_TRUE(report.residual <= 1e-14 && report.sweeps <= 2) << report.sweeps;
  }
}

// A light body that stops two heavy ones has impulses of their mass ratio: no sign of incompatible laws.
TEST(CoupledReport, BlamesNoLawForAMassRatio) {
  CoupledProblem light = chain({{1e12, 1.0}, {1.0, 0.0}, {1e12, -1.0}});
  const ilaw_coupled_report report = solve(light, 1e-12, 1000);
  EXPECT_GT(report.speed, 1e9 * report.first_speed);
  EXPECT_EQ(report.law, nullptr) << report.law;
}

// A chain of masses 1 and 1e7 in turn moves as one.
TEST(CoupledReport, IsOfASolutionAtAMassRatioOfTenMillion) {
  std::vector<std::pair<double, double>> links;
  for (int i = 0; i < 20; ++i) links.emplace_back(i % 2 == 0 ? 1e7 : 1.0, std::sin(1.0 + i));
  CoupledProblem pulled = chain(links);
  const double common = pulled.momentum()[0] / (10.0 * 1e7 + 10.0);
  EXPECT_EQ(solve(pulled, 1e-12, 1000).message, nullptr);
  for (const Body& one : pulled.body) EXPECT_NEAR(one.v[0], common, 1e-6);
}

// Balls high up are reached last: each column is an island, and its contacts stick at the end. The method is
// that of the island that takes longer, in either order.
TEST(CoupledReport, HasTheLastStatusAndTheMethodOfTheSlowestIsland) {
  const auto columns = [](int first, int second) {
    CoupledProblem both = column(first), other = column(second);
    for (std::size_t k = 0; k < other.body.size(); ++k) {
      const std::int32_t here = both.add_body(other.body[k]);
      both.touch(here, k > 0 ? here - 1 : -1, {0.0, 0.0, 1.0});
    }
    const ilaw_coupled_report report = solve(both, 1e-12, 2000);
    EXPECT_TRUE(first != second || report.residual <= 1e-12) << report.residual;
    for (const Contact& c : both.contact) EXPECT_TRUE(first != second || c.status == ILAW_STICK);
    return report;
  };
  const ilaw_coupled_report low = columns(50, 0), high = columns(400, 0);
  ASSERT_NE(low.method, high.method);
  ASSERT_NE(low.sweeps, high.sweeps);
  const std::uint32_t slowest = low.sweeps > high.sweeps ? low.method : high.method;
  EXPECT_EQ(columns(50, 400).method, slowest);
  EXPECT_EQ(columns(400, 50).method, slowest);
  columns(250, 250);
}

// A body between two walls that begin to approach each other, beside a heavy one on a wall of its own: the
// walls' law is named, not that of the largest impulse. Ties to walls that moved before have another branch,
// in which their impulse does no work: then nothing is said of the laws.
TEST(CoupledReport, NamesIncompatibleLawsAtOneBody) {
  for (const bool moved_before : {false, true}) {
    CoupledProblem pinched(tie(ILAW_DELASSUS_SCALAR), ILAW_DELASSUS_SCALAR, 2),
        heavy(coupled_law("contact", ILAW_DELASSUS_SCALAR), ILAW_DELASSUS_SCALAR);
    pinched.body[0].inverse_mass = {1.0, 1.0, 1.0}, pinched.body[1].inverse_mass = {1e-18, 1e-18, 1e-18};
    pinched.body[1].v = pinched.body[1].v_before = {0.0, 0.0, -1.0};
    for (const double speed : {1.0, -1.0}) {
      Contact wall;
      wall.wall = {0.0, 0.0, speed};
      wall.wall_before = moved_before ? wall.wall : Vector{};
      pinched.add(0, -1, wall);
    }
    heavy.add(1, -1, Contact{});
    pinched.has_wall = pinched.has_wall_before = true;
    const ilaw_batch ties = pinched.batch(), contact = heavy.batch();
    const ilaw_contacts first = pinched.contacts(ties), second = heavy.contacts(contact);
    const ilaw_contacts* groups[] = {&first, &second};
    const ilaw_coupled_report report = pinched.solver.solve(pinched.bodies(), groups, {});
    EXPECT_NE(report.message, nullptr);
    if (moved_before) {
      EXPECT_EQ(report.law, nullptr);
    } else {
      EXPECT_STREQ(report.law, "tie");
      EXPECT_STREQ(report.other_law, "tie");
    }
  }
}

// A heavy box on a light one, four corners each: gravity in each step, from the forces of the last one.
TEST(Coupled, HeavyBoxStaysOnALightOne) {
  const std::pair<double, std::uint32_t> cases[] = {{1.0, 20},   {1e2, 20},   {1.0, 1000},
                                                    {1e2, 1000}, {1e4, 1000}, {1e6, 1000}};
  for (const auto& [ratio, most] : cases) {
    GIVEN(ratio, most);
    const bool is_short = most < 1000;
    CoupledProblem boxes(friction(0.5), ILAW_DELASSUS_FULL);
    for (const double m : {1.0, ratio}) {
      Body box;
      box.mass = m, box.inertia = m / 6.0;
      boxes.add_body(box);
    }
    for (const double x : {-0.5, 0.5})
      for (const double y : {-0.5, 0.5})
        for (const std::int32_t upper : {0, 1}) {
          Contact corner;
          corner.arm = {x, y, -0.5}, corner.other_arm = {x, y, 0.5};
          boxes.add(upper, upper - 1, corner);
        }
    double fallen = 0.0;
    for (int n = 0; n < 120; ++n) {
      for (Body& one : boxes.body) one.v[2] -= g * boxes.h;
      const bool is_solved = solve(boxes, 1e-10, most).message == nullptr;
      EXPECT_LE(boxes.largest_velocity(), (is_short ? 1e-3 : 1e-7) * g * boxes.h) << n;
      EXPECT_TRUE(is_solved || is_short) << n;
      fallen -= boxes.h * boxes.body[1].v[2];
    }
    EXPECT_NEAR(fallen, 0.0, is_short ? 1e-8 : 1e-12) << "of an edge of 1";
    double weight = 0.0;
    for (std::size_t k = 0; k < 8; k += 2) weight += boxes.contact[k].impulse[2];
    EXPECT_NEAR(weight / ((1.0 + ratio) * g * boxes.h), 1.0, is_short ? 1e-4 : 1e-9);
  }
}

// ---- facets
// ------------------------------------------------------------------------------------------------

// Facets of one node each, and one with the same node twice, are pairs of bodies. For nodes with axes of
// their own, the matrices of a node that a side names twice add up, here to the identity: also in H, so that
// a contact by itself is solved at once.
TEST(CoupledFacets, OfOneNodeArePairs) {
  const std::vector<double> identity{1, 0, 0, 0, 1, 0, 0, 0, 1},
      part{0.3, -0.2, 0.5, 0.1, 0.6, -0.4, 0.7, 0.2, 0.9};
  std::vector<double> both = part, once = identity;
  for (std::size_t c = 0; c < 9; ++c) both.push_back(identity[c] - part[c]);
  once.resize(18);
  for (const bool has_axes : {false, true})
    for (const int count : {6, 2}) {
      GIVEN(has_axes, count);
      const std::uint32_t form = has_axes ? ILAW_DELASSUS_FULL : ILAW_DELASSUS_SCALAR;
      CoupledProblem pairs(friction(0.3, form), form), facets(friction(0.3, form), form);
      pairs.rotates = facets.rotates = false;
      facets.weight_size = has_axes ? 9 : 1;
      for (std::int32_t i = 0; i < count; ++i) {
        Body point;
        point.mass = 1.0 + i;
        point.v = {0.01 * i, -0.02, -1e-2 * (i + 1)};
        pairs.add_body(point), facets.add_body(point);
        if (count == 2 && i == 0) continue;
        pairs.add(i, i - 1, Contact{});
        if (has_axes)
          facets.add({i, i}, both, {i - 1, -1}, once, Contact{});
        else
          facets.add({i, i}, {0.25, 0.75}, {i - 1, -1}, {1.0, 0.0}, Contact{});
      }
      const ilaw_coupled_report one = solve(pairs, 1e-13, 1000), other = solve(facets, 1e-13, 1000);
      EXPECT_LE(std::max(one.residual, other.residual), 1e-13);
      if (count == 2) {
        EXPECT_LE(other.sweeps, 2U);
      }
      expect_same(pairs, facets, 1e-11);
      for (std::size_t k = 0; k < pairs.contact.size(); ++k)
        EXPECT_THAT(pairs.contact[k].impulse, VectorNear(facets.contact[k].impulse, 1e-10));
    }
}

// By the lever: a node on the middle of a beam of two nodes feels half of their masses.
TEST(CoupledFacets, ShareTheImpulseByWeights) {
  CoupledProblem facet(coupled_law("contact", ILAW_DELASSUS_SCALAR), ILAW_DELASSUS_SCALAR);
  for (const double mass : {1.0, 2.0, 4.0}) {
    Body point;
    point.mass = mass;
    facet.add_body(point);
  }
  facet.body[0].v[2] = -1.0;
  facet.add({0, -1}, {1.0, 0.0}, {1, 2}, {0.25, 0.75}, Contact{});
  solve(facet, 1e-14, 100);
  const double h = 1.0 + 0.0625 / 2.0 + 0.5625 / 4.0, r = 1.0 / h;
  EXPECT_NEAR(facet.contact[0].impulse[2], r, 1e-14);
  EXPECT_NEAR(facet.body[1].v[2], -0.25 * r / 2.0, 1e-14);
  EXPECT_NEAR(facet.body[2].v[2], -0.75 * r / 4.0, 1e-14);
}

// Two meshes of 5 x 5 and 4 x 4 cells, the nodes of each on facets of the other: more contacts than needed.
TEST(CoupledFacets, OfBothSidesAreSolvedWithFriction) {
  constexpr double mu = 0.3, known = 1.3e-9;
  CoupledProblem meshes(friction(mu, ILAW_DELASSUS_SCALAR), ILAW_DELASSUS_SCALAR);
  const int cells[] = {5, 4}, first[] = {0, 36};
  for (const int mesh : {0, 1})
    for (int i = 0; i < (cells[mesh] + 1) * (cells[mesh] + 1); ++i) {
      Body node;
      node.mass = 1.0 / cells[mesh];
      node.v = {0.1 * std::sin(i), 0.05 * std::cos(3.0 * i),
                (mesh == 0 ? -1.0 : 1.0) + 0.3 * std::sin(7.0 * i)};
      meshes.add_body(node);
    }
  for (const int mesh : {0, 1}) {
    const int n = cells[mesh], m = cells[1 - mesh];
    for (int i = 0; i <= n; ++i)
      for (int j = 0; j <= n; ++j) {
        const double x = static_cast<double>(i * m) / n, y = static_cast<double>(j * m) / n;
        const int a = std::min(static_cast<int>(x), m - 1), b = std::min(static_cast<int>(y), m - 1);
        const double u = x - a, w = y - b;
        const auto corner = [&](int p, int q) { return first[1 - mesh] + (a + p) * (m + 1) + b + q; };
        const std::vector<std::int32_t> facet{corner(0, 0), corner(0, 1), corner(1, 0), corner(1, 1)},
            node{first[mesh] + i * (n + 1) + j, -1, -1, -1};
        const std::vector<double> weights{(1 - u) * (1 - w), (1 - u) * w, u * (1 - w), u * w},
            one{1.0, 0.0, 0.0, 0.0};
        // The normal points from the second mesh into the first.
        if (mesh == 0)
          meshes.add(node, one, facet, weights, Contact{});
        else
          meshes.add(facet, weights, node, one, Contact{});
      }
  }
  EXPECT_EQ(solve(meshes, 1e-10).message, nullptr);
  for (std::size_t k = 0; k < meshes.contact.size(); ++k) {
    const Vector v = meshes.relative(k), r = meshes.contact[k].impulse;
    const double pull = std::hypot(r[0], r[1]), slip = std::hypot(v[0], v[1]);
    EXPECT_TRUE(r[2] >= 0.0 && v[2] >= -known && r[2] * v[2] <= known) << k;
    EXPECT_LE(pull, mu * r[2] * (1.0 + 1e-12)) << k;
    EXPECT_LE((mu * r[2] - pull) * slip, known) << k;                // it sticks, or friction is at its limit
    EXPECT_LE(r[0] * v[0] + r[1] * v[1], known - pull * slip) << k;  // against the slip
  }
}

// ---- ruptures
// ----------------------------------------------------------------------------------------------

// A bond that broke at a solution stays broken in its step, whatever its neighbors then carry, and what broke
// depends on no order of contacts.
class Ruptures : public ::testing::TestWithParam<const char*> {
 protected:
  // A bond that carries this impulse.
  static ilaw::interface bond(double impulse) {
    if (std::string(GetParam()) == "tie")
      return coupled_law("tie", ILAW_DELASSUS_FULL, {{"strength", impulse}});
    return coupled_law("postit", ILAW_DELASSUS_FULL,
                       {{"adhesion_limit", impulse}, {"initial_adhesion", impulse}});
  }
  // Spheres that hang from a ceiling one below the other: bond k carries those from k on.
  static CoupledProblem hanging(ilaw::interface law, unsigned seed) {
    std::vector<std::int32_t> order;
    for (std::int32_t k = 0; k < count; ++k) order.push_back(k);
    if (seed > 0) std::shuffle(order.begin(), order.end(), std::mt19937(seed));
    CoupledProblem made(std::move(law), ILAW_DELASSUS_FULL, count);
    for (const std::int32_t k : order) made.touch(k, k - 1, {0.0, 0.0, -1.0});
    made.options.tolerance = 1e-12;
    return made;
  }
  static constexpr int count = 20;
};

// In a gravity that grows by a thousandth a step the bond at the ceiling breaks alone, at the step in which
// the weight of all exceeds it, and all that hangs below falls freely in that step.
TEST_P(Ruptures, HappenAtTheStepOfStaticsInAnyOrder) {
  const auto gravity_of = [](int step) { return g * (1.0 + 1e-3 * step); };
  constexpr int expected = 61;
  const double impulse = count * 2.0 * 1e-3 * 0.5 * (gravity_of(expected - 1) + gravity_of(expected));
  for (const unsigned seed : {0U, 1U, 2U, 3U, 4U}) {
    CoupledProblem grains = hanging(bond(impulse), seed);
    for (int n = 0; n <= expected; ++n) {
      EXPECT_EQ(grains.step(gravity_of(n)).message, nullptr) << n;
      for (std::size_t k = 0; k < grains.contact.size(); ++k)
        ASSERT_EQ(grains.contact[k].status == ILAW_BROKEN, n == expected && grains.ends[k] == 0)
            << n << ", order " << seed;
    }
    for (const Body& one : grains.body)
      ASSERT_NEAR(one.v[2], -1e-3 * gravity_of(expected), 1e-11) << "order " << seed;
  }
}

// Spheres without weight, pulled at the end: all bonds carry the same, and break together.
TEST_P(Ruptures, OfEqualLoadsHappenTogether) {
  for (const unsigned seed : {0U, 1U, 2U}) {
    CoupledProblem grains = hanging(bond(1.0), seed);
    grains.body[count - 1].v[2] = -1.01 / 2.0;
    grains.solve();
    for (const Contact& c : grains.contact) {
      EXPECT_EQ(c.status, ILAW_BROKEN) << "order " << seed;
      EXPECT_LE(length(c.impulse), 1e-12);
    }
  }
}

// Two bonds hold one sphere, neither of which could alone: however iterations shared its weight, it falls.
TEST_P(Ruptures, ShedTheirLoadOnOthersInTheSameStep) {
  const double weight = 2.0 * 1e-3 * g;
  for (const double stronger : {0.2, 0.8}) {
    CoupledProblem grain(bond(stronger * weight), ILAW_DELASSUS_FULL, 1);
    for (int k = 0; k < 2; ++k) grain.touch(0, -1, {0.0, 0.0, -1.0});
    grain.contact[0].impulse[2] = -weight;  // all of it at the first one
    grain.options.tolerance = 1e-12;
    grain.step(g);
    EXPECT_NEAR(grain.body[0].v[2], -1e-3 * g, 1e-15) << stronger;
  }
}
INSTANTIATE_TEST_SUITE_P(Of, Ruptures, ::testing::Values("tie", "postit"),
                         [](const auto& of) { return std::string(of.param); });

// ---- walls
// -------------------------------------------------------------------------------------------------

// Walls and belts with velocities of their own, over a step and before it, at three bodies of all kinds.
enum class Kind { points, spheres, rigid, facets };
constexpr Kind kinds[] = {Kind::points, Kind::spheres, Kind::rigid, Kind::facets};
std::ostream& operator<<(std::ostream& out, Kind kind) { return out << static_cast<int>(kind); }

struct Walls : CoupledProblem {
  static std::uint32_t form_of(Kind kind) {
    return kind == Kind::points    ? ILAW_DELASSUS_SCALAR
           : kind == Kind::spheres ? ILAW_DELASSUS_TRANSVERSE
                                   : ILAW_DELASSUS_FULL;
  }
  Walls(Kind kind_of_bodies, unsigned seed, const std::string& name, const Numbers& numbers,
        const char* activation = "moreau")
      : CoupledProblem(coupled_law(name, form_of(kind_of_bodies), numbers,
                                   name == "tie" ? Texts{} : Texts{{"activation", activation}}),
                       form_of(kind_of_bodies)),
        kind(kind_of_bodies),
        random(seed) {
    const double inverse[] = {0.5, 1.3, 0.2};
    const std::array<double, 6> tensors[] = {
        {1.0, 2.0, 1.5, 0.1, -0.2, 0.3}, {0.7, 0.4, 0.6, 0.0, 0.1, -0.1}, {3.0, 2.0, 4.0, 0.5, 0.2, 0.1}};
    for (std::size_t b = 0; b < 3; ++b) {
      Body one;
      one.mass = 1.0 / inverse[b];
      one.v = random.vector(), one.v_before = random.vector();
      if (rotates) one.w = random.vector(), one.w_before = random.vector();
      add_body(one);
      body[b].inverse_inertia = tensors[b];
    }
    has_wall = has_wall_before = true;
    options.tolerance = 1e-14;
  }
  void meet(std::int32_t a, std::int32_t other, const Vector& n, double gap = 0.0) {
    const auto arm = [&] {
      return kind == Kind::points ? Vector{} : kind == Kind::spheres ? random() * n : random.vector();
    };
    Contact one{gap, n};
    one.arm = arm(), one.other_arm = arm();
    one.wall = random.vector(), one.wall_before = random.vector();
    const std::vector<double> weights{0.25, 0.75};
    if (kind == Kind::facets)
      add({a, a == 1 ? 2 : -1}, weights, {other, other == 1 ? 2 : -1}, weights, one);
    else
      add(a, other, one);
  }
  // Two walls at one body, one at each of the others, and a belt between two bodies.
  void meet_five() {
    meet(0, -1, {0.0, 0.0, 1.0});
    meet(0, -1, {1.0, 0.0, 0.0});
    meet(1, -1, {0.0, 0.6, 0.8});
    meet(2, -1, {-0.8, 0.6, 0.0});
    meet(1, 0, {0.0, 1.0, 0.0});
  }
  void begin_as_before() {
    for (Body& one : body) one.v = one.v_before, one.w = one.w_before;
  }
  Kind kind;
  Random random;
};

// Newton's restitution: u_n >= -e u_n^- and r_n >= 0, one of them an equality (Moreau 1988), where u is
// relative to the wall of each contact. A contact that was opening turns round at most (kit/friction.hpp).
// The work of an impulse is r.(u^- + u)/2 with these velocities.
TEST(CoupledWalls, ReboundFromTheirOwnVelocities) {
  constexpr double e = 0.6;
  for (const Kind kind : kinds) {
    int pressed = 0;
    for (unsigned seed = 0; seed < 60; ++seed) {
      GIVEN(kind, seed);
      Walls walls(kind, seed, "contact", {{"restitution", e}});
      walls.has_wall = seed % 5 > 0;  // a wall may have moved before and stand still now
      walls.has_wall_before = seed % 3 > 0;
      walls.meet_five();
      const ilaw_coupled_report report = walls.solve();
      ASSERT_LE(report.residual, 1e-14);
      double work = 0.0;
      for (std::size_t k = 0; k < 5; ++k) {
        const Vector &n = walls.contact[k].normal, &r = walls.contact[k].impulse, u = walls.relative(k),
                     u_before = walls.relative(k, true);
        const double before = dot(u_before, n), target = before < 0.0 ? -e * before : -before,
                     beyond = dot(u, n) - target, push = dot(r, n);
        EXPECT_GE(beyond, -1e-12);
        EXPECT_GE(push, 0.0);
        EXPECT_LE(std::min(beyond, push), 1e-12);
        pressed += push > 0.0;
        work += 0.5 * dot(r, u + u_before);
      }
      EXPECT_NEAR(report.work, work, 1e-12);
    }
    EXPECT_GT(pressed, 100);
    EXPECT_LT(pressed, 250);
  }
}

// Stuck by friction, a sphere leaves its wall with -e u_n^- and -e_t u_t^-.
TEST(CoupledWalls, TurnSpheresByTheirOwnVelocities) {
  constexpr double e = 0.6, e_t = 0.3;
  for (const Kind kind : {Kind::points, Kind::spheres}) {
    int stuck = 0;
    for (unsigned seed = 0; seed < 60; ++seed) {
      GIVEN(kind, seed);
      Walls walls(kind, seed, "coulomb",
                  {{"friction", 1e3}, {"restitution", e}, {"tangential_restitution", e_t}});
      walls.begin_as_before();
      walls.meet(0, -1, {0.0, 0.0, 1.0});
      walls.meet(1, -1, {1.0, 0.0, 0.0});
      walls.meet(2, -1, {0.0, 0.6, -0.8});
      for (Contact& c : walls.contact)  // velocities far from those before are kept from adding energy
        c.wall = c.wall_before + 0.02 * c.wall;
      walls.solve();
      for (std::size_t k = 0; k < 3; ++k) {
        const Vector n = walls.contact[k].normal, before = walls.relative(k, true),
                     normal = dot(before, n) * n;
        if (dot(before, n) > -0.1) continue;
        ++stuck;
        EXPECT_THAT(walls.relative(k), VectorNear(-e * normal - e_t * (before - normal), 1e-12));
      }
    }
    EXPECT_GT(stuck, 40);
  }
}

// With H of the contact itself, its law solves a single one in the first iteration, and the second sees that.
TEST(CoupledWalls, SolveOneContactByItsOwnInertia) {
  for (const Kind kind : kinds)
    for (unsigned seed = 0; seed < 10; ++seed) {
      Walls walls(kind, seed, "tie", {});
      walls.begin_as_before();
      walls.meet(1, 0, {0.0, 0.6, 0.8});
      walls.has_wall_before = false;
      EXPECT_LE(walls.solve().sweeps, 2U) << kind << ", seed " << seed;
      EXPECT_LE(length(walls.relative(0)), 1e-13) << kind << ", seed " << seed;
    }
}

// From a distance of h, a wall with a speed of 3 passes 2 of it on; those that go away or come too slowly
// touch nothing.
TEST(CoupledWalls, ReachBodiesByTheirOwnVelocities) {
  for (const Kind kind : {Kind::points, Kind::spheres, Kind::rigid}) {
    Walls walls(kind, 1, "contact", {}, "predictive");
    for (Body& one : walls.body) one.v = one.w = one.v_before = one.w_before = {};
    for (std::int32_t b = 0; b < 3; ++b) {
      walls.meet(b, -1, {0.0, 0.0, 1.0}, walls.h);
      Contact& c = walls.contact.back();
      c.arm = {};
      c.wall = c.wall_before = {0.0, 0.0, std::array{-3.0, 3.0, 0.9}[static_cast<std::size_t>(b)]};
    }
    walls.solve();
    for (std::int32_t b = 0; b < 3; ++b) EXPECT_NEAR(walls.at(b).v[2], b == 1 ? 2.0 : 0.0, 1e-14) << kind;
  }
}

}  // namespace
}  // namespace ilaw::testing
