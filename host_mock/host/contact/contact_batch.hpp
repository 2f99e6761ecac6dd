// contact_batch.hpp - one contact as a law is given it: a batch of one node on the stored arrays.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "contact/block_step.hpp"
#include "contact/contact_geometry.hpp"

#include <ilaw/arrays.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace ilaw::host {

struct ContactBatch {
  ilaw_batch batch;
  std::array<double, ILAW_ENERGY_COUNT> energy{};
  std::vector<double> amounts;

  ContactBatch(const BlockStep& step, std::int32_t contact, const ContactPoint& point, const Vector& v_free,
               const Vector& v_previous)
      : batch(empty_batch(step.obstacle.tangent(), step.step.time, step.step.velocity_step(), step.step.dt)),
        amounts(step.gets_energies ? step.law.info().amount_count : 0),
        state_(step.contacts.state.of(static_cast<std::size_t>(contact))) {
    ContactArrays& at = step.contacts;
    const auto k = static_cast<std::size_t>(contact);
    for (const std::vector<double>& values : at.parameters)
      parameters_.push_back(ilaw::input(&values[k], 1, 0));
    turn_axes(step.setup, step.axes, step.model.dimension(), step.step,
              [&](std::size_t number) -> double& { return state_[number]; });
    for (double& amount : amounts) outputs_.push_back(ilaw::output(&amount, 1, 0));
    batch.node_count = 1;
    batch.v_free = ilaw::input(v_free.data(), 0, 1);
    batch.v_previous = ilaw::input(v_previous.data(), 0, 1);
    batch.delassus = ilaw::input(&at.delassus[k], 0, 0);
    batch.gap = ilaw::input(&point.gap, 0, 0);
    batch.normal = ilaw::input(point.normal.data(), 0, 1);
    if (!at.area.empty()) batch.area = ilaw::input(&at.area[k], 0, 0);
    batch.per_node_parameters = parameters_.data();
    batch.state_in = ilaw::input(state_.data(), 0, 1);
    batch.state_out = ilaw::output(at.state.first(k), 0, at.state.stride());
    batch.impulse = ilaw::output(at.vector(at.impulse, contact).data(), 0, 1);
    if (step.gets_energies) batch.energy = ilaw::output(energy.data(), 0, 1);
    batch.amounts = outputs_.empty() ? nullptr : outputs_.data();
    batch.status = &at.status[k];
  }
  ContactBatch(const ContactBatch&) = delete;

 private:
  std::vector<double> state_;  // the accepted one, turned with the surface
  std::vector<ilaw_input> parameters_;
  std::vector<ilaw_output> outputs_;
};

}  // namespace ilaw::host
