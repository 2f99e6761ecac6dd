// Rules: the floating-point environment is the host's, and changes no bit.
// SPDX-License-Identifier: BSD-3-Clause
#include "check/rule.hpp"

#include <array>
#include <cfenv>
#include <cmath>
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

void in_environment(const Subject& subject, void (*enter)(), bool (*leave)(), const char* how) {
  for_trials(subject, [&](const Trial& trial, Draw& draw) {
    const Script script = hostile(trial, draw);
    const std::vector<Results> expected = run(trial, script);
    InEnvironment memory(enter, leave);
    const std::vector<Results> found = run(trial, script, {}, memory);
    if (!memory.kept())
      fail(trial, script[0], 0, std::string("evaluate or initialise did not leave ") + how + " as it was",
           "the environment as it was found");
    expect_same(trial, script, expected, found, std::string("with ") + how);
    return true;
  });
}

void flags(const Subject& subject) {
  in_environment(
      subject, [] { std::feclearexcept(FE_ALL_EXCEPT); },
      [] { return std::fetestexcept(FE_ALL_EXCEPT) == 0; }, "no exception flag");
  in_environment(
      subject,
      [] {
        std::feclearexcept(FE_ALL_EXCEPT);
        std::feraiseexcept(FE_DIVBYZERO);
      },
      [] { return std::fetestexcept(FE_ALL_EXCEPT) == FE_DIVBYZERO; }, "the flag of division by zero");
}

template <int Mode>
void in_mode(const Subject& subject, const char* how) {
  in_environment(
      subject, [] { std::fesetround(Mode); },
      [] {
        const bool kept = std::fegetround() == Mode;
        std::fesetround(FE_TONEAREST);
        return kept;
      },
      how);
}

void rounding(const Subject& subject) {
  in_mode<FE_UPWARD>(subject, "rounding upward");
  in_mode<FE_TOWARDZERO>(subject, "rounding toward zero");
}

void flushing(const Subject& subject) {
#if defined(__x86_64__)
  constexpr unsigned flush = 0x8040;  // results and operands
  in_environment(
      subject, [] { _mm_setcsr(_mm_getcsr() | flush); },
      [] {
        const bool kept = (_mm_getcsr() & flush) == flush;
        _mm_setcsr(_mm_getcsr() & ~flush);
        return kept;
      },
      "subnormal numbers flushed to zero");
#else
  static_cast<void>(subject);
  throw NotJudged{"this processor's mode is not known"};
#endif
}

void trapping(const Subject& subject) {
#if defined(__GLIBC__)
  constexpr int traps = FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW | FE_UNDERFLOW;
  in_environment(
      subject,
      [] {
        std::feclearexcept(FE_ALL_EXCEPT);
        feenableexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW | FE_UNDERFLOW);
      },
      [] { return fedisableexcept(FE_ALL_EXCEPT) == traps; }, "exceptions that trap");
#else
  static_cast<void>(subject);
  throw NotJudged{"this C library sets no traps"};
#endif
}

}  // namespace

std::vector<Rule> float_rules() {
  constexpr const char* source = "ilaw.h, Conventions";
  return {{"float-flags", "Exception flags are left as they were.", source, Needs::motion, flags},
          {"float-rounding", "The rounding mode changes no bit, and stays.", source, Needs::motion, rounding},
          {"float-flushing", "Flushing of subnormal numbers changes no bit, and stays.", source,
           Needs::motion, flushing},
          {"float-traps", "Hosts that trap exceptions get the same bits, and no signal.", source,
           Needs::motion, trapping}};
}

}  // namespace ilaw::check
