// How long this processor takes for eight numbers, one division, root, product or choice of bits right after
// the other: below it no loop comes that has so many of them (docs/log/loops.md, "What forbids the rest").
// Nothing takes less than a choice of bits, for which all pipes serve.
#include "base/clock.hpp"

#include <algorithm>
#include <cstdio>

namespace {

double seconds() { return ilaw::host::clock_seconds(CLOCK_THREAD_CPUTIME_ID); }

// The fastest of some runs: what disturbs a machine only takes longer.
template <class Work>
double nanoseconds(Work&& work) {
  constexpr int turns = 20000;
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
// Many, lest what is around them is timed, in a short loop: that is where processors take them fastest.
constexpr int at_once = 16 * 64;
__attribute__((target("avx512f"))) void multiply() {
  const eight x = 3.0 - eight{};
  eight y;
  asm volatile("mov $64, %%ecx\n1:\n\t.rept 16\n\tvmulpd %1, %1, %0\n\t.endr\n\tdec %%ecx\n\tjnz 1b"
               : "=&v"(y)
               : "v"(x)
               : "ecx", "cc");
}
__attribute__((target("avx512f"))) void choose_bits() {
  const eight x = 3.0 - eight{};
  eight y;
  asm volatile("mov $64, %%ecx\n1:\n\t.rept 16\n\tvpandq %1, %1, %0\n\t.endr\n\tdec %%ecx\n\tjnz 1b"
               : "=&v"(y)
               : "v"(x)
               : "ecx", "cc");
}
#endif

}  // namespace

int main() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f")) {
    std::printf("division %.2f root %.2f product %.3f bits %.3f ns for eight numbers\n", nanoseconds(divide),
                nanoseconds(take_root), nanoseconds(multiply) / at_once, nanoseconds(choose_bits) / at_once);
    return 0;
  }
#endif
  std::puts("this processor has no vectors of eight doubles");
}
