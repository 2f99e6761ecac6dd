// springs.hpp - springs and dampers between nodes, or between a node and a fixed point, beside the
// model's own internal forces. A spring of rest length L pulls with k (l - L) along the line between
// its ends, however far they move and turn. The force on a point at an anchor is central, so that central
// difference keeps the angular momentum x_n x m v_{n+1/2} about it to rounding.
//
// A damper resists with c dl/dt, at the velocity before the step: it counts in the critical step.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "model/load.hpp"
#include "model/model.hpp"

#include <memory>
#include <optional>
#include <vector>

namespace ilaw::host {

struct Spring {
  int node, partner;  // partner -1: the anchor
  Vector anchor;
  double stiffness, damping, length;  // length without load
};

// Force of a spring and its damper on its node, along the line to the other end.
Vector pull_of(const Model& model, const Spring& spring, Motions at);

// A model and what was put between its nodes.
class Sprung : public Model {
 public:
  Sprung(std::unique_ptr<const Model> body, std::vector<Spring> springs);

  bool has_internal_forces() const override { return true; }
  void add_internal_forces(const Dofs& u, Dofs& force) const override;
  bool is_linear() const override { return false; }
  double potential(const Dofs& u) const override;
  std::vector<Eigen::Matrix3d> stresses(const Dofs& u) const override { return body_->stresses(u); }
  std::vector<VolumeElement> volume_elements() const override { return body_->volume_elements(); }
  double critical_step() const override { return critical_step_; }
  // One spring from a point to its anchor has the bound as its eigenvalue.
  bool critical_step_is_exact() const override {
    return springs_.size() == 1 && springs_[0].partner < 0 && !body_->has_internal_forces();
  }

 private:
  std::unique_ptr<const Model> body_;
  std::vector<Spring> springs_;
  double critical_step_;
};

// The dampers of springs.
class Dampers : public Load {
 public:
  Dampers(const Model& model, std::vector<Spring> springs) : model_(model), springs_(std::move(springs)) {}
  void correct(StepTimes step, Motions before, Dofs& v, Dofs& impulse) const override;
  bool corrects() const override { return true; }
  bool damps() const override { return true; }

 private:
  const Model& model_;
  std::vector<Spring> springs_;
};

}  // namespace ilaw::host
