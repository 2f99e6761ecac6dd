// The contract of evaluate: a node's result depends on its own inputs alone, bit for bit.
#include "batch_runner.hpp"

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <thread>

namespace ilaw::testing {
namespace {

struct Case {
  const char* law;
  Parameters parameters;

  friend void PrintTo(const Case& shown, std::ostream* out) { *out << shown.law; }
};

class Contract : public ::testing::TestWithParam<Case> {
 protected:
  ilaw::interface make(std::uint32_t frame, std::uint32_t form = ILAW_DELASSUS_SCALAR,
                       std::uint32_t d = 3) const {
    const SetupBuilder setup(GetParam().parameters, d, form, frame);
    const std::string law = GetParam().law;
    return {ilaw::library(law == "kit_probe" ? ILAW_KIT_PROBE : plugin_file(law)), law, setup.setup};
  }
};

TEST_P(Contract, LayoutsGiveTheSameBits) {
  for (const std::uint32_t frame : {ILAW_FRAME_LOCAL, ILAW_FRAME_GLOBAL})
    for (const std::int64_t n : {1, 2, 63, 64, 65, 200}) {
      const ilaw::interface law = make(frame);
      const Nodes nodes(n);
      const bool global = frame == ILAW_FRAME_GLOBAL;
      const Results reference = run(law, nodes, {}, global);
      EXPECT_EQ(reference.code, ILAW_OK);
      EXPECT_TRUE(run(law, nodes, {.soa = true}, global) == reference) << "SoA, n = " << n;
      EXPECT_TRUE(run(law, nodes, {.node_stride = 2, .component_stride = 2}, global) == reference)
          << "strided";
      EXPECT_TRUE(run(law, nodes, {.separate_state = true}, global) == reference) << "separate state";
      std::vector<std::int32_t> order(static_cast<std::size_t>(n));
      std::iota(order.begin(), order.end(), 0);
      std::shuffle(order.begin(), order.end(), std::mt19937(7));
      EXPECT_TRUE(run(law, nodes, {.order = order}, global) == reference) << "permuted";
      for (std::int32_t& i : order) ++i;
      EXPECT_TRUE(run(law, nodes, {.soa = true, .order = order, .index_base = 1}, global) == reference)
          << "base 1";
    }
}

// In all dimensions and forms of H that the law serves, whether it has a solution for all of these H or
// refuses some.
TEST_P(Contract, EveryFormOfHGivesTheSameBitsInAllLayoutsAndInstructionSets) {
  const ilaw::interface any = make(ILAW_FRAME_LOCAL);
  for (const int d : {1, 2, 3})
    for (const auto& [form, components] : {std::pair{ILAW_DELASSUS_SCALAR, 1},
                                           {ILAW_DELASSUS_DIAGONAL, d},
                                           {ILAW_DELASSUS_FULL, d * (d + 1) / 2}})
      for (const std::uint32_t frame : {ILAW_FRAME_LOCAL, ILAW_FRAME_GLOBAL}) {
        if (!(any.law().delassus_forms & static_cast<std::uint32_t>(form))) continue;
        SCOPED_TRACE(::testing::Message() << "d " << d << ", form " << form << ", frame " << frame);
        const bool global = frame == ILAW_FRAME_GLOBAL;
        const auto made = [&] {
          return make(frame, static_cast<std::uint32_t>(form), static_cast<std::uint32_t>(d));
        };
        const Nodes nodes(130, d, components);
        std::vector<std::int32_t> order(130);
        std::iota(order.begin(), order.end(), 0);
        std::shuffle(order.begin(), order.end(), std::mt19937(7));
        const ilaw::interface law = made();
        const Results reference = run(law, nodes, {}, global);
        EXPECT_TRUE(run(law, nodes, {.soa = true}, global) == reference);
        EXPECT_TRUE(run(law, nodes, {.separate_state = true, .order = order}, global) == reference);
        EXPECT_EQ(run(law, nodes, {.outputs = false}, global).impulse, reference.impulse);
        for (const char* level : {"baseline", "v3", "v4"}) {
          setenv("ILAW_ISA", level, 1);
          EXPECT_TRUE(run(made(), nodes, {}, global) == reference) << level;
        }
        unsetenv("ILAW_ISA");
      }
}

TEST_P(Contract, EmptyBatchIsFine) {
  const ilaw::interface law = make(ILAW_FRAME_LOCAL);
  EXPECT_EQ(run(law, Nodes(0), {}).code, ILAW_OK);
}

TEST_P(Contract, PartsOfABatchGiveTheSameBitsAndLeaveTheRestAlone) {
  const ilaw::interface law = make(ILAW_FRAME_GLOBAL);
  const Nodes nodes(100);
  const Results whole = run(law, nodes, {}, true);
  const Results part = run(law, nodes, {}, true, 3, 20, 37);
  for (std::size_t i = 0; i < 100; ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      const bool inside = i >= 20 && i < 57;
      EXPECT_EQ(part.impulse[3 * i + c], inside ? whole.impulse[3 * i + c] : Laid::guard);
    }
}

TEST_P(Contract, OptionalOutputsDoNotChangeTheImpulse) {
  const ilaw::interface law = make(ILAW_FRAME_GLOBAL);
  const Nodes nodes(150);
  const Results with = run(law, nodes, {}, true), without = run(law, nodes, {.outputs = false}, true);
  EXPECT_EQ(std::memcmp(with.impulse.data(), without.impulse.data(), with.impulse.size() * sizeof(double)),
            0);
  EXPECT_EQ(with.state, without.state);
}

TEST_P(Contract, InstructionSetsGiveTheSameBits) {
  for (const std::uint32_t frame : {ILAW_FRAME_LOCAL, ILAW_FRAME_GLOBAL})
    for (const bool outputs : {false, true}) {
      std::vector<Results> all;
      for (const char* level : {"baseline", "v3", "v4"}) {
        setenv("ILAW_ISA", level, 1);
        all.push_back(run(make(frame), Nodes(517), {.outputs = outputs}, frame == ILAW_FRAME_GLOBAL));
      }
      unsetenv("ILAW_ISA");
      EXPECT_TRUE(all[0] == all[1]);
      EXPECT_TRUE(all[0] == all[2]);
    }
}

TEST_P(Contract, ThreadsShareAnInstance) {
  const ilaw::interface law = make(ILAW_FRAME_LOCAL);
  const Results reference = run(law, Nodes(300), {});
  std::vector<Results> results(4);
  std::vector<std::thread> threads;
  for (Results& mine : results) threads.emplace_back([&law, &mine] { mine = run(law, Nodes(300), {}); });
  for (std::thread& thread : threads) thread.join();
  for (const Results& mine : results) EXPECT_TRUE(mine == reference);
}

// A structure with a smaller size is one of an older minor version: what it lacks counts as absent.
TEST_P(Contract, ReportAndInfoAreFilledUpToTheSizeAsked) {
  const ilaw::interface law = make(ILAW_FRAME_LOCAL);
  ilaw_instance_info info;
  std::memset(&info, 0x5a, sizeof info);
  info.struct_size = offsetof(ilaw_instance_info, state_variables);
  ASSERT_EQ(law.law().info(law.instance(), &info), ILAW_OK);
  EXPECT_EQ(info.struct_size, offsetof(ilaw_instance_info, state_variables));
  EXPECT_EQ(info.state_size, law.info().state_size);
  unsigned char untouched[sizeof info.state_variables];
  std::memset(untouched, 0x5a, sizeof untouched);
  EXPECT_EQ(std::memcmp(&info.state_variables, untouched, sizeof untouched), 0);
}

// A batch from a host of an older minor version ends early, one from a newer host goes on beyond what is
// known here.
TEST(Minor, HostsOfOtherMinorVersionsAreServed) {
  const SetupBuilder setup({{{"friction", 0.5}}, {}});
  const ilaw::interface law = make_law("coulomb", setup);
  const double v[] = {-1.0, 2.0, 0.0}, h = 1.0, gap = 0.0;
  double r[3];
  std::uint8_t status = 99;
  struct {
    ilaw_batch batch{};
    double appended[4] = {1.0, 2.0, 3.0, 4.0};
  } newer;
  ilaw_batch& b = newer.batch;
  b.struct_size = sizeof newer;
  b.node_count = 1;
  b.velocity_step = b.position_step = 1e-3;
  b.v_free = b.v_previous = {v, 3, 1};
  b.delassus = {&h, 1, 1};
  b.gap = {&gap, 1, 1};
  b.impulse = {r, 3, 1};
  b.status = &status;
  EXPECT_EQ(law.evaluate(b), ILAW_OK);
  EXPECT_EQ(status, ILAW_SLIP);
  EXPECT_EQ(r[1], -0.5);

  b.struct_size = offsetof(ilaw_batch, velocity);  // knows no optional outputs: what stands there is not read
  status = 99;
  r[1] = 0.0;
  EXPECT_EQ(law.evaluate(b), ILAW_OK);
  EXPECT_EQ(status, 99);
  EXPECT_EQ(r[1], -0.5);
}

INSTANTIATE_TEST_SUITE_P(
    Laws, Contract,
    ::testing::Values(
        Case{"contact", {{{"restitution", 0.3}}, {}}}, Case{"contact", {{}, {{"activation", "predictive"}}}},
        Case{"coulomb", {{{"friction", 0.3}, {"restitution", 0.5}}, {}}},
        Case{"coulomb", {{{"friction", 0.3}, {"tangential_restitution", 0.5}}, {}}},
        Case{"postit",
             {{{"memory", 0.01},
               {"friction", 0.2},
               {"tangent_influence", 0.8},
               {"adhesion_limit", 0.3},
               {"initial_adhesion", 0.2},
               {"buckets", 4}},
              {}}},
        Case{"tie", {{{"strength", 2.0}, {"memory", 0.01}}, {}}},
        Case{"penalty",
             {{{"stiffness", 1e6}, {"damping", 20.0}, {"friction", 0.3}, {"tangential_stiffness", 1e5}}, {}}},
        Case{"penalty",
             {{{"stiffness", 1e6}, {"friction", 0.3}, {"tangential_stiffness", 1e5}},
              {{"integration", "implicit"}}}},
        Case{"penalty",
             {{{"stiffness", 1e6}, {"exponent", 2.3}, {"damping", 20.0}}, {{"integration", "implicit"}}}},
        Case{"cohesive",
             {{{"strength", 10.0}, {"toughness", 0.02}, {"strength_2", 15.0}, {"mixing_exponent", 1.7}}, {}}},
        Case{"cohesive",
             {{{"strength", 10.0}, {"toughness", 0.02}, {"stiffness", 1e4}, {"friction", 0.4}},
              {{"shape", "exponential"}}}},
        Case{"cohesive",
             {{{"strength", 10.0}, {"toughness", 0.02}, {"stiffness", 1e4}, {"delay_time", 2e-3}}, {}}},
        Case{"kit_probe", {{{"viscosity", 2.0}}, {}}}),
    [](const auto& drawn) { return std::string(drawn.param.law) + "_" + std::to_string(drawn.index); });

}  // namespace
}  // namespace ilaw::testing
