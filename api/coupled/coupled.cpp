// The functions of coupled.h: structs of any version in, no exception out.
// SPDX-License-Identifier: BSD-3-Clause
#include "sizes.hpp"
#include "solver.hpp"

#include <atomic>
#include <new>
#include <stdexcept>

struct ilaw_coupled {
  ilaw::coupled::Solver solver;
  std::atomic_flag is_in_use;
};

ilaw_coupled* ILAW_CALL ilaw_coupled_create(void) { return new (std::nothrow) ilaw_coupled; }

void ILAW_CALL ilaw_coupled_destroy(ilaw_coupled* solver) { delete solver; }

ilaw_result ILAW_CALL ilaw_coupled_solve(ilaw_coupled* solver, const ilaw_bodies* bodies,
                                         const ilaw_contacts* const* groups, int64_t group_count,
                                         const ilaw_coupled_options* options, ilaw_coupled_report* report) {
  using namespace ilaw;
  if (!solver || (report && !sized::cleared(report)) || (options && !sized::is_complete(options)))
    return ILAW_INVALID_ARGUMENT;
  const ilaw_coupled_options asked = options ? sized::read(options) : ilaw_coupled_options{};
  if (asked.exchange && !sized::is_complete(asked.exchange)) return ILAW_INVALID_ARGUMENT;
  if (asked.pool && !sized::is_complete(asked.pool)) return ILAW_INVALID_ARGUMENT;
  ilaw_coupled_report said{};
  const auto refuse = [&](const char* reason) {
    said.bad_group = said.bad_contact = -1;
    said.reason = reason;
    if (report) sized::write(report, said);
    return ILAW_INVALID_ARGUMENT;
  };
  if (asked.pool && !asked.pool->run) return refuse("the function of the pool is null");
  if (asked.exchange && !(asked.exchange->sum_bodies && asked.exchange->largest && asked.exchange->sum))
    return refuse("a function of the exchange is null");
  if (solver->is_in_use.test_and_set(std::memory_order_acquire))
    return refuse("another thread's call uses the solver; give each thread its own");
  int32_t code = ILAW_OUT_OF_MEMORY;
  try {
    code = solver->solver.solve(bodies, groups, group_count, asked, said);
  } catch (const std::bad_alloc&) {
    said.reason = "out of memory";
  } catch (const std::length_error&) {
    said.reason = "out of memory";
  }
  solver->is_in_use.clear(std::memory_order_release);
  if (report) sized::write(report, said);
  return code;
}
