// Calls of ilaw/coupled.h that are wrong, empty, or of bodies that do not rotate.
// SPDX-License-Identifier: BSD-3-Clause
#include "coupled_scene.hpp"

#include "support/law_runner.hpp"

#include <gtest/gtest.h>
#include <ilaw/arrays.hpp>
#include <ilaw/coupled.hpp>
#include <ilaw/loader.hpp>

#include <array>
#include <cmath>
#include <initializer_list>
#include <vector>

namespace {

using namespace coupled_scene;

struct Call {
  ilaw_bodies bodies;
  ilaw_contacts contacts;
  ilaw_batch batch;
};

struct Mistake {
  const char* said;
  void (*spoil)(Call&);
};

// bad_group: 0 where the group of the call is refused, -1 where its bodies are.
void expect_refused(Scene& scene, std::int64_t bad_group, std::initializer_list<Mistake> mistakes) {
  const std::vector<double> before = scene.v;
  for (const Mistake& mistake : mistakes) {
    Call call{scene.bodies(), {}, scene.batch()};
    call.contacts = scene.contacts(call.batch);
    mistake.spoil(call);
    const ilaw_contacts* groups[] = {&call.contacts};
    ilaw_coupled_report report{};
    report.struct_size = sizeof report;
    ilaw_coupled* solver = ilaw_coupled_create();
    EXPECT_EQ(ilaw_coupled_solve(solver, &call.bodies, groups, 1, nullptr, &report), ILAW_INVALID_ARGUMENT)
        << mistake.said;
    EXPECT_STREQ(report.reason, mistake.said);
    EXPECT_EQ(report.bad_group, bad_group) << mistake.said;
    ilaw_coupled_destroy(solver);
  }
  EXPECT_EQ(scene.v, before);
}

TEST(Coupled, SaysWhatIsWrongWithSpins) {
  static const double six[6] = {1, 1, 1, 0, 0, 0};
  Scene scene = cube(rolling(), 1, ILAW_DELASSUS_TRANSVERSE_SPIN);
  scene.arm[1] += 1e-3;
  expect_refused(scene, 0,
                 {{"delassus_form is transverse, and an arm is not along the normal", [](Call&) {}}});
  scene.arm[1] -= 1e-3;
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
  Scene scene = cube(tie(), 1);
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
          c.batch.normal = {};
        }},
       {"delassus_form has spins, which the law does not serve", [](Call& c) {
          c.contacts.delassus_form = ILAW_DELASSUS_TRANSVERSE_SPIN;
          c.batch.moment = c.batch.impulse;
        }}});
}

// In place of an array of doubles one of floats, which has no values.
template <class Array>
void make_single(Array& array) {
  static float numbers[9];
  array = {nullptr, numbers, array.node_stride, array.component_stride};
}
template <auto array>
Mistake bodies_have(const char* said) {
  return {said, [](Call& c) { make_single(c.bodies.*array); }};
}
template <auto array>
Mistake contacts_have(const char* said) {
  return {said, [](Call& c) { make_single(c.contacts.*array); }};
}
template <auto array>
Mistake batch_has(const char* said) {
  return {said, [](Call& c) { make_single(c.batch.*array); }};
}

TEST(Coupled, RefusesFloatsOfBodies) {
  Scene scene = cube(tie(), 1);
  expect_refused(
      scene, -1,
      {bodies_have<&ilaw_bodies::inverse_mass>("inverse_mass of bodies has floats; expected doubles"),
       bodies_have<&ilaw_bodies::inverse_inertia>("inverse_inertia of bodies has floats; expected doubles"),
       bodies_have<&ilaw_bodies::v_free>("v_free of bodies has floats; expected doubles"),
       bodies_have<&ilaw_bodies::spin_free>("spin_free of bodies has floats; expected doubles"),
       bodies_have<&ilaw_bodies::v_previous>("v_previous of bodies has floats; expected doubles"),
       bodies_have<&ilaw_bodies::spin_previous>("spin_previous of bodies has floats; expected doubles"),
       bodies_have<&ilaw_bodies::velocity>("velocity of bodies has floats; expected doubles"),
       bodies_have<&ilaw_bodies::spin>("spin of bodies has floats; expected doubles"),
       bodies_have<&ilaw_bodies::impulse>("impulse of bodies has floats; expected doubles"),
       bodies_have<&ilaw_bodies::angular_impulse>("angular_impulse of bodies has floats; expected doubles")});
}

TEST(Coupled, RefusesFloatsOfContacts) {
  Scene scene = cube(tie(), 1);
  expect_refused(
      scene, 0,
      {contacts_have<&ilaw_contacts::arm>("arm has floats; expected doubles"),
       contacts_have<&ilaw_contacts::counterpart_arm>("counterpart_arm has floats; expected doubles"),
       contacts_have<&ilaw_contacts::wall_velocity>("wall_velocity has floats; expected doubles"),
       contacts_have<&ilaw_contacts::wall_previous>("wall_previous has floats; expected doubles"),
       contacts_have<&ilaw_contacts::body_weight>("body_weight has floats; expected doubles"),
       contacts_have<&ilaw_contacts::counterpart_weight>("counterpart_weight has floats; expected doubles"),
       contacts_have<&ilaw_contacts::wall_spin>("wall_spin has floats; expected doubles"),
       contacts_have<&ilaw_contacts::wall_spin_previous>("wall_spin_previous has floats; expected doubles"),
       batch_has<&ilaw_batch::gap>("gap has floats; expected doubles"),
       batch_has<&ilaw_batch::gap_offset>("gap_offset has floats; expected doubles"),
       batch_has<&ilaw_batch::area>("area has floats; expected doubles"),
       batch_has<&ilaw_batch::normal>("normal has floats; expected doubles"),
       batch_has<&ilaw_batch::tangent>("tangent has floats; expected doubles"),
       batch_has<&ilaw_batch::state_in>("state_in has floats; expected doubles"),
       batch_has<&ilaw_batch::state_out>("state_out has floats; expected doubles"),
       batch_has<&ilaw_batch::impulse>("impulse has floats; expected doubles"),
       batch_has<&ilaw_batch::moment>("moment has floats; expected doubles"),
       batch_has<&ilaw_batch::energy>("energy has floats; expected doubles")});
}

// The lists of a batch, whose lengths the instance says.
TEST(Coupled, RefusesFloatsInListsOfABatch) {
  static const ilaw::interface varying = ilaw::testing::make_law(
      "coulomb", ilaw::testing::SetupBuilder({{{"friction", 0.3}}, {}, {}, {"kinetic_friction"}}, 3,
                                             ILAW_DELASSUS_FULL, ILAW_FRAME_GLOBAL));
  static std::array<ilaw_output, 8> amounts;
  static double amount = 0.0;
  Scene scene = cube(friction(0.3), 1);
  ASSERT_LE(scene.law.info().amount_count, amounts.size());
  expect_refused(scene, 0,
                 {{"an array of per_node_parameters has floats; expected doubles",
                   [](Call& c) {
                     static ilaw_input kinetic;
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

TEST(Coupled, AnswersCallsOfNothing) {
  Scene scene = cube(tie(), 1);
  const ilaw_bodies bodies = scene.bodies();
  const ilaw_contacts* nothing[] = {nullptr};
  ilaw_coupled* solver = ilaw_coupled_create();
  ilaw_coupled_report report{};
  ilaw_coupled_options options{};
  ilaw_exchange exchange{};
  EXPECT_EQ(ilaw_coupled_solve(nullptr, &bodies, nullptr, 0, nullptr, nullptr), ILAW_INVALID_ARGUMENT);
  EXPECT_EQ(ilaw_coupled_solve(solver, &bodies, nullptr, 0, nullptr, &report), ILAW_INVALID_ARGUMENT);
  EXPECT_EQ(ilaw_coupled_solve(solver, &bodies, nullptr, 0, &options, nullptr), ILAW_INVALID_ARGUMENT);
  options.struct_size = sizeof options;
  options.exchange = &exchange;
  EXPECT_EQ(ilaw_coupled_solve(solver, &bodies, nullptr, 0, &options, nullptr), ILAW_INVALID_ARGUMENT);
  report.struct_size = sizeof report;
  exchange.struct_size = sizeof exchange;
  EXPECT_EQ(ilaw_coupled_solve(solver, &bodies, nullptr, 0, &options, &report), ILAW_INVALID_ARGUMENT);
  EXPECT_STREQ(report.reason, "a function of the exchange is null");
  EXPECT_EQ(ilaw_coupled_solve(solver, &bodies, nullptr, 1, nullptr, &report), ILAW_INVALID_ARGUMENT);
  EXPECT_STREQ(report.reason, "groups are missing");
  EXPECT_EQ(ilaw_coupled_solve(solver, &bodies, nothing, 1, nullptr, &report), ILAW_INVALID_ARGUMENT);
  EXPECT_STREQ(report.reason, "a group is null");
  EXPECT_EQ(report.bad_group, 0);
  // Bodies that touch nothing keep their velocities.
  const std::vector<double> before = scene.v;
  EXPECT_EQ(ilaw_coupled_solve(solver, &bodies, nullptr, 0, nullptr, &report), ILAW_OK);
  EXPECT_EQ(scene.v, before);
  ilaw_coupled_destroy(solver);
}

// A second group that cannot be served: nothing of the first is written.
TEST(Coupled, WritesNothingWhereOneGroupIsRefused) {
  Scene scene = cube(tie(), 1);
  const ilaw_bodies bodies = scene.bodies();
  ilaw_batch batch = scene.batch();
  const ilaw_contacts contacts = scene.contacts(batch);
  ilaw_law silent = *contacts.law;
  silent.outputs &= ~ilaw_outputs{ILAW_OUTPUT_ENERGY};
  Scene other = cube(tie(), 1);
  ilaw_batch other_batch = other.batch();
  ilaw_contacts second = other.contacts(other_batch);
  second.law = &silent;
  const ilaw_contacts* groups[] = {&contacts, &second};
  const std::vector<double> v = scene.v, impulse = scene.impulse, state = scene.state;
  ilaw_coupled_report report{};
  report.struct_size = sizeof report;
  ilaw_coupled* solver = ilaw_coupled_create();
  EXPECT_EQ(ilaw_coupled_solve(solver, &bodies, groups, 2, nullptr, &report), ILAW_INVALID_ARGUMENT);
  ilaw_coupled_destroy(solver);
  EXPECT_STREQ(report.reason, "energies are asked for, which the law does not give");
  EXPECT_EQ(report.bad_group, 1);
  EXPECT_EQ(scene.v, v);
  EXPECT_EQ(scene.impulse, impulse);
  EXPECT_EQ(scene.state, state);
}

// A history of four variables, read by component and written by contact with places left between.
TEST(Coupled, ReadsAndWritesStatesOfTwoLayouts) {
  const auto pressed = [] {
    Scene scene = cube(create("penalty", ILAW_DELASSUS_FULL,
                              {{"stiffness", 1e4}, {"tangential_stiffness", 3e3}, {"friction", 0.3}}),
                       1);
    for (int n = 0; n < 3; ++n) {
      scene.step(g, 1e-10);
      for (double& gap : scene.gap) gap -= 1e-3;
    }
    return scene;
  };
  Scene same = pressed(), other = pressed();
  const std::size_t size = same.law.info().state_size, count = same.body.size(), width = 2 * size + 1;
  ASSERT_GE(size, 3U);
  std::vector<double> by_component(size * count), apart(width * count, 7.0);
  for (std::size_t k = 0; k < count; ++k)
    for (std::size_t c = 0; c < size; ++c) by_component[c * count + k] = other.state[k * size + c];
  same.step(g, 1e-10);
  other.time = same.time;
  for (std::size_t i = 2; i < other.v.size(); i += 3) other.v[i] -= h * g;
  ilaw_batch batch = other.batch();
  batch.state_in = ilaw::input(by_component.data(), 1, static_cast<std::int64_t>(count));
  batch.state_out = ilaw::output(apart.data() + width - 1, static_cast<std::int64_t>(width), -2);
  ilaw_bodies bodies = other.bodies();
  bodies.v_previous = ilaw::input(same.v_before.data(), 3, 1);
  bodies.spin_previous = ilaw::input(same.w_before.data(), 3, 1);
  other.solver.solve(bodies, other.contacts(batch));
  EXPECT_EQ(other.v, same.v);
  EXPECT_EQ(other.impulse, same.impulse);
  for (std::size_t k = 0; k < count; ++k)
    for (std::size_t c = 0; c < width; ++c) {
      const bool is_written = c % 2 == 0 && c > 0;
      EXPECT_EQ(apart[k * width + c], is_written ? same.state[k * size + (width - 1 - c) / 2] : 7.0);
    }
}

// A velocity that is no number is bad input at its contact, no agreement of all.
TEST(Coupled, CountsNoNumberAsNoSolution) {
  Scene scene = cube(tie(), 1);
  scene.v[0] = std::nan("");
  const ilaw_bodies bodies = scene.bodies();
  ilaw_batch batch = scene.batch();
  const ilaw_contacts contacts = scene.contacts(batch);
  const ilaw_contacts* groups[] = {&contacts};
  ilaw_coupled_report report{};
  report.struct_size = sizeof report;
  ilaw_coupled* solver = ilaw_coupled_create();
  EXPECT_EQ(ilaw_coupled_solve(solver, &bodies, groups, 1, nullptr, &report), ILAW_BAD_NODES);
  ilaw_coupled_destroy(solver);
  EXPECT_GT(report.bad_count, 0);
  EXPECT_TRUE(std::isfinite(report.work)) << report.work;
}

// Options and bodies that make no sense are refused by name before anything is solved.
TEST(Coupled, RefusesNumbersThatMakeNoSense) {
  Scene scene = cube(tie(), 1);
  const std::vector<double> v = scene.v;
  const auto said = [&](const auto& change) {
    ilaw_bodies bodies = scene.bodies();
    const ilaw_batch batch = scene.batch();
    ilaw_contacts contacts = scene.contacts(batch);
    ilaw_coupled_options options{};
    std::vector<const ilaw_contacts*> groups{&contacts};
    change(bodies, contacts, options, groups);
    try {
      ilaw::coupled().solve(bodies, groups, options);
    } catch (const ilaw::coupled_error& refused) {
      EXPECT_EQ(refused.code(), ILAW_INVALID_ARGUMENT);
      EXPECT_EQ(scene.v, v);
      return std::string(refused.what());
    }
    return std::string();
  };
  static const double bad[] = {std::nan(""), INFINITY, -1.0};
  for (const double& x : bad) {
    EXPECT_EQ(said([&](auto&, auto&, auto& o, auto&) { o.tolerance = x; }),
              "tolerance is below 0 or not finite");
    EXPECT_EQ(said([&](auto&, auto&, auto& o, auto&) { o.speed = x; }), "speed is below 0 or not finite");
    EXPECT_EQ(said([&](auto&, auto&, auto& o, auto&) { o.rounding = x; }),
              "rounding is below 0 or not finite");
    EXPECT_EQ(said([&](auto& b, auto&, auto&, auto&) { b.inverse_mass = ilaw::input(&x, 0, 0); }),
              "an inverse_mass of bodies is below 0 or not finite");
    EXPECT_EQ(said([&](auto& b, auto&, auto&, auto&) { b.inverse_inertia = ilaw::input(&x, 0, 0); }),
              "an inverse_inertia of bodies is below 0 or not finite");
    if (!(x < 0.0)) {
      EXPECT_EQ(said([&](auto&, auto& c, auto&, auto&) { c.body_weight = ilaw::input(&x, 0, 0); }),
                "a weight is not finite");
    }
  }
  EXPECT_EQ(said([&](auto&, auto&, auto& o, auto&) { o.threads = 4294967295U; }), "threads is above 256");
  EXPECT_EQ(said([&](auto&, auto& c, auto&, auto& g) { g.push_back(&c); }), "a group is given twice");
  EXPECT_EQ(
      said([&](auto& b, auto&, auto&, auto&) { b.velocity = ilaw::output(scene.impulse.data(), 3, 1); }),
      "two outputs are one array");
  EXPECT_EQ(said([&](auto& b, auto&, auto&, auto&) { b.v_free = ilaw::input(scene.impulse.data(), 3, 1); }),
            "an output of contacts is an input of bodies");
  EXPECT_EQ(
      said([&](auto& b, auto&, auto&, auto&) { b.impulse = ilaw::output(scene.impulse.data() + 1, 1, 1); }),
      "an output of bodies overlaps itself");
}

TEST(Coupled, RefusesAnExchangeThatReturnsNoNumber) {
  Scene scene = cube(tie(), 1);
  ilaw_exchange exchange{};
  exchange.struct_size = sizeof exchange;
  exchange.sum_bodies = [](void*, double*, std::int64_t) {};
  exchange.sum = [](void*, double*, std::int64_t) {};
  exchange.largest = [](void*, double* values, std::int64_t count) {
    if (count == 4) values[0] = std::nan("");
  };
  const ilaw_batch batch = scene.batch();
  const ilaw_contacts contacts = scene.contacts(batch);
  ilaw_coupled_options options{};
  options.exchange = &exchange;
  try {
    ilaw::coupled().solve(scene.bodies(), contacts, options);
    FAIL();
  } catch (const ilaw::error& refused) {
    EXPECT_STREQ(refused.what(), "a function of the exchange returned a value that is not a number");
  }
}

std::int32_t says_no_number(const ilaw_instance*, const ilaw_batch*, ilaw_report* report) {
  report->stable_velocity_step = std::nan("");
  return ILAW_OK;
}
std::int32_t says_below_zero(const ilaw_instance*, const ilaw_batch*, ilaw_report* report) {
  report->stable_velocity_step = -1.0;
  return ILAW_OK;
}

// It would pass for none at all.
TEST(Coupled, RefusesALawWhoseStableStepMakesNoSense) {
  for (const auto evaluate : {says_no_number, says_below_zero}) {
    Scene scene = cube(tie(), 1);
    const ilaw_bodies bodies = scene.bodies();
    ilaw_batch batch = scene.batch();
    ilaw_contacts contacts = scene.contacts(batch);
    ilaw_law law = *contacts.law;
    law.evaluate = evaluate;
    contacts.law = &law;
    const ilaw_contacts* groups[] = {&contacts};
    ilaw_coupled_report report{};
    report.struct_size = sizeof report;
    ilaw_coupled* solver = ilaw_coupled_create();
    EXPECT_EQ(ilaw_coupled_solve(solver, &bodies, groups, 1, nullptr, &report), ILAW_BAD_LIBRARY);
    EXPECT_STREQ(report.reason, "a law reported a stable step that is below 0 or not a number");
    EXPECT_EQ(report.bad_group, 0);
    ilaw_coupled_destroy(solver);
  }
}

// Two points that a rigid bond joins have the velocity of their centre of mass, in the plane and on a line.
TEST(Coupled, PointsThatAreTiedMoveAsOne) {
  for (const std::uint32_t dimension : {1U, 2U})
    for (const std::uint32_t form : {ILAW_DELASSUS_SCALAR, ILAW_DELASSUS_FULL}) {
      const ilaw::interface law = create("tie", form, {}, dimension);
      const auto d = static_cast<std::int64_t>(dimension);
      const std::array<double, 2> inverse_mass{1.0 / 2.0, 1.0 / 3.0}, normal{1.0, 0.0};
      const std::array<double, 4> start{1.0, -0.5, -2.0, 0.25};
      std::array<double, 4> v = start, impulse{};
      const double gap = 0.0, area = 1.0;
      std::vector<double> state(law.info().state_size);
      const auto size = static_cast<std::int64_t>(state.size());
      const std::int32_t first = 0, second = 1;
      ilaw_batch batch{};
      batch.struct_size = sizeof batch;
      batch.node_count = 1;
      batch.velocity_step = batch.position_step = batch.time = h;
      batch.gap = ilaw::input(&gap, 1, 0);
      batch.area = ilaw::input(&area, 1, 0);
      batch.normal = ilaw::input(normal.data(), d, 1);
      batch.state_in = ilaw::input(state.data(), size, 1);
      batch.state_out = ilaw::output(state.data(), size, 1);
      batch.impulse = ilaw::output(impulse.data(), d, 1);
      ASSERT_EQ(law.initialise(batch), ILAW_OK) << "form " << form;
      const ilaw_contacts contacts = ilaw::contacts_of(law, form, batch, &first, &second);
      ilaw_bodies bodies{};
      bodies.struct_size = sizeof bodies;
      bodies.dimension = dimension;
      bodies.count = bodies.owned_count = 2;
      bodies.inverse_mass = ilaw::input(inverse_mass.data(), 1, 0);
      bodies.v_free = bodies.v_previous = ilaw::input(start.data(), d, 1);
      bodies.velocity = ilaw::output(v.data(), d, 1);
      const ilaw_contacts* groups[] = {&contacts};
      ilaw_coupled* solver = ilaw_coupled_create();
      EXPECT_EQ(ilaw_coupled_solve(solver, &bodies, groups, 1, nullptr, nullptr), ILAW_OK) << "form " << form;
      ilaw_coupled_destroy(solver);
      for (std::size_t c = 0; c < dimension; ++c) {
        const double together = (2.0 * start[c] + 3.0 * start[dimension + c]) / 5.0;
        EXPECT_NEAR(v[c], together, 1e-12) << "d = " << dimension << ", form " << form;
        EXPECT_NEAR(v[dimension + c], together, 1e-12) << "d = " << dimension << ", form " << form;
      }
    }
}

}  // namespace
