// SPDX-License-Identifier: BSD-3-Clause
#include "contact/interface.hpp"

#include "base/bytes.hpp"

#include <algorithm>
#include <utility>

namespace ilaw::host {

Interface::Interface(InterfaceSetup setup, const Model& model)
    : setup_(std::move(setup)),
      model_(model),
      dimension_(model.dimension()),
      law_(setup_.library, setup_.law, setup_.arguments, setup_.tangent, dimension_),
      contacts_(dimension_, law_.info(), setup_.nodes.size()),
      obstacle_velocity_(Vector::Zero(dimension_)),
      obstacle_velocity_before_(obstacle_velocity_) {}

ilaw_batch Interface::timed(ilaw_batch batch, double time, double dt) const {
  batch.time = time;
  batch.velocity_step = dt;
  batch.position_step = dt;
  if (setup_.tangent.size() > 0) batch.tangent = {setup_.tangent.data(), 0, 1};
  return batch;
}

void Interface::check(const Answer& answer) const {
  if (answer.code == ILAW_OK) return;
  const ilaw_report& report = answer.report;
  std::string text = "interface '" + setup_.name + "' (law '" + setup_.law + "'): ";
  if (report.first_bad_node >= 0)
    text += std::to_string(report.bad_count) + " node(s) refused, first node " +
            std::to_string(node_of(static_cast<int>(report.first_bad_node))) + ": ";
  throw ilaw::error(answer.code, text + (report.reason ? report.reason : "no reason given"));
}

// ---- contacts -------------------------------------------------------------------------------------------

int Interface::contact_index_of(int node_index, const Dofs& u) {
  const std::size_t k = at(node_index);
  if (const int found = contacts_.index_of(k); found >= 0) return found;
  std::vector<double> parameters;
  for (std::size_t p = 0; p < info().per_node_parameter_count; ++p)
    parameters.push_back(setup_.arguments.per_node.at(info().per_node_parameters[p])[k]);
  contacts_.add(node_index, setup_.areas[k], parameters);
  contacts_.touched.back() = law_.acts_at_distance();
  contacts_.delassus.back() = 1.0 / model_.mass()[setup_.nodes[k] * dimension_];
  const int made = contacts_.index_of(k);
  initialise(made, u);
  return made;
}

// The state that the law starts with at time 0, whenever the contact is made. Its axes are those of
// the first time that it is active: where the normal turns, a law whose state has axes is active
// from the first step (may_skip).
void Interface::initialise(int contact_index, const Dofs& u) {
  contacts_.vector(contacts_.normal, contact_index) =
      setup_.counterpart->contact_point(contacts_.node_index[at(contact_index)], u, 0.0).normal;
  if (info().state_size > 0)
    check(law_.initialise(timed(contacts_.start_batch(), 0.0, 1.0), ContactList{contact_index}));
}

bool Interface::may_skip() const {
  if (setup_.keeps_all_active || (law_.acts_at_distance() && !law_.rests())) return false;
  return setup_.counterpart->keeps_normal() || !law_.carries_axes();
}

// Touched contacts stay near: only fresh ones, and those at rest, are known to do nothing at a
// distance.
void Interface::refresh_near(const StepView& step) {
  near_.clear();
  setup_.counterpart->refresh(step.u);
  for (std::size_t k = 0; k < setup_.nodes.size(); ++k) {
    const int node_index = static_cast<int>(k), contact_index = contacts_.index_of(k);
    const bool touched =
        contact_index >= 0 ? contacts_.touched[at(contact_index)] != 0 : law_.acts_at_distance();
    if (touched || !may_skip() ||
        proximity_.may_touch(setup_.counterpart->gap_bound(node_index, step.u, step.time) -
                             setup_.gap_offset))
      near_.push_back(contact_index_of(node_index, step.u));
  }
}

// ---- a step ---------------------------------------------------------------------------------------------

void Interface::open_step(const StepView& step) {
  active_.clear();
  const Counterpart& counterpart = *setup_.counterpart;
  obstacle_velocity_before_ = counterpart.velocity(step.time - step.dt, step.time);
  obstacle_velocity_ = counterpart.velocity(step.time, step.time + step.dt);
  const double moving = counterpart.partners().empty() ? 1.0 : 2.0;
  const double closing_before = moving * step.speed_before + obstacle_velocity_before_.norm(),
               closing_after = moving * step.speed_after + obstacle_velocity_.norm();
  closing_ = step.dt * closing_after;
  const bool due = proximity_.refresh_due(step.dt, closing_before, closing_after, counterpart.validity());
  if (step.time < setup_.birth || step.time >= setup_.death) {
    proximity_.invalidate();
    return;
  }
  if (due) refresh_near(step);
  active_ = near_;
  for (const std::int32_t contact_index : active_) locate(contact_index, step);
}

void Interface::locate(int contact_index, const StepView& step) {
  const std::size_t k = at(contact_index);
  const ContactPoint& point = contacts_.point[k] =
      setup_.counterpart->contact_point(contacts_.node_index[k], step.u, step.time);
  contacts_.gap[k] = point.gap - setup_.gap_offset;
  contacts_.vector(contacts_.normal, contact_index) = point.normal;
  contacts_.vector(contacts_.impulse, contact_index).setZero();
  if (point.partner_count == 0) return;
  const auto mass = [this](int node) { return model_.mass()[static_cast<Eigen::Index>(node) * dimension_]; };
  contacts_.delassus[k] = 1.0 / mass(node_of(contact_index));
  for (std::size_t i = 0; i < at(point.partner_count); ++i)
    contacts_.delassus[k] += point.weights[i] * point.weights[i] / mass(point.partners[i]);
}

bool Interface::is_idle(int contact_index) const {
  const std::size_t k = at(contact_index);
  return !contacts_.touched[k] && contacts_.gap[k] > closing_;
}

void Interface::gather(const ContactList& contacts, const Dofs& v, const StepView& step) {
#pragma omp parallel for schedule(static) if (contacts.size() > 2 * std::size_t{Law::chunk})
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const std::int32_t contact_index = contacts[i];
    contacts_.vector(contacts_.v_free, contact_index) =
        relative(contact_index, v) - obstacle_velocity_ - delassus(contact_index) * impulse(contact_index);
    contacts_.vector(contacts_.v_previous, contact_index) =
        relative(contact_index, step.v_before) - obstacle_velocity_before_;
    contacts_.vector(contacts_.previous_impulse, contact_index) = impulse(contact_index);
  }
}

void Interface::evaluate(const ContactList& contacts, const StepView& step) {
  const Answer answer = law_.evaluate(timed(contacts_.step_batch(), step.time, step.dt), contacts);
  check(answer);
  check_status(contacts);
  stable_step_ = std::min(stable_step_, answer.report.stable_velocity_step);
}

// ABI 1 has eight statuses for ever: any other number is a broken library's.
void Interface::check_status(const ContactList& contacts) const {
  for (const std::int32_t contact_index : contacts)
    if (const int found = status(contact_index); found >= ILAW_STATUS_COUNT)
      throw ilaw::error(ILAW_BAD_LIBRARY, "interface '" + setup_.name + "' (law '" + setup_.law +
                                              "', library " + library().path() + "): found status " +
                                              std::to_string(found) + " at node " +
                                              std::to_string(node_of(contact_index)) + ", expected 0 to " +
                                              std::to_string(ILAW_STATUS_COUNT - 1));
}

double Interface::apply(const ContactList& contacts, Dofs& v) {
  double speed = 0.0;
  const Eigen::Index d = dimension_;
#pragma omp parallel for schedule(static) \
    reduction(max                         \
              : speed) if (contacts.size() > 2 * std::size_t{Law::chunk})
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const std::int32_t contact_index = contacts[i];
    const Vector added = impulse(contact_index) - contacts_.vector(contacts_.previous_impulse, contact_index);
    if (added.isZero(0.0)) continue;  // idle contacts must not even write nodes they share
    const auto move = [&](int node, double weight) {
      v.segment(node * d, d) += (weight / model_.mass()[node * d]) * added;
      speed = std::max(speed, v.segment(node * d, d).norm());
    };
    move(node_of(contact_index), 1.0);
    const ContactPoint& point = contacts_.point[at(contact_index)];
    for (std::size_t p = 0; p < at(point.partner_count); ++p) move(point.partners[p], -point.weights[p]);
  }
  return speed;
}

void Interface::accept(double dt) {
  if (info().state_size == 0) return;
  for (const std::int32_t contact_index : active_) {
    const bool in_reach = !(gap(contact_index) > dt * v_free(contact_index).norm());
    std::uint8_t& touched = contacts_.touched[at(contact_index)];
    if (status(contact_index) != ILAW_FREE || (in_reach && !law_.rests()))
      touched = 1;
    else if (law_.rests())
      touched = 0;
    contacts_.accept_state(contact_index);
  }
}

void Interface::change_impulse(int contact_index, const Vector& change) {
  contacts_.vector(contacts_.previous_impulse, contact_index) = impulse(contact_index);
  contacts_.vector(contacts_.impulse, contact_index) += change;
}

// ---- the last step --------------------------------------------------------------------------------------

bool Interface::is_active(int contact_index) const {
  return std::find(active_.begin(), active_.end(), contact_index) != active_.end();
}

Vector Interface::relative(int contact_index, const Dofs& v) const {
  const ContactPoint& point = contacts_.point[at(contact_index)];
  const Eigen::Index d = dimension_;
  Vector relative = v.segment(node_of(contact_index) * d, d);
  for (std::size_t i = 0; i < at(point.partner_count); ++i)
    relative -= point.weights[i] * v.segment(point.partners[i] * d, d);
  return relative;
}

void Interface::add_impulse(int contact_index, Dofs& impulse) const {
  const ContactPoint& point = contacts_.point[at(contact_index)];
  const Eigen::Index d = dimension_;
  impulse.segment(node_of(contact_index) * d, d) += this->impulse(contact_index);
  for (std::size_t i = 0; i < at(point.partner_count); ++i)
    impulse.segment(point.partners[i] * d, d) -= point.weights[i] * this->impulse(contact_index);
}

void Interface::load(std::istream& in, const Dofs& u) {
  const std::vector<int> nodes = ContactArrays::load_nodes(in, setup_.nodes.size());
  for (const int node_index : nodes) contact_index_of(node_index, u);
  if (contacts_.node_index != nodes) refuse_damaged();
  contacts_.load_state(in);
  proximity_.invalidate();
}

}  // namespace ilaw::host
