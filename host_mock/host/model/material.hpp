// material.hpp - stored energy per undeformed volume and first Piola-Kirchhoff stress, from the
// Lame constants.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>

#include <cmath>

namespace ilaw::host {

enum class MaterialLaw { linear, neo_hookean };

// Which dilatation an integration point feels: its own, or the mean of its element (Nagtegaal, Parks
// and Rice 1974; Hughes 1980; Simo, Taylor and Pister 1985).
enum class Element { full, mean_dilatation };

struct Material {
  MaterialLaw law;
  double young, poisson, density;

  double shear_modulus() const { return 0.5 * young / (1.0 + poisson); }
  double lame() const { return young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)); }
};

// Linear elasticity with the displacement gradient H, and a dilatation theta in the place of its trace:
//   sigma = 2 mu (eps - tr(eps)/3 I) + K theta I,  K = lambda + 2/3 mu.
inline Eigen::Matrix3d linear_stress(const Material& material, const Eigen::Matrix3d& H, double theta) {
  const double mu = material.shear_modulus(), bulk = material.lame() + 2.0 / 3.0 * mu;
  return mu * (H + H.transpose()) + (bulk * theta - 2.0 / 3.0 * mu * H.trace()) * Eigen::Matrix3d::Identity();
}
inline double linear_energy(const Material& material, const Eigen::Matrix3d& H, double theta) {
  const double mu = material.shear_modulus(), bulk = material.lame() + 2.0 / 3.0 * mu;
  const Eigen::Matrix3d strain = 0.5 * (H + H.transpose());
  return mu * (strain.squaredNorm() - H.trace() * H.trace() / 3.0) + 0.5 * bulk * theta * theta;
}

// Compressible neo-Hookean solid (Simo and Pister 1984; Bonet and Wood 2008, eq. 6.27):
//   W = mu/2 (F:F - 3) - mu ln J + lambda/2 (ln J)^2,  P = mu (F - F^-T) + lambda ln J F^-T,
// which is linear elasticity with the same constants for small strains. J <= 0 gives NaN: the
// motion diverged.
inline double neo_hookean_energy(double mu, double lambda, const Eigen::Matrix3d& F) {
  const double log_volume = std::log(F.determinant());
  return 0.5 * mu * (F.squaredNorm() - 3.0) - mu * log_volume + 0.5 * lambda * log_volume * log_volume;
}
inline Eigen::Matrix3d neo_hookean_stress(double mu, double lambda, const Eigen::Matrix3d& F) {
  const Eigen::Matrix3d turned_inverse = F.inverse().transpose();
  return mu * F + (lambda * std::log(F.determinant()) - mu) * turned_inverse;
}

// The same solid with F replaced by (V/J)^(1/3) F, whose determinant is V, the mean of J = det F over
// an element (Simo, Taylor and Pister 1985; Moran, Ortiz and Shih 1990). With s = (V/J)^(2/3),
//   W = mu/2 (s F:F - 3) - mu ln V + lambda/2 (ln V)^2.
struct MeanDilatation {
  double mu, lambda, volume;  // volume: V

  // s of a point; J <= 0 gives NaN.
  double scale(double J) const { return std::pow(volume / J, 2.0 / 3.0); }
  // distortion: s F:F.
  double energy(double distortion) const {
    const double log_volume = std::log(volume);
    return 0.5 * mu * (distortion - 3.0) - mu * log_volume + 0.5 * lambda * log_volume * log_volume;
  }
  // Cauchy's mean stress, the derivative of the mean of W by V.
  double pressure(double mean_distortion) const {
    return (mu * (mean_distortion / 3.0 - 1.0) + lambda * std::log(volume)) / volume;
  }
  // Derivative of the mean of W by F of a point, times the number of points.
  Eigen::Matrix3d stress(double pressure, const Eigen::Matrix3d& F, double J, double s) const {
    return mu * s * F + (pressure * J - mu * s * F.squaredNorm() / 3.0) * F.inverse().transpose();
  }
};

}  // namespace ilaw::host
