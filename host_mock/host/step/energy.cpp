// SPDX-License-Identifier: BSD-3-Clause
#include "step/energy.hpp"

#include "base/bytes.hpp"
#include "step/dof_loops.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <functional>

namespace ilaw::host {
namespace {

long double kinetic_sum(const Model& model, const Dofs& v) {
  long double twice = 0;
  for (Eigen::Index i = 0; i < v.size(); ++i)
    twice += static_cast<long double>(model.mass()[i]) * v[i] * v[i];
  return twice / 2;
}

long double twice_the_work(const Dofs& impulse, const Dofs& v_before, const Dofs& v_after, Eigen::Index first,
                           Eigen::Index end) {
  long double sum = 0;
  for (Eigen::Index i = first; i < end; ++i)
    sum += static_cast<long double>(impulse[i]) * (static_cast<long double>(v_before[i]) + v_after[i]);
  return sum;
}

long double work(const Dofs& impulse, const Dofs& v_before, const Dofs& v_after) {
  const auto twice = [&](Eigen::Index first, Eigen::Index end) {
    return twice_the_work(impulse, v_before, v_after, first, end);
  };
  return over_parts(impulse.size(), twice, std::plus<>()) / 2;
}

// 1/2 U_n^T K U_{n+1} of a linear model.
double mixed_potential(const Model& model, const Dofs& u, const Dofs& u_next) {
  Dofs force = Dofs::Zero(u.size());
  model.add_internal_forces(u_next, force);
  return -0.5 * u.dot(force);
}

}  // namespace

void EnergyBalance::start(const Model& model, const Dofs& u, const Dofs& u_next, const Dofs& v) {
  const double stored = sums_.stored_before;
  sums_ = {};
  begin_with_stored(stored);
  sums_.initial = kinetic_sum(model, v);
  sums_.initial += model.is_linear() ? mixed_potential(model, u, u_next) : model.potential(u);
  if (!model.is_linear()) sums_.internal_work = -static_cast<Sum>(model.potential(u));
  note_size(sums_.initial);
  sums_.put_in = std::abs(static_cast<double>(sums_.initial)) + std::abs(model.potential(u));
}

void EnergyBalance::note_size(Sum energy) {
  sums_.largest = std::max(sums_.largest, std::abs(static_cast<double>(energy)));
}

void EnergyBalance::add_external(long double work) {
  sums_.external_work += work;
  sums_.put_in += std::max(static_cast<double>(work), 0.0);
  note_size(sums_.external_work);
}

void EnergyBalance::add_damping(const Dofs& impulse, const Dofs& v_before, const Dofs& v_after) {
  sums_.damping_work += work(impulse, v_before, v_after);
  note_size(sums_.damping_work);
}

void EnergyBalance::add_internal(const Dofs& impulse, const Dofs& v_before, const Dofs& v_after) {
  sums_.internal_work += work(impulse, v_before, v_after);
}

void EnergyBalance::add_interface(double work, double relative_work) {
  sums_.interface_work += work;
  sums_.relative_work += relative_work;
  sums_.put_in += std::max(work - relative_work, 0.0);
  note_size(sums_.interface_work);
}

void EnergyBalance::add_dissipation(const std::array<double, ILAW_ENERGY_COUNT>& energy, double least) {
  for (std::size_t part = 0; part < ILAW_ENERGY_STORED; ++part) by_law_[part] += energy[part];
  sums_.least_dissipation = std::min(sums_.least_dissipation, least);
}

void EnergyBalance::set_stored(double energy) {
  by_law_[ILAW_ENERGY_STORED] = energy;
  sums_.most_stored = std::max(sums_.most_stored, std::abs(energy));  // adhesion stores less than nothing
}

EnergyReport EnergyBalance::report(const Model& model, const Dofs& u, const Dofs& u_next,
                                   const Dofs& v) const {
  const Sum kinetic = kinetic_sum(model, v);
  const Sum internal = model.is_linear() ? Sum{mixed_potential(model, u, u_next)} : -sums_.internal_work;
  const Sum open =
      kinetic + internal - sums_.initial - sums_.external_work - sums_.damping_work - sums_.interface_work;
  const double scale =
      std::max({sums_.largest, static_cast<double>(kinetic), std::abs(static_cast<double>(internal))});
  EnergyReport report{};
  report.kinetic = static_cast<double>(kinetic);
  report.internal = static_cast<double>(internal);
  report.potential = model.potential(u);
  report.external_work = static_cast<double>(sums_.external_work);
  report.damping_work = static_cast<double>(sums_.damping_work);
  report.interface_work = static_cast<double>(sums_.interface_work);
  report.scale = scale;
  report.balance_error = scale > 0.0 ? std::abs(static_cast<double>(open)) / scale : 0.0;
  Sum parts = 0;
  for (std::size_t k = 0; k < by_law_.size(); ++k) {
    report.by_law[k] = static_cast<double>(by_law_[k]);
    parts += by_law_[k];
  }
  report.least_dissipation = sums_.least_dissipation;
  report.reaction_work = static_cast<double>(sums_.relative_work + parts - sums_.stored_before);
  return report;
}

WorkAndSpeed work_and_speed(const Dofs& impulse, const Dofs& v_before, const Dofs& v_after,
                            Eigen::Index dimension) {
  struct Part {
    long double twice;
    double square;
  };
  const Part sum = over_parts(
      v_after.size(),
      [&](Eigen::Index first, Eigen::Index end) {
        const double square = largest_square(v_after, dimension, first, end);
        return Part{impulse.size() == 0 ? 0 : twice_the_work(impulse, v_before, v_after, first, end), square};
      },
      [](const Part& a, const Part& b) {
        return Part{a.twice + b.twice, std::max(a.square, b.square)};
      });
  return {sum.twice / 2, std::sqrt(sum.square)};
}

double kinetic_energy(const Model& model, const Dofs& v) {
  return static_cast<double>(kinetic_sum(model, v));
}

Vector angular_momentum(const Model& model, const Dofs& u, const Dofs& v) {
  using Long = Eigen::Matrix<long double, 3, 1>;
  const Eigen::Index d = model.dimension();
  Long sum = Long::Zero(), x = sum, p = sum;
  for (Eigen::Index i = 0; i < u.size(); i += d) {
    for (Eigen::Index c = 0; c < d; ++c) {
      x[c] = static_cast<long double>(model.position()[i + c]) + u[i + c];
      p[c] = static_cast<long double>(model.mass()[i + c]) * v[i + c];
    }
    sum += x.cross(p);
  }
  return sum.tail(d == 1 ? 0 : d == 2 ? 1 : 3).cast<double>();
}

void EnergyBalance::save(std::ostream& out) const {
  for (Sum Sums::*sum : all_sums) write_value(out, sums_.*sum);
  for (double Sums::*extreme : all_extremes) write_value(out, sums_.*extreme);
  for (const Sum& sum : by_law_) write_value(out, sum);
}

void EnergyBalance::load(std::istream& in) {
  for (Sum Sums::*sum : all_sums) read_value(in, sums_.*sum);
  for (double Sums::*extreme : all_extremes) read_value(in, sums_.*extreme);
  for (Sum& sum : by_law_) read_value(in, sum);
}

}  // namespace ilaw::host
