// What surrounds the steps: how a run starts, what is read of it, and where it can go on from.
// SPDX-License-Identifier: BSD-3-Clause
#include "base/bytes.hpp"
#include "step/dof_loops.hpp"
#include "step/integrator.hpp"

#include <algorithm>

namespace ilaw::host {

// Half a kick takes V_0 to V_{1/2}.
Integrator::Integrator(const Model& model, const Loads& loads, Interfaces& interfaces, double dt)
    : model_(model),
      loads_(loads),
      interfaces_(interfaces),
      dt_(dt),
      loads_are_steady_(
          std::all_of(loads.begin(), loads.end(), [](const auto& load) { return load->is_steady(); })),
      loads_correct_(
          std::any_of(loads.begin(), loads.end(), [](const auto& load) { return load->corrects(); })),
      u_(model.initial_displacement()),
      v_(model.initial_velocity()),
      v_before_(v_),
      external_impulse_(Dofs::Zero(loads.empty() ? 0 : u_.size())),
      internal_impulse_(Dofs::Zero(model.has_internal_forces() ? u_.size() : 0)),
      inverse_mass_(model.mass().cwiseInverse()) {
  if (share_nodes(model_, interfaces_)) coupled_.emplace(model_, interfaces_);
  Dofs force = Dofs::Zero(u_.size());
  for (const auto& load : loads_) load->add_force(0.0, force);
  if (loads_are_steady_ && !loads_.empty()) external_impulse_ = dt_ * force;
  model_.add_internal_forces(u_, force);
  v_ += 0.5 * dt_ * force.cwiseQuotient(model_.mass());
  for (const auto& load : loads_) load->start(dt_, v_before_, v_);
  accounts_.start(model_, u_, u_ + dt_ * v_, v_);
  speed_before_ = largest_speed(v_, model_.dimension());
}

Dofs Integrator::interface_impulse() const {
  Dofs impulse = Dofs::Zero(u_.size());
  for (const auto& interface : interfaces_)
    for (const std::int32_t contact_index : interface->active())
      interface->add_impulse(contact_index, impulse);
  return impulse;
}

void Integrator::save(std::ostream& out) const {
  write_value(out, steps_);
  for (const Dofs* dofs : {&u_, &v_}) write_array(out, dofs->data(), static_cast<std::size_t>(dofs->size()));
  accounts_.save(out);
  for (const auto& interface : interfaces_) interface->save(out);
}

void Integrator::load(std::istream& in) {
  read_value(in, steps_);
  for (Dofs* dofs : {&u_, &v_}) read_array(in, dofs->data(), static_cast<std::size_t>(dofs->size()));
  accounts_.load(in);
  speed_before_ = largest_speed(v_, model_.dimension());
  for (const auto& interface : interfaces_) interface->load(in, u_);
}

}  // namespace ilaw::host
