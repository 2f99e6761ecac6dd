// plane_contact.hpp - what an interface law adds to an explicit code in deal.II: the arrays of its nodes and
// one call.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/arrays.hpp>
#include <ilaw/loader.hpp>

#include <array>
#include <cstdint>
#include <stdexcept>
#include <utility>
#include <vector>

#include "block.hpp"

// A law between the plane z = -gap and the nodes of the lower side that this rank owns: a rank may have none.
class plane_contact {
 public:
  plane_contact(const block& body, ilaw::interface law, double h, double gap)
      : law_(std::move(law)), info_(law_.info()) {
    const distributed_vector area = body.areas(block::lower_side);
    for (const block::node& at : body.nodes()) {
      if (area.local_element(at.dof) <= 0.0) continue;  // 0 at hanging nodes, too
      dofs_.push_back(at.dof);
      height_.push_back(at.place[2] + gap);
      area_.push_back(area.local_element(at.dof));
      inverse_mass_.push_back(body.inverse_mass().local_element(at.dof));
    }
    describe(h);
    if (law_.initialise(batch_) != ILAW_OK) throw std::runtime_error("initialise refused");
  }

  // v is the velocity without the interface, then with it.
  void apply(const distributed_vector& u, const distributed_vector& before, distributed_vector& v,
             double time) {
    for (std::size_t k = 0; k < dofs_.size(); ++k) {
      gap_[k] = u.local_element(dofs_[k] + 2) + height_[k];
      for (unsigned c = 0; c < 3; ++c) {
        v_free_[3 * k + c] = v.local_element(dofs_[k] + c);
        v_before_[3 * k + c] = before.local_element(dofs_[k] + c);
      }
    }
    ilaw_report report{};
    report.struct_size = sizeof report;
    batch_.time = time;
    if (law_.evaluate(batch_, &report) != ILAW_OK) throw std::runtime_error(report.reason);
    work_ = 0.0;
    for (std::size_t k = 0; k < dofs_.size(); ++k)
      for (unsigned c = 0; c < 3; ++c) {
        double& now = v.local_element(dofs_[k] + c);
        now += inverse_mass_[k] * impulse_[3 * k + c];
        work_ += impulse_[3 * k + c] * 0.5 * (now + v_before_[3 * k + c]);
      }
  }

  std::size_t size() const { return dofs_.size(); }
  double work() const { return work_; }  // of the last step, on this rank
  // Status, gap and the law's first state variable (rccm: intensity of adhesion), in the places of x, y, z.
  void fill(distributed_vector& nodal) const {
    for (std::size_t k = 0; k < dofs_.size(); ++k) {
      nodal.local_element(dofs_[k]) = status_[k];
      nodal.local_element(dofs_[k] + 1) = gap_[k];
      nodal.local_element(dofs_[k] + 2) = info_.state_size > 0 ? state_[k * info_.state_size] : 0.0;
    }
  }

 private:
  void describe(double h) {
    constexpr std::uint32_t given =
        ILAW_INPUT_GAP | ILAW_INPUT_V_PREVIOUS | ILAW_INPUT_NORMAL | ILAW_INPUT_AREA | ILAW_INPUT_V_SMOOTH;
    if ((info_.inputs | info_.balance_inputs) & ~given)
      throw std::runtime_error("the law reads an input that this code does not have");
    const std::size_t count = dofs_.size();
    for (auto* vectors : {&v_free_, &v_before_, &impulse_}) vectors->assign(3 * count, 0.0);
    gap_ = height_;
    state_.assign(count * info_.state_size, 0.0);
    status_.assign(count, 0);
    const auto state_size = static_cast<std::int64_t>(info_.state_size);
    batch_.struct_size = sizeof batch_;
    batch_.node_count = static_cast<std::int64_t>(count);
    batch_.velocity_step = batch_.position_step = h;
    batch_.v_free = ilaw::input(v_free_.data(), 3, 1);
    batch_.delassus = ilaw::input(inverse_mass_.data(), 1, 0);
    batch_.gap = ilaw::input(gap_.data(), 1, 0);
    batch_.v_previous = ilaw::input(v_before_.data(), 3, 1);
    batch_.area = ilaw::input(area_.data(), 1, 0);
    batch_.normal = ilaw::input(up_.data(), 0, 1);
    batch_.state_in = ilaw::input(state_.data(), state_size, 1);
    batch_.state_out = ilaw::output(state_.data(), state_size, 1);
    batch_.impulse = ilaw::output(impulse_.data(), 3, 1);
    batch_.status = status_.data();
    batch_.status_stride = 1;
  }

  ilaw::interface law_;
  ilaw_instance_info info_;
  ilaw_batch batch_{};
  std::vector<unsigned> dofs_;
  std::vector<double> height_, area_, inverse_mass_, gap_, v_free_, v_before_, impulse_, state_;
  std::vector<std::uint8_t> status_;
  std::array<double, 3> up_{{0.0, 0.0, 1.0}};
  double work_ = 0.0;
};
