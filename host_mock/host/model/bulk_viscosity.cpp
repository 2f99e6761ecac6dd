// SPDX-License-Identifier: BSD-3-Clause
#include "model/bulk_viscosity.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace ilaw::host {

Eigen::Matrix3Xd BulkViscosity::deformed_gradients(const VolumeElement& element, const Dofs& u) const {
  const int d = model_.dimension();
  Eigen::Matrix3d deformation = Eigen::Matrix3d::Identity();
  for (std::size_t a = 0; a < element.nodes.size(); ++a)
    deformation.topRows(d) += u.segment(Eigen::Index{d} * element.nodes[a], d) *
                              element.gradients.col(static_cast<Eigen::Index>(a)).transpose();
  return deformation.inverse().transpose() * element.gradients;
}

// By the deformed positions, so that a body may turn; a linear model has small displacements.
template <class Use>
void BulkViscosity::for_each_element(Motions at, Use use) const {
  for (const VolumeElement& element : elements_) {
    if (is_linear_) {
      use(element, element.gradients, rate_of(element, element.gradients, at.v));
      continue;
    }
    const Eigen::Matrix3Xd gradients = deformed_gradients(element, at.u);
    use(element, gradients, rate_of(element, gradients, at.v));
  }
}

double BulkViscosity::rate_of(const VolumeElement& element, const Eigen::Matrix3Xd& gradients,
                              const Dofs& v) const {
  const int d = model_.dimension();
  double rate = 0.0;
  for (std::size_t a = 0; a < element.nodes.size(); ++a)
    rate += gradients.col(static_cast<Eigen::Index>(a))
                .head(d)
                .dot(v.segment(Eigen::Index{d} * element.nodes[a], d));
  return rate;
}

double BulkViscosity::viscosity(const VolumeElement& element, double rate) const {
  const double quadratic = quadratic_ * element.length;
  return linear_ * element.wave_speed * element.length + quadratic * quadratic * std::max(-rate, 0.0);
}

void BulkViscosity::correct(StepTimes step, Motions before, Dofs& v, Dofs& impulse) const {
  const int d = model_.dimension();
  Dofs own = Dofs::Zero(v.size());
  for_each_element(before, [&](const VolumeElement& element, const Eigen::Matrix3Xd& gradients, double rate) {
    const double impulse_of_pressure = step.duration() * element.mass * viscosity(element, rate) * rate;
    for (std::size_t a = 0; a < element.nodes.size(); ++a)
      own.segment(Eigen::Index{d} * element.nodes[a], d) -=
          impulse_of_pressure * gradients.col(static_cast<Eigen::Index>(a)).head(d);
  });
  v += own.cwiseQuotient(model_.mass());
  impulse += own;
}

// Of the whole it is no more than the largest of an element alone.
double BulkViscosity::damping_rate(Motions at) const {
  double largest = 0.0;
  for_each_element(at, [&](const VolumeElement& element, const Eigen::Matrix3Xd&, double rate) {
    largest = std::max(largest, viscosity(element, rate) * element.response);
  });
  return largest;
}

}  // namespace ilaw::host
