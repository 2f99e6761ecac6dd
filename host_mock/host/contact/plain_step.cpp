// SPDX-License-Identifier: BSD-3-Clause
#include "contact/plain_step.hpp"

#include "contact/contact_batch.hpp"
#include "contact/contact_geometry.hpp"

#include <algorithm>

namespace ilaw::host {
namespace {

// Asks the law for impulse, state, status, energies and amounts. False: it refuses.
bool evaluate(const BlockStep& step, std::int32_t contact, ContactBatch& one, ChunkOutcome& outcome) {
  const Answer answer = step.law.evaluate(one.batch);
  outcome.refusal.add(answer, 1, &contact);
  outcome.sums.add_stable_step(answer.report.stable_velocity_step);
  if (answer.code == ILAW_OK) outcome.refusal.add_unknown(one.batch.status, &contact, 1);
  if (outcome.refusal.code != ILAW_OK) return false;
  ++outcome.sums.statuses[*one.batch.status];
  outcome.sums.add_energy(one.energy.data());
  for (std::size_t a = 0; a < one.amounts.size(); ++a) outcome.sums.add_amount(a, one.amounts[a]);
  return true;
}

// v += r/m at the node, and the weighted opposite at its partners.
template <class Impulse>
void push(const BlockStep& step, const ContactPoint& point, int node, const Impulse& r) {
  point.for_each_node(node, [&](int pushed, double weight) {
    const Eigen::Index first = r.size() * pushed;
    for (Eigen::Index c = 0; c < r.size(); ++c) step.v[first + c] += weight * step.inverse_mass[first] * r[c];
  });
}

// r . sum/2, in the order of block_step.cpp; to_obstacle: of the mean velocity less that of the surface.
template <class Impulse>
void add_work(ContactSums& sums, const Impulse& r, const Vector& sum, const Vector& obstacle,
              const Vector& turn) {
  double all = 0.0, to_obstacle = 0.0;
  for (Eigen::Index c = 0; c < r.size(); ++c) {
    all += r[c] * sum[c];
    to_obstacle += r[c] * (sum[c] - obstacle[c]);
    to_obstacle -= r[c] * turn[c];
  }
  sums.work += 0.5 * all;
  sums.relative_work += 0.5 * to_obstacle;
}

void step_contact(const BlockStep& step, std::int32_t contact, int node, ChunkOutcome& outcome) {
  const int d = step.model.dimension();
  const auto k = static_cast<std::size_t>(contact);
  ContactArrays& at = step.contacts;
  const ObstacleMotion& obstacle = step.obstacle;

  // Gap, normal, H, and the velocity of the surface.
  const auto [point, surface] = locate_contact(step.setup, at.node_index[k], step.step, obstacle.rates());
  if (!at.point.empty()) {
    at.point[k] = point;
    at.delassus[k] = point.delassus(step.inverse_mass, d, node);
  }
  if (step.heat) step.heat->give(k, node, point, at);

  // v_free and v_previous, relative to what the node meets.
  const Vector before = relative_velocity(point, node, d, step.step.v_before);
  const Vector v_free = relative_velocity(point, node, d, step.v) - obstacle.velocity() - surface.after;
  const Vector v_previous = before - obstacle.velocity_before() - surface.before;

  // The law, and v += H r.
  ContactBatch one(step, contact, point, v_free, v_previous);
  if (!evaluate(step, contact, one, outcome)) return;
  if (step.heat) step.heat->take(k, [&](std::size_t a) { return one.amounts[a]; });
  const auto r = at.vector(at.impulse, contact);
  if (!r.isZero(0.0)) push(step, point, node, r);

  // The accounts: work r . (v_previous + v)/2, the deepest indentation, contacts to evaluate in the next
  // step.
  add_work(outcome.sums, r, before + relative_velocity(point, node, d, step.v),
           obstacle.velocity() + obstacle.velocity_before(), surface.before + surface.after);
  outcome.sums.penetration = std::max(outcome.sums.penetration, -point.gap);
  const bool in_reach = is_in_reach(point.gap, point.normal.data(), v_free.data(), d, step.step.dt);
  if (!at.state.empty()) at.mark_touched(k, at.status[k] != ILAW_FREE, in_reach, step.law.may_skip_free());
}

}  // namespace

void plain_step(const BlockStep& step, const NearContacts& contacts, ChunkOutcome& outcome) {
  for (std::ptrdiff_t i = 0; i < contacts.count; ++i)
    step_contact(step, contacts.index[i], contacts.nodes[i], outcome);
}

}  // namespace ilaw::host
