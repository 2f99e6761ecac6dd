// material.hpp - stored energy per undeformed volume and first Piola-Kirchhoff stress, from the
// Lame constants.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>

#include <cmath>

namespace ilaw::host {

enum class MaterialLaw { linear, neo_hookean };

struct Material {
  MaterialLaw law;
  double young, poisson, density;

  double shear_modulus() const { return 0.5 * young / (1.0 + poisson); }
  double lame() const { return young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)); }
};

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

}  // namespace ilaw::host
