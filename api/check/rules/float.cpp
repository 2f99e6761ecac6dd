// Rules: the floating-point environment is the host's, and changes no bit.
// SPDX-License-Identifier: BSD-3-Clause
#include "check/rule.hpp"

#include <array>
#include <cfenv>
#include <limits>

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

namespace ilaw::check {
namespace {

// Zeros, tiny, huge and infinite numbers besides those drawn.
Script hostile(const Trial& trial, Draw& draw) {
  constexpr std::array odd{0.0,      -0.0,   5e-324, -1e-310,
                           -3e-308,  -1e300, 1e300,  std::numeric_limits<double>::quiet_NaN(),
                           -infinity};
  Script script = draw_script(trial, draw, {40, 2});
  for (Inputs& in : script)
    for (std::size_t k = 0; k < odd.size(); ++k) {
      in.v_free[(4 * k + 1) * in.dimension] = odd[k];
      in.v_previous[(4 * k + 2) * in.dimension] = odd[k];
      if (!in.v_smooth.empty()) in.v_smooth[4 * k * in.dimension] = odd[k];
      in.gap[4 * k + 3] = odd[k];
    }
  return script;
}

// As run, with the environment set for the calls of the library alone.
class InEnvironment : public Heap {
 public:
  InEnvironment(void (*enter)(), bool (*leave)()) : enter_(enter), leave_(leave) {}
  void before_call() override { enter_(); }
  void after_call() override { kept_ = leave_() && kept_; }
  bool kept() const { return kept_; }

 private:
  void (*enter_)();
  bool (*leave_)();  // back to the usual one; false where it was changed meanwhile
  bool kept_ = true;
};

struct Environment {
  const char* how;
  void (*enter)();
  bool (*leave)();
};

Judge in_environments(const std::vector<Environment>& environments) {
  return on_trials([=](const Trial& trial, Draw& draw) {
    const Script script = hostile(trial, draw);
    const std::vector<Results> expected = run(trial, script);
    for (const auto& [how, enter, leave] : environments) {
      InEnvironment memory(enter, leave);
      const std::vector<Results> found = run(trial, script, {}, &memory);
      if (!memory.kept())
        fail(trial, script[0], 0, joined("evaluate or initialise did not leave ", how, " as it was"),
             "the environment as it was found");
      expect_same(trial, script, expected, found, joined("with ", how));
    }
    return true;
  });
}

const Environment without_flags{"no exception flag", [] { std::feclearexcept(FE_ALL_EXCEPT); },
                                [] { return std::fetestexcept(FE_ALL_EXCEPT) == 0; }};
const Environment with_a_flag{"the flag of division by zero",
                              [] {
                                std::feclearexcept(FE_ALL_EXCEPT);
                                std::feraiseexcept(FE_DIVBYZERO);
                              },
                              [] { return std::fetestexcept(FE_ALL_EXCEPT) == FE_DIVBYZERO; }};

template <int Mode>
Environment rounding(const char* how) {
  return {how, [] { std::fesetround(Mode); },
          [] {
            const bool kept = std::fegetround() == Mode;
            std::fesetround(FE_TONEAREST);
            return kept;
          }};
}

Judge flushing() {
#if defined(__x86_64__)
  constexpr unsigned flush = 0x8040;  // results and operands
  return in_environments({{"subnormal numbers flushed to zero", [] { _mm_setcsr(_mm_getcsr() | flush); },
                           [] {
                             const bool kept = (_mm_getcsr() & flush) == flush;
                             _mm_setcsr(_mm_getcsr() & ~flush);
                             return kept;
                           }}});
#else
  return needing(Needs::motion,
                 [](const Subject&) { throw NotJudged{"this processor's mode is not known"}; });
#endif
}

Judge trapping() {
#if defined(__GLIBC__)
  constexpr int traps = FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW | FE_UNDERFLOW;
  return in_environments({{"exceptions that trap",
                           [] {
                             std::feclearexcept(FE_ALL_EXCEPT);
                             feenableexcept(traps);
                           },
                           [] { return fedisableexcept(FE_ALL_EXCEPT) == traps; }}});
#else
  return needing(Needs::motion, [](const Subject&) { throw NotJudged{"this C library sets no traps"}; });
#endif
}

}  // namespace

std::vector<Rule> float_rules() {
  constexpr const char* source = "ilaw.h, Conventions";
  return {
      {"float-flags", "Exception flags are left as they were.", source,
       in_environments({without_flags, with_a_flag})},
      {"float-rounding", "The rounding mode changes no bit, and stays.", source,
       in_environments(
           {rounding<FE_UPWARD>("rounding upward"), rounding<FE_TOWARDZERO>("rounding toward zero")})},
      {"float-flushing", "Flushing of subnormal numbers changes no bit, and stays.", source, flushing()},
      {"float-traps", "Hosts that trap exceptions get the same bits, and no signal.", source, trapping()}};
}

}  // namespace ilaw::check
