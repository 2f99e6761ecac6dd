// The floating-point environment of the host: left as it was found, and of no influence on the result.
#include "batch_runner.hpp"

#include "support/law_batch.hpp"
#include "support/law_cases.hpp"

#include <cfenv>
#include <functional>

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

namespace ilaw::testing {
namespace {

// With what divides by zero, overflows and makes NaN on the way.

// Velocities and gaps that are zero, tiny, huge or NaN, besides those drawn.
Nodes hostile_nodes(std::int64_t count, int components) {
  Nodes nodes(count, 3, components);
  const double odd[] = {0.0, -0.0, 5e-324, -1e-310, -3e-308, -1e300, 1e300, std::nan(""), -INFINITY};
  for (std::size_t k = 0; k < 9; ++k)
    for (std::size_t c = 0; c < 3; ++c) {
      nodes.v_free[3 * (7 * k + 2) + c] = odd[(k + c) % 9];
      nodes.v_previous[3 * (7 * k + 3) + c] = odd[(k + 2 * c) % 9];
      nodes.gap[7 * k + 4] = odd[k];
    }
  return nodes;
}

// initialise and two steps, with nothing but calls of the law in between.
LawBatch outcome_of(const ilaw::interface& law, const Nodes& nodes) {
  LawBatch out(law, static_cast<std::size_t>(nodes.count));
  ilaw_batch b = out.batch();
  b.v_free = ilaw::input(nodes.v_free.data(), 3, 1);
  b.v_previous = ilaw::input(nodes.v_previous.data(), 3, 1);
  b.delassus = ilaw::input(nodes.delassus.data(), nodes.hc, 1);
  b.gap = ilaw::input(nodes.gap.data(), 1, 1);
  b.area = ilaw::input(nodes.area.data(), 1, 1);
  law.initialise(b);
  law.evaluate(b);
  b.time = 1e-3;
  law.evaluate(b);
  return out;
}

void for_all_laws(const std::function<void(const ilaw::interface&, const Nodes&)>& check) {
  for (const LawCase& served : law_cases("environment")) {
    SCOPED_TRACE(served.law);
    const std::uint32_t form = form_of(served);
    const SetupBuilder setup(served.parameters, 3, form);
    const ilaw::interface law = make_law(served.law, setup);
    check(law, hostile_nodes(200, form == ILAW_DELASSUS_FULL ? 6 : form == ILAW_DELASSUS_DIAGONAL ? 3 : 1));
  }
}

TEST(FloatEnvironment, FlagsAreLeftAsTheyWere) {
  for_all_laws([](const ilaw::interface& law, const Nodes& nodes) {
    for (const int flags : {0, int{FE_DIVBYZERO}, FE_INEXACT | FE_UNDERFLOW}) {
      std::feclearexcept(FE_ALL_EXCEPT);
      std::feraiseexcept(flags);
      const int before = std::fetestexcept(FE_ALL_EXCEPT);
      outcome_of(law, nodes);
      const int after = std::fetestexcept(FE_ALL_EXCEPT);
      EXPECT_EQ(after, before) << "flags " << flags;
    }
    std::feclearexcept(FE_ALL_EXCEPT);
  });
}

TEST(FloatEnvironment, RoundingModeDoesNotMatterAndStays) {
  for_all_laws([](const ilaw::interface& law, const Nodes& nodes) {
    const LawBatch nearest = outcome_of(law, nodes);
    for (const int mode : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
      std::fesetround(mode);
      const LawBatch found = outcome_of(law, nodes);
      const int after = std::fegetround();
      std::fesetround(FE_TONEAREST);
      EXPECT_EQ(after, mode) << "mode " << mode;
      EXPECT_TRUE(found == nearest) << mode;
    }
  });
}

#if defined(__x86_64__)
TEST(FloatEnvironment, FlushingToZeroDoesNotMatterAndStays) {
  constexpr unsigned flush_to_zero = 0x8000, subnormals_are_zero = 0x0040;
  for_all_laws([](const ilaw::interface& law, const Nodes& nodes) {
    const LawBatch expected = outcome_of(law, nodes);
    const unsigned host = _mm_getcsr(), flushing = host | flush_to_zero | subnormals_are_zero;
    _mm_setcsr(flushing);
    const LawBatch found = outcome_of(law, nodes);
    const unsigned after = _mm_getcsr();
    _mm_setcsr(host);
    EXPECT_EQ(after, flushing);
    EXPECT_TRUE(found == expected);
  });
}
#endif

#if defined(__GLIBC__)
// As gfortran -ffpe-trap=invalid,zero,overflow,underflow: an exception inside a law would end the program.
TEST(FloatEnvironment, HostsThatTrapLive) {
  for_all_laws([](const ilaw::interface& law, const Nodes& nodes) {
    const LawBatch expected = outcome_of(law, nodes);
    std::feclearexcept(FE_ALL_EXCEPT);
    feenableexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW | FE_UNDERFLOW);
    const LawBatch found = outcome_of(law, nodes);
    const int trapping = fedisableexcept(FE_ALL_EXCEPT);
    EXPECT_EQ(trapping, FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW | FE_UNDERFLOW);
    EXPECT_TRUE(found == expected);
  });
}
#endif

}  // namespace
}  // namespace ilaw::testing
