// The contract of evaluate where `ilaw check` does not reach: the same bits at all levels of instructions, in
// batches of any size, and beside nodes that are solved in another way.
#include "batch_runner.hpp"
#include "kit_probe.hpp"

#include "support/law_cases.hpp"

#include <numeric>

namespace ilaw::testing {
namespace {

class Contract : public ::testing::TestWithParam<LawCase> {
 protected:
  ilaw::interface make(std::uint32_t frame, std::uint32_t form = ILAW_DELASSUS_SCALAR,
                       std::uint32_t d = 3) const {
    return make_tested_law(GetParam().law, SetupBuilder(GetParam().parameters, d, form, frame));
  }
};

// In all dimensions and forms of H that the law serves, whether it has a solution for all of these H or
// refuses some.
TEST_P(Contract, EveryFormOfHGivesTheSameBitsInAllLayoutsAndInstructionSets) {
  const ilaw::interface any = make(ILAW_FRAME_LOCAL);
  for (const int d : {1, 2, 3})
    for (const auto& [form, components] : {std::pair{ILAW_DELASSUS_SCALAR, 1},
                                           {ILAW_DELASSUS_DIAGONAL, d},
                                           {ILAW_DELASSUS_FULL, d * (d + 1) / 2},
                                           {ILAW_DELASSUS_TRANSVERSE, 2}})
      for (const std::uint32_t frame : {ILAW_FRAME_LOCAL, ILAW_FRAME_GLOBAL}) {
        if (!(any.law().delassus_forms & static_cast<std::uint32_t>(form))) continue;
        SCOPED_TRACE(::testing::Message() << "d " << d << ", form " << form << ", frame " << frame);
        const bool global = frame == ILAW_FRAME_GLOBAL;
        const auto made = [&, form_of_h = static_cast<std::uint32_t>(form)] {
          return make(frame, form_of_h, static_cast<std::uint32_t>(d));
        };
        const Nodes nodes(270, d, components);
        std::vector<std::int32_t> order(270);
        std::iota(order.begin(), order.end(), 0);
        std::shuffle(order.begin(), order.end(), std::mt19937(7));
        const ilaw::interface law = made();
        const Results reference = run(law, nodes, {}, global);
        EXPECT_TRUE(run(law, nodes, {.soa = true}, global) == reference);
        EXPECT_TRUE(run(law, nodes, {.separate_state = true, .order = order}, global) == reference);
        EXPECT_EQ(run(law, nodes, {.outputs = false}, global).impulse, reference.impulse);
        Results motion = run(law, nodes, {.energy = false}, global);
        motion.energy = reference.energy;
        EXPECT_TRUE(motion == reference);
        for (const char* level : {"baseline", "v3", "v4"}) {
          setenv("ILAW_ISA", level, 1);
          EXPECT_TRUE(run(made(), nodes, {}, global) == reference) << level;
        }
        unsetenv("ILAW_ISA");
      }
}

// Laws that try the usual step first: motions that turned round within the step are met in some blocks, and
// not in others.
TEST_P(Contract, NodesThatAreNotUsualChangeNoOther) {
  for (const std::uint32_t frame : {ILAW_FRAME_LOCAL, ILAW_FRAME_GLOBAL}) {
    const ilaw::interface law = make(frame);
    Nodes nodes(1000);
    const std::vector<double> other = nodes.v_previous;
    nodes.v_previous = nodes.v_free;
    for (const std::size_t i : {5, 200, 201, 930})
      for (std::size_t c = 3 * i; c < 3 * i + 3; ++c) nodes.v_previous[c] = 2.0 * other[c] - nodes.v_free[c];
    const bool global = frame == ILAW_FRAME_GLOBAL;
    for (const std::size_t i : {18, 403}) {  // which close within the step
      nodes.gap[i] = 1e-6;
      for (std::size_t c = 0; c < 3; ++c)
        nodes.v_free[3 * i + c] = nodes.v_previous[3 * i + c] =
            global ? -nodes.normal[3 * i + c] : (c == 0 ? -1.0 : 0.0);
    }
    const Results in_full = run(law, nodes, {}, global);  // as it is where energies are asked for
    for (const bool soa : {false, true})
      for (const bool separate_state : {false, true}) {
        Results tried =
            run(law, nodes, {.soa = soa, .separate_state = separate_state, .energy = false}, global);
        tried.energy = in_full.energy;
        EXPECT_TRUE(tried == in_full) << "frame " << frame << ", SoA " << soa << ", apart " << separate_state;
        const Results alone =
            run(law, nodes, {.soa = soa, .separate_state = separate_state, .outputs = false}, global);
        EXPECT_TRUE(alone.impulse == in_full.impulse && alone.state == in_full.state)
            << "without outputs, frame " << frame << ", SoA " << soa << ", apart " << separate_state;
      }
  }
}

// Blocks of nodes out of reach may take a shorter way. Here they do, and among others they do not: two blocks
// in flight, in the second one node that closes within the step, then two that touch.
TEST_P(Contract, NodesInFlightGetWhatTheyGetAmongOthers) {
  constexpr std::size_t block = 128, n = 4 * block, closing = block + 5, bad = 7;
  std::vector<std::int32_t> mixed(n);
  for (std::size_t i = 0; i < n; ++i) mixed[i] = static_cast<std::int32_t>(i % 4 * block + i / 4);
  for (const std::uint32_t frame : {ILAW_FRAME_LOCAL, ILAW_FRAME_GLOBAL})
    for (const auto& [form, components] :
         {std::pair{ILAW_DELASSUS_SCALAR, 1}, {ILAW_DELASSUS_DIAGONAL, 3}, {ILAW_DELASSUS_FULL, 6}}) {
      const bool global = frame == ILAW_FRAME_GLOBAL;
      if (!(make(frame).law().delassus_forms & static_cast<std::uint32_t>(form))) continue;
      const ilaw::interface law = make(frame, static_cast<std::uint32_t>(form));
      Nodes nodes(n, 3, components);
      std::fill_n(nodes.gap.begin(), 2 * block, 0.5);
      nodes.gap[closing] = 1e-6;
      for (std::size_t c = 0; c < 3; ++c)
        nodes.v_free[3 * closing + c] = global ? -nodes.normal[3 * closing + c] : (c == 0 ? -1.0 : 0.0);
      nodes.v_previous[3 * bad] = std::numeric_limits<double>::quiet_NaN();
      for (Layout apart :
           {Layout{}, Layout{.energy = false}, Layout{.outputs = false}, Layout{.soa = true}}) {
        const Results alone = run(law, nodes, apart, global);
        apart.order = mixed;
        EXPECT_TRUE(run(law, nodes, apart, global) == alone)
            << "frame " << frame << ", form " << form << ", outputs " << apart.outputs << apart.energy;
      }
    }
}

// From some thousand nodes on, arrays are asked for ahead, and blocks are worked on in pieces.
TEST_P(Contract, LargeBatchesGiveTheBitsOfListedNodes) {
  constexpr std::int64_t n = 16384 + 64 + 21;
  std::vector<std::int32_t> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), 0);
  for (const std::uint32_t frame : {ILAW_FRAME_LOCAL, ILAW_FRAME_GLOBAL}) {
    const ilaw::interface law = make(frame);
    const Nodes nodes(n);
    const bool global = frame == ILAW_FRAME_GLOBAL;
    const Results listed = run(law, nodes, {.order = order}, global);
    EXPECT_TRUE(run(law, nodes, {}, global) == listed) << "frame " << frame;
    EXPECT_TRUE(run(law, nodes, {.soa = true, .separate_state = true}, global) == listed)
        << "SoA, frame " << frame;
  }
}

// Rows of more nodes than caches hold are worked on in other blocks than those of fewer.
class ManyRows : public Contract {};
TEST_P(ManyRows, GiveTheBitsOfListedNodes) {
  constexpr std::int64_t n = 131072 + 64 + 21;
  std::vector<std::int32_t> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), 0);
  const ilaw::interface law = make(ILAW_FRAME_LOCAL);
  const Nodes nodes(n);
  for (const bool outputs : {false, true})
    EXPECT_TRUE(run(law, nodes, {.outputs = outputs, .energy = false}, false) ==
                run(law, nodes, {.outputs = outputs, .energy = false, .order = order}, false))
        << "outputs " << outputs;
}
INSTANTIATE_TEST_SUITE_P(Laws, ManyRows,
                         ::testing::Values(LawCase{"tie", "tie", {}, {}},
                                           LawCase{"penalty", "penalty", {{{"stiffness", 1e6}}, {}}, {}}),
                         name_of_case);

INSTANTIATE_TEST_SUITE_P(Laws, Contract, ::testing::ValuesIn(law_cases("contract")), name_of_case);
const LawCase laws_of_contract[] = {{"kit_probe", "kit_probe", probe_parameters, {}},
                                    {"pack_probe", "pack_probe", probe_parameters, {}},
                                    {"solver_probe", "solver_probe", {}, {}},
                                    {"tie", "tie_that_cannot_break", {}, {}}};
INSTANTIATE_TEST_SUITE_P(Kit, Contract, ::testing::ValuesIn(laws_of_contract), name_of_case);

}  // namespace
}  // namespace ilaw::testing
