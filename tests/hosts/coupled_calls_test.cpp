// Calls of ilaw/coupled.h that are wrong, empty, or of bodies that do not rotate.
// SPDX-License-Identifier: BSD-3-Clause
#include "support/coupled_problem.hpp"

#include <functional>

namespace ilaw::testing {
namespace coupled_calls {
namespace {

constexpr double g = 10.0;

struct Call {
  ilaw_bodies bodies;
  ilaw_contacts contacts;
  ilaw_batch batch;
  ilaw_coupled_options options{};
  std::vector<const ilaw_contacts*> groups{&contacts};
};

struct Mistake {
  std::string said;
  std::function<void(Call&)> spoil;
  ilaw_result code = ILAW_INVALID_ARGUMENT;
};

CoupledProblem tied() { return cube(coupled_law("tie", ILAW_DELASSUS_FULL), ILAW_DELASSUS_FULL, 1); }

// Nothing is written. bad_group: 0 where the group of the call is refused, -1 where its bodies or options
// are.
void expect_refused(CoupledProblem& problem, std::int64_t bad_group, const std::vector<Mistake>& mistakes) {
  problem.batch();  // so that states are those of the start
  const std::vector<Vector> velocities = problem.velocities(), impulses = problem.impulses();
  const std::vector<double> state = problem.state;
  for (const Mistake& mistake : mistakes) {
    Call call{problem.bodies(), {}, problem.batch()};
    call.contacts = problem.contacts(call.batch);
    call.groups = {&call.contacts};
    call.options.struct_size = sizeof call.options;
    mistake.spoil(call);
    ilaw_coupled_report report{};
    report.struct_size = sizeof report;
    ilaw_coupled* solver = ilaw_coupled_create();
    EXPECT_EQ(ilaw_coupled_solve(solver, &call.bodies, call.groups.data(),
                                 static_cast<std::int64_t>(call.groups.size()), &call.options, &report),
              mistake.code)
        << mistake.said;
    EXPECT_STREQ(report.reason, mistake.said.c_str());
    EXPECT_EQ(report.bad_group, bad_group) << mistake.said;
    ilaw_coupled_destroy(solver);
    if (mistake.code != ILAW_INVALID_ARGUMENT) continue;
    EXPECT_EQ(problem.velocities(), velocities) << mistake.said;
    EXPECT_EQ(problem.impulses(), impulses) << mistake.said;
    EXPECT_EQ(problem.state, state) << mistake.said;
  }
}

TEST(Coupled, SaysWhatIsWrongWithSpins) {
  static const double six[6] = {1, 1, 1, 0, 0, 0};
  CoupledProblem scene = cube(rolling_law(), ILAW_DELASSUS_TRANSVERSE_SPIN, 1);
  scene.contact[0].arm[1] += 1e-3;
  expect_refused(scene, 0,
                 {{"delassus_form is transverse, and an arm is not along the normal", [](Call&) {}}});
  scene.contact[0].arm[1] -= 1e-3;
  expect_refused(scene, 0,
                 {{"delassus_form has spins, and moment is missing", [](Call& c) { c.batch.moment = {}; }},
                  {"moment overlaps itself", [](Call& c) { c.batch.moment.node_stride = 0; }},
                  {"delassus_form has spins; expected one body on either side, without weights",
                   [](Call& c) { c.contacts.body_weight = ilaw::input(six, 0, 0); }},
                  {"delassus_form has spins, and bodies do not rotate: inverse_inertia is missing",
                   [](Call& c) { c.bodies.inverse_inertia = {}; }},
                  {"delassus_form is transverse, and bodies are no spheres",
                   [](Call& c) { c.bodies.inverse_inertia = ilaw::input(six, 0, 1); }},
                  {"delassus_form is transverse, and bodies have masses per axis",
                   [](Call& c) { c.bodies.inverse_mass = ilaw::input(six, 0, 1); }}});
}

TEST(Coupled, SaysWhatIsWrongWithWhatItWasGiven) {
  static const double six[6] = {1, 1, 1, 0, 0, 0};
  static std::uint8_t one_status = 0;
  static const std::int32_t list[1] = {0};
  CoupledProblem scene = tied();
  expect_refused(
      scene, -1,
      {{"bodies are missing, or their struct_size is wrong", [](Call& c) { c.bodies.struct_size = 8; }},
       {"dimension is not 1, 2 or 3", [](Call& c) { c.bodies.dimension = 0; }},
       {"dimension is not 1, 2 or 3", [](Call& c) { c.bodies.dimension = 4; }},
       {"counts of bodies are wrong", [](Call& c) { c.bodies.owned_count = -1; }},
       {"counts of bodies are wrong", [](Call& c) { c.bodies.count = c.bodies.owned_count - 1; }},
       {"count is above 2^31 - 2", [](Call& c) { c.bodies.count = std::int64_t{1} << 60; }},
       {"an output of bodies overlaps itself", [](Call& c) { c.bodies.velocity.node_stride = 0; }},
       {"inverse_mass or v_free is missing", [](Call& c) { c.bodies.inverse_mass = {}; }},
       {"inverse_mass or v_free is missing", [](Call& c) { c.bodies.v_free = {}; }},
       {"v_free or v_previous has one component per body (component stride 0), expected a (d,n) array",
        [](Call& c) { c.bodies.v_free.component_stride = 0; }},
       {"v_free or v_previous has one component per body (component stride 0), expected a (d,n) array",
        [](Call& c) { c.bodies.v_previous.component_stride = 0; }},
       {"spin_free or spin_previous has one component per body (component stride 0), expected a (3,n) array",
        [](Call& c) { c.bodies.spin_free.component_stride = 0; }},
       {"bodies rotate in dimension 3 alone", [](Call& c) { c.bodies.dimension = 2; }},
       {"spin_free is missing", [](Call& c) { c.bodies.spin_free = {}; }},
       {"spin_previous is missing", [](Call& c) { c.bodies.spin_previous = {}; }}});
  expect_refused(
      scene, 0,
      {{"the struct_size of contacts is not that of any version",
        [](Call& c) { c.contacts.struct_size = 8; }},
       {"a batch is missing, or its struct_size is wrong", [](Call& c) { c.contacts.batch = nullptr; }},
       {"law or instance is null", [](Call& c) { c.contacts.law = nullptr; }},
       {"law or instance is null", [](Call& c) { c.contacts.instance = nullptr; }},
       {"delassus_form is neither scalar, transverse, transverse_spin nor full",
        [](Call& c) { c.contacts.delassus_form = ILAW_DELASSUS_DIAGONAL; }},
       {"node_count is negative", [](Call& c) { c.batch.node_count = -1; }},
       {"node_count is above 2^31 - 2", [](Call& c) { c.batch.node_count = std::int64_t{1} << 60; }},
       {"impulse overlaps itself", [](Call& c) { c.batch.impulse.node_stride = 0; }},
       {"energy overlaps itself", [](Call& c) { c.batch.energy.component_stride = 0; }},
       {"state_out overlaps itself", [](Call& c) { c.batch.state_out.node_stride = 0; }},
       {"status_stride is 0",
        [](Call& c) {
          c.batch.status = &one_status;
          c.batch.status_stride = 0;
        }},
       {"contacts have no list of nodes", [](Call& c) { c.batch.index = list; }},
       {"body or counterpart is missing", [](Call& c) { c.contacts.body = nullptr; }},
       {"body or counterpart is missing", [](Call& c) { c.contacts.counterpart = nullptr; }},
       {"impulse is missing", [](Call& c) { c.batch.impulse = {}; }},
       {"normal or tangent has one component per contact (component stride 0), expected a (d,n) array",
        [](Call& c) { c.batch.normal.component_stride = 0; }},
       {"state_in or state_out is missing", [](Call& c) { c.batch.state_in = {}; }},
       {"state_in or state_out is missing", [](Call& c) { c.batch.state_out = {}; }},
       {"the law reads v_previous, which the bodies do not have", [](Call& c) { c.bodies.v_previous = {}; }},
       {"bodies rotate, so delassus_form has to be transverse or full",
        [](Call& c) { c.contacts.delassus_form = ILAW_DELASSUS_SCALAR; }},
       {"bodies rotate, and an arm is missing", [](Call& c) { c.contacts.arm = {}; }},
       {"bodies rotate, and an arm is missing", [](Call& c) { c.contacts.counterpart_arm = {}; }},
       {"delassus_form is transverse, and bodies are no spheres",
        [](Call& c) {
          c.contacts.delassus_form = ILAW_DELASSUS_TRANSVERSE;
          c.bodies.inverse_inertia = ilaw::input(six, 0, 1);
        }},
       {"delassus_form is transverse, and the normal is missing",
        [](Call& c) {
          c.contacts.delassus_form = ILAW_DELASSUS_TRANSVERSE;
          c.bodies.inverse_inertia.component_stride = 0;
          c.batch.normal = {};
        }},
       {"delassus_form has spins, which the law does not serve", [](Call& c) {
          c.contacts.delassus_form = ILAW_DELASSUS_TRANSVERSE_SPIN;
          c.batch.moment = c.batch.impulse;
        }}});
}

TEST(Coupled, RefusesBodiesThatCannotMeet) {
  CoupledProblem scene = tied();
  std::vector<std::int32_t> none = scene.other_ends, self = scene.other_ends;
  none.back() = 27;
  self[4] = scene.ends[4];
  expect_refused(
      scene, 0,
      {{"a contact names a body that is not there", [&](Call& c) { c.contacts.counterpart = none.data(); }},
       {"a contact of a body with itself", [&](Call& c) { c.contacts.counterpart = self.data(); }}});
}

// In place of an array of doubles one of floats, which has no values.
template <class Array>
void make_single(Array& array) {
  static float numbers[9];
  array = {nullptr, numbers, array.node_stride, array.component_stride};
}
#define HAS_FLOATS(part, name, of)                                                       \
  Mistake {                                                                              \
#name of " has floats; expected doubles", [](Call & c) { make_single(c.part.name); } \
  }

TEST(Coupled, RefusesFloats) {
  CoupledProblem scene = tied();
  expect_refused(
      scene, -1,
      {HAS_FLOATS(bodies, inverse_mass, " of bodies"), HAS_FLOATS(bodies, inverse_inertia, " of bodies"),
       HAS_FLOATS(bodies, v_free, " of bodies"), HAS_FLOATS(bodies, spin_free, " of bodies"),
       HAS_FLOATS(bodies, v_previous, " of bodies"), HAS_FLOATS(bodies, spin_previous, " of bodies"),
       HAS_FLOATS(bodies, velocity, " of bodies"), HAS_FLOATS(bodies, spin, " of bodies"),
       HAS_FLOATS(bodies, impulse, " of bodies"), HAS_FLOATS(bodies, angular_impulse, " of bodies")});
  expect_refused(
      scene, 0,
      {HAS_FLOATS(contacts, arm, ""), HAS_FLOATS(contacts, counterpart_arm, ""),
       HAS_FLOATS(contacts, wall_velocity, ""), HAS_FLOATS(contacts, wall_previous, ""),
       HAS_FLOATS(contacts, body_weight, ""), HAS_FLOATS(contacts, counterpart_weight, ""),
       HAS_FLOATS(contacts, wall_spin, ""), HAS_FLOATS(contacts, wall_spin_previous, ""),
       HAS_FLOATS(batch, gap, ""), HAS_FLOATS(batch, gap_offset, ""), HAS_FLOATS(batch, area, ""),
       HAS_FLOATS(batch, normal, ""), HAS_FLOATS(batch, tangent, ""), HAS_FLOATS(batch, state_in, ""),
       HAS_FLOATS(batch, state_out, ""), HAS_FLOATS(batch, impulse, ""), HAS_FLOATS(batch, moment, ""),
       HAS_FLOATS(batch, energy, "")});
}

// The lists of a batch, whose lengths the instance says.
TEST(Coupled, RefusesFloatsInListsOfABatch) {
  static const ilaw::interface varying =
      make_law("coulomb", SetupBuilder({{{"friction", 0.3}}, {}, {}, {"kinetic_friction"}}, 3,
                                       ILAW_DELASSUS_FULL, ILAW_FRAME_GLOBAL));
  static std::array<ilaw_output, 8> amounts;
  static double amount = 0.0;
  static ilaw_input kinetic;
  CoupledProblem scene =
      cube(coupled_law("coulomb", ILAW_DELASSUS_FULL, {{"friction", 0.3}}), ILAW_DELASSUS_FULL, 1);
  ASSERT_LE(scene.law.info().amount_count, amounts.size());
  expect_refused(scene, 0,
                 {{"an array of per_node_parameters has floats; expected doubles",
                   [](Call& c) {
                     make_single(kinetic);
                     c.contacts.instance = varying.instance();
                     c.batch.per_node_parameters = &kinetic;
                   }},
                  {"an array of amounts has floats; expected doubles",
                   [](Call& c) {
                     make_single(amounts[1]);
                     c.batch.amounts = amounts.data();
                   }},
                  {"an array of amounts overlaps itself", [](Call& c) {
                     amounts[1] = ilaw::output(&amount, 0, 0);
                     c.batch.amounts = amounts.data();
                   }}});
}

// Options and bodies that make no sense are refused by name before anything is solved.
TEST(Coupled, RefusesNumbersThatMakeNoSense) {
  CoupledProblem scene = tied();
  double* const impulse = scene.contact[0].impulse.data();
  static const double bad[] = {nan_value, inf_value, -1.0};
  for (const double& x : bad) {
    expect_refused(scene, -1,
                   {{"tolerance is below 0 or not finite", [&](Call& c) { c.options.tolerance = x; }},
                    {"speed is below 0 or not finite", [&](Call& c) { c.options.speed = x; }},
                    {"rounding is below 0 or not finite", [&](Call& c) { c.options.rounding = x; }},
                    {"an inverse_mass of bodies is below 0 or not finite",
                     [&](Call& c) { c.bodies.inverse_mass = ilaw::input(&x, 0, 0); }},
                    {"an inverse_inertia of bodies is below 0 or not finite",
                     [&](Call& c) { c.bodies.inverse_inertia = ilaw::input(&x, 0, 0); }}});
    if (x < 0.0) continue;
    expect_refused(
        scene, 0,
        {{"a weight is not finite", [&](Call& c) { c.contacts.body_weight = ilaw::input(&x, 0, 0); }}});
  }
  expect_refused(
      scene, -1,
      {{"threads is above 256", [](Call& c) { c.options.threads = 4294967295U; }},
       {"two outputs are one array", [&](Call& c) { c.bodies.velocity = ilaw::output(impulse, 3, 1); }},
       {"an output of contacts is an input of bodies",
        [&](Call& c) { c.bodies.v_free = ilaw::input(impulse, 3, 1); }},
       {"an output of bodies overlaps itself",
        [&](Call& c) { c.bodies.impulse = ilaw::output(impulse + 1, 1, 1); }}});
}

// A second group that cannot be served: nothing of the first is written.
TEST(Coupled, RefusesASecondGroup) {
  CoupledProblem scene = tied(), other = tied();
  ilaw_law silent = scene.law.law();
  silent.outputs &= ~ilaw_outputs{ILAW_OUTPUT_ENERGY};
  const ilaw_batch batch = other.batch();
  ilaw_contacts second = other.contacts(batch);
  second.law = &silent;
  expect_refused(
      scene, 1,
      {{"energies are asked for, which the law does not give", [&](Call& c) { c.groups.push_back(&second); }},
       {"a group is given twice", [](Call& c) { c.groups.push_back(&c.contacts); }},
       {"a group is null", [](Call& c) { c.groups.push_back(nullptr); }}});
}

std::int32_t says_no_number(const ilaw_instance*, const ilaw_batch*, ilaw_report* report) {
  report->stable_velocity_step = nan_value;
  return ILAW_OK;
}
std::int32_t says_below_zero(const ilaw_instance*, const ilaw_batch*, ilaw_report* report) {
  report->stable_velocity_step = -1.0;
  return ILAW_OK;
}

// A stable step that makes no sense would pass for none at all.
TEST(Coupled, RefusesALawWhoseStableStepMakesNoSense) {
  CoupledProblem scene = tied();
  ilaw_law law = scene.law.law();
  for (const auto evaluate : {says_no_number, says_below_zero}) {
    law.evaluate = evaluate;
    expect_refused(scene, 0,
                   {{"a law reported a stable step that is below 0 or not a number",
                     [&](Call& c) { c.contacts.law = &law; }, ILAW_BAD_LIBRARY}});
  }
}

TEST(Coupled, RefusesAnExchangeThatMakesNoSense) {
  CoupledProblem scene = tied();
  ilaw_exchange exchange{};
  exchange.struct_size = sizeof exchange;
  const std::vector<Mistake> unset{
      {"a function of the exchange is null", [&](Call& c) { c.options.exchange = &exchange; }}};
  expect_refused(scene, -1, unset);
  exchange.sum_bodies = [](void*, double*, std::int64_t) {};
  exchange.sum = [](void*, double*, std::int64_t) {};
  exchange.largest = [](void*, double* values, std::int64_t count) {
    if (count == 4) values[0] = nan_value;
  };
  scene.options.exchange = &exchange;
  try {
    scene.solve();
    FAIL();
  } catch (const ilaw::error& refused) {
    EXPECT_STREQ(refused.what(), "a function of the exchange returned a value that is not a number");
  }
}

TEST(Coupled, AnswersCallsOfNothing) {
  CoupledProblem scene = tied();
  const ilaw_bodies bodies = scene.bodies();
  ilaw_coupled* solver = ilaw_coupled_create();
  ilaw_coupled_report report{};
  ilaw_coupled_options options{};
  EXPECT_EQ(ilaw_coupled_solve(nullptr, &bodies, nullptr, 0, nullptr, nullptr), ILAW_INVALID_ARGUMENT);
  EXPECT_EQ(ilaw_coupled_solve(solver, &bodies, nullptr, 0, nullptr, &report), ILAW_INVALID_ARGUMENT);
  EXPECT_EQ(ilaw_coupled_solve(solver, &bodies, nullptr, 0, &options, nullptr), ILAW_INVALID_ARGUMENT);
  report.struct_size = sizeof report;
  EXPECT_EQ(ilaw_coupled_solve(solver, &bodies, nullptr, 1, nullptr, &report), ILAW_INVALID_ARGUMENT);
  EXPECT_STREQ(report.reason, "groups are missing");
  // Bodies that touch nothing keep their velocities.
  const std::vector<Vector> before = scene.velocities();
  EXPECT_EQ(ilaw_coupled_solve(solver, &bodies, nullptr, 0, nullptr, &report), ILAW_OK);
  EXPECT_EQ(scene.velocities(), before);
  ilaw_coupled_destroy(solver);
}

// A history of four variables, read by component and written by contact with places left between.
TEST(Coupled, ReadsAndWritesStatesOfTwoLayouts) {
  const auto pressed = [] {
    CoupledProblem made =
        cube(coupled_law("penalty", ILAW_DELASSUS_FULL,
                         {{"stiffness", 1e4}, {"tangential_stiffness", 3e3}, {"friction", 0.3}}),
             ILAW_DELASSUS_FULL, 1);
    for (int n = 0; n < 3; ++n) {
      made.step(g);
      for (CoupledProblem::Contact& c : made.contact) c.gap -= 1e-3;
    }
    return made;
  };
  CoupledProblem same = pressed(), other = pressed();
  const std::size_t size = same.law.info().state_size, count = same.contact.size(), width = 2 * size + 1;
  ASSERT_GE(size, 3U);
  std::vector<double> by_component(size * count), apart(width * count, 7.0);
  for (std::size_t k = 0; k < count; ++k)
    for (std::size_t c = 0; c < size; ++c) by_component[c * count + k] = other.state[k * size + c];
  same.step(g);
  other.kick(g);
  ilaw_batch batch = other.batch();
  batch.state_in = ilaw::input(by_component.data(), 1, static_cast<std::int64_t>(count));
  batch.state_out = ilaw::output(apart.data() + width - 1, static_cast<std::int64_t>(width), -2);
  other.solve(batch);
  EXPECT_EQ(other.velocities(), same.velocities());
  EXPECT_EQ(other.impulses(), same.impulses());
  for (std::size_t k = 0; k < count; ++k)
    for (std::size_t c = 0; c < width; ++c) {
      const bool is_written = c % 2 == 0 && c > 0;
      EXPECT_EQ(apart[k * width + c], is_written ? same.state[k * size + (width - 1 - c) / 2] : 7.0);
    }
}

// A velocity that is no number is bad input at its contact, no agreement of all.
TEST(Coupled, CountsNoNumberAsNoSolution) {
  CoupledProblem scene = tied();
  scene.body[0].v[0] = nan_value;
  const ilaw_coupled_report report = scene.solve();
  EXPECT_GT(report.bad_count, 0);
  EXPECT_TRUE(std::isfinite(report.work)) << report.work;
}

// Two points that a rigid bond joins have the velocity of their centre of mass, in the plane and on a line.
TEST(Coupled, PointsThatAreTiedMoveAsOne) {
  for (const std::uint32_t dimension : {1U, 2U})
    for (const std::uint32_t form : {ILAW_DELASSUS_SCALAR, ILAW_DELASSUS_FULL}) {
      GIVEN(dimension, form);
      CoupledProblem points(make_law("tie", SetupBuilder({}, dimension, form, ILAW_FRAME_GLOBAL)), form);
      for (const double mass : {2.0, 3.0}) {
        CoupledProblem::Body one;
        one.mass = mass;
        one.v = mass == 2.0 ? Vector{1.0, -0.5, 0.0} : Vector{-2.0, 0.25, 0.0};
        points.add_body(one);
      }
      points.rotates = false;
      points.touch(0, 1, {1.0, 0.0, 0.0});
      ilaw_bodies bodies = points.bodies();
      bodies.dimension = dimension;
      const ilaw_batch batch = points.batch();
      points.solver.solve(bodies, points.contacts(batch));
      for (std::size_t c = 0; c < dimension; ++c)
        for (const CoupledProblem::Body& one : points.body)
          EXPECT_NEAR(one.v[c], c == 0 ? -0.8 : -0.05, 1e-12);
    }
}

}  // namespace
}  // namespace coupled_calls
}  // namespace ilaw::testing
