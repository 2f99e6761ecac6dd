// The start of a run: bodies that rest or are bonded carry their load from time 0 on.
#include "run_result.hpp"

namespace ilaw::host::testing::start {
namespace {

// A point at rest on a floor stays where it is, under its weight from time 0 on, whatever the rigid law and
// step.
TEST(Start, LeavesABodyAtRestOnItsFloor) {
  for (const auto& [law, parameters] :
       {std::pair{"contact", json::object()}, std::pair{"coulomb", json{{"friction", 0.3}}},
        std::pair{"tie", json::object()}, std::pair{"postit", json::object()},
        std::pair{"cohesive", json{{"strength", 50}, {"toughness", 10}}}})
    for (const double h : coprime_steps) {
      GIVEN(law, h);
      const Ran run = ran(resting_point(law, parameters, h));
      EXPECT_THAT(run["n0.u1"], Each(DoubleNear(0.0, 1e-16)));
      EXPECT_THAT(run["floor.F1"], Each(DoubleNear(10.0, 1e-12)));
      const json& forces = run.summary["forces"];
      EXPECT_NEAR(forces["floor"]["largest"].get<double>(), 10.0, 1e-12);
      // From V_0 = 0 to V_{n+1/2} = 0.
      const double held = forces["floor"]["impulse"][1], given = forces["weight"]["impulse"][1];
      EXPECT_NEAR(held, 10.0 * (run.last("time") + 0.5 * h), 1e-12);
      EXPECT_NEAR(held + given, 0.0, 1e-12);
      EXPECT_LT(run.energy("balance_error"), 1e-12);
      EXPECT_THAT(run.summary["warnings"], IsEmpty());
      EXPECT_THAT(run.events, HasSubstr("\n0,0,floor,contact"));
    }
}

// Gaps and overlaps at the start count as touching: points at different heights rest where they are, alone
// and where they share a partner.
TEST(Start, LeavesBodiesThatTouchAcrossTheirInitialGaps) {
  for (const double h : coprime_steps)
    for (const bool shares : {false, true}) {
      GIVEN(h, shares);
      json source = resting_point("contact", {}, h);
      source["model"]["points"] =
          json::parse(R"([{"mass": 1, "position": [0, 0.1]}, {"mass": 1, "position": [1, -0.2]}])");
      json& floor = source["interfaces"][0];
      floor["nodes"] = {0, 1};
      floor["gap_offset"] = "initial";
      if (shares) {
        json again = floor;
        again["name"] = "again";
        source["interfaces"].push_back(again);
      }
      const Ran run = ran(source);
      EXPECT_THAT(run["n0.u1"], Each(DoubleNear(0.0, 1e-15)));
      EXPECT_NEAR(run.last("weight.F1"), -20.0, 1e-12);
      EXPECT_EQ(run.summary["penetration_max"].get<double>(), 0.0);
      EXPECT_THAT(run.summary["warnings"], IsEmpty());
      if (shares) continue;
      EXPECT_THAT(run["n0.gap"], Each(DoubleNear(0.0, 1e-15)));
      EXPECT_NEAR(run.last("floor.F1"), 20.0, 1e-12);
    }
}

// A bond holds below its strength from the start, and breaks above.
TEST(Start, BondHoldsUpToItsStrength) {
  for (const double h : coprime_steps)
    for (const double part : {0.9, 0.99, 1.01}) {
      json cohesive = resting_point("cohesive", {{"strength", 10.0 / part}, {"toughness", 1e-4}}, h);
      json tie = resting_point("tie", {{"strength", 10.0 * 0.05 / part}, {"memory", 0.05}}, h);
      for (json* source : {&cohesive, &tie}) {
        GIVEN(h, part, (*source)["interfaces"][0]["law"].dump());
        (*source)["loads"][0]["acceleration"] = {0, 10};
        const double u = ran(*source).last("n0.u1");
        EXPECT_TRUE(part < 1.0 ? std::abs(u) < 1e-15 : u > 1e-3) << u;
      }
    }
}

// Impacts at time 0 from a gap of 0 are exact: the body turns at once, and never enters.
TEST(Start, ImpactsAtAGapOfZeroAreExact) {
  for (const char* activation : {"predictive", "moreau"})
    for (const double e : {0.0, 0.5, 1.0})
      for (const double h : coprime_steps) {
        GIVEN(activation, e, h);
        json source = resting_point("contact", {{"restitution", e}, {"activation", activation}}, h);
        source["loads"] = json::array();
        source["output"]["forces"] = {"floor"};
        source["model"]["points"][0]["velocity"] = {0, -1};
        const Ran run = ran(source);
        for (std::size_t k = 0; k < run.rows(); ++k) EXPECT_NEAR(run["n0.u1"][k], e * run["time"][k], 1e-15);
        EXPECT_NEAR(run.energy("dissipated_impact"), 0.5 * (1.0 - e * e), 1e-15);
        EXPECT_NEAR(run.summary["forces"]["floor"]["impulse"][1].get<double>(), 1.0 + e, 1e-15);
        EXPECT_LT(run.energy("balance_error"), 1e-15);
      }
}

// A fault that ends a run does so at time 0, too.
TEST(Start, FailsAsAnyStepDoes) {
  json source = resting_point("contact", {}, 1e-2);
  source["loads"] = json::parse(R"([{"type": "motion", "nodes": [0], "axes": [1], "velocity": [0, -1]}])");
  source["output"]["forces"] = {"floor"};
  EXPECT_THAT(
      run_scene(source),
      Exits(1, HasSubstr("failed after step 0, time 0: node 0 is driven along axis 1 against 'floor'")));
}

// The summary has the time of the first contact and of the largest force.
TEST(Summary, HasFirstContactAndTheTimeOfThePeak) {
  json source = resting_point("contact", {}, 1e-3);
  source["model"]["points"][0]["position"] = {0, 0.05};
  const Ran run = ran(source);
  const double fall = std::sqrt(2 * 0.05 / 10);
  EXPECT_NEAR(run.summary["interfaces"][0]["first_contact"].get<double>(), fall, 2e-3);
  EXPECT_NEAR(run.summary["forces"]["floor"]["largest_at"].get<double>(), fall, 2e-3);
  source["time"]["end"] = 0.01;
  EXPECT_TRUE(ran(source).summary["interfaces"][0]["first_contact"].is_null());
}

}  // namespace
}  // namespace ilaw::host::testing::start
