// Bad input at a node: nothing happens to it, everything happens to the others, and the report says so.
#include "batch_runner.hpp"

#include "support/law_cases.hpp"

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

class BadInput : public ::testing::TestWithParam<std::tuple<LawCase, Bad>> {};

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
      EXPECT_EQ(bad.code, ILAW_OK);
      EXPECT_EQ(bad.impulse, good.impulse);
      EXPECT_EQ(bad.state, good.state);
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

const std::vector<Bad> inputs = {
    {"nan_velocity", [](Nodes& n) { n.v_free[211] = nan_value; }, "v_free is not finite"},
    {"infinite_velocity", [](Nodes& n) { n.v_free[210] = inf_value; }, "v_free is not finite"},
    {"nan_previous", [](Nodes& n) { n.v_previous[212] = nan_value; }, "v_previous is not finite",
     ILAW_INPUT_V_PREVIOUS},
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

std::string name_of(const ::testing::TestParamInfo<std::tuple<LawCase, Bad>>& drawn) {
  return std::get<0>(drawn.param).name + "_" + std::get<1>(drawn.param).name;
}

INSTANTIATE_TEST_SUITE_P(Laws, BadInput,
                         ::testing::Combine(::testing::ValuesIn(law_cases("bad_input")),
                                            ::testing::ValuesIn(inputs)),
                         name_of);

INSTANTIATE_TEST_SUITE_P(Coulomb, BadInput,
                         ::testing::Combine(::testing::Values(LawCase{
                                                "coulomb", "coulomb", {{{"friction", 0.3}}, {}}, {}}),
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
  double v = -1.0, h = 1.0, gap = 0.0, r[6] = {7.0, 7.0, 7.0, 7.0, 7.0, 7.0};
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
      {"a node of the index list lies below index_base",
       [](ilaw_batch& b) {
         static const std::int32_t index[] = {1, 0};
         b.node_count = 2;
         b.index = index;
         b.index_base = 1;
         b.impulse.node_stride = 3;
       }},
      {"a node of the index list lies below index_base",
       [](ilaw_batch& b) {
         static const std::int64_t index[] = {-1};
         b.index64 = index;
       }},
      {"index and index64 are both given",
       [](ilaw_batch& b) {
         static const std::int32_t index[] = {0};
         static const std::int64_t index64[] = {0};
         b.index = index;
         b.index64 = index64;
       }},
      {"impulse has a stride of 0", [](ilaw_batch& b) { b.node_count = 2; }},
      {"impulse has a stride of 0", [](ilaw_batch& b) { b.impulse.component_stride = 0; }},
      {"velocity has a stride of 0",
       [](ilaw_batch& b) {
         static double v_out[3];
         b.node_count = 2;
         b.impulse.node_stride = 3;
         b.velocity = {v_out, 0, 1};
       }},
      {"status_stride is 0",
       [](ilaw_batch& b) {
         static std::uint8_t status[2];
         b.node_count = 2;
         b.impulse.node_stride = 3;
         b.status = status;
       }},
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

// A flag asks for something that a library which does not know it would not give.
TEST(WrongBatch, FlagsThatAreNotKnownAreRefused) {
  const SetupBuilder setup({{{"viscosity", 2.0}}, {}});
  const ilaw::interface law(ilaw::library(ILAW_KIT_PROBE), "kit_probe", setup.setup);
  ilaw_report report{};
  report.struct_size = sizeof report;
  for (const int bit : {0, 31, 63}) {
    ilaw_batch b{};
    b.struct_size = sizeof b;
    b.flags = std::uint64_t{1} << bit;
    for (const auto call : {law.law().evaluate, law.law().initialise}) {
      EXPECT_EQ(call(law.instance(), &b, &report), ILAW_UNSUPPORTED) << bit;
      EXPECT_STREQ(report.reason, "flags of the batch are not known");
    }
  }
}

TEST(WrongBatch, InitialiseRefusesStatesOnTopOfEachOther) {
  const SetupBuilder setup({{{"viscosity", 2.0}}, {}});
  const ilaw::interface law(ilaw::library(ILAW_KIT_PROBE), "kit_probe", setup.setup);
  std::vector<double> state(2 * law.info().state_size, 7.0);
  ilaw_report report{};
  report.struct_size = sizeof report;
  for (const auto& [node_stride, component_stride] : {std::pair{0, 1}, {10, 0}}) {
    ilaw_batch b{};
    b.struct_size = sizeof b;
    b.node_count = 2;
    b.state_out = {state.data(), node_stride, component_stride};
    EXPECT_EQ(law.law().initialise(law.instance(), &b, &report), ILAW_INVALID_ARGUMENT);
    EXPECT_STREQ(report.reason, "state_out has a stride of 0");
    EXPECT_EQ(state[0], 7.0);
  }
}

// initialise is the first to write a state: what stands where it would be read is nobody's.
TEST(Initialise, ReadsNoState) {
  const SetupBuilder setup({{{"viscosity", 2.0}}, {}}, 3, ILAW_DELASSUS_SCALAR, ILAW_FRAME_GLOBAL);
  const ilaw::interface law(ilaw::library(ILAW_KIT_PROBE), "kit_probe", setup.setup);
  const std::size_t s = law.info().state_size;
  const double normal[] = {0.36, 0.48, 0.8};
  std::vector<double> expected(s), found(s, nan_value), rubbish(s, 0.6);
  ilaw_batch b{};
  b.struct_size = sizeof b;
  b.node_count = 1;
  b.normal = {normal, 0, 1};
  b.state_out = {expected.data(), 0, 1};
  ASSERT_EQ(law.initialise(b), ILAW_OK);
  b.state_in = {rubbish.data(), 0, 1};
  b.state_out = {found.data(), 0, 1};
  ASSERT_EQ(law.initialise(b), ILAW_OK);
  EXPECT_EQ(found, expected);
}

// A velocity before the step that only the energies need: without it the motion is the same, and its
// dissipation is not known.
TEST(EnergyOutput, DoesNotChangeTheMotionWhereThePreviousVelocityIsNone) {
  std::vector<LawCase> served = law_cases("bad_input");
  served.push_back({"kit_probe", "kit_probe", {{{"viscosity", 2.0}}, {}}, {}});
  for (const auto& [name, ignored, parameters, more] : served) {
    const SetupBuilder setup(parameters);
    const ilaw::interface law(ilaw::library(name == "kit_probe" ? ILAW_KIT_PROBE : plugin_file(name)), name,
                              setup.setup);
    if (law.info().inputs & ILAW_INPUT_V_PREVIOUS) continue;
    Nodes nodes(130);
    for (std::size_t k = 0; k < nodes.v_previous.size(); k += 5) nodes.v_previous[k] = nan_value;
    nodes.v_previous[6] = inf_value;
    const Results with = run(law, nodes, {}, false), without = run(law, nodes, {.outputs = false}, false);
    EXPECT_EQ(with.code, ILAW_OK) << name << ": " << (with.report.reason ? with.report.reason : "");
    EXPECT_EQ(with.impulse, without.impulse) << name;
    EXPECT_EQ(with.state, without.state) << name;
    for (std::size_t i = 0; i < 130; ++i) {
      if (!std::isfinite(nodes.v_previous[3 * i] + nodes.v_previous[3 * i + 1] +
                         nodes.v_previous[3 * i + 2])) {
        EXPECT_EQ(with.energy[4 * i] + with.energy[4 * i + 1] + with.energy[4 * i + 2], 0.0) << name << i;
      }
    }
  }
}

TEST(Tangent, ThatIsNoneIsBadInput) {
  const SetupBuilder setup({{{"friction", 0.3}}, {}}, 3, ILAW_DELASSUS_SCALAR, ILAW_FRAME_GLOBAL, true);
  const ilaw::interface law = make_law("coulomb", setup);
  const double normal[] = {0.0, 0.0, 1.0}, v[] = {1.0, 0.5, -1.0}, h = 1.0, gap = 0.0;
  struct Given {
    Vector tangent;
    bool good;
  };
  for (const Given& given :
       {Given{{0.6, 0.8, 0.0}, true}, Given{{0.6, 0.8, 1e-7}, true}, Given{{0.6, 0.8, 1e-3}, false},
        Given{{0.0, 0.0, 1.0}, false}, Given{{0.3, 0.4, 0.0}, false}, Given{{0.0, 0.0, 0.0}, false},
        Given{{nan_value, 0.8, 0.0}, false}, Given{{0.6, inf_value, 0.0}, false}}) {
    double r[3];
    ilaw_batch b{};
    b.struct_size = sizeof b;
    b.node_count = 1;
    b.velocity_step = b.position_step = 1e-3;
    b.v_free = b.v_previous = {v, 0, 1};
    b.delassus = {&h, 0, 1};
    b.gap = {&gap, 0, 1};
    b.normal = {normal, 0, 1};
    b.tangent = {given.tangent.data(), 0, 1};
    b.impulse = {r, 0, 1};
    ilaw_report report{};
    report.struct_size = sizeof report;
    EXPECT_EQ(law.evaluate(b, &report), given.good ? ILAW_OK : ILAW_BAD_NODES) << given.tangent[2];
    EXPECT_STREQ(report.reason,
                 given.good ? nullptr : "the tangent is not a unit vector orthogonal to the normal");
  }
}

// Definite or not is no matter of axes: H = Q diag(1, 0.7, x) Q^T for any rotation Q.
TEST(FullDelassus, IsAcceptedOrRefusedWhateverItsRotation) {
  const SetupBuilder setup({{{"friction", 0.3}}, {}}, 3, ILAW_DELASSUS_FULL);
  const ilaw::interface law = make_law("coulomb", setup);
  const SetupBuilder diagonal_setup({{{"friction", 0.3}}, {}}, 3, ILAW_DELASSUS_DIAGONAL);
  const ilaw::interface diagonal = make_law("coulomb", diagonal_setup);
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  const double v[] = {-1.0, 0.5, 0.2}, gap = 0.0;
  const auto code_of = [&](const ilaw::interface& served, const double* h) {
    double r[3];
    ilaw_batch b{};
    b.struct_size = sizeof b;
    b.node_count = 1;
    b.velocity_step = b.position_step = 1e-3;
    b.v_free = b.v_previous = {v, 0, 1};
    b.delassus = {h, 0, 1};
    b.gap = {&gap, 0, 1};
    b.impulse = {r, 0, 1};
    return served.evaluate(b);
  };
  for (const double scale : {1.0, 1e-200, 1e150})
    for (const auto& [smallest, good] :
         {std::pair{0.0, false}, {-1e-18, false}, {1e-15, false}, {1e-11, true}, {1e-3, true}}) {
      const double d[] = {scale * 1.0, scale * 0.7, scale * smallest};
      EXPECT_EQ(code_of(diagonal, d) == ILAW_OK, good) << smallest << ", diagonal, scale " << scale;
      int accepted = 0;
      for (int k = 0; k < 500; ++k) {
        double q[4], size = 0.0;
        for (double& c : q) {
          c = normal(random);
          size += c * c;
        }
        const double w = q[0], x = q[1], y = q[2], z = q[3], s = 2.0 / size;
        const double m[3][3] = {{1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)},
                                {s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x)},
                                {s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y)}};
        const auto entry = [&](int a, int b) {
          return d[0] * m[a][0] * m[b][0] + d[1] * m[a][1] * m[b][1] + d[2] * m[a][2] * m[b][2];
        };
        const double h[] = {entry(0, 0), entry(1, 1), entry(2, 2), entry(0, 1), entry(0, 2), entry(1, 2)};
        accepted += code_of(law, h) == ILAW_OK;
      }
      EXPECT_EQ(accepted, good ? 500 : 0) << smallest << ", scale " << scale;
    }
}

}  // namespace
}  // namespace ilaw::testing
