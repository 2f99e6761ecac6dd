// How long the divider of this processor takes for eight numbers, one division or root right after the other:
// below it no loop comes that has so many of them (docs/benchmarks.md, "What forbids the bars").
#include "base/clock.hpp"

#include <algorithm>
#include <cstdio>

namespace {

double seconds() { return ilaw::host::clock_seconds(CLOCK_THREAD_CPUTIME_ID); }

// The fastest of some runs: what disturbs a machine only takes longer.
template <class Work>
double nanoseconds(Work&& work) {
  constexpr int turns = 200000;
  double fastest = 1.0;
  for (int run = 0; run < 20; ++run) {
    const double start = seconds();
    for (int k = 0; k < turns; ++k) work();
    fastest = std::min(fastest, (seconds() - start) / turns);
  }
  return 1e9 * fastest;
}

#if defined(__x86_64__)
using eight = double __attribute__((vector_size(64)));

__attribute__((target("avx512f"))) void divide() {
  const eight x = 3.0 - eight{};
  eight y;
  asm volatile("vdivpd %1, %1, %0" : "=v"(y) : "v"(x));
}
__attribute__((target("avx512f"))) void take_root() {
  const eight x = 3.0 - eight{};
  eight y;
  asm volatile("vsqrtpd %1, %0" : "=v"(y) : "v"(x));
}
#endif

}  // namespace

int main() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f")) {
    std::printf("division %.2f root %.2f ns for eight numbers\n", nanoseconds(divide),
                nanoseconds(take_root));
    return 0;
  }
#endif
  std::puts("this processor has no vectors of eight doubles");
}
