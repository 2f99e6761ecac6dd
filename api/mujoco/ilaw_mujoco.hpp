// ilaw_mujoco.hpp - steps of MuJoCo whose contacts have a law: stepper::step in the place of mj_step.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mujoco/mujoco.h>
#include <ilaw/coupled.hpp>

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace ilaw::mujoco {

struct options {
  bool has_model_friction = false;  // the parameter `friction` of the law is that of the geoms in the model
  double area = 1.0;                // of each contact, for laws with a strength per area [m^2]
  std::uint32_t most_iterations = 20;  // of a step, over all contacts
  double tolerance = 1e-10;            // of the residual
};

// The part of a contact that lives from step to step. MuJoCo's contacts have no names: a contact is the
// nearest one of the same two geoms in the step before.
struct contact_memory {
  std::array<int, 2> geoms{};
  std::array<double, 3> place{};  // in the axes of the second geom
  std::array<double, 3> impulse{};
  std::vector<double> state;
};

// The contacts of a step. The velocity of contact k is jacobian v, and root root^T is its part of J M^-1 J^T.
struct contact_arrays {
  std::vector<double> jacobian, root;  // 3 rows of nv each
  std::vector<double> gap, normal, friction, impulse, state, energy;
  std::vector<double> weight;        // `ends` matrices per contact
  std::vector<std::int32_t> body;    // `ends` pseudo-bodies per contact
  std::vector<std::int32_t> wall;    // no counterpart: the Jacobian has both sides
  std::vector<std::int32_t> is_new;  // numbers of contacts that the law has to initialise
  std::uint32_t ends = 0;
  std::size_t count() const { return gap.size(); }
};

// One stepper for each mjData, one thread at a time. The model has to outlive it and is not changed.
class stepper {
 public:
  // Throws ilaw::error where the law or the model is refused.
  stepper(const mjModel* model, const std::string& law, parameters law_parameters, const options& given = {});

  // As mj_step with the integrator Euler, but contacts have the law. Joint limits, equality constraints and
  // friction in joints are forces of MuJoCo that act before the contacts. Throws ilaw::error where a contact
  // has bad input.
  ilaw_coupled_report step(mjData* data) { return kick_and_move(data, model_->opt.timestep); }

  // The first step of a run whose velocities are those of time 0: half a kick, in which the law acts, and a
  // whole move. Positions are then of second order in the step; `step` takes the velocities at half a step
  // before.
  ilaw_coupled_report start(mjData* data) { return kick_and_move(data, 0.5 * model_->opt.timestep); }

  // The contacts of the last step, to store and to go on from.
  const std::vector<contact_memory>& memory() const { return memory_; }
  void recall(std::vector<contact_memory> memory) { memory_ = std::move(memory); }

 private:
  ilaw_coupled_report kick_and_move(mjData* data, double kick);
  void advance_without_contact(mjData* data);
  void find_contacts(mjData* data);
  void add_contact(mjData* data, const mjContact& contact);
  void remember_contact(const mjData* data, const mjContact& contact);
  void fill_weights();
  ilaw_batch batch(const mjData* data);
  std::vector<double> pseudo_velocity(mjData* data, const double* v);
  ilaw_coupled_report solve(mjData* data);
  void apply_impulses(mjData* data);
  void move(mjData* data) const;

  const mjModel* model_;
  options given_;
  interface law_;
  ilaw_instance_info info_;
  coupled solver_;
  std::vector<int> dof_;  // of each component of the pseudo-bodies, three to a body; -1: none
  std::vector<contact_memory> memory_, before_;
  contact_arrays contacts_;
  ilaw_input friction_input_{};
  std::vector<double> v_before_, force_;
  double kick_ = 0.0;  // duration of the current one: the velocity step of the law [s]
};

}  // namespace ilaw::mujoco
