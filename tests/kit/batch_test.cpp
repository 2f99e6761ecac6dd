// The contract of evaluate where `ilaw check` does not reach: the same bits at all levels of instructions, in
// batches of any size, and beside nodes that are solved in another way.
#include "kit_probe.hpp"
#include "mixed_nodes.hpp"

#include "support/law_cases.hpp"

#include <numeric>

namespace ilaw::testing {
namespace {

// From some thousand nodes on, arrays are asked for ahead, and blocks are worked on in pieces.
constexpr std::size_t large = 16384 + 64 + 21, small = 3 * 128 + 21;

std::vector<std::int32_t> shuffled(std::size_t count) {
  std::vector<std::int32_t> order(count);
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937(7));
  return order;
}

void expect_same_motion(const MixedNodes& found, const MixedNodes& expected) {
  EXPECT_TRUE(same_bits(found.r, expected.r) && same_bits(found.state, expected.state));
}

class Contract : public ::testing::TestWithParam<LawCase> {
 protected:
  static ilaw::interface make(std::uint32_t frame, std::uint32_t form = ILAW_DELASSUS_SCALAR,
                              std::uint32_t d = 3) {
    return make_tested_law(GetParam().law, SetupBuilder(GetParam().parameters, d, form, frame));
  }
};

// In all dimensions and forms of H that the law serves, whether it has a solution for all of these H or
// refuses some.
TEST_P(Contract, AnyBatchAndInstructionSetGivesTheSameBits) {
  const std::uint32_t forms = make(ILAW_FRAME_LOCAL).law().delassus_forms;
  for (const std::uint32_t d : {1U, 2U, 3U})
    for (const std::uint32_t form :
         {ILAW_DELASSUS_SCALAR, ILAW_DELASSUS_DIAGONAL, ILAW_DELASSUS_FULL, ILAW_DELASSUS_TRANSVERSE})
      for (const std::uint32_t frame : {ILAW_FRAME_LOCAL, ILAW_FRAME_GLOBAL}) {
        if (!(forms & form)) continue;
        SCOPED_TRACE(::testing::Message() << "d " << d << ", form " << form << ", frame " << frame);
        const std::size_t count = d == 3 && form == ILAW_DELASSUS_SCALAR ? large : small;
        const MixedNodes nodes(make(frame, form, d), count, d, form == ILAW_DELASSUS_FULL),
            listed = nodes.stepped({.order = shuffled(count)});
        EXPECT_TRUE(nodes.stepped() == listed);
        MixedNodes motion = nodes.stepped({.energy = false});
        motion.energy = listed.energy;
        EXPECT_TRUE(motion == listed);
        expect_same_motion(nodes.stepped({.outputs = false}), listed);
        for (const char* level : {"baseline", "v3", "v4"}) {
          setenv("ILAW_ISA", level, 1);
          EXPECT_TRUE(MixedNodes(make(frame, form, d), count, d, form == ILAW_DELASSUS_FULL).stepped() ==
                      listed)
              << level;
        }
        unsetenv("ILAW_ISA");
      }
}

// Rows of more nodes than caches hold are worked on in other blocks than those of fewer.
class ManyRows : public Contract {};
TEST_P(ManyRows, GiveTheBitsOfListedNodes) {
  constexpr std::size_t count = 131072 + 64 + 21;
  const MixedNodes nodes(make(ILAW_FRAME_LOCAL), count);
  const std::vector<std::int32_t> order = shuffled(count);
  for (const bool outputs : {false, true})
    expect_same_motion(nodes.stepped({.outputs = outputs, .energy = false}),
                       nodes.stepped({.order = order, .outputs = outputs, .energy = false}));
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
