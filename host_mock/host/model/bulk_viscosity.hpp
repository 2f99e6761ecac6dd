// bulk_viscosity.hpp - a pressure that resists the rate of volume of each element, so that the front of a
// wave leaves fewer oscillations behind it.
//   p = -rho (b1 c L + (b2 L)^2 |e'| [e' < 0]) e',  e' the rate of volume, the mean over the element,
// with the wave speed c and the length L of the element. Sources: J. von Neumann, R. D. Richtmyer (1950), the
// second term; R. Landshoff (1955), the first.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "model/load.hpp"
#include "model/model.hpp"

#include <vector>

namespace ilaw::host {

class BulkViscosity : public Load {
 public:
  BulkViscosity(const Model& model, double linear, double quadratic)
      : model_(model),
        linear_(linear),
        quadratic_(quadratic),
        is_linear_(model.is_linear()),
        elements_(model.volume_elements()) {}
  // Explicit: with the velocities before the step.
  void correct(StepTimes step, Motions before, Dofs& v, Dofs& impulse) const override;
  bool corrects() const override { return true; }
  bool damps() const override { return true; }
  double damping_rate(Motions at) const override;

 private:
  // Calls use(element, gradients, rate of volume) for each element.
  template <class Use>
  void for_each_element(Motions at, Use use) const;
  Eigen::Matrix3Xd deformed_gradients(const VolumeElement& element, const Dofs& u) const;
  double rate_of(const VolumeElement& element, const Eigen::Matrix3Xd& gradients, const Dofs& v) const;
  // -p over rho e'.
  double viscosity(const VolumeElement& element, double rate) const;

  const Model& model_;
  double linear_, quadratic_;
  bool is_linear_;
  std::vector<VolumeElement> elements_;
};

}  // namespace ilaw::host
