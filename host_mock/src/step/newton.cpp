// SPDX-License-Identifier: BSD-3-Clause
#include "step/newton.hpp"

#include <Eigen/QR>

#include <cmath>
#include <map>
#include <utility>
#include <vector>

namespace ilaw::host {
namespace {

// Velocity that a scaled impulse at one contact makes at another, over all pairs: W, scaled to a diagonal
// of 1, along an axis.
Eigen::MatrixXd scaled_coupling(const ContactGroup& group, const double* inverse_mass, Eigen::Index d,
                                Eigen::Index axis) {
  std::map<int, std::vector<std::pair<Eigen::Index, double>>> at_node;
  for_each_contact(group, [&](const Interface& interface, int contact, Eigen::Index k) {
    const double root = std::sqrt(interface.delassus(contact));
    interface.point(contact).for_each_node(interface.node_of(contact), [&](int node, double weight) {
      at_node[node].emplace_back(k, weight / root);
    });
  });
  const Eigen::Index count = contact_count(group);
  Eigen::MatrixXd coupling = Eigen::MatrixXd::Zero(count, count);
  for (const auto& [node, shares] : at_node)
    for (const auto& [j, weight] : shares)
      for (const auto& [k, other] : shares) coupling(j, k) += weight * other * inverse_mass[node * d + axis];
  return coupling;
}

// Changes of velocities that show the tangents of laws, one per contact.
std::vector<double> small_changes(const ContactGroup& group, const std::vector<Vector>& velocities) {
  constexpr double small = 0x1p-20;
  std::vector<double> changes;
  for_each_contact(group, [&](const Interface& interface, int contact, Eigen::Index k) {
    const double made = interface.delassus(contact) * interface.impulse(contact).cwiseAbs().maxCoeff();
    changes.push_back(small * (velocities[static_cast<std::size_t>(k)].cwiseAbs().maxCoeff() + made));
  });
  return changes;
}

// H times the derivative of each law's impulse by its velocity, by differences, in rows of the contacts: a
// law sees its own contact alone, so that all are found at once.
Eigen::MatrixXd tangents_of(const ContactGroup& group, const StepView& step,
                            const std::vector<Vector>& velocities, const Dofs& answered) {
  const std::vector<double> changes = small_changes(group, velocities);
  const Eigen::Index d = velocities.front().size();
  Eigen::MatrixXd tangents = Eigen::MatrixXd::Zero(answered.size(), d);
  for (Eigen::Index c = 0; c < d; ++c) {
    std::vector<Vector> changed = velocities;
    for (std::size_t k = 0; k < changed.size(); ++k) changed[k][c] += changes[k];
    answer_at(group, changed, step);
    tangents.col(c) = scaled_impulses(group) - answered;
  }
  for_each_contact(group, [&](const Interface& interface, int contact, Eigen::Index k) {
    const double change = changes[static_cast<std::size_t>(k)];
    if (change > 0.0) tangents.middleRows(d * k, d) *= std::sqrt(interface.delassus(contact)) / change;
  });
  return tangents;
}

}  // namespace

// A law f answers to c + (W - 1) r, all scaled, where c is v without any impulse: all agree where that is r,
// and (1 - f' (W - 1)) dr = f - r leads there.
Dofs newton_impulses(const ContactGroup& group, const double* inverse_mass, const StepView& step,
                     const Dofs& v) {
  const Dofs impulses = scaled_impulses(group);
  for (const auto& [interface, contacts] : group) interface->gather(contacts, v, step);
  const std::vector<Vector> velocities = asked_velocities(group);
  answer_at(group, velocities, step);
  const Dofs answered = scaled_impulses(group);
  const Eigen::MatrixXd tangents = tangents_of(group, step, velocities, answered);
  const Eigen::Index d = tangents.cols(), count = contact_count(group);
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(impulses.size(), impulses.size());
  for (Eigen::Index c = 0; c < d; ++c) {
    const Eigen::MatrixXd coupling = scaled_coupling(group, inverse_mass, d, c);
    for (Eigen::Index j = 0; j < count; ++j)
      for (Eigen::Index k = 0; k < count; ++k)
        if (j != k) matrix.block(d * j, d * k + c, d, 1) -= coupling(j, k) * tangents.block(d * j, c, d, 1);
  }
  return impulses + matrix.colPivHouseholderQr().solve(answered - impulses);
}

}  // namespace ilaw::host
