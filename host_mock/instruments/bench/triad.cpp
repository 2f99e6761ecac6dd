// Compiled with -O3 in every mode: a slow triad would make every law look fast.
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/triad.hpp"

namespace ilaw::host {
namespace {

constexpr double factor = 1.5;

using Kernel = void (*)(double* a, const double* b, const double* c, std::size_t size);

[[gnu::always_inline]] inline void triad(double* __restrict a, const double* __restrict b,
                                         const double* __restrict c, std::size_t size) {
  for (std::size_t i = 0; i < size; ++i) a[i] = b[i] + factor * c[i];
}

void triad_anywhere(double* a, const double* b, const double* c, std::size_t size) { triad(a, b, c, size); }
#ifdef __x86_64__
[[gnu::target("avx2")]] void triad_v3(double* a, const double* b, const double* c, std::size_t size) {
  triad(a, b, c, size);
}
[[gnu::target("avx512f")]] void triad_v4(double* a, const double* b, const double* c, std::size_t size) {
  triad(a, b, c, size);
}
#endif

Kernel best_kernel() {
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx512f")) return triad_v4;
  if (__builtin_cpu_supports("avx2")) return triad_v3;
#endif
  return triad_anywhere;
}

}  // namespace

void Triad::run() {
  static const Kernel kernel = best_kernel();
  kernel(a_.data(), b_.data(), c_.data(), a_.size());
}

}  // namespace ilaw::host
