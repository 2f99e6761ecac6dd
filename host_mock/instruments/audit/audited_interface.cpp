// SPDX-License-Identifier: BSD-3-Clause
#include "audit/audited_interface.hpp"

#include "audit/audit.hpp"
#include "base/words.hpp"
#include "contact/contact_geometry.hpp"

#include <ilaw/arrays.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace ilaw::host {
namespace {

// Parts of the largest velocity of the step. An answer may be off by the first. One that jumps (a rupture, a
// contact that closes) is judged at velocities and gaps off by the second, too; a gap that the third closes
// in a step counts as closed. A contact alone is known but for the rounding of its velocities; contacts that
// share nodes are solved to 1e-10.
struct Bounds {
  double law, jump, closing;
};
constexpr Bounds unshared{1e-13, 1e-13, 0.0}, shared{1e-9, 2e-10, 1e-10};
constexpr double energy_bound = 1e-7;
constexpr double rounding = 64.0 * std::numeric_limits<double>::epsilon();

ilaw_delassus_form form_of(const Interface& interface) {
  return interface.setup().has_driven_nodes ? ilaw_delassus_form{ILAW_DELASSUS_FULL}
                                            : ilaw_delassus_form{ILAW_DELASSUS_SCALAR};
}

}  // namespace

AuditedInterface::AuditedInterface(const Interface& interface, const Model& model, bool is_coupled)
    : interface_(interface),
      model_(model),
      d_(model.dimension()),
      law_(create_law(interface.setup().law, interface.setup().arguments, interface.setup().tangent,
                      interface.library(), d_, form_of(interface))),
      axes_(interface.axes()),
      is_coupled_(is_coupled),
      states_(interface.nodes().size()) {
  stops_ = !(law_.info().capabilities & ILAW_CAN_STORE_ENERGY) && find_whether_it_stops();
}

bool AuditedInterface::find_whether_it_stops() const {
  const Dofs zero = Dofs::Zero(model_.mass().size());
  const AuditedStep step{zero, zero, zero, zero, -1.0, 0.0, 1.0, 1.0, 1.0, 0.0, false};
  const Vector& tangent = interface_.setup().tangent;
  Call call;
  call.normal = tangent.size() > 0 ? across(tangent) : Vector(Vector::Unit(d_, d_ - 1));
  call.v_free = call.v_smooth = call.v_previous = -call.normal;
  call.delassus = Vector::Ones(d_);
  call.parameters = interface_.parameters_of(0);
  call.state = interface_.state_at(0, model_.initial_displacement());
  evaluate(call, 0, step);
  return (call.v_free + call.impulse).dot(call.normal) >= -rounding;
}

void AuditedInterface::open(const Dofs& u) {
  for (std::size_t k = 0; k < states_.size(); ++k) {
    const int node_index = static_cast<int>(k);
    if (states_[k].empty() || interface_.contact_at(node_index) >= 0)
      states_[k] = interface_.state_at(node_index, u);
  }
}

void AuditedInterface::add_impulses(Dofs& impulse) const {
  for (const std::int32_t contact : interface_.active()) interface_.add_impulse(contact, impulse);
}

void AuditedInterface::fail(int node_index, const std::string& what) const {
  const std::string node =
      node_index < 0
          ? ""
          : "node " + std::to_string(interface_.nodes()[static_cast<std::size_t>(node_index)]) + ", ";
  throw AuditFailure(node + "interface '" + interface_.name() + "' (law '" + interface_.setup().law +
                     "'): " + what);
}

// Relative to what the node meets. The law is asked at v - H r, which is what it saw if the step is right.
void AuditedInterface::find_velocities(Call& call, int node_index, const AuditedStep& step) const {
  const int contact = interface_.contact_at(node_index),
            node = interface_.nodes()[static_cast<std::size_t>(node_index)];
  const Counterpart& counterpart = *interface_.setup().counterpart;
  const ContactPoint alone, &point = contact < 0 ? alone : interface_.point(contact);
  Vector before = Vector::Zero(d_), after = before;
  if (const Obstacle* obstacle = counterpart.obstacle()) {
    after = obstacle->velocity(step.time, step.until);
    before = step.is_start ? after : obstacle->velocity(step.since, step.time);
  }
  if (counterpart.turns()) {
    const SurfaceVelocities surface =
        surface_velocities(counterpart, node_index, step.u, step.time,
                           {call.gap + interface_.setup().gap_offset(node_index), call.normal},
                           counterpart.obstacle()->rates(step.since, step.time, step.until));
    before += step.is_start ? surface.after : surface.before;
    after += surface.after;
  }
  call.v_previous = relative_velocity(point, node, d_, step.v_before) - before;
  call.v_smooth = relative_velocity(point, node, d_, step.v_smooth) - after;
  Vector own(d_);
  for (int axis = 0; axis < d_; ++axis) own[axis] = point.delassus(interface_.inverse_mass(), d_, node, axis);
  call.delassus = own.cwiseMax(driven_delassus * own.maxCoeff());
  call.v_free = relative_velocity(point, node, d_, step.v) - after - own.cwiseProduct(call.impulse);
}

// The memory of a law turns with its obstacle.
void AuditedInterface::turn(Call& call, const AuditedStep& step) const {
  const Counterpart& counterpart = *interface_.setup().counterpart;
  for (const std::size_t first : counterpart.turns() && !step.is_start ? axes_ : std::vector<std::size_t>())
    turn_axis(counterpart, d_, step.since, step.time,
              [&](std::size_t c) -> double& { return call.state[first + c]; });
}

AuditedInterface::Call AuditedInterface::call_of(int node_index, const AuditedStep& step) const {
  const int contact = interface_.contact_at(node_index);
  const std::size_t k = static_cast<std::size_t>(node_index);
  const bool is_active = interface_.is_active(contact);
  Call call;
  call.area = interface_.setup().area(node_index, interface_.point(contact));
  const bool is_partnered = !interface_.setup().counterpart->partners().empty();
  if (is_partnered) {
    const ContactPoint& point = interface_.point(contact);
    call.normal = point.normal;
    Vector from = Vector::Zero(d_);
    point.for_each_node(interface_.nodes()[k],
                        [&](int node, double weight) { from += weight * model_.position(node, step.u); });
    call.gap = point.is_beyond_border ? point.gap
                                      : from.dot(call.normal) - interface_.setup().gap_offset(node_index);
  } else {
    const ContactPoint point = interface_.setup().counterpart->contact_point(node_index, step.u, step.time);
    call.normal = point.normal;
    call.gap = point.gap - interface_.setup().gap_offset(node_index);
  }
  call.impulse = is_active ? Vector(interface_.impulse(contact)) : Vector(Vector::Zero(d_));
  call.parameters = contact < 0 ? interface_.parameters_of(node_index) : interface_.parameters_at(contact);
  call.state = states_[k];
  find_velocities(call, node_index, step);
  turn(call, step);
  return call;
}

void AuditedInterface::evaluate(Call& call, int node_index, const AuditedStep& step) const {
  const std::size_t size = call.state.size();
  std::vector<ilaw_input> parameters;
  for (const double& value : call.parameters) parameters.push_back(ilaw::input(&value, 0, 0));
  const Counterpart& counterpart = *interface_.setup().counterpart;
  const Vector tangent = counterpart.obstacle()
                             ? counterpart.obstacle()->turned(interface_.setup().tangent, 0.0, step.time)
                             : interface_.setup().tangent;
  std::vector<double> full(call.delassus.data(), call.delassus.data() + d_);  // no part off the diagonal
  full.resize(static_cast<std::size_t>(d_ * (d_ + 1) / 2));
  call.next_state.resize(size);
  call.impulse = Vector::Zero(d_);
  ilaw_batch batch = empty_batch(tangent, step.time, (step.is_start ? 0.5 : 1.0) * step.dt, step.dt);
  batch.node_count = 1;
  batch.flags = call.flags;
  batch.v_free = ilaw::input(call.v_free.data(), 0, 1);
  batch.v_smooth = ilaw::input(call.v_smooth.data(), 0, 1);
  batch.v_previous = ilaw::input(call.v_previous.data(), 0, 1);
  batch.delassus = interface_.setup().has_driven_nodes ? ilaw::input(full.data(), 0, 1)
                                                       : ilaw::input(call.delassus.data(), 0, 0);
  batch.gap = ilaw::input(&call.gap, 0, 0);
  batch.normal = ilaw::input(call.normal.data(), 0, 1);
  batch.area = ilaw::input(&call.area, 0, 0);
  batch.per_node_parameters = parameters.data();
  batch.state_in = ilaw::input(call.state.data(), 0, 1);
  batch.state_out = ilaw::output(call.next_state.data(), 0, 1);
  batch.impulse = ilaw::output(call.impulse.data(), 0, 1);
  batch.energy = ilaw::output(call.energy.data(), 0, 1);
  ilaw_status status = ILAW_FREE;
  batch.status = &status;
  ilaw_report report{};
  report.struct_size = sizeof report;
  if (const std::int32_t code = law_.evaluate(batch, &report); code != ILAW_OK)
    fail(node_index, std::string("law: refused with ") + (report.reason ? report.reason : "no reason"));
}

// Whether the law answers so, at the gap and velocity of the call.
bool AuditedInterface::answers(Call call, const Vector& found, int node_index, const AuditedStep& step,
                               double bound) {
  evaluate(call, node_index, step);
  if (!((call.impulse - found).cwiseProduct(call.delassus).cwiseAbs().maxCoeff() <= bound)) return false;
  for (std::size_t part = 0; part < energy_.size(); ++part) energy_[part] += call.energy[part];
  for (std::size_t part = 0; part < ILAW_ENERGY_STORED; ++part)
    if (call.energy[part] < 0.0)
      fail(node_index, formatted("energy: the law dissipates %.3g", call.energy[part]));
  return true;
}

// A bond that broke at a solution of contacts that share nodes stays broken in its step, although it would
// hold the load that its neighbors have taken over since.
bool AuditedInterface::is_final_rupture(int node_index) const {
  const int contact = interface_.contact_at(node_index);
  return (law_.info().capabilities & ILAW_CAN_HOLD_BONDS) && interface_.is_active(contact) &&
         interface_.status(contact) == ILAW_BROKEN;
}

void AuditedInterface::check_node(int node_index, const AuditedStep& step) {
  const Call call = call_of(node_index, step);
  const Vector change = call.delassus.cwiseProduct(call.impulse);
  const double speed = std::max({step.speed, call.v_free.norm(), call.v_previous.norm(), change.norm()});
  const Bounds& bounds = is_coupled_ ? shared : unshared;
  const double rounded = std::max(rounding * step.farthest, bounds.closing * speed * step.dt);
  const double bound = bounds.law * speed + rounded / step.dt;
  work_scale_ += call.impulse.norm() * (call.v_free.norm() + call.v_previous.norm() + change.norm()) +
                 call.impulse.norm() * step.speed;
  // Within the bound an impulse is off by bound / H, which is large at driven nodes, with next to no H.
  if (const double least = call.delassus.minCoeff(); least > 0.0)
    work_rounding_ += bound / least * (least < call.delassus.maxCoeff() ? speed : bound);
  if (!(law_.info().capabilities & ILAW_CAN_ADHERE) && change.dot(call.normal) < -bound)
    fail(node_index,
         formatted("cone: the impulse %.3g pulls, and the law cannot adhere", call.impulse.dot(call.normal)));
  check_gap(call, node_index, step, bounds.law);
  const double h = bounds.jump * speed + rounded / step.dt;
  for (const auto& [gap, velocity] : {std::pair{0.0, 0.0}, std::pair{-rounded, 0.0}, std::pair{rounded, 0.0},
                                      std::pair{0.0, -h}, std::pair{0.0, h}}) {
    Call near = call;
    near.gap += gap;
    near.v_free += velocity * call.normal;
    near.v_smooth += velocity * call.normal;
    if (answers(near, call.impulse, node_index, step, bound)) return;
  }
  if (is_final_rupture(node_index)) {
    Call broken = call;
    broken.flags = ILAW_BATCH_BREAK_BONDS;
    if (answers(broken, call.impulse, node_index, step, bound)) return;
  }
  Call own = call;
  evaluate(own, node_index, step);
  fail(node_index, formatted("impulse: found %.6g along the normal, the law answers %.6g; off by %.2g of the "
                             "largest velocity",
                             call.impulse.dot(call.normal), own.impulse.dot(call.normal),
                             (own.impulse - call.impulse).cwiseProduct(call.delassus).norm() / speed));
}

// Beyond the border only an intact bond has an impulse.
void AuditedInterface::check_beyond_border(int node_index) const {
  const double impulse = interface_.impulse(interface_.contact_at(node_index)).norm();
  if (impulse > 0.0) fail(node_index, formatted("impulse: %.6g beyond the border of the surface", impulse));
}

// Once the gap is closed a rigid law lets nothing further in, but as fast as it came out in the step before:
// then its impulse would do work on the way out.
void AuditedInterface::check_gap(const Call& call, int node_index, const AuditedStep& step,
                                 double relative_bound) const {
  const bool is_rigid = stops_ && !(law_.info().capabilities & ILAW_CAN_ADHERE);
  if (!is_rigid || call.gap > -rounding * step.farthest) return;
  const Vector v = call.v_free + call.delassus.cwiseProduct(call.impulse);
  const double bound = relative_bound * std::max(step.speed, call.v_free.norm()) +
                       rounding * step.farthest / step.dt + std::max(0.0, call.v_previous.dot(call.normal));
  if (v.dot(call.normal) < -bound)
    fail(node_index, formatted("gap: it is %.3g and closes at %.3g, which a rigid law allows by %.3g alone",
                               call.gap, -v.dot(call.normal), bound));
}

// What the host has booked for the interface is what its law says.
void AuditedInterface::check_energy(const AuditedStep&) const {
  if (!interface_.gives_energies()) return;
  for (std::size_t part = 0; part < energy_.size(); ++part) {
    const double booked = interface_.sums().energy[part];
    const double scale = work_scale_ + std::abs(booked) + std::abs(energy_[part]);
    if (!(std::abs(booked - energy_[part]) <= energy_bound * scale + work_rounding_))
      fail(-1, formatted("energy: part %zu is %.6g, the laws say %.6g", part, booked, energy_[part]));
  }
}

void AuditedInterface::close(const AuditedStep& step) {
  const InterfaceSetup& setup = interface_.setup();
  if (step.time < setup.birth || step.time >= setup.death) return;
  energy_ = {};
  work_scale_ = work_rounding_ = 0.0;
  interface_.setup().counterpart->follow(step.u);
  const bool is_partnered = !interface_.setup().counterpart->partners().empty(),
             adheres = (law_.info().capabilities & ILAW_CAN_ADHERE) != 0;
  for (int k = 0; k < static_cast<int>(states_.size()); ++k) {
    const int contact = interface_.contact_at(k);
    // What a node out of reach of other bodies would face, nobody has looked for; nor its temperature.
    if ((is_partnered || interface_.heat()) && !interface_.is_active(contact)) continue;
    if (contact >= 0 && interface_.point(contact).is_beyond_border && !adheres)
      check_beyond_border(k);
    else
      check_node(k, step);
  }
  check_energy(step);
}

}  // namespace ilaw::host
