// Bad input at a node: nothing happens to it, everything happens to the others, and the report says so.
#include "batch_runner.hpp"

#include <functional>
#include <limits>

namespace ilaw::testing {
namespace {

constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();
constexpr double inf_value = std::numeric_limits<double>::infinity();

struct Bad {
  const char* name;
  std::function<void(Nodes&)> spoil;  // node 70
  const char* reason;
  std::uint32_t input = 0;  // the law must read this to notice; 0: all do

  friend void PrintTo(const Bad& bad, std::ostream* out) { *out << bad.name; }
};

struct Served {
  const char* law;
  Parameters parameters;

  friend void PrintTo(const Served& served, std::ostream* out) { *out << served.law; }
};

class BadInput : public ::testing::TestWithParam<std::tuple<Served, Bad>> {};

TEST_P(BadInput, IsRefusedAtItsNodeOnly) {
  const auto& [served, spoilt] = GetParam();
  const SetupBuilder setup(served.parameters, 3, ILAW_DELASSUS_SCALAR, ILAW_FRAME_GLOBAL);
  const ilaw::interface law = make_law(served.law, setup);
  const bool reads = spoilt.input == 0 || (law.info().inputs & spoilt.input);
  Nodes nodes(130);
  nodes.gap[70] = -1e-3;
  const Results good = run(law, nodes, {}, true, 1);
  spoilt.spoil(nodes);
  nodes.sound = false;
  for (const Layout& layout : {Layout{}, Layout{.soa = true}}) {
    const Results bad = run(law, nodes, layout, true, 1);
    if (!reads) {
      EXPECT_TRUE(bad == good);
      continue;
    }
    EXPECT_EQ(bad.code, ILAW_BAD_NODES);
    EXPECT_EQ(bad.report.bad_count, 1);
    EXPECT_EQ(bad.report.first_bad_node, 70);
    EXPECT_STREQ(bad.report.reason, spoilt.reason);
    for (std::size_t i = 0; i < 130; ++i) {
      EXPECT_EQ(bad.status[i], i == 70 ? int{ILAW_BAD_INPUT} : int{good.status[i]});
      for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_EQ(bad.impulse[3 * i + c], i == 70 ? 0.0 : good.impulse[3 * i + c]);
        const double velocity = bad.velocity[3 * i + c],
                     expected = i == 70 ? nodes.v_free[3 * i + c] : good.velocity[3 * i + c];
        EXPECT_TRUE(velocity == expected || (std::isnan(velocity) && std::isnan(expected)));
      }
      for (std::size_t c = 0; c < 4; ++c)
        EXPECT_EQ(bad.energy[4 * i + c], i == 70 ? 0.0 : good.energy[4 * i + c]);
    }
  }
}

const std::vector<Served> laws = {
    {"contact", {{{"restitution", 0.5}}, {}}},
    {"coulomb", {{{"friction", 0.3}, {"restitution", 0.5}}, {}}},
    {"postit", {{{"adhesion_limit", 1.0}, {"initial_adhesion", 0.5}, {"memory", 0.01}}, {}}},
    {"tie", {{{"strength", 1.0}, {"memory", 0.01}}, {}}},
    {"penalty",
     {{{"stiffness", 1e4}, {"damping", 1.0}, {"friction", 0.3}, {"tangential_stiffness", 1e4}}, {}}},
    {"cohesive", {{{"strength", 1.0}, {"toughness", 1e-3}, {"friction", 0.3}}, {}}}};

const std::vector<Bad> inputs = {
    {"nan_velocity", [](Nodes& n) { n.v_free[211] = nan_value; }, "v_free is not finite"},
    {"infinite_velocity", [](Nodes& n) { n.v_free[210] = inf_value; }, "v_free is not finite"},
    {"nan_previous", [](Nodes& n) { n.v_previous[212] = nan_value; }, "v_previous is not finite"},
    {"zero_delassus", [](Nodes& n) { n.delassus[70] = 0.0; }, "H is not finite and positive definite"},
    {"negative_delassus", [](Nodes& n) { n.delassus[70] = -1.0; }, "H is not finite and positive definite"},
    {"infinite_delassus", [](Nodes& n) { n.delassus[70] = inf_value; },
     "H is not finite and positive definite"},
    {"subnormal_delassus", [](Nodes& n) { n.delassus[70] = 1e-310; },
     "H is not finite and positive definite"},
    {"nan_gap", [](Nodes& n) { n.gap[70] = nan_value; }, "the gap is not finite", ILAW_INPUT_GAP},
    {"infinite_gap", [](Nodes& n) { n.gap[70] = -inf_value; }, "the gap is not finite", ILAW_INPUT_GAP},
    {"negative_area", [](Nodes& n) { n.area[70] = -1.0; }, "the area is not a finite number >= 0",
     ILAW_INPUT_AREA},
    {"nan_area", [](Nodes& n) { n.area[70] = nan_value; }, "the area is not a finite number >= 0",
     ILAW_INPUT_AREA},
    {"long_normal",
     [](Nodes& n) {
       n.normal[210] *= 3.0;
       n.normal[211] += 1.0;
     },
     "the normal is not a unit vector"},
    {"nan_normal", [](Nodes& n) { n.normal[210] = nan_value; }, "the normal is not a unit vector"}};

std::string name_of(const ::testing::TestParamInfo<std::tuple<Served, Bad>>& drawn) {
  return std::string(std::get<0>(drawn.param).law) + "_" + std::get<1>(drawn.param).name;
}

INSTANTIATE_TEST_SUITE_P(Laws, BadInput,
                         ::testing::Combine(::testing::ValuesIn(laws), ::testing::ValuesIn(inputs)), name_of);

INSTANTIATE_TEST_SUITE_P(Coulomb, BadInput,
                         ::testing::Combine(::testing::Values(laws[1]),
                                            ::testing::Values(Bad{"overflow",
                                                                  [](Nodes& n) {
                                                                    for (int c = 0; c < 3; ++c)
                                                                      n.v_free[210 + c] =
                                                                          -1e300 * n.normal[210 + c];
                                                                    n.delassus[70] = 1e-300;
                                                                  },
                                                                  "the impulse or the state overflows"})),
                         name_of);

TEST(BadInputAtMemory, LeavesStateAndHistoryUntouched) {
  const SetupBuilder setup({{{"viscosity", 2.0}}, {}});
  const ilaw::interface law(ilaw::library(ILAW_KIT_PROBE), "kit_probe", setup.setup);
  Nodes nodes(70);
  const Results good = run(law, nodes, {}, false, 1);
  nodes.v_free[3 * 66] = nan_value;
  for (const bool separate : {false, true}) {
    const Results bad = run(law, nodes, {.separate_state = separate}, false, 1);
    EXPECT_EQ(bad.report.first_bad_node, 66);
    const std::size_t s = law.info().state_size;
    for (std::size_t k = 0; k < bad.state.size(); ++k)
      EXPECT_EQ(bad.state[k], k / s == 66 ? 0.0 : good.state[k]);
  }
}

TEST(FullDelassus, ThatIsNotPositiveDefiniteIsRefused) {
  const SetupBuilder setup({}, 3, ILAW_DELASSUS_FULL);
  const ilaw::interface law = make_law("contact", setup);
  Nodes nodes(3, 3, 6);
  EXPECT_EQ(run(law, nodes, {}, false, 1).code, ILAW_OK);
  nodes.delassus[6 + 5] = 2.5;  // H_12 larger than H_11 = H_22 = 2
  const Results bad = run(law, nodes, {}, false, 1);
  EXPECT_EQ(bad.report.first_bad_node, 1);
  EXPECT_STREQ(bad.report.reason, "H is not finite and positive definite");
}

// Tiny and huge but representable inputs are ordinary.
TEST(Extremes, AreSolvedWhereTheResultCanBeRepresented) {
  const SetupBuilder setup({{{"friction", 0.5}}, {}});
  const ilaw::interface law = make_law("coulomb", setup);
  for (const double scale : {5e-324, 1e-310, 1e-300, 1e-200, 1e200, 1e300})
    for (const double h : {1e-5, 1.0, 1e5}) {
      Nodes nodes(1);
      nodes.v_free = {-scale, scale, 0.0};
      nodes.delassus = {h};
      nodes.gap = {0.0};
      const Results results = run(law, nodes, {}, false, 1);
      EXPECT_EQ(results.code, ILAW_OK) << scale << " " << h;
      EXPECT_EQ(results.impulse[0], scale / h);
      // A few ulp, where subnormal velocities have ulps of 5e-324.
      const double relative = 1e-15 + 5e-324 / scale;
      EXPECT_LE(std::abs(results.impulse[1] + 0.5 * (scale / h)), relative * (scale / h));
    }
}

TEST(WrongBatch, IsRefusedWithNothingWritten) {
  const SetupBuilder setup({{{"friction", 0.5}}, {}});
  const ilaw::interface law = make_law("coulomb", setup);
  double v = -1.0, h = 1.0, gap = 0.0, r[3] = {7.0, 7.0, 7.0};
  const auto good = [&] {
    ilaw_batch b{};
    b.struct_size = sizeof b;
    b.node_count = 1;
    b.velocity_step = b.position_step = 1e-3;
    b.v_free = b.v_previous = {&v, 0, 0};
    b.delassus = {&h, 0, 0};
    b.gap = {&gap, 0, 0};
    b.impulse = {r, 0, 1};
    return b;
  };
  struct Wrong {
    const char* reason;
    std::function<void(ilaw_batch&)> spoil;
  };
  const Wrong wrongs[] = {
      {"v_free is null", [](ilaw_batch& b) { b.v_free.values = nullptr; }},
      {"delassus is null", [](ilaw_batch& b) { b.delassus.values = nullptr; }},
      {"gap is null", [](ilaw_batch& b) { b.gap.values = nullptr; }},
      {"impulse is null", [](ilaw_batch& b) { b.impulse.values = nullptr; }},
      {"v_previous is null", [](ilaw_batch& b) { b.v_previous.values = nullptr; }},
      {"node_count is negative", [](ilaw_batch& b) { b.node_count = -1; }},
      {"index_base is neither 0 nor 1", [](ilaw_batch& b) { b.index_base = 2; }},
      {"time is not finite", [](ilaw_batch& b) { b.time = nan_value; }},
      {"velocity_step is not a finite number > 0", [](ilaw_batch& b) { b.velocity_step = 0.0; }},
      {"position_step is not a finite number > 0", [](ilaw_batch& b) { b.position_step = inf_value; }}};
  for (const Wrong& wrong : wrongs) {
    ilaw_batch b = good();
    wrong.spoil(b);
    ilaw_report report{};
    report.struct_size = sizeof report;
    EXPECT_EQ(law.evaluate(b, &report), ILAW_INVALID_ARGUMENT);
    EXPECT_STREQ(report.reason, wrong.reason);
    EXPECT_EQ(r[0], 7.0);
  }
  EXPECT_EQ(law.evaluate(good()), ILAW_OK);
  EXPECT_EQ(r[0], 1.0);
}

}  // namespace
}  // namespace ilaw::testing
