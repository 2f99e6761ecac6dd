// SPDX-License-Identifier: BSD-3-Clause
#include "model/load.hpp"

#include <utility>

namespace ilaw::host {

double critical_step(const Model& model, const Loads& loads, Motions at) {
  double rate = 0.0;
  for (const auto& load : loads) rate += load->damping_rate(at);
  const double alone = model.critical_step();
  return rate == 0.0 ? alone : damped_critical_step(4.0 / (alone * alone), rate);
}

const std::vector<int> Load::none_;

Force::Force(std::vector<int> nodes, std::vector<double> shares, Vector direction, Table history)
    : nodes_(std::move(nodes)),
      shares_(std::move(shares)),
      direction_(std::move(direction)),
      history_(std::move(history)) {}

void Force::add_force(double time, const Dofs& /*u*/, Dofs& force) const {
  const Eigen::Index d = direction_.size();
  const Vector whole = history_.at(time)[0] * direction_;
  for (std::size_t k = 0; k < nodes_.size(); ++k) force.segment(nodes_[k] * d, d) += shares_[k] * whole;
}

Shock::Shock(std::vector<int> nodes, double time, Vector impulse)
    : nodes_(std::move(nodes)), time_(time), impulse_(std::move(impulse)) {}

void Shock::add_impulse(StepTimes step, Dofs& impulse) const {
  // An instant that is a multiple of dt only but for rounding belongs to the step that ends there;
  // both ends of the interval move alike, so that it enters exactly one step.
  const double slack = 1e-9 * (step.after - step.before);
  if (!(time_ > step.before + slack && time_ <= step.after + slack)) return;
  const Eigen::Index d = impulse_.size();
  for (int node : nodes_) impulse.segment(node * d, d) += impulse_;
}

PrescribedMotion::PrescribedMotion(const Model& model, std::vector<int> nodes, std::vector<int> axes,
                                   Motion motion)
    : model_(model), nodes_(std::move(nodes)), axes_(std::move(axes)), motion_(std::move(motion)) {}

// Positions follow the motion: the velocity is its mean over the step to come.
void PrescribedMotion::correct(StepTimes step, Motions /*before*/, Dofs& v, Dofs& impulse) const {
  const Vector mean = motion_.velocity(step.after, step.until);
  for (int node : nodes_)
    for (int axis : axes_) {
      const Eigen::Index dof = Eigen::Index{node} * model_.dimension() + axis;
      impulse[dof] += model_.mass()[dof] * (mean[axis] - v[dof]);
      v[dof] = mean[axis];
    }
}

void PrescribedMotion::transmit(StepTimes /*step*/, Dofs& impulse) const {
  for (const int node : nodes_)
    for (const int axis : axes_) impulse[Eigen::Index{node} * model_.dimension() + axis] = 0.0;
}

Damping::Damping(const Model& model, std::vector<int> nodes, double rate, Table history)
    : model_(model), nodes_(std::move(nodes)), rate_(rate), history_(std::move(history)) {}

// m (v' - v_before) = m (v - v_before) - rate h m (v_before + v')/2, solved for v'.
void Damping::correct(StepTimes step, Motions before, Dofs& v, Dofs& impulse) const {
  const double a = part(step);
  const Eigen::Index d = model_.dimension();
  for (int node : nodes_)
    for (Eigen::Index dof = node * d; dof < (node + 1) * d; ++dof) {
      const double damped = (v[dof] - a * before.v[dof]) / (1.0 + a);
      impulse[dof] += model_.mass()[dof] * (damped - v[dof]);
      v[dof] = damped;
    }
}

// With an impulse r beside it the equation of correct() has r/m on its right: v' changes by r/(m (1 + a)).
void Damping::transmit(StepTimes step, Dofs& impulse) const {
  const double a = part(step);
  const Eigen::Index d = model_.dimension();
  for (const int node : nodes_) impulse.segment(node * d, d) /= 1.0 + a;
}

}  // namespace ilaw::host
