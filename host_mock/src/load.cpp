// SPDX-License-Identifier: BSD-3-Clause
#include "load.hpp"

#include <utility>

namespace ilaw::host {

Gravity::Gravity(const Model& model, std::vector<int> nodes, Eigen::VectorXd acceleration)
    : model_(model), nodes_(std::move(nodes)), acceleration_(std::move(acceleration)) {}

void Gravity::add_force(double /*time*/, Dofs& force) const {
  const Eigen::Index d = acceleration_.size();
  for (int node : nodes_)
    force.segment(node * d, d) += model_.mass().segment(node * d, d).cwiseProduct(acceleration_);
}

Force::Force(std::vector<int> nodes, Eigen::VectorXd direction, Table history)
    : nodes_(std::move(nodes)), direction_(std::move(direction)), history_(std::move(history)) {}

void Force::add_force(double time, Dofs& force) const {
  const Eigen::Index d = direction_.size();
  const double size = history_.at(time)[0];
  for (int node : nodes_) force.segment(node * d, d) += size * direction_;
}

Shock::Shock(std::vector<int> nodes, double time, Eigen::VectorXd impulse)
    : nodes_(std::move(nodes)), time_(time), impulse_(std::move(impulse)) {}

void Shock::add_impulse(StepTimes step, Dofs& impulse) const {
  // An instant that is a multiple of dt only but for rounding belongs to the step that ends there; both ends
  // of the interval move alike, so that it enters exactly one step.
  const double slack = 1e-9 * (step.after - step.before);
  if (!(time_ > step.before + slack && time_ <= step.after + slack)) return;
  const Eigen::Index d = impulse_.size();
  for (int node : nodes_) impulse.segment(node * d, d) += impulse_;
}

}  // namespace ilaw::host
