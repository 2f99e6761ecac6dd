// SPDX-License-Identifier: BSD-3-Clause
#include "contact/coupled_interface.hpp"

#include "base/words.hpp"
#include "contact/contact_geometry.hpp"
#include "contact/law_faults.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace ilaw::host {
namespace {

CoupledGroup group_of(const Interface& interface, const Law& law, int dimension) {
  const bool is_driven = interface.setup().has_driven_nodes,
             has_partners = !interface.setup().counterpart->partners().empty();
  return {law, dimension, is_driven ? ILAW_DELASSUS_FULL : ILAW_DELASSUS_SCALAR, has_partners};
}

}  // namespace

CoupledInterface::CoupledInterface(Interface& interface)
    : interface_(interface), group_(group_of(interface, interface.law_, interface.dimension_)) {
  interface.contacts_.keep_geometry();
}

const ilaw_contacts& CoupledInterface::open(const StepView& step) {
  interface_.choose_active(step);
  interface_.sums_.clear();
  group_.open();
  const InterfaceSetup& setup = interface_.setup();
  const ObstacleMotion& obstacle = interface_.obstacle_;
  ContactArrays& contacts = interface_.contacts_;
  for (const std::int32_t contact : interface_.active()) {
    const auto k = static_cast<std::size_t>(contact);
    locate_contact(setup, contacts.node_index[k], step, obstacle.rates(), found_);
    const auto& [point, surface] = found_;
    contacts.gap[k] = point.gap;
    contacts.vector(contacts.normal, contact) = point.normal;
    contacts.vector(contacts.impulse, contact).setZero();
    contacts.status[k] = ILAW_FREE;
    if (point.is_beyond_border && setup.counterpart->is_held(contacts.node_index[k])) ++interface_.sums_.left;
    if (!contacts.area.empty()) contacts.area[k] = setup.area(contacts.node_index[k], point);
    if (!point.partners.empty()) {
      contacts.point[k] = point;
      interface_.find_delassus(k);
    }
    if (is_idle(contact)) continue;
    const Vector after = obstacle.velocity() + surface.after,
                 before = obstacle.velocity_before() + surface.before;
    group_.add({contact, interface_.node_of(contact), point, after, before});
    if (interface_.heat_)
      interface_.heat_->give(k, interface_.node_of(contact), interface_.point(contact), contacts);
  }
  const ilaw_contacts& given = group_.close(contacts, obstacle.tangent(), step);
  for (std::size_t i = 0; i < group_.count(); ++i)
    turn_axes(setup, interface_.axes_, interface_.dimension_, step, [&](std::size_t number) -> double& {
      return columns().state(static_cast<std::ptrdiff_t>(i), number);
    });
  return given;
}

// Out of reach, and its state does not change there.
bool CoupledInterface::is_idle(std::int32_t contact) const {
  const auto k = static_cast<std::size_t>(contact);
  return !interface_.search_.axes_turn() && !interface_.contacts_.must_be_evaluated(k) &&
         interface_.gap(contact) > interface_.search_.closing();
}

void CoupledInterface::check(const ilaw_coupled_report& report, std::int64_t bad_contact, double dt) const {
  if (bad_contact < 0) return;
  interface_.check({ILAW_BAD_NODES, report.bad_count, group_.contact(static_cast<std::size_t>(bad_contact)),
                    0, report.reason},
                   dt);
}

// A rigid law that is driven along its normal answers with an impulse that takes the whole approach, over the
// small H that it was given. The size of the answer tells it: the node would give way by H r, and laws that
// need no such thing give way by a vanishing part of the speed, or of the indentation in a step.
void CoupledInterface::check_driven(const StepView& step, const Dofs& v) const {
  constexpr double noticeable = 1e-9;
  const ContactArrays& contacts = interface_.contacts_;
  if (contacts.axis_delassus.empty()) return;
  const double speed = std::max(step.speed_before, step.speed_after);
  for (std::size_t place = 0; place < group_.count(); ++place) {
    const std::int32_t k = group_.contact(place);
    const auto r = interface_.impulse(k);
    const Vector given_way =
        contacts.vector(contacts.law_delassus, k).cwiseProduct(r) - interface_.velocity_of(k, r);
    Eigen::Index axis = 0;
    const double largest = given_way.cwiseAbs().maxCoeff(&axis);
    if (!(largest > noticeable * std::max(speed, std::abs(interface_.gap(k)) / step.dt))) continue;
    if (largest < 0.5 * std::abs(v_free_of(place, v)[axis])) continue;
    throw std::runtime_error(
        formatted("node %d is driven along axis %td against '%s' (law '%s'), which cannot give way",
                  interface_.node_of(k), axis, interface_.name().c_str(), interface_.setup().law.c_str()));
  }
}

void CoupledInterface::refuse(ilaw_result code, const char* reason) const {
  interface_.check({code, 0, -1, 0, reason}, 0.0);
}

void CoupledInterface::refuse_driven(std::size_t place) const {
  const ContactArrays& contacts = interface_.contacts_;
  const std::int32_t k = group_.contact(place);
  Eigen::Index axis = 0;
  if (!contacts.law_delassus.empty()) contacts.vector(contacts.law_delassus, k).minCoeff(&axis);
  throw std::runtime_error(
      formatted("node %d is driven along axis %td against '%s' (law '%s'), which cannot give way",
                interface_.node_of(k), axis, interface_.name().c_str(), interface_.setup().law.c_str()));
}

// Velocity that the law sees, without the contact's own impulse.
Vector CoupledInterface::v_free_of(std::size_t place, const Dofs& v) const {
  const std::int32_t contact = group_.contact(place);
  return interface_.relative(contact, v) - group_.surface(place) -
         interface_.velocity_of(contact, interface_.impulse(contact));
}

void CoupledInterface::check_results(double dt) const {
  for (std::size_t i = 0; i < group_.count(); ++i) {
    const std::int32_t contact = group_.contact(i);
    const std::uint8_t status = columns().status()[i];
    const std::array energies = columns().energies(static_cast<std::ptrdiff_t>(i));
    Refusal refusal;
    refusal.add_unknown(&status, &contact, 1);
    interface_.check(refusal, dt);
    if (const char* fault =
            fault_of(group_.impulse(i).data(), interface_.dimension_, energies.data(), status))
      interface_.check({ILAW_BAD_LIBRARY, 0, contact, 0, fault}, dt);
  }
}

void CoupledInterface::accept(const StepView& step, const Dofs& v) {
  ContactArrays& contacts = interface_.contacts_;
  ContactSums& sums = interface_.sums_;
  std::size_t place = 0;
  for (const std::int32_t contact : interface_.active()) {
    const auto k = static_cast<std::size_t>(contact);
    ++sums.statuses[contacts.status[k]];
    sums.penetration = std::max(sums.penetration, -interface_.gap(contact));
    interface_.setup().counterpart->note_contact(contacts.node_index[k], contacts.status[k] != ILAW_FREE,
                                                 interface_.point(contact));
    const bool acts = place < group_.count() && group_.contact(place) == contact;
    if (acts) accept_contact(step, v, place++);
  }
  columns().sum_amounts(sums);
  if (interface_.heat_) columns().give_heat(*interface_.heat_);
  interface_.total_amounts();
}

void CoupledInterface::accept_contact(const StepView& step, const Dofs& v, std::size_t place) {
  const std::int32_t contact = group_.contact(place);
  const auto k = static_cast<std::size_t>(contact);
  ContactArrays& contacts = interface_.contacts_;
  ContactSums& sums = interface_.sums_;
  const auto r = interface_.impulse(contact);
  const Vector sum = interface_.relative(contact, step.v_before) + interface_.relative(contact, v);
  sums.work += 0.5 * r.dot(sum);
  const Vector drift = group_.surface(place) + group_.surface_before(place);
  sums.relative_work += 0.5 * r.dot(sum - drift);
  const auto i = static_cast<std::ptrdiff_t>(place);
  sums.add_energy(columns().energies(i).data());
  const std::size_t state_size = interface_.info().state_size;
  if (state_size == 0) return;
  bool changed = false;
  for (std::size_t number = 0; number < state_size; ++number) {
    double& state = contacts.state.at(k, number);
    changed = changed || state != columns().state(i, number);
    state = columns().state(i, number);
  }
  const bool in_reach = is_in_reach(interface_.gap(contact), interface_.normal(contact).data(),
                                    v_free_of(place, v).data(), interface_.dimension_, step.dt);
  contacts.mark_touched(k, interface_.status(contact) != ILAW_FREE, in_reach || changed,
                        interface_.law_.may_skip_free());
}

}  // namespace ilaw::host
