// SPDX-License-Identifier: BSD-3-Clause
#include "contact/plain_step.hpp"

#include "contact/contact_geometry.hpp"

#include <ilaw/arrays.hpp>

#include <algorithm>
#include <array>
#include <vector>

namespace ilaw::host {
namespace {

class PlainContact {
 public:
  PlainContact(const BlockStep& step, std::int32_t contact, int node)
      : step_(step),
        at_(step.contacts),
        contact_(contact),
        k_(static_cast<std::size_t>(contact)),
        node_(node) {}

  void solve(ContactSums& sums, Refusal& refusal) {
    locate();
    const Vector v_free = relative(step_.v, step_.obstacle_velocity, surface_.after);
    const Vector v_previous = relative(step_.step.v_before, step_.obstacle_velocity_before, surface_.before);
    if (!evaluate(v_free, v_previous, sums, refusal)) return;
    const auto r = at_.vector(at_.impulse, contact_);
    if (!r.isZero(0.0)) apply(r);
    add_work(r, sums);
    const bool acts = at_.status[k_] != ILAW_FREE;
    const bool in_reach =
        is_in_reach(point_.gap, point_.normal.data(), v_free.data(), step_.model.dimension(), step_.step.dt);
    if (!at_.state.empty()) at_.mark_touched(k_, acts, in_reach, step_.law.may_skip_free());
  }

 private:
  // Gap, normal, H, and the velocities of a surface that turns.
  void locate() {
    const int dimension = step_.model.dimension();
    const auto [point, surface] = locate_contact(step_.setup, at_.node_index[k_], step_.step, step_.rates);
    point_ = point;
    surface_ = surface;
    turn_axes(step_.setup, step_.axes, dimension, step_.step,
              [&](std::size_t number) -> double& { return at_.state.at(k_, number); });
    if (at_.point.empty()) return;
    at_.point[k_] = point_;
    at_.delassus[k_] = point_.delassus(step_.inverse_mass, dimension, node_);
  }

  // The node's, to its partners.
  Vector relative(const Dofs& v) const {
    const Eigen::Index d = step_.model.dimension();
    Vector value = v.segment(node_ * d, d);
    for (std::size_t p = 0; p < static_cast<std::size_t>(point_.partner_count); ++p)
      value -= point_.weights[p] * v.segment(point_.partners[p] * d, d);
    return value;
  }
  // To the obstacle, too.
  Vector relative(const Dofs& v, const Vector& obstacle, const Vector& turn) const {
    return relative(v) - obstacle - turn;
  }

  // Impulse, state, status; energies and amounts into the sums.
  bool evaluate(const Vector& v_free, const Vector& v_previous, ContactSums& sums, Refusal& refusal) {
    const ilaw_instance_info& info = step_.law.info();
    std::array<double, ILAW_ENERGY_COUNT> energy{};
    std::vector<ilaw_input> parameters;
    std::vector<ilaw_output> outputs;
    std::vector<double> amounts(step_.gets_energies ? info.amount_count : 0);
    for (const std::vector<double>& values : at_.parameters)
      parameters.push_back(ilaw::input(&values[k_], 1, 0));
    outputs.reserve(amounts.size());
    for (double& amount : amounts) outputs.push_back(ilaw::output(&amount, 1, 0));
    ilaw_batch batch = empty_batch(step_.tangent, step_.step.time, step_.step.velocity_step(), step_.step.dt);
    batch.node_count = 1;
    batch.v_free = ilaw::input(v_free.data(), 0, 1);
    batch.v_previous = ilaw::input(v_previous.data(), 0, 1);
    batch.delassus = ilaw::input(&at_.delassus[k_], 0, 0);
    batch.gap = ilaw::input(&point_.gap, 0, 0);
    batch.normal = ilaw::input(point_.normal.data(), 0, 1);
    if (!at_.area.empty()) batch.area = ilaw::input(&at_.area[k_], 0, 0);
    batch.per_node_parameters = parameters.data();
    batch.state_in = ilaw::input(at_.state.first(k_), 0, at_.state.stride());
    batch.state_out = ilaw::output(at_.state.first(k_), 0, at_.state.stride());
    batch.impulse = ilaw::output(at_.vector(at_.impulse, contact_).data(), 0, 1);
    if (step_.gets_energies) batch.energy = ilaw::output(energy.data(), 0, 1);
    batch.amounts = outputs.empty() ? nullptr : outputs.data();
    batch.status = &at_.status[k_];
    const Answer answer = step_.law.evaluate(batch);
    refusal.add(answer, 1, &contact_);
    sums.add_stable_step(answer.report.stable_velocity_step);
    if (answer.code == ILAW_OK) refusal.add_unknown(batch.status, &contact_, 1);
    if (refusal.code != ILAW_OK) return false;
    ++sums.statuses[at_.status[k_]];
    sums.penetration = std::max(sums.penetration, -point_.gap);
    sums.add_energy(energy.data());
    for (std::size_t a = 0; a < amounts.size(); ++a) sums.add_amount(a, amounts[a]);
    return true;
  }

  // v += r/m at the node, and the weighted opposite at its partners.
  template <class Impulse>
  void apply(const Impulse& r) {
    point_.for_each_node(node_, [&](int node, double weight) {
      const Eigen::Index first = r.size() * node;
      for (Eigen::Index c = 0; c < r.size(); ++c)
        step_.v[first + c] += weight * step_.inverse_mass[first] * r[c];
    });
  }

  // r . (v_previous + v)/2, and the same relative to the obstacle.
  template <class Impulse>
  void add_work(const Impulse& r, ContactSums& sums) const {
    const Vector before = relative(step_.step.v_before), after = relative(step_.v);
    double all = 0.0, to_obstacle = 0.0;
    for (Eigen::Index c = 0; c < r.size(); ++c) {
      const double sum = before[c] + after[c];
      all += r[c] * sum;
      to_obstacle += r[c] * (sum - (step_.obstacle_velocity[c] + step_.obstacle_velocity_before[c]));
      to_obstacle -= r[c] * (surface_.before[c] + surface_.after[c]);
    }
    sums.work += 0.5 * all;
    sums.relative_work += 0.5 * to_obstacle;
  }

  const BlockStep& step_;
  ContactArrays& at_;
  std::int32_t contact_;
  std::size_t k_;
  int node_;
  ContactPoint point_;
  SurfaceVelocities surface_;
};

}  // namespace

void plain_step(const BlockStep& step, const NearContacts& contacts, ChunkOutcome& outcome) {
  for (std::ptrdiff_t i = 0; i < contacts.count; ++i)
    PlainContact(step, contacts.index[i], contacts.nodes[i]).solve(outcome.sums, outcome.refusal);
}

}  // namespace ilaw::host
