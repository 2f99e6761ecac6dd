// solid_element.hpp - forces, energy and stress of one element with its own dilatation or the mean of its
// integration points.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "model/mesh_body.hpp"

#include <Eigen/LU>

#include <cmath>

namespace ilaw::host {

// Displacements relative to the first corner: rounding then grows with strain, not with the distance
// travelled.
template <std::size_t N>
Eigen::Matrix<double, 3, N> gather(const std::array<int, N>& nodes, const Dofs& u) {
  Eigen::Matrix<double, 3, N> local;
  const Eigen::Vector3d origin = u.segment<3>(3 * Eigen::Index{nodes[0]});
  for (std::size_t a = 0; a < N; ++a)
    local.col(static_cast<Eigen::Index>(a)) = u.segment<3>(3 * Eigen::Index{nodes[a]}) - origin;
  return local;
}

// Deformation at the integration points of an element, by the displacements of its corners.
template <int N, int P>
class DeformedElement {
 public:
  using Corners = Eigen::Matrix<double, 3, N>;

  DeformedElement(const SolidElement<N, P>& element, const Corners& u, const Material& material, Element kind)
      : element_(element),
        material_(material),
        is_linear_(material.law == MaterialLaw::linear),
        takes_mean_(kind == Element::mean_dilatation && P > 1) {
    for (std::size_t g = 0; g < P; ++g) {
      gradient_[g] = u * element.gradients[g].transpose();
      if (!is_linear_) gradient_[g] += Eigen::Matrix3d::Identity();
      dilatation_[g] = is_linear_ ? gradient_[g].trace() : gradient_[g].determinant();
      mean_ += part(g) * dilatation_[g];
    }
    solid_ = {material.shear_modulus(), material.lame(), mean_};
  }

  Corners force() const {
    Corners force = Corners::Zero();
    const double pressure = mean_pressure();
    for (std::size_t g = 0; g < P; ++g)
      force += element_.weights[g] * stress(g, pressure) * element_.gradients[g];
    return force;
  }

  double energy() const {
    double sum = 0.0;
    for (std::size_t g = 0; g < P; ++g) sum += element_.weights[g] * density(g);
    return sum;
  }

  // Cauchy's stress, its mean over the deformed element.
  Eigen::Matrix3d mean_stress() const {
    const double pressure = mean_pressure();
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (std::size_t g = 0; g < P; ++g) {
      if (is_linear_)
        sum += part(g) * stress(g, pressure);
      else
        sum += part(g) * stress(g, pressure) * gradient_[g].transpose();
    }
    return is_linear_ ? sum : Eigen::Matrix3d(sum / mean_);
  }

 private:
  double part(std::size_t g) const { return element_.weights[g] / element_.volume; }
  double felt(std::size_t g) const { return takes_mean_ ? mean_ : dilatation_[g]; }
  double distortion(std::size_t g) const { return solid_.scale(dilatation_[g]) * gradient_[g].squaredNorm(); }

  double mean_pressure() const {
    if (is_linear_ || !takes_mean_) return 0.0;
    double mean = 0.0;
    for (std::size_t g = 0; g < P; ++g) mean += part(g) * distortion(g);
    return solid_.pressure(mean);
  }

  // The first Piola-Kirchhoff stress, or that of small displacements.
  Eigen::Matrix3d stress(std::size_t g, double pressure) const {
    const Eigen::Matrix3d& F = gradient_[g];
    if (is_linear_) return linear_stress(material_, F, felt(g));
    if (!takes_mean_) return neo_hookean_stress(material_.shear_modulus(), material_.lame(), F);
    return solid_.stress(pressure, F, dilatation_[g], solid_.scale(dilatation_[g]));
  }

  double density(std::size_t g) const {
    if (is_linear_) return linear_energy(material_, gradient_[g], felt(g));
    if (takes_mean_) return solid_.energy(distortion(g));
    return neo_hookean_energy(material_.shear_modulus(), material_.lame(), gradient_[g]);
  }

  const SolidElement<N, P>& element_;
  const Material& material_;
  bool is_linear_, takes_mean_;
  std::array<Eigen::Matrix3d, P> gradient_;  // F, or the displacement gradient
  std::array<double, P> dilatation_;         // det F, or the trace
  double mean_ = 0.0;
  MeanDilatation solid_{};
};

}  // namespace ilaw::host
