// load.hpp - what acts on the nodes from outside.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "model.hpp"
#include "table.hpp"

#include <memory>
#include <vector>

namespace ilaw::host {

// The step from time t_n to t_{n+1} = t_n + dt.
struct StepTimes {
  double before, after;
};

class Load {
 public:
  virtual ~Load() = default;
  // Adds the force at a time.
  virtual void add_force(double /*time*/, Dofs& /*force*/) const {}
  // Adds the impulses that fall into a step.
  virtual void add_impulse(StepTimes /*step*/, Dofs& /*impulse*/) const {}
};

using Loads = std::vector<std::unique_ptr<Load>>;

class Gravity : public Load {
 public:
  Gravity(const Model& model, std::vector<int> nodes, Eigen::VectorXd acceleration);
  void add_force(double time, Dofs& force) const override;

 private:
  const Model& model_;
  std::vector<int> nodes_;
  Eigen::VectorXd acceleration_;
};

// A force along a direction, of a size that is piecewise linear in time.
class Force : public Load {
 public:
  Force(std::vector<int> nodes, Eigen::VectorXd direction, Table history);
  void add_force(double time, Dofs& force) const override;

 private:
  std::vector<int> nodes_;
  Eigen::VectorXd direction_;
  Table history_;
};

// An impulse at an instant s; it enters the step with t_n < s <= t_{n+1}.
class Shock : public Load {
 public:
  Shock(std::vector<int> nodes, double time, Eigen::VectorXd impulse);
  void add_impulse(StepTimes step, Dofs& impulse) const override;

 private:
  std::vector<int> nodes_;
  double time_;
  Eigen::VectorXd impulse_;
};

}  // namespace ilaw::host
