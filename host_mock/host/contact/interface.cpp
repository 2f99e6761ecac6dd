// SPDX-License-Identifier: BSD-3-Clause
#include "contact/interface.hpp"

#include "base/large_pages.hpp"
#include "base/parallel.hpp"
#include "base/words.hpp"
#include "contact/contact_geometry.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

namespace ilaw::host {
namespace {

// On a plane that turns about its normal the law cannot see what its tangential memory has to turn with. Axes
// in its state would have to turn in every step (turn_axis), and contacts out of reach be asked for that.
InterfaceSetup with_tangent(InterfaceSetup setup, const Model& model) {
  const Counterpart& counterpart = *setup.counterpart;
  if (!counterpart.turns() || !counterpart.keeps_normal() || setup.tangent.size() > 0) return setup;
  const Law law(setup.library, setup.law, setup.arguments, {}, model.dimension(), setup.name);
  if (!law.axes().empty()) setup.tangent = across(counterpart.flat_at(0.0)->normal);
  return setup;
}

}  // namespace

Interface::Interface(InterfaceSetup setup, const Model& model)
    : setup_(with_tangent(std::move(setup), model)),
      model_(model),
      dimension_(model.dimension()),
      law_(setup_.library, setup_.law, setup_.arguments, setup_.tangent, dimension_, setup_.name,
           setup_.has_driven_nodes ? ILAW_DELASSUS_FULL : ILAW_DELASSUS_SCALAR),
      axes_(law_.axes()),
      contacts_(dimension_, law_.info(), setup_.nodes.size(), !setup_.counterpart->partners().empty()),
      search_(setup_, law_, contacts_),
      obstacle_(setup_, dimension_),
      amounts_(law_.info().amount_count) {
  // An area that changes would change the stored energy without work (mortar.md, Areas).
  const bool store_energy = (info().capabilities & ILAW_CAN_STORE_ENERGY) != 0;
  if (store_energy || (info().capabilities & ILAW_CAN_ADHERE) != 0)
    setup_.counterpart->expect_bonds(store_energy, bonds_at_once());
  if (bonds_at_start()) leave_out();
  if (setup_.heat) heat_.emplace(law_.info(), setup_.heat->obstacle_temperature);
}

// A face may overhang the other one. What has nothing below it at the start has no bond.
void Interface::leave_out() {
  const Counterpart& counterpart = *setup_.counterpart;
  for (std::size_t k = 0; k < setup_.nodes.size(); ++k) {
    const auto index = static_cast<int>(k);
    if (counterpart.has_overlap(index)) continue;
    setup_.left_out.resize(setup_.nodes.size());
    setup_.left_out[k] =
        counterpart.contact_point(index, model_.initial_displacement(), 0.0).is_beyond_border ? 1 : 0;
  }
}

// With what of the node limits the step, where equations have more than one solution.
void Interface::check(const Refusal& refusal, double dt) const {
  if (refusal.code == ILAW_OK) return;
  if (refusal.contact < 0) return check(refusal, "");
  std::string node = std::to_string(node_of(refusal.contact));
  if (refusal.code == ILAW_BAD_NODES)
    node +=
        formatted(" (H = %.6g, area %.6g, step %.6g)", delassus(refusal.contact), area(refusal.contact), dt);
  check(refusal, node);
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
                 !law_.may_skip_fresh(), search_.axes_turn()});
  if (setup_.has_driven_nodes) find_delassus(contacts_.count() - 1);
  search_.look_again(node_index);
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

// ---- a step ---------------------------------------------------------------------------------------------

void Interface::choose_active(const StepView& step) {
  obstacle_.follow(step);
  search_.choose(step, obstacle_, [&](int node_index) { return contact_index_of(node_index, step.u); });
  if (heat_) heat_->open(step.time, contacts_.count(), active());
}

void Interface::solve(const StepView& step, Dofs& v) {
  choose_active(step);
  if (active().empty()) {
    sums_.clear();
    return;
  }
  const BlockStep blocks{
      setup_, model_,           inverse_mass_,           law_,   contacts_,  step, obstacle_, axes_,
      v,      gives_energies(), asks_energies_ || heat_, heat(), one_by_one_};
  const ChunkStep step_chunk = chunk_step_of(blocks);
  outcomes_.resize(static_cast<std::size_t>(search_.chunk_count()));
  for_each_chunk(search_.chunk_count(), 1, [&](std::ptrdiff_t c, auto, auto) {
    ChunkOutcome& outcome = outcomes_[static_cast<std::size_t>(c)];
    outcome = {};
    if (const NearContacts contacts = search_.chunk(c); contacts.count > 0)
      step_chunk(blocks, contacts, outcome);
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

// The law gives the conducted heat of contacts that share no node and that nothing else heats.
void Interface::total_amounts() {
  for (std::size_t k = 0; k < sums_.amounts.size(); ++k)
    if (!heat_ || !heat_->is_conducted_heat(k)) amounts_[k] += sums_.amounts[k];
}

void Interface::add_conducted_heat(double heat) {
  for (std::size_t k = 0; k < amounts_.size(); ++k)
    if (heat_->is_conducted_heat(k)) amounts_[k] += heat;
}

// ---- the last step --------------------------------------------------------------------------------------

bool Interface::is_active(int contact_index) const {
  return contact_index >= 0 && search_.contains(node_index_of(contact_index));
}

bool Interface::has_lost_a_node(const Dofs& u, double time) const {
  constexpr double rounding = 1e-6;
  setup_.counterpart->follow(u);
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
  return relative_velocity(point(contact_index), node_of(contact_index), dimension_, v);
}

// The node comes to where it is with the velocity before the step.
Interface::Rubbing Interface::rubbing(int contact_index, const StepView& step) const {
  const int node_index = node_index_of(contact_index);
  ContactGeometry found;
  locate_contact(setup_, node_index, step, obstacle_.rates(), found);
  const auto& [point, surface] = found;
  const auto along_surface = [&normal = point.normal](const Vector& vector) {
    return (vector - vector.dot(normal) * normal).norm();
  };
  const Vector v = relative(contact_index, step.v_before) - obstacle_.velocity_before() - surface.before;
  const Vector r = impulse(contact_index);
  const double area = setup_.area(node_index, point);
  return {r.dot(point.normal) / (step.dt * area), along_surface(r) / (step.dt * area),
          step.dt * along_surface(v)};
}

void Interface::add_impulse(int contact_index, Dofs& impulse) const {
  const Eigen::Index d = dimension_;
  point(contact_index).for_each_node(node_of(contact_index), [&](int node, double weight) {
    impulse.segment(node * d, d) += weight * this->impulse(contact_index);
  });
}

}  // namespace ilaw::host
