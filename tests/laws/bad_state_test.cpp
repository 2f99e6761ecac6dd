// A state that the law cannot have written, and a clock that was set back: refused at their node with the
// reason, nothing touched but that node's results. For the laws with a window.
#include "support/law_runner.hpp"

#include <cstring>
#include <functional>
#include <ostream>

namespace ilaw::testing {
namespace {

constexpr const char* set_back = "the time lies before what the state remembers";

// Three nodes side by side, their states between guards.
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

class BadState : public ::testing::TestWithParam<Kind> {
 protected:
  // A step with node 1 spoilt: everything of the others must be as it is when nothing is.
  static void expect_contained(Trio& trio, const std::vector<double>& sound, const std::string& what) {
    const std::vector<double> before = trio.memory;
    const std::int32_t code = trio.advance();
    const std::size_t begin = Trio::guard + trio.size, end = begin + trio.size;
    for (std::size_t k = 0; k < trio.memory.size(); ++k) {
      if (k < begin || k >= end) {
        ASSERT_EQ(trio.memory[k], sound[k]) << what << ", double " << k;
      }
    }
    for (const double r : trio.impulse) ASSERT_TRUE(std::isfinite(r)) << what;
    if (code == ILAW_OK) return;
    ASSERT_EQ(code, ILAW_BAD_NODES) << what;
    ASSERT_EQ(trio.report.first_bad_node, 1) << what;
    ASSERT_EQ(trio.statuses[1], ILAW_BAD_INPUT) << what;
    for (std::size_t c = 3; c < 6; ++c) ASSERT_EQ(trio.impulse[c], 0.0) << what;
    ASSERT_EQ(std::memcmp(&trio.memory[begin], &before[begin], trio.size * sizeof(double)), 0) << what;
  }
};

// Any double of the state as any number: bad input or a finite impulse.
TEST_P(BadState, HarmsNothingElse) {
  Trio trio(GetParam().law, GetParam().parameters);
  const std::vector<double> start = trio.memory;
  const double begin = trio.time;
  ASSERT_EQ(trio.advance(), ILAW_OK);
  const std::vector<double> sound = trio.memory;
  for (std::size_t entry = 0; entry < trio.size; ++entry)
    for (const double value :
         {nan_value, inf_value, -inf_value, 1e300, -1e300, 1e18, -1e18, 4096.0, -17.0, 0.5, -0.5, 1e-310}) {
      trio.memory = start;
      trio.time = begin;
      trio.of(1)[entry] = value;
      expect_contained(trio, sound, "double " + std::to_string(entry) + " = " + std::to_string(value));
      if (HasFatalFailure()) return;
    }
}

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

struct Impossible {
  const char* law;
  std::size_t entry;
  double value;
};

// Named state: adhesion, ruptures, grace of postit; broken of tie; then the number of the newest bucket.
TEST(ImpossibleState, IsRefusedWithItsReason) {
  for (const auto& [law, entry, value] : {Impossible{"postit", 0, -1e-3},
                                          {"postit", 1, -1.0},
                                          {"postit", 1, 0.5},
                                          {"postit", 2, -1e-3},
                                          {"postit", 3, 0.5},
                                          {"postit", 3, nan_value},
                                          {"postit", 3, inf_value},
                                          {"postit", 3, -1e300},
                                          {"postit", 4, nan_value},
                                          {"postit", 6, inf_value},
                                          {"tie", 0, 0.5},
                                          {"tie", 0, -1.0},
                                          {"tie", 1, 2.5},
                                          {"tie", 1, nan_value},
                                          {"tie", 2, nan_value}}) {
    Trio trio(law, law == std::string("tie") ? tie_parameters : postit_parameters);
    trio.of(1)[entry] = value;
    EXPECT_EQ(trio.evaluate(), ILAW_BAD_NODES) << law << " " << entry << " " << value;
    EXPECT_EQ(trio.report.bad_count, 1) << law << " " << entry << " " << value;
    EXPECT_THAT(std::string(trio.report.reason), HasSubstr("have written"))
        << law << " " << entry << " " << value << ": " << trio.report.reason;
  }
}

// The number of a bucket in the future is a clock that was set back.
TEST(ImpossibleState, OfTheFutureIsATimeThatLiesBefore) {
  Trio trio("postit", postit_parameters);
  trio.of(1)[3] += 100.0;
  EXPECT_EQ(trio.evaluate(), ILAW_BAD_NODES);
  EXPECT_STREQ(trio.report.reason, set_back);
}

TEST(ImpossibleState, OfAnUnbreakableTieIsRefused) {
  Trio trio("tie", {});
  trio.of(1)[0] = 0.5;
  EXPECT_EQ(trio.evaluate(), ILAW_BAD_NODES);
  EXPECT_STREQ(trio.report.reason, "state variable 'broken' has a value that the law cannot have written");
}

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
