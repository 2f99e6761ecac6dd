// SPDX-License-Identifier: BSD-3-Clause
#include "step/energy.hpp"

#include <algorithm>
#include <cmath>
#include <istream>
#include <ostream>
#include <stdexcept>

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

// 1/2 U_n^T K U_{n+1} of a linear model.
double mixed_potential(const Model& model, const Dofs& u, const Dofs& u_next) {
  Dofs force = Dofs::Zero(u.size());
  model.add_internal_forces(u_next, force);
  return -0.5 * u.dot(force);
}

}  // namespace

void EnergyBalance::start(const Model& model, const Dofs& u, const Dofs& u_next, const Dofs& v) {
  sums_.initial = kinetic_energy(model, v);
  sums_.initial += model.is_linear() ? mixed_potential(model, u, u_next) : model.potential(u);
  if (!model.is_linear()) sums_.internal_work = -static_cast<Sum>(model.potential(u));
  meet(sums_.initial);
}

void EnergyBalance::meet(Sum energy) {
  sums_.largest = std::max(sums_.largest, std::abs(static_cast<double>(energy)));
}

void EnergyBalance::add_external(const Dofs& impulse, const Dofs& v_before, const Dofs& v_after) {
  sums_.external_work += work(impulse, v_before, v_after);
  meet(sums_.external_work);
}

void EnergyBalance::add_internal(const Dofs& impulse, const Dofs& v_before, const Dofs& v_after) {
  sums_.internal_work += work(impulse, v_before, v_after);
}

void EnergyBalance::add_interface(double work, double relative_work) {
  sums_.interface_work += work;
  sums_.relative_work += relative_work;
  meet(sums_.interface_work);
}

void EnergyBalance::add_dissipation(int part, double energy) {
  by_law_[static_cast<std::size_t>(part)] += energy;
  sums_.least_dissipation = std::min(sums_.least_dissipation, energy);
}

EnergyReport EnergyBalance::report(const Model& model, const Dofs& u, const Dofs& u_next,
                                   const Dofs& v) const {
  const Sum kinetic = kinetic_energy(model, v);
  const Sum internal = model.is_linear() ? Sum{mixed_potential(model, u, u_next)} : -sums_.internal_work;
  const Sum open = kinetic + internal - sums_.initial - sums_.external_work - sums_.interface_work;
  const double scale =
      std::max({sums_.largest, static_cast<double>(kinetic), std::abs(static_cast<double>(internal))});
  EnergyReport report{};
  report.kinetic = static_cast<double>(kinetic);
  report.internal = static_cast<double>(internal);
  report.potential = model.potential(u);
  report.external_work = static_cast<double>(sums_.external_work);
  report.interface_work = static_cast<double>(sums_.interface_work);
  report.scale = scale;
  report.balance_error = scale > 0.0 ? std::abs(static_cast<double>(open)) / scale : 0.0;
  Sum parts = 0;
  for (std::size_t k = 0; k < by_law_.size(); ++k) {
    report.by_law[k] = static_cast<double>(by_law_[k]);
    parts += by_law_[k];
  }
  report.least_dissipation = sums_.least_dissipation;
  report.reaction_work = static_cast<double>(sums_.relative_work + parts);
  return report;
}

void EnergyBalance::save(std::ostream& out) const {
  out.write(reinterpret_cast<const char*>(&sums_), sizeof sums_);
  out.write(reinterpret_cast<const char*>(&by_law_), sizeof by_law_);
}

void EnergyBalance::load(std::istream& in) {
  in.read(reinterpret_cast<char*>(&sums_), sizeof sums_);
  in.read(reinterpret_cast<char*>(&by_law_), sizeof by_law_);
  if (!in) throw std::runtime_error("the checkpoint is damaged");
}

}  // namespace ilaw::host
