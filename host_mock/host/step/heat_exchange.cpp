// SPDX-License-Identifier: BSD-3-Clause
#include "step/heat_exchange.hpp"

#include <cmath>

namespace ilaw::host {
namespace {

// 1/(1 - e^-x) - 1/x: between 1/2, which is of second order, and 1, which passes no equilibrium.
double fitted_theta(double x) {
  constexpr double small = 0.02;
  if (x < small) return 0.5 + x / 12.0 - x * x * x / 720.0;
  return -1.0 / std::expm1(-x) - 1.0 / x;
}

}  // namespace

void HeatExchange::clear() {
  for (const int node : nodes_) place_[static_cast<std::size_t>(node)] = -1;
  conductance_.clear();
  obstacle_.clear();
  entries_.clear();
  nodes_.clear();
  first_.assign(1, 0);
}

Eigen::Index HeatExchange::body_of(int node) {
  const auto n = static_cast<std::size_t>(node);
  if (place_.size() <= n) place_.resize(n + 1, -1);
  if (place_[n] < 0) {
    place_[n] = static_cast<std::int32_t>(nodes_.size());
    nodes_.push_back(node);
  }
  return place_[n];
}

void HeatExchange::add(double conductance, double obstacle, int node, const ContactPoint& point) {
  conductance_.push_back(conductance);
  obstacle_.push_back(obstacle);
  point.for_each_node(node, [&](int other, double weight) { entries_.push_back({body_of(other), weight}); });
  first_.push_back(entries_.size());
}

Dofs HeatExchange::of_contacts(const Dofs& of_bodies) const {
  Dofs sums = Dofs::Zero(static_cast<Eigen::Index>(conductance_.size()));
  for (std::size_t c = 0; c + 1 < first_.size(); ++c)
    for (std::size_t e = first_[c]; e < first_[c + 1]; ++e)
      sums[static_cast<Eigen::Index>(c)] += entries_[e].weight * of_bodies[entries_[e].body];
  return sums;
}

Dofs HeatExchange::of_bodies(const Dofs& of_contacts) const {
  Dofs sums = Dofs::Zero(static_cast<Eigen::Index>(nodes_.size()));
  for (std::size_t c = 0; c + 1 < first_.size(); ++c)
    for (std::size_t e = first_[c]; e < first_[c + 1]; ++e)
      sums[entries_[e].body] += entries_[e].weight * of_contacts[static_cast<Eigen::Index>(c)];
  return sums;
}

// (1/(theta G h) + a C^-1 a^T) Q.
Dofs HeatExchange::applied(const Dofs& heat) const {
  return resistance_.cwiseProduct(heat) + of_contacts(softness_.cwiseProduct(of_bodies(heat)));
}

Dofs HeatExchange::bodies_of(const Dofs& of_nodes) const {
  Dofs values(static_cast<Eigen::Index>(nodes_.size()));
  for (std::size_t b = 0; b < nodes_.size(); ++b) values[static_cast<Eigen::Index>(b)] = of_nodes[nodes_[b]];
  return values;
}

void HeatExchange::set_coefficients(const NodeHeat& nodes) {
  const auto count = static_cast<Eigen::Index>(conductance_.size());
  softness_ = bodies_of(nodes.softness);
  for (Dofs* const values : {&theta_, &resistance_, &diagonal_}) values->setZero(count);
  for (Eigen::Index c = 0; c < count; ++c) {
    const auto k = static_cast<std::size_t>(c);
    for (std::size_t e = first_[k]; e < first_[k + 1]; ++e)
      diagonal_[c] += entries_[e].weight * entries_[e].weight * softness_[entries_[e].body];
    theta_[c] = fitted_theta(conductance_[k] * diagonal_[c]);
    resistance_[c] = 1.0 / (theta_[c] * conductance_[k]);
  }
  diagonal_ += resistance_;
}

const Dofs& HeatExchange::solve(const NodeHeat& nodes) {
  set_coefficients(nodes);
  const Eigen::Map<const Dofs> obstacle(obstacle_.data(), static_cast<Eigen::Index>(obstacle_.size()));
  find_heat((obstacle - of_contacts(bodies_of(nodes.temperature))).cwiseQuotient(theta_) -
            of_contacts(bodies_of(nodes.change)));
  return heat_;
}

// Conjugate gradients, preconditioned by the diagonal. Heat that flows out of one side flows into the other,
// whether it has converged or not.
void HeatExchange::find_heat(const Dofs& right) {
  constexpr int most_iterations = 200;
  constexpr double tolerance = 1e-15;
  heat_.setZero(right.size());
  Dofs residual = right, scaled = residual.cwiseQuotient(diagonal_), direction = scaled;
  double size = residual.dot(scaled);
  const double small = tolerance * tolerance * size;
  for (int iteration = 0; iteration < most_iterations && size > small; ++iteration) {
    const Dofs image = applied(direction);
    const double length = size / direction.dot(image);
    heat_ += length * direction;
    residual -= length * image;
    scaled = residual.cwiseQuotient(diagonal_);
    const double next = residual.dot(scaled);
    direction = scaled + next / size * direction;
    size = next;
  }
}

void HeatExchange::add_heat(Dofs& heat) const {
  const Dofs received = of_bodies(heat_);
  for (std::size_t b = 0; b < nodes_.size(); ++b) heat[nodes_[b]] += received[static_cast<Eigen::Index>(b)];
}

}  // namespace ilaw::host
