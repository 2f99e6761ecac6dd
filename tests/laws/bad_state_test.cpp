// What a step reads of the state of a window, and a clock that was set back. A state that a law cannot have
// written is for `ilaw check` (foreign-state).
#include "support/law_runner.hpp"

#include <cstring>
#include <functional>
#include <ostream>

namespace ilaw::testing {
namespace {

constexpr const char* set_back = "the time lies before what the state remembers";

// Three nodes side by side.
class Trio : public NodeRun {
 public:
  Trio(const std::string& law, const Parameters& parameters)
      : NodeRun(law, parameters, 1e-3), size(state.size()), memory(2 * guard + 3 * size, 0.125) {
    for (std::size_t i = 0; i < 3; ++i) std::memcpy(of(i), state.data(), size * sizeof(double));
    for (int k = 1; k <= 60; ++k) advance();
  }

  std::int32_t advance() {
    time += dt;
    return evaluate();
  }
  std::int32_t evaluate() {
    v_free = {2e-3, 1e-3, -1e-3};
    ilaw_batch b = batch();
    b.node_count = 3;
    const auto width = static_cast<std::int64_t>(size);
    b.state_in = ilaw::input(of(0), width, 1);
    b.state_out = ilaw::output(of(0), width, 1);
    b.impulse = ilaw::output(impulse.data(), 3, 1);
    b.status = statuses.data();
    b.status_stride = 1;
    report.struct_size = sizeof report;
    return interface.evaluate(b, &report);
  }
  double* of(std::size_t node) { return memory.data() + guard + node * size; }

  static constexpr std::size_t guard = 200;
  std::size_t size;
  std::vector<double> memory;
  std::array<double, 9> impulse{};
  std::array<std::uint8_t, 3> statuses{};
};

struct Kind {
  const char* name;
  const char* law;
  Parameters parameters;

  friend void PrintTo(const Kind& kind, std::ostream* out) { *out << kind.name; }
};

class BadState : public ::testing::TestWithParam<Kind> {};

// A step judges what it reads of a window (abi.md, State): NaN in any slot is refused in the end, or written
// over, and no impulse before depends on it. Over more than two memories, so that every slot has had its
// turn.
TEST_P(BadState, ThatIsNotReadChangesNoImpulse) {
  const auto run_on = [](Trio& trio, auto look) {
    for (int k = 0; k < 100 && look(trio.advance()); ++k) continue;
  };
  Trio trio(GetParam().law, GetParam().parameters);
  const std::vector<double> start = trio.memory;
  const double begin = trio.time;
  std::vector<std::array<double, 9>> sound;
  run_on(trio, [&](std::int32_t) { return sound.push_back(trio.impulse), true; });
  std::size_t late = 0;
  for (std::size_t entry = 0; entry < trio.size; ++entry) {
    trio.memory = start;
    trio.time = begin;
    trio.of(1)[entry] = nan_value;
    std::size_t step = 0;
    run_on(trio, [&](std::int32_t code) {
      if (code == ILAW_OK) {
        EXPECT_EQ(trio.impulse, sound[step]) << "double " << entry << ", step " << step;
      }
      return code == ILAW_OK && !HasFailure() && ++step < sound.size();
    });
    if (step > 0) ++late;
    ASSERT_FALSE(HasFailure()) << "entry " << entry;
  }
  EXPECT_GT(late, 0U) << "every slot was read at once: nothing was tested";
}

TEST_P(BadState, OfAClockSetBackIsRefused) {
  Trio trio(GetParam().law, GetParam().parameters);
  trio.time -= 0.03;
  EXPECT_EQ(trio.evaluate(), ILAW_BAD_NODES);
  EXPECT_EQ(trio.report.bad_count, 3);
  EXPECT_STREQ(trio.report.reason, set_back);
}

const Parameters postit_parameters{{{"initial_adhesion", 10.0}, {"memory", 0.04}}, {}},
    tie_parameters{{{"strength", 10.0}, {"memory", 0.04}}, {}};

INSTANTIATE_TEST_SUITE_P(Laws, BadState,
                         ::testing::Values(Kind{"postit", "postit", postit_parameters},
                                           Kind{"tie", "tie", tie_parameters}),
                         [](const auto& drawn) { return drawn.param.name; });

// The size of a state depends on the parameters alone, so that it survives a restart with another step.
TEST(StateSize, DoesNotDependOnTheStep) {
  for (const char* law : {"postit", "tie"})
    for (const double memory : {0.0, 0.04, inf_value}) {
      const Parameters parameters{{{"memory", memory}}, {}};
      std::vector<std::uint64_t> sizes;
      for (const double step : {1e-9, 1e-3, 10.0})
        sizes.push_back(NodeRun(law, parameters, step).interface.info().state_size);
      EXPECT_EQ(sizes[0], sizes[1]) << law << " " << memory;
      EXPECT_EQ(sizes[0], sizes[2]) << law << " " << memory;
    }
}

}  // namespace
}  // namespace ilaw::testing
