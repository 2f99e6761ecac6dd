// Made problems as laws and the solver of coupled contacts are given them.
// SPDX-License-Identifier: BSD-3-Clause
#include "stress/made_problem.hpp"

#include <ilaw/arrays.hpp>

#include <algorithm>
#include <deque>
#include <limits>

namespace ilaw::host {
namespace {

constexpr double unit_area = 1.0;

ilaw_batch batch_of_step(double step) {
  ilaw_batch batch{};
  batch.struct_size = sizeof batch;
  batch.velocity_step = batch.position_step = step;
  batch.area = ilaw::input(&unit_area, 0, 0);
  return batch;
}

}  // namespace

ilaw_batch MadeProblem::batch_of(const Contact& contact) const {
  ilaw_batch batch = batch_of_step(setup_.step);
  batch.node_count = 1;
  batch.gap = ilaw::input(&contact.gap, 1, 0);
  batch.normal = ilaw::input(contact.normal.data(), 3, 1);
  return batch;
}

std::vector<double> MadeProblem::first_state(const Contact& contact) const {
  std::vector<double> state(laws_[contact.law]->info().state_size);
  ilaw_batch batch = batch_of(contact);
  batch.state_out = ilaw::output(state.data(), 1, 1);
  laws_[contact.law]->initialise(batch);
  return state;
}

// H as the form has it.
MadeProblem::Wrench MadeProblem::form_of(const Contact& contact) const {
  const Matrix h = delassus(contact);
  const Vector& n = contact.normal;
  Wrench form;
  form << h(0, 0), h(1, 1), h(2, 2), h(0, 1), h(0, 2), h(1, 2);
  if (form_ == ILAW_DELASSUS_SCALAR || form_ == ILAW_DELASSUS_FULL) return form;
  const Eigen::Matrix3d own = h.topLeftCorner<3, 3>();
  form[0] = n.dot(own * n);
  form[1] = 0.5 * (own.trace() - form[0]);
  if (form_ == ILAW_DELASSUS_TRANSVERSE) return form;
  // A moment m moves the contact by k n x m: read k from H.
  const Vector m{n[1], n[2], n[0]}, turned = n.cross(m);
  form[2] = turned.dot(h.topRightCorner<3, 3>() * m) / turned.squaredNorm();
  form[3] = form[4] = h(3, 3);
  return form;
}

MadeProblem::Wrench MadeProblem::answer(const Contact& contact, const Wrench& v_free) const {
  const Wrench form = form_of(contact), v_before = before(contact), v_smooth = smooth(contact);
  std::vector<double> state(contact.state.size() + 1);
  Wrench made = Wrench::Zero();
  ilaw_batch batch = batch_of(contact);
  if (contact.has_broken) batch.flags = ILAW_BATCH_BREAK_BONDS;
  batch.time = setup_.step;
  batch.v_free = ilaw::input(v_free.data(), 6, 1);
  batch.v_previous = ilaw::input(v_before.data(), 6, 1);
  if (reads_smooth(contact.law)) batch.v_smooth = ilaw::input(v_smooth.data(), 6, 1);
  batch.delassus = ilaw::input(form.data(), 6, 1);
  batch.state_in = ilaw::input(contact.state.data(), 1, 1);
  batch.state_out = ilaw::output(state.data(), 1, 1);
  batch.impulse = ilaw::output(made.data(), 6, 1);
  if (width() == 6) {
    batch.spin_free = ilaw::input(v_free.data() + 3, 6, 1);
    batch.spin_previous = ilaw::input(v_before.data() + 3, 6, 1);
    batch.moment = ilaw::output(made.data() + 3, 6, 1);
  }
  ilaw_report report{};
  report.struct_size = sizeof report;
  if (laws_[contact.law]->evaluate(batch, &report) != ILAW_OK)
    made.setConstant(std::numeric_limits<double>::quiet_NaN());
  return made;
}

// The contacts of a law, which lie one behind another. Their numbers are read where they lie.
struct MadeProblem::Group {
  std::vector<std::int32_t> body, counterpart;
  std::vector<double> weight, other_weight, state_in, state_out;
  std::vector<ilaw_status> status;
  ilaw_batch batch{};
  ilaw_contacts given{};

  Group(const interface& law, ilaw_delassus_form form, double step, Contact* first, Contact* end)
      : status(static_cast<std::size_t>(end - first)), batch(batch_of_step(step)) {
    for (const Contact* contact = first; contact != end; ++contact) {
      const auto append = [](auto& to, const auto& values) {
        to.insert(to.end(), values.begin(), values.end());
      };
      append(body, contact->body);
      append(counterpart, contact->counterpart);
      append(weight, contact->weight);
      append(other_weight, contact->other_weight);
      append(state_in, contact->state);
    }
    state_out = state_in;
    constexpr auto stride = static_cast<std::int64_t>(sizeof(Contact) / sizeof(double));
    const auto states = static_cast<std::int64_t>(law.info().state_size);
    const auto input = [&](const double* values) { return ilaw::input(values, stride, 1); };
    batch.node_count = end - first;
    batch.time = step;
    batch.gap = ilaw::input(&first->gap, stride, 0);
    batch.normal = input(first->normal.data());
    batch.impulse = ilaw::output(first->impulse.data(), stride, 1);
    batch.state_in = ilaw::input(state_in.data(), states, 1);
    batch.state_out = ilaw::output(state_out.data(), states, 1);
    batch.status = status.data();
    batch.status_stride = 1;
    given = contacts_of(law, form, batch, body.data(), counterpart.data());
    given.arm = input(first->arm.data());
    given.counterpart_arm = input(first->other_arm.data());
    given.wall_velocity = input(first->wall.data());
    given.wall_previous = input(first->wall_before.data());
    if (const std::size_t ends = first->body.size(); ends > 1) {
      given.body_count = given.counterpart_count = static_cast<std::uint32_t>(ends);
      given.weight_size = static_cast<std::uint32_t>(first->weight.size() / ends);
      given.body_weight = ilaw::input(weight.data(), static_cast<std::int64_t>(first->weight.size()), 1);
      given.counterpart_weight =
          ilaw::input(other_weight.data(), static_cast<std::int64_t>(first->other_weight.size()), 1);
    }
    if (form != ILAW_DELASSUS_TRANSVERSE_SPIN) return;
    batch.moment = ilaw::output(first->impulse.data() + 3, stride, 1);
    given.wall_spin = input(first->wall.data() + 3);
    given.wall_spin_previous = input(first->wall_before.data() + 3);
  }
};

ilaw_bodies MadeProblem::describe_bodies(std::vector<double>& inertia) {
  constexpr auto stride = static_cast<std::int64_t>(sizeof(Body) / sizeof(double));
  ilaw_bodies bodies{};
  bodies.struct_size = sizeof bodies;
  bodies.dimension = 3;
  bodies.count = bodies.owned_count = body_count();
  Body& first = bodies_.front();
  bodies.inverse_mass = ilaw::input(first.inverse.data(), stride, setup_.no_freedom > 0.0 ? 1 : 0);
  bodies.v_free = ilaw::input(first.free.data(), stride, 1);
  bodies.v_previous = ilaw::input(first.before.data(), stride, 1);
  bodies.velocity = ilaw::output(first.velocity.data(), stride, 1);
  if (!rotates()) return bodies;
  for (const Body& body : bodies_)
    inertia.insert(inertia.end(), {body.inverse[3], body.inverse[4], body.inverse[5], 0.0, 0.0, 0.0});
  bodies.inverse_inertia = ilaw::input(inertia.data(), 6, setup_.rotate ? 1 : 0);
  bodies.spin_free = ilaw::input(first.free.data() + 3, stride, 1);
  bodies.spin_previous = ilaw::input(first.before.data() + 3, stride, 1);
  bodies.spin = ilaw::output(first.velocity.data() + 3, stride, 1);
  return bodies;
}

ilaw_coupled_report MadeProblem::solve(coupled& solver, const ilaw_coupled_options& options) {
  std::vector<double> inertia;
  const ilaw_bodies bodies = describe_bodies(inertia);
  std::deque<Group> groups;
  std::vector<const ilaw_contacts*> given;
  Contact* const last = contacts_.data() + contacts_.size();
  for (Contact *first = contacts_.data(), *end = first; first != last; first = end) {
    end = std::find_if(first, last, [first](const Contact& contact) { return contact.law != first->law; });
    groups.emplace_back(*laws_[first->law], form_, setup_.step, first, end);
    given.push_back(&groups.back().given);
  }
  const ilaw_coupled_report report = solver.solve(bodies, given, options);
  Contact* contact = contacts_.data();
  for (const Group& group : groups)
    for (const ilaw_status status : group.status) {
      const bool holds_bonds = laws_[contact->law]->info().capabilities & ILAW_CAN_HOLD_BONDS;
      contact++->has_broken = holds_bonds && status == ILAW_BROKEN;
    }
  return report;
}

}  // namespace ilaw::host
