// The triad of STREAM, a = b + s c, in the place of a law's kernel.
#include "triad.hpp"

extern "C" __attribute__((global)) void ilaw_triad(ilaw::testing::Triad t) {
  const std::int64_t i = ilaw::kit::detail::thread_number();
  if (i < t.count) t.a[i] = t.b[i] + t.s * t.c[i];
}
