// parallel.hpp - loops over many items in chunks, which threads share. The chunks do not
// depend on the number of threads, so that sums by chunks do not either.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <omp.h>

#include <algorithm>
#include <cstddef>
#include <exception>

namespace ilaw::host {

#ifdef ILAW_HOSTILE
inline constexpr bool is_hostile = true;
#else
inline constexpr bool is_hostile = false;
#endif

// Items of a chunk. With ILAW_HOSTILE they are few, so that small models have several chunks; whole nodes and
// packs all the same.
constexpr std::ptrdiff_t chunk_of(std::ptrdiff_t usual) { return is_hostile && usual > 24 ? 24 : usual; }

constexpr std::ptrdiff_t chunks_of(std::ptrdiff_t count, std::ptrdiff_t chunk) {
  return (count + chunk - 1) / chunk;
}

// Calls f(c, first, end) for the items of each chunk c; what f throws first on any thread is thrown here. A
// single chunk, and all of them where there is one thread, are a plain loop: a parallel region costs 300 ns,
// and one whose `if` is false as well.
template <class F>
void for_each_chunk(std::ptrdiff_t count, std::ptrdiff_t chunk, F f) {
  const std::ptrdiff_t chunks = chunks_of(count, chunk);
  if (chunks < 2 || omp_get_max_threads() == 1) {
    for (std::ptrdiff_t c = 0; c < chunks; ++c) f(c, c * chunk, std::min(count, (c + 1) * chunk));
    return;
  }
  std::exception_ptr failure;
#pragma omp parallel for schedule(static)
  for (std::ptrdiff_t c = 0; c < chunks; ++c) try {
      f(c, c * chunk, std::min(count, (c + 1) * chunk));
    } catch (...) {
#pragma omp critical(ilaw_failure)
      if (!failure) failure = std::current_exception();
    }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace ilaw::host
