// bars.hpp - elastic bars in a line (1D): linear elements, lumped mass.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "model/model.hpp"

#include <string>
#include <vector>

namespace ilaw::host {

struct BarSetup {
  std::string name;
  double start, length;  // from start to start + length
  int elements;
  double young, density, section, velocity;
};

// Sets of bar "b": "b", "b.left", "b.right".
class Bars : public Model {
 public:
  explicit Bars(const std::vector<BarSetup>& bars);

  bool has_internal_forces() const override { return true; }
  void add_internal_forces(const Dofs& u, Dofs& force) const override;
  double potential(const Dofs& u) const override;
  std::vector<Eigen::Matrix3d> stresses(const Dofs& u) const override;
  std::vector<VolumeElement> volume_elements() const override;
  // Element length over wave speed: with lumped mass exactly the limit 2/omega_max of the longest
  // mesh.
  double critical_step() const override { return critical_step_; }

 private:
  struct Run {
    int first, elements;
    double stiffness;  // of one element
    double section;
    double element_length, density;
  };
  std::vector<Run> runs_;  // one per bar
  double critical_step_;
};

}  // namespace ilaw::host
