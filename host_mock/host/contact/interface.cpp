// SPDX-License-Identifier: BSD-3-Clause
#include "contact/interface.hpp"

#include "base/large_pages.hpp"
#include "base/parallel.hpp"
#include "base/running_law.hpp"
#include "contact/contact_geometry.hpp"
#include "contact/law_faults.hpp"
#include "contact/plain_step.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>
#include <utility>

namespace ilaw::host {
namespace {

// The largest speed is that of the largest square, which is 0 for smaller ones: nodes that come to
// rest on a spring have them, at gaps as small.
constexpr double least_speed = 0x1p-500;

// H of a driven axis as laws are given it, beside the largest of the node: they resolve 2^-42 of it.
constexpr double driven_delassus = 0x1p-40;

// On a plane that turns about its normal the law cannot see what its tangential memory has to turn with. Axes
// in its state would have to turn in every step (turn_axis), and contacts out of reach be asked for that.
InterfaceSetup with_tangent(InterfaceSetup setup, const Model& model) {
  const Counterpart& counterpart = *setup.counterpart;
  if (!counterpart.turns() || !counterpart.keeps_normal() || setup.tangent.size() > 0) return setup;
  const Law law(setup.library, setup.law, setup.arguments, {}, model.dimension());
  if (!law.axes().empty()) setup.tangent = across(counterpart.flat_at(0.0)->normal);
  return setup;
}

}  // namespace

Interface::Interface(InterfaceSetup setup, const Model& model)
    : setup_(with_tangent(std::move(setup), model)),
      model_(model),
      dimension_(model.dimension()),
      law_(setup_.library, setup_.law, setup_.arguments, setup_.tangent, dimension_,
           setup_.has_driven_nodes ? ILAW_DELASSUS_FULL : ILAW_DELASSUS_SCALAR),
      axes_(law_.axes()),
      contacts_(dimension_, law_.info(), setup_.nodes.size(), !setup_.counterpart->partners().empty()),
      obstacle_velocity_(Vector::Zero(dimension_)),
      obstacle_velocity_before_(obstacle_velocity_),
      tangent_(setup_.tangent),
      amounts_(law_.info().amount_count) {}

// With what of the node limits the step, where equations have more than one solution.
void Interface::check(const Refusal& refusal, double dt) const {
  if (refusal.code == ILAW_OK) return;
  if (refusal.contact < 0) return check(refusal, "");
  std::array<char, 128> given{};
  if (refusal.code == ILAW_BAD_NODES)
    std::snprintf(given.data(), given.size(), " (H = %.6g, area %.6g, step %.6g)", delassus(refusal.contact),
                  setup_.areas[at(node_index_of(refusal.contact))], dt);
  check(refusal, std::to_string(node_of(refusal.contact)) + given.data());
}

void Interface::check(const Refusal& refusal, const std::string& node) const {
  if (refusal.code == ILAW_OK) return;
  std::string text =
      "interface '" + setup_.name + "' (law '" + setup_.law + "', library " + library().path() + "): ";
  if (refusal.status >= ILAW_STATUS_COUNT)
    throw ilaw::error(refusal.code, text + "found status " + std::to_string(refusal.status) + " at node " +
                                        node + ", expected 0 to " + std::to_string(ILAW_STATUS_COUNT - 1));
  if (refusal.code == ILAW_BAD_NODES)
    text += std::to_string(refusal.bad_count) + " node(s) refused, first node " + node + ": ";
  else if (!node.empty())
    text += "node " + node + ": ";
  if (!refusal.reason) text += "code " + std::to_string(refusal.code) + ", ";
  throw ilaw::error(refusal.code, text + (refusal.reason ? refusal.reason : "no reason given"));
}

// ---- contacts -------------------------------------------------------------------------------------------

int Interface::contact_index_of(int node_index, const Dofs& u) {
  const std::size_t k = at(node_index);
  if (const int found = contacts_.index_of(k); found >= 0) return found;
  contacts_.add({node_index, ContactPoint().delassus(inverse_mass_, dimension_, setup_.nodes[k]),
                 setup_.areas[k], parameters_of(node_index), first_state(node_index, u),
                 !law_.may_skip_fresh(), axes_turn()});
  if (setup_.has_driven_nodes) find_delassus(contacts_.count() - 1);
  if (const std::size_t chunk = k / contact_chunk; chunk < far_.size()) far_[chunk] = {};
  return contacts_.index_of(k);
}

// Contacts with partners find their H in every step.
void Interface::set_inverse_mass(const double* inverse_mass) {
  inverse_mass_ = inverse_mass;
  for (std::size_t k = 0; k < contacts_.count() && contacts_.point.empty(); ++k) find_delassus(k);
}

// A driven axis has H = 0, which laws refuse. They are given a small part of the largest H, which every
// precision of the kit resolves; impulses are applied with the true one.
void Interface::find_delassus(std::size_t k) {
  const auto along = [&](int axis) {
    return point(static_cast<int>(k)).delassus(inverse_mass_, dimension_, node_of(static_cast<int>(k)), axis);
  };
  contacts_.delassus[k] = along(0);
  if (!setup_.has_driven_nodes) return;
  const auto d = at(dimension_);
  for (std::vector<double>* values : {&contacts_.axis_delassus, &contacts_.law_delassus})
    values->resize(d * contacts_.count());
  double* const own = &contacts_.axis_delassus[d * k];
  for (int axis = 0; axis < dimension_; ++axis) own[axis] = along(axis);
  contacts_.delassus[k] = *std::max_element(own, own + d);
  for (std::size_t axis = 0; axis < d; ++axis)
    contacts_.law_delassus[d * k + axis] = std::max(own[axis], driven_delassus * contacts_.delassus[k]);
}

Vector Interface::velocity_of(int contact_index, const Vector& impulse) const {
  if (contacts_.axis_delassus.empty()) return delassus(contact_index) * impulse;
  return contacts_.vector(contacts_.axis_delassus, contact_index).cwiseProduct(impulse);
}

// A rigid law that is driven along its normal answers with an impulse that takes the whole approach, over the
// small H that it was given. The size of the answer tells it: the node would give way by H r, and laws that
// need no such thing give way by a vanishing part of the speed, or of the indentation in a step.
void Interface::check_driven(const StepView& step, const Dofs& v, const CoupledGroup& group) const {
  constexpr double noticeable = 1e-9;
  if (contacts_.axis_delassus.empty()) return;
  const double speed = std::max(step.speed_before, step.speed_after);
  for (std::size_t place = 0; place < group.count(); ++place) {
    const std::int32_t k = group.contact(place);
    const Vector given_way =
        contacts_.vector(contacts_.law_delassus, k).cwiseProduct(impulse(k)) - velocity_of(k, impulse(k));
    Eigen::Index axis = 0;
    const double largest = given_way.cwiseAbs().maxCoeff(&axis);
    if (!(largest > noticeable * std::max(speed, std::abs(gap(k)) / step.dt))) continue;
    if (largest < 0.5 * std::abs(v_free_of(group, place, v)[axis])) continue;
    std::array<char, 160> text{};
    std::snprintf(text.data(), text.size(),
                  "node %d is driven along axis %td against '%s' (law '%s'), which cannot give way",
                  node_of(k), axis, name().c_str(), setup_.law.c_str());
    throw std::runtime_error(text.data());
  }
}

bool Interface::axes_turn() const { return !axes_.empty() && !setup_.counterpart->keeps_normal(); }

bool Interface::may_skip() const {
  if (setup_.keeps_all_active || (!law_.may_skip_fresh() && !law_.may_skip_free())) return false;
  return !axes_turn();
}

// Chunks are cut by the nodes, so that sums do not depend on which of them are near. Of those whose
// nodes are all far, only what may have come closer is looked at.
void Interface::refresh_near(const StepView& step) {
  setup_.counterpart->refresh(step.u);
  const auto count = static_cast<std::ptrdiff_t>(setup_.nodes.size());
  is_near_.resize(setup_.nodes.size());
  far_.resize(static_cast<std::size_t>(chunks_of(count, contact_chunk)));
  for_each_chunk(static_cast<std::ptrdiff_t>(far_.size()), 1, [&](std::ptrdiff_t c, auto, auto) {
    const auto chunk = static_cast<std::size_t>(c);
    if (proximity_.may_touch(far_[chunk])) look_at(chunk, step);
  });
  const std::size_t known = contacts_.count();
  near_.clear();
  near_nodes_.clear();
  chunk_starts_.clear();
  for (std::size_t c = 0; c < far_.size(); ++c) {
    chunk_starts_.push_back(static_cast<std::ptrdiff_t>(near_.size()));
    if (far_[c].gap_bound > 0.0) continue;
    const std::size_t first = c * contact_chunk, end = std::min(first + contact_chunk, is_near_.size());
    for (std::size_t k = first; k < end; ++k) {
      if (!is_near_[k]) continue;
      near_.push_back(contact_index_of(static_cast<int>(k), step.u));
      near_nodes_.push_back(setup_.nodes[k]);
    }
  }
  chunk_starts_.push_back(static_cast<std::ptrdiff_t>(near_.size()));
  if (contacts_.count() == known) return;
  contacts_.keep_in_large_pages();
  host::keep_in_large_pages(near_);
  host::keep_in_large_pages(near_nodes_);
}

// Touched contacts stay near: only fresh ones, and those at rest, are known to do nothing at a
// distance.
void Interface::look_at(std::size_t chunk, const StepView& step) {
  const std::size_t first = chunk * contact_chunk,
                    count = std::min<std::size_t>(contact_chunk, is_near_.size() - first);
  const bool skips = may_skip(), may_be_awake = info().state_size > 0 || !law_.may_skip_fresh();
  std::array<double, contact_chunk> bounds;
  if (skips)
    setup_.counterpart->gap_bounds(static_cast<int>(first), static_cast<int>(count), step.u, step.time,
                                   bounds.data());
  std::size_t near = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < count; ++i) {
    const int contact_index = may_be_awake ? contacts_.index_of(first + i) : -1;
    const bool awake =
        contact_index >= 0 ? contacts_.must_be_evaluated(at(contact_index)) : !law_.may_skip_fresh();
    const double gap = skips ? bounds[i] - setup_.gap_offset : 0.0;
    const bool is_near = awake || !skips || proximity_.may_touch(gap) ||
                         setup_.counterpart->is_held(static_cast<int>(first + i));
    is_near_[first + i] = is_near ? 1 : 0;
    near += is_near ? 1 : 0;
    least = gap < least ? gap : least;
  }
  far_[chunk] = near > 0 || setup_.counterpart->validity() < std::numeric_limits<double>::infinity()
                    ? FarNodes{}
                    : FarNodes{least, proximity_.way()};
}

// ---- a step ---------------------------------------------------------------------------------------------

// One that stands still is asked once: a few virtual calls take as long as a law that has one node.
void Interface::follow_obstacle(const StepView& step) {
  if (obstacle_is_known_) return;
  const Counterpart& counterpart = *setup_.counterpart;
  obstacle_velocity_before_ = counterpart.velocity(step.since, step.time);
  obstacle_velocity_ = counterpart.velocity(step.time, step.until);
  if (step.number == 0)
    obstacle_velocity_before_ = obstacle_velocity_;  // the start is no impact of the obstacle
  obstacle_speed_before_ = obstacle_velocity_before_.norm();
  obstacle_speed_ = obstacle_velocity_.norm();
  obstacle_speed_before_ += counterpart.tilting_speed(step.since, step.time, step.u);
  obstacle_speed_ += counterpart.tilting_speed(step.time, step.until, step.u);
  if (counterpart.turns()) rates_ = counterpart.rates({step.since, step.time, step.until});
  if (step.number == 0) rates_.before = rates_.after;
  flat_ = counterpart.flat_at(step.time);
  tangent_ = counterpart.turned(setup_.tangent, 0.0, step.time);
  obstacle_is_known_ = counterpart.stands_still();
}

void Interface::choose_active(const StepView& step) {
  follow_obstacle(step);
  const Counterpart& counterpart = *setup_.counterpart;
  const double moving = counterpart.partners().empty() ? 1.0 : 2.0;
  const double closing_before = moving * std::max(step.speed_before, least_speed) + obstacle_speed_before_,
               closing_after = moving * std::max(step.speed_after, least_speed) + obstacle_speed_;
  closing_ = step.dt * closing_after;
  const bool due = proximity_.refresh_due(step.dt, closing_before, closing_after, counterpart.validity());
  const double clock = std::max(step.time, 0.0);  // before it, a run is prestressed
  acts_ = !(clock < setup_.birth || clock >= setup_.death);
  if (!acts_)
    proximity_.invalidate();
  else if (due)
    refresh_near(step);
}

void Interface::solve(const StepView& step, Dofs& v) {
  choose_active(step);
  if (active().empty()) {
    sums_ = {};
    return;
  }
  const bool energies = asks_energies_ && (law_.outputs() & ILAW_OUTPUT_ENERGY) != 0,
             watched = InputCopy::is_due(step.number);
  const BlockStep blocks{setup_,
                         model_,
                         inverse_mass_,
                         law_,
                         contacts_,
                         step,
                         flat_ ? &*flat_ : nullptr,
                         obstacle_velocity_,
                         obstacle_velocity_before_,
                         tangent_,
                         axes_,
                         rates_,
                         v,
                         energies,
                         watched};
  const auto step_chunk = steps_plainly_ ? plain_step : solve_chunk;
  outcomes_.resize(chunk_starts_.size() - 1);
  const RunningLaw running(setup_.law.c_str(), ilaw_library_path(library().get()), setup_.name.c_str());
  for_each_chunk(static_cast<std::ptrdiff_t>(outcomes_.size()), 1, [&](std::ptrdiff_t c, auto, auto) {
    const std::ptrdiff_t* const range = &chunk_starts_[static_cast<std::size_t>(c)];
    ChunkOutcome& outcome = outcomes_[static_cast<std::size_t>(c)];
    outcome = {};
    const std::ptrdiff_t first = range[0], count = range[1] - first;
    if (count > 0) step_chunk(blocks, {near_.data() + first, near_nodes_.data() + first, count}, outcome);
  });
  Refusal refusal = outcomes_.front().refusal;
  sums_ = outcomes_.front().sums;
  for (std::size_t c = 1; c < outcomes_.size(); ++c) {
    refusal.add(outcomes_[c].refusal);
    sums_.add(outcomes_[c].sums);
  }
  if (refusal.code != ILAW_OK) check(refusal, step.dt);
  total_amounts();
}

void Interface::total_amounts() {
  for (std::size_t k = 0; k < sums_.amounts.size(); ++k) amounts_[k] += sums_.amounts[k];
}

// ---- a step where contacts share nodes ------------------------------------------------------------------

CoupledGroup Interface::make_group() const {
  const Counterpart& counterpart = *setup_.counterpart;
  int partners = 0;
  if (!counterpart.partners().empty())
    partners = counterpart.shares_partners() ? ContactPoint::most_partners : 1;
  return {law_, setup_.name, dimension_, setup_.has_driven_nodes ? ILAW_DELASSUS_FULL : ILAW_DELASSUS_SCALAR,
          partners};
}

const ilaw_contacts& Interface::open_step(const StepView& step, CoupledGroup& group) {
  choose_active(step);
  sums_ = {};
  group.open(InputCopy::is_due(step.number));
  for (const std::int32_t contact_index : active()) {
    const std::size_t k = at(contact_index);
    const auto [point, surface] = locate_contact(setup_, contacts_.node_index[k], step, rates_);
    turn_axes(setup_, axes_, dimension_, step,
              [&](std::size_t number) -> double& { return contacts_.state.at(k, number); });
    contacts_.gap[k] = point.gap;
    contacts_.vector(contacts_.normal, contact_index) = point.normal;
    contacts_.vector(contacts_.impulse, contact_index).setZero();
    contacts_.status[k] = ILAW_FREE;
    if (point.is_beyond_border && setup_.counterpart->is_held(contacts_.node_index[k])) ++sums_.left;
    if (point.partner_count > 0) {
      contacts_.point[k] = point;
      find_delassus(k);
    }
    if (is_idle(contact_index)) continue;
    const Vector after = obstacle_velocity_ + surface.after,
                 before = obstacle_velocity_before_ + surface.before;
    group.add({contact_index, node_of(contact_index), point, after, before}, contacts_);
  }
  return group.close(tangent_, step);
}

// Out of reach, and its state does not change there.
bool Interface::is_idle(int contact_index) const {
  const std::size_t k = at(contact_index);
  return !axes_turn() && !contacts_.must_be_evaluated(k) && contacts_.gap[k] > closing_;
}

void Interface::take(const CoupledGroup& group) {
  for (std::size_t i = 0; i < group.count(); ++i) {
    contacts_.vector(contacts_.impulse, group.contact(i)) = group.impulse(i);
    contacts_.status[at(group.contact(i))] = group.status(i);
  }
}

void Interface::check_solve(const CoupledGroup& group, const ilaw_coupled_report& report,
                            std::int64_t bad_contact, double dt) const {
  check(group.refusal(), dt);
  if (bad_contact < 0) return;
  check({ILAW_BAD_NODES, report.bad_count, group.contact(static_cast<std::size_t>(bad_contact)), 0,
         report.reason},
        dt);
}

// Velocity that the law sees, without the contact's own impulse.
Vector Interface::v_free_of(const CoupledGroup& group, std::size_t place, const Dofs& v) const {
  const std::int32_t contact_index = group.contact(place);
  return relative(contact_index, v) - group.surface(place) -
         velocity_of(contact_index, impulse(contact_index));
}

void Interface::accept(const StepView& step, const Dofs& v, const CoupledGroup& group) {
  std::size_t place = 0;
  for (const std::int32_t contact_index : active()) {
    const bool acts = place < group.count() && group.contact(place) == contact_index;
    const std::size_t k = at(contact_index);
    Refusal unknown;
    unknown.add_unknown(&contacts_.status[k], &contact_index, 1);
    check(unknown, step.dt);
    ++sums_.statuses[contacts_.status[k]];
    sums_.penetration = std::max(sums_.penetration, -gap(contact_index));
    setup_.counterpart->note_contact(contacts_.node_index[k], contacts_.status[k] != ILAW_FREE,
                                     point(contact_index));
    if (acts) accept_contact(step, v, group, place++);
  }
  total_amounts();
  if (show_fault(sums_)) find_fault(group, step.dt);
}

void Interface::accept_contact(const StepView& step, const Dofs& v, const CoupledGroup& group,
                               std::size_t place) {
  const std::int32_t contact_index = group.contact(place);
  const std::size_t k = at(contact_index);
  const Vector sum = relative(contact_index, step.v_before) + relative(contact_index, v);
  sums_.work += 0.5 * impulse(contact_index).dot(sum);
  const Vector drift = group.surface(place) + group.surface_before(place);
  sums_.relative_work += 0.5 * impulse(contact_index).dot(sum - drift);
  sums_.add_energy(group.energy(place));
  for (std::size_t a = 0; a < group.amount_count(); ++a) sums_.add_amount(a, group.amount(a, place));
  bool changed = false;
  for (std::size_t number = 0; number < info().state_size; ++number) {
    double& state = contacts_.state.at(k, number);
    changed = changed || state != group.state(place, number);
    state = group.state(place, number);
  }
  if (info().state_size == 0) return;
  const bool in_reach = is_in_reach(gap(contact_index), normal(contact_index).data(),
                                    v_free_of(group, place, v).data(), dimension_, step.dt);
  contacts_.mark_touched(k, status(contact_index) != ILAW_FREE, in_reach || changed, law_.may_skip_free());
}

void Interface::find_fault(const CoupledGroup& group, double dt) const {
  for (std::size_t i = 0; i < group.count(); ++i)
    if (const char* fault = fault_of(group.impulse(i).data(), dimension_, group.energy(i), group.status(i)))
      check({ILAW_BAD_LIBRARY, 0, group.contact(i), 0, fault}, dt);
}

// ---- the last step --------------------------------------------------------------------------------------

bool Interface::is_active(int contact_index) const {
  if (contact_index < 0 || active().empty()) return false;
  return is_near_[at(node_index_of(contact_index))] != 0;
}

bool Interface::has_lost_a_node(const Dofs& u, double time) const {
  constexpr double rounding = 1e-6;
  for (std::size_t k = 0; k < setup_.nodes.size(); ++k) {
    const ContactPoint point = setup_.counterpart->contact_point(static_cast<int>(k), u, time);
    const double length = point.normal.norm();
    if (!(std::isfinite(point.gap) && std::abs(length - 1.0) < rounding)) return true;
  }
  return false;
}

const ContactPoint& Interface::point(int contact_index) const {
  static const ContactPoint alone;
  return contacts_.point.empty() ? alone : contacts_.point[at(contact_index)];
}

Vector Interface::relative(int contact_index, const Dofs& v) const {
  const Eigen::Index d = dimension_;
  const ContactPoint& point = this->point(contact_index);
  Vector relative = v.segment(node_of(contact_index) * d, d);
  for (std::size_t i = 0; i < at(point.partner_count); ++i)
    relative -= point.weights[i] * v.segment(point.partners[i] * d, d);
  return relative;
}

void Interface::add_impulse(int contact_index, Dofs& impulse) const {
  const Eigen::Index d = dimension_;
  point(contact_index).for_each_node(node_of(contact_index), [&](int node, double weight) {
    impulse.segment(node * d, d) += weight * this->impulse(contact_index);
  });
}

}  // namespace ilaw::host
