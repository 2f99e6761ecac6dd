// solver.hpp - the sweeps: mass-split Jacobi over all contacts, Nesterov's acceleration with restart.
//
// One sweep takes trial impulses y to the answers T(y), each law with H of split masses. For contact
// without friction that is a projected gradient step on the energy of the impulses, in a metric that bounds
// it from above, so it converges whatever the number of contacts (Tonge et al. 2012); the next trial is
// T(y_k) + b_k (T(y_k) - T(y_k-1)) with Nesterov's b_k (Mazhar et al. 2015).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "contacts.hpp"

#include <cstdint>
#include <limits>
#include <vector>

namespace ilaw::coupled {

class Solver {
 public:
  // report has been cleared.
  std::int32_t solve(const ilaw_bodies* bodies, const ilaw_contacts* const* groups, std::int64_t group_count,
                     const ilaw_coupled_options& options, ilaw_coupled_report& report);

 private:
  // Why the call is refused, or null.
  const char* open(const ilaw_bodies* bodies, const ilaw_contacts* const* groups, std::int64_t group_count,
                   ilaw_coupled_report& report);
  std::int32_t iterate(const ilaw_coupled_options& options, ilaw_coupled_report& report);
  std::int32_t evaluate(ilaw_coupled_report& report);
  void sum_answers();
  bool counts_changed() const;
  double momentum(bool learn_anew);
  void extrapolate(double by);
  std::int32_t write(ilaw_coupled_report& report);
  bool any_rank(bool here) const;

  const ilaw_exchange* exchange_ = nullptr;
  Bodies bodies_;
  std::vector<Contacts> groups_;
  std::size_t group_count_ = 0;
  std::vector<double> sums_, sums_before_;
  std::vector<Motion> of_answer_, of_before_, of_trial_, difference_;
  double nesterov_ = 1.0;
};

}  // namespace ilaw::coupled
