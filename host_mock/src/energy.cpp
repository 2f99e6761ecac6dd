// SPDX-License-Identifier: BSD-3-Clause
#include "energy.hpp"

#include <algorithm>
#include <cmath>

namespace ilaw::host {
namespace {

long double kinetic_energy(const Model& model, const Dofs& v) {
  long double twice = 0;
  for (Eigen::Index i = 0; i < v.size(); ++i)
    twice += static_cast<long double>(model.mass()[i]) * v[i] * v[i];
  return twice / 2;
}

long double work(const Dofs& impulse, const Dofs& v_before, const Dofs& v_after) {
  long double twice = 0;
  for (Eigen::Index i = 0; i < impulse.size(); ++i)
    twice += static_cast<long double>(impulse[i]) * (static_cast<long double>(v_before[i]) + v_after[i]);
  return twice / 2;
}

}  // namespace

void EnergyBalance::start(const Model& model, const Dofs& u, const Dofs& u_next, const Dofs& v) {
  initial_ = kinetic_energy(model, v) + model.internal_energy(u, u_next);
  largest_ = std::abs(static_cast<double>(initial_));
}

void EnergyBalance::add_step(const Dofs& v_before, const Dofs& v_after, const Dofs& external,
                             const Dofs& interface) {
  external_work_ += work(external, v_before, v_after);
  interface_work_ += work(interface, v_before, v_after);
  largest_ = std::max({largest_, std::abs(static_cast<double>(external_work_)),
                       std::abs(static_cast<double>(interface_work_))});
}

void EnergyBalance::add_dissipation(int part, double energy) {
  by_law_[static_cast<std::size_t>(part)] += energy;
  least_dissipation_ = std::min(least_dissipation_, energy);
}

EnergyReport EnergyBalance::report(const Model& model, const Dofs& u, const Dofs& u_next,
                                   const Dofs& v) const {
  const long double kinetic = kinetic_energy(model, v);
  const double internal = model.internal_energy(u, u_next);
  const long double open = kinetic + internal - initial_ - external_work_ - interface_work_;
  const double scale = std::max({largest_, static_cast<double>(kinetic), std::abs(internal)});
  EnergyReport report{};
  report.kinetic = static_cast<double>(kinetic);
  report.internal = internal;
  report.external_work = static_cast<double>(external_work_);
  report.interface_work = static_cast<double>(interface_work_);
  report.balance_error = scale > 0.0 ? std::abs(static_cast<double>(open)) / scale : 0.0;
  long double parts = 0;
  for (std::size_t k = 0; k < by_law_.size(); ++k) {
    report.by_law[k] = static_cast<double>(by_law_[k]);
    parts += by_law_[k];
  }
  report.least_dissipation = least_dissipation_;
  report.reaction_work = static_cast<double>(relative_work_ + parts);
  return report;
}

}  // namespace ilaw::host
