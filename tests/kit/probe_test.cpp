// Probe laws with all features: tables over fields, amounts, numbers that a batch shares, first states,
// refusals, a solver with a scalar fallback, stable steps. kit_probe.cpp has the equations.
#include "kit_probe.hpp"

#include "support/small_batch.hpp"

#include <memory>
#include <numeric>

namespace ilaw::testing {
namespace {

using ::testing::Each;
using ::testing::HasSubstr;

struct Axis {
  std::string name;
  std::vector<double> points;
};

// An instance of a law of the probe library, by its arguments.
class Probe {
 public:
  explicit Probe(std::string law) : law_(std::move(law)) {
    setup_.struct_size = sizeof setup_;
    setup_.dimension = 3;
    setup_.delassus_form = ILAW_DELASSUS_SCALAR;
    setup_.frame = ILAW_FRAME_LOCAL;
    setup_.numbers = ILAW_NUMBERS_DOUBLE;
  }
  Probe& number(const std::string& name, double value) { return arguments_.number(name, value), *this; }
  Probe& text(const std::string& name, const std::string& value) {
    return arguments_.text(name, value), *this;
  }
  Probe& per_node(const std::string& name) { return arguments_.per_node(name), *this; }
  Probe& table(const std::string& name, const std::vector<Axis>& axes, const std::vector<double>& values) {
    std::vector<ilaw::parameters::axis> all;
    for (const Axis& axis : axes) all.push_back({axis.name, axis.points});
    arguments_.table(name, all, values);
    return *this;
  }
  ilaw::interface make() {
    arguments_.give(setup_);
    return {ilaw::library(ILAW_KIT_PROBE), law_, setup_};
  }
  // In the words of create.
  std::string refusal() {
    try {
      make();
    } catch (const ilaw::error& error) {
      return error.code() == ILAW_INVALID_PARAMETER ? error.what() : "another code";
    }
    return "not refused";
  }

 private:
  std::string law_;
  ilaw::parameters arguments_;
  ilaw_setup setup_{};
};

// The viscosity c of pack_probe that acted on v = -1 at rest, where r_N = -c v/(1 + c) for H = 1.
class ViscosityOf {
 public:
  explicit ViscosityOf(const ilaw::interface& law)
      : law_(law), nodes_(19, {-1.0, 0.0, 0.0}, law.info().state_size) {}

  std::vector<double> at(double time, std::vector<std::vector<double>> per_node = {}) {
    std::vector<ilaw_input> inputs;
    for (const auto& values : per_node) inputs.push_back(ilaw::input(values.data(), 1, 1));
    nodes_.b.per_node_parameters = inputs.data();
    nodes_.b.time = time;
    nodes_.state.assign(nodes_.state.size(), 0.0);
    EXPECT_EQ(law_.evaluate(nodes_.b, &nodes_.report), ILAW_OK) << nodes_.report.reason;
    std::vector<double> found;
    for (const Vector& r : nodes_.r) found.push_back(r[0] / (1.0 - r[0]));
    return found;
  }

 private:
  const ilaw::interface& law_;
  SmallBatch nodes_;
};

MATCHER_P(IsNear, expected, "") { return std::abs(arg - expected) <= 1e-14 * std::abs(expected); }

// At 300 K the probe's own heating is 1.
const Axis seconds{"time", {0.0, 2.0}}, degrees{"temperature", {200.0, 300.0, 400.0}};

TEST(Tables, AreReadAtTheFieldOfTheBatch) {
  const ilaw::interface law =
      Probe("pack_probe").table("viscosity", {degrees}, {1.0, 2.0, 4.0}).number("temperature", 300.0).make();
  EXPECT_THAT(ViscosityOf(law).at(0.0), Each(IsNear(2.0)));
}

TEST(Tables, AreReadAtTheFieldOfEachNode) {
  const ilaw::interface law =
      Probe("pack_probe").table("viscosity", {degrees}, {1.0, 2.0, 4.0}).per_node("temperature").make();
  std::vector<double> kelvin(19), expected(19);
  for (std::size_t i = 0; i < 19; ++i) {
    kelvin[i] = 150.0 + 25.0 * static_cast<double>(i % 13);  // from below the table to beyond it
    const double within = std::min(std::max(kelvin[i], 200.0), 400.0);
    const double table = within <= 300.0 ? 1.0 + 0.01 * (within - 200.0) : 2.0 + 0.02 * (within - 300.0);
    expected[i] = table * (1.0 + 0.001 * (kelvin[i] - 300.0));
  }
  const std::vector<double> found = ViscosityOf(law).at(0.0, {kelvin});
  for (std::size_t i = 0; i < 19; ++i) EXPECT_THAT(found[i], IsNear(expected[i])) << kelvin[i];
}

// The last axis varies fastest; linear along each.
TEST(Tables, AreBilinearOverTimeAndAField) {
  const Axis two{"temperature", {300.0, 400.0}};
  const ilaw::interface law = Probe("pack_probe")
                                  .table("viscosity", {seconds, two}, {1.0, 3.0, 5.0, 11.0})
                                  .per_node("temperature")
                                  .make();
  const auto at = [&](double time, double kelvin) {
    return ViscosityOf(law).at(time, {std::vector<double>(19, kelvin)})[3] / (1.0 + 0.001 * (kelvin - 300.0));
  };
  EXPECT_THAT(at(0.0, 300.0), IsNear(1.0));
  EXPECT_THAT(at(0.0, 400.0), IsNear(3.0));
  EXPECT_THAT(at(2.0, 300.0), IsNear(5.0));
  EXPECT_THAT(at(1.0, 350.0), IsNear(5.0));   // the mean of all four
  EXPECT_THAT(at(0.5, 350.0), IsNear(3.5));   // 2 + (8 - 2)/4
  EXPECT_THAT(at(9.0, 999.0), IsNear(11.0));  // constant beyond its ends
}

// Values that go together at each node only.
TEST(Tables, AreJudgedForConflictsAtEachNode) {
  const ilaw::interface law = Probe("pack_probe")
                                  .table("viscosity", {{"hardness", {1e-6, 1.0}}}, {5.0, 5.0})
                                  .per_node("hardness")
                                  .make();
  SmallBatch nodes(3, {-1.0, 0.0, 0.0}, law.info().state_size);
  const double hardness[] = {1.0, 1e-6, 1.0};
  const ilaw_input given = ilaw::input(hardness, 1, 1);
  nodes.b.per_node_parameters = &given;
  ASSERT_EQ(law.evaluate(nodes.b, &nodes.report), ILAW_BAD_NODES);
  EXPECT_EQ(nodes.report.first_bad_node, 1);
  EXPECT_EQ(nodes.report.bad_count, 1);
  EXPECT_STREQ(nodes.report.reason, "parameter 'viscosity' is above 1e6 'hardness'");
}

ilaw::interface plain_probe() { return Probe("pack_probe").number("viscosity", 2.0).make(); }

// One step of pack_probe with its amounts.
struct WithAmounts : SmallBatch {
  explicit WithAmounts(const ilaw::interface& law, std::size_t count = 3)
      : SmallBatch(count, {-1.0, 0.25, 0.0}, law.info().state_size), heat(count, -7.0), wear(count, -7.0) {
    amounts[0] = ilaw::output(heat.data(), 1, 1);
    amounts[1] = ilaw::output(wear.data(), 1, 1);
    b.amounts = amounts;
  }
  std::vector<double> heat, wear;
  ilaw_output amounts[2];
};

TEST(Amounts, AreWhatTheStepGave) {
  const ilaw::interface law = plain_probe();
  WithAmounts nodes(law);
  ASSERT_EQ(law.evaluate(nodes.b, &nodes.report), ILAW_OK);
  EXPECT_THAT(nodes.heat, Each(IsNear(2.0 / 9.0)));  // c v_N^2, v_N = -1/(1 + c)
  EXPECT_THAT(nodes.wear, Each(IsNear(0.25 / 3.0)));
}

TEST(Amounts, AreWrittenWhereTheyAreAskedForAlone) {
  const ilaw::interface law = plain_probe();
  WithAmounts nodes(law);
  nodes.amounts[0] = {};
  ASSERT_EQ(law.evaluate(nodes.b, &nodes.report), ILAW_OK);
  EXPECT_THAT(nodes.heat, Each(-7.0));
  EXPECT_THAT(nodes.wear, Each(IsNear(0.25 / 3.0)));
}

TEST(Amounts, AreZeroAtABadNode) {
  const ilaw::interface law = plain_probe();
  WithAmounts nodes(law);
  const double gaps[] = {0.0, nan_value, 0.0};
  nodes.b.gap = ilaw::input(gaps, 1, 1);
  ASSERT_EQ(law.evaluate(nodes.b, &nodes.report), ILAW_BAD_NODES);
  EXPECT_EQ(nodes.heat[1], 0.0);
  EXPECT_THAT(nodes.heat[2], IsNear(2.0 / 9.0));
}

TEST(Initialise, SeesAreaTimeAndParametersOfItsNode) {
  const ilaw::interface law = Probe("pack_probe").number("viscosity", 2.0).per_node("temperature").make();
  SmallBatch nodes(2, {}, law.info().state_size);
  const double kelvin[] = {300.0, 400.0}, area[] = {2.0, 3.0};
  const ilaw_input given = ilaw::input(kelvin, 1, 1);
  nodes.b.per_node_parameters = &given;
  nodes.b.area = ilaw::input(area, 1, 1);
  ASSERT_EQ(law.initialise(nodes.b), ILAW_OK);
  // count, sum, last, slip
  EXPECT_THAT(nodes.state, ::testing::ElementsAre(0, 0, 0, 0, -300, 0, 0, 0, 0, 0, 0, -600, 0, 0));
}

// exp(-rate h), once for all nodes.
TEST(Prepare, IsSeenByEveryNode) {
  const ilaw::interface law = plain_probe();
  SmallBatch nodes(19, {}, law.info().state_size);
  for (std::size_t i = 0; i < 19; ++i) nodes.state[7 * i + 4] = -8.0;  // last
  ASSERT_EQ(law.evaluate(nodes.b), ILAW_OK);
  for (const Vector& r : nodes.r) EXPECT_NEAR(r[0], std::exp(-0.1), 1e-15);
}

TEST(Refuse, NamesTheReasonAtItsNode) {
  const ilaw::interface law = plain_probe();
  SmallBatch nodes(19, {}, law.info().state_size);
  nodes.state[7 * 5] = 1000.0;  // count
  ASSERT_EQ(law.evaluate(nodes.b, &nodes.report), ILAW_BAD_NODES);
  EXPECT_EQ(nodes.report.first_bad_node, 5);
  EXPECT_STREQ(nodes.report.reason, "the state is not one that the law can have written");
  EXPECT_EQ(nodes.state[7 * 5], 1000.0);
  EXPECT_EQ(nodes.state[7 * 6], 1.0);
}

TEST(Permissions, FollowTheParameters) {
  EXPECT_EQ(Probe("pack_probe").number("viscosity", 2.0).make().info().permissions, 0U);
  EXPECT_EQ(Probe("pack_probe").number("viscosity", 2.0).text("rests", "yes").make().info().permissions,
            std::uint32_t{ILAW_MAY_SKIP_FREE});
}

// h r exp(r) = -v. Lanes with w > 2 are left to the scalar fallback, which says so by another status.
TEST(Solver, GivesEachNodeItsAnswer) {
  const ilaw::interface law = Probe("solver_probe").make();
  constexpr std::size_t count = 300;  // several blocks
  SmallBatch nodes(count, {}, law.info().state_size);
  std::vector<double> v(3 * count), h(count), energy(4 * count), wear(count);
  for (std::size_t i = 0; i < count; ++i) {
    v[3 * i] = i % 3 == 0 ? 0.5 : -0.01 * static_cast<double>(i + 1);
    h[i] = 0.5 + 0.01 * static_cast<double>(i % 7);
  }
  nodes.b.v_free = nodes.b.v_previous = ilaw::input(v.data(), 3, 1);
  nodes.b.delassus = ilaw::input(h.data(), 1, 1);
  nodes.b.energy = ilaw::output(energy.data(), 4, 1);
  const ilaw_output amount = ilaw::output(wear.data(), 1, 1);
  nodes.b.amounts = &amount;
  ASSERT_EQ(law.evaluate(nodes.b, &nodes.report), ILAW_OK);
  for (std::size_t i = 0; i < count; ++i) {
    const double r = nodes.r[i][0], w = -v[3 * i] / h[i];
    SCOPED_TRACE(::testing::Message() << "node " << i << ", w " << w);
    EXPECT_NEAR(w > 0.0 ? r * std::exp(r) : 0.0, std::max(w, 0.0), 1e-14 * std::max(1.0, w));
    EXPECT_EQ(nodes.status[i], w <= 0.0 ? ILAW_FREE : w > 2.0 ? ILAW_STICK : ILAW_SLIP);
    EXPECT_EQ(nodes.state[i], r);
    EXPECT_EQ(energy[4 * i + ILAW_ENERGY_STORED], 0.5 * r);
    EXPECT_EQ(wear[i], w <= 0.0 ? 0.0 : w > 2.0 ? 60.0 : 40.0);
  }
}

TEST(Solver, LeavesABadNodeAlone) {
  const ilaw::interface law = Probe("solver_probe").per_node("offset").make();
  constexpr std::size_t count = 37;
  SmallBatch nodes(count, {-1.0, 0.0, 0.0}, law.info().state_size),
      good(count, {-1.0, 0.0, 0.0}, law.info().state_size);
  std::vector<double> offset(count, 0.5), gap(count, 0.0);
  const ilaw_input given = ilaw::input(offset.data(), 1, 1);
  good.b.per_node_parameters = nodes.b.per_node_parameters = &given;
  ASSERT_EQ(law.evaluate(good.b), ILAW_OK);
  offset[3] = -1.0;  // below its minimum
  gap[20] = inf_value;
  nodes.b.gap = ilaw::input(gap.data(), 1, 1);
  ASSERT_EQ(law.evaluate(nodes.b, &nodes.report), ILAW_BAD_NODES);
  EXPECT_EQ(nodes.report.bad_count, 2);
  EXPECT_STREQ(nodes.report.reason, "a per-node parameter is out of range");
  for (std::size_t i = 0; i < count; ++i) {
    const bool is_bad = i == 3 || i == 20;
    EXPECT_EQ(nodes.r[i], is_bad ? Vector{} : good.r[i]) << i;
    EXPECT_EQ(nodes.state[i], is_bad ? 0.0 : good.state[i]) << i;
    EXPECT_EQ(nodes.status[i] == ILAW_BAD_INPUT, is_bad) << i;
  }
}

TEST(StableStep, IsTheSmallestOfGoodNodes) {
  double h[] = {0.5, 2.0, 1.0, 40.0, 0.25};
  const double k[] = {1.0, 1.0, 9.0, 1.0, 1.0}, gap[] = {0.0, 0.0, 0.0, 1.0, 0.0};  // the stiffest is open
  const ilaw_input given = ilaw::input(k, 1, 1);
  for (const bool per_node : {false, true}) {
    const ilaw::interface law =
        per_node ? Probe("limit_probe").per_node("stiffness").make() : Probe("limit_probe").make();
    for (const auto& [count, bad, largest] : {std::tuple{1, -1, 0.5},
                                              {5, -1, per_node ? 9.0 : 2.0},
                                              {5, per_node ? 2 : 1, per_node ? 2.0 : 1.0}}) {
      SmallBatch nodes(5, {});
      nodes.b.node_count = count;
      nodes.b.delassus = ilaw::input(h, 1, 1);
      nodes.b.gap = ilaw::input(gap, 1, 1);
      nodes.b.per_node_parameters = &given;
      const double kept = bad < 0 ? 0.0 : std::exchange(h[bad], -1.0);
      ASSERT_EQ(law.evaluate(nodes.b, &nodes.report), bad < 0 ? ILAW_OK : ILAW_BAD_NODES);
      EXPECT_DOUBLE_EQ(nodes.report.stable_velocity_step, 2.0 / std::sqrt(largest)) << count << " " << bad;
      if (bad >= 0) h[bad] = kept;
    }
  }
}

// A law that gives what its card does not announce: with outputs and without, the node is refused, with the
// promise.
TEST(Promises, ThatALawBreaksAreRefusedAtTheirNode) {
  struct Broken {
    const char* promise;
    std::int64_t node;  // of three: closed, open, open and out of reach; -1: none
    const char* reason;
  };
  const double gap[] = {-0.1, 1e-4, 1.0};
  for (const auto& [promise, node, reason] :
       {Broken{"none", -1, nullptr},
        {"number", 0, "the law gave an impulse that is not a number"},
        {"pull", 0, "the law pulled, which needs can_adhere in its card"},
        {"far", 2, "the law acted out of reach, which may_skip_fresh of its card excludes"}})
    for (const bool outputs : {true, false}) {
      SCOPED_TRACE(::testing::Message() << promise << (outputs ? ", outputs" : ""));
      const ilaw::interface law = Probe("promise_breaker").text("breaks", promise).make();
      SmallBatch nodes(3, {-1.0, 0.0, 0.0});
      nodes.b.gap = ilaw::input(gap, 1, 1);
      if (!outputs) nodes.b.status = nullptr;
      EXPECT_EQ(law.evaluate(nodes.b, &nodes.report), node < 0 ? ILAW_OK : ILAW_BAD_NODES);
      EXPECT_EQ(nodes.report.first_bad_node, node);
      EXPECT_STREQ(nodes.report.reason, reason);
      if (node < 0) continue;
      EXPECT_EQ(nodes.r[static_cast<std::size_t>(node)][0], 0.0);
      EXPECT_EQ(nodes.status[static_cast<std::size_t>(node)], outputs ? ILAW_BAD_INPUT : 0);
    }
}

// g++ 12 lost such an assignment.
TEST(Input, MayBeCopiedAsItIs) {
  const ilaw::interface law = make_tested_law("copy_probe", SetupBuilder({}));
  std::vector<double> v(3 * 21), r(v.size());
  std::iota(v.begin(), v.end(), 1.0);
  const double h = 1.0, gap = 0.0;
  ilaw_batch b{};
  b.struct_size = sizeof b;
  b.node_count = 21;
  b.velocity_step = b.position_step = 1e-3;
  b.v_free = ilaw::input(v.data(), 3, 1);
  b.delassus = ilaw::input(&h, 0, 0);
  b.gap = ilaw::input(&gap, 0, 0);
  b.impulse = ilaw::output(r.data(), 3, 1);
  ASSERT_EQ(law.evaluate(b), ILAW_OK);
  EXPECT_EQ(r, v);
}

}  // namespace
}  // namespace ilaw::testing
