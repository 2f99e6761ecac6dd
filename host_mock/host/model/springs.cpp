// SPDX-License-Identifier: BSD-3-Clause
#include "model/springs.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ilaw::host {
namespace {

// From the node to the other end.
struct Line {
  double length;
  Vector direction;  // zero where the ends meet, which have none
};

Line line_of(const Model& model, const Spring& spring, const Dofs& u) {
  const Vector apart = (spring.partner < 0 ? spring.anchor : model.position(spring.partner, u)) -
                       model.position(spring.node, u);
  const double length = apart.norm();
  return {length, length > 0.0 ? Vector(apart / length) : Vector::Zero(apart.size())};
}

double stretch_rate(const Model& model, const Spring& spring, const Vector& direction, const Dofs& v) {
  const Eigen::Index d = model.dimension();
  Vector apart = -v.segment(spring.node * d, d);
  if (spring.partner >= 0) apart += v.segment(spring.partner * d, d);
  return apart.dot(direction);
}

// A pull along the line, on both ends.
void add_pull(const Spring& spring, const Vector& pull, Dofs& sum) {
  const Eigen::Index d = pull.size();
  sum.segment(spring.node * d, d) += pull;
  if (spring.partner >= 0) sum.segment(spring.partner * d, d) -= pull;
}

double inverse_mass(const Model& model, int node) {
  return node < 0 ? 0.0 : 1.0 / model.mass()[Eigen::Index{node} * model.dimension()];
}

// A bound on the largest eigenvalue of M^-1 sum k e e^T, e the difference of a spring's ends along any
// direction: that of the matrix sqrt(k_i k_j) (e_i^T M^-1 e_j) of the springs, from its rows (Gershgorin
// 1931). A spring under load is no stiffer across its line than along it.
double largest_eigenvalue(const Model& model, const std::vector<Spring>& springs, double Spring::*stiffness) {
  std::vector<double> roots(static_cast<std::size_t>(model.node_count()));  // sums at each node
  const auto at = [&](int node) -> double& { return roots[static_cast<std::size_t>(node)]; };
  for (const Spring& spring : springs)
    for (const int node : {spring.node, spring.partner})
      if (node >= 0) at(node) += std::sqrt(spring.*stiffness);
  double largest = 0.0;
  for (const Spring& spring : springs) {
    double row = 0.0;
    for (const int node : {spring.node, spring.partner})
      if (node >= 0) row += at(node) * inverse_mass(model, node);
    largest = std::max(largest, std::sqrt(spring.*stiffness) * row);
  }
  return largest;
}

double critical_step_of(const Model& body, const std::vector<Spring>& springs) {
  const double own = 2.0 / body.critical_step();
  const double k = own * own + largest_eigenvalue(body, springs, &Spring::stiffness);
  return damped_critical_step(k, largest_eigenvalue(body, springs, &Spring::damping));
}

Nodes nodes_of(const Model& model) {
  return {model.dimension(),        model.mass(), model.position(),
          model.initial_velocity(), model.sets(), model.initial_displacement()};
}

}  // namespace

Vector pull_of(const Model& model, const Spring& spring, Motions at) {
  const Line line = line_of(model, spring, at.u);
  const double rate = stretch_rate(model, spring, line.direction, at.v);
  return (spring.stiffness * (line.length - spring.length) + spring.damping * rate) * line.direction;
}

Sprung::Sprung(std::unique_ptr<const Model> body, std::vector<Spring> springs)
    : Model(nodes_of(*body)),
      body_(std::move(body)),
      springs_(std::move(springs)),
      critical_step_(critical_step_of(*body_, springs_)) {
  mesh_ = body_->mesh();
}

void Sprung::add_internal_forces(const Dofs& u, Dofs& force) const {
  body_->add_internal_forces(u, force);
  for (const Spring& spring : springs_) {
    const Line line = line_of(*this, spring, u);
    add_pull(spring, spring.stiffness * (line.length - spring.length) * line.direction, force);
  }
}

double Sprung::potential(const Dofs& u) const {
  double energy = body_->potential(u);
  for (const Spring& spring : springs_) {
    const double stretch = line_of(*this, spring, u).length - spring.length;
    energy += 0.5 * spring.stiffness * stretch * stretch;
  }
  return energy;
}

void Dampers::correct(StepTimes step, Motions before, Dofs& v, Dofs& impulse) const {
  Dofs own = Dofs::Zero(v.size());
  for (const Spring& spring : springs_) {
    if (spring.damping == 0.0) continue;
    const Line line = line_of(model_, spring, before.u);
    const double rate = stretch_rate(model_, spring, line.direction, before.v);
    add_pull(spring, step.duration() * spring.damping * rate * line.direction, own);
  }
  v += own.cwiseQuotient(model_.mass());
  impulse += own;
}

}  // namespace ilaw::host
