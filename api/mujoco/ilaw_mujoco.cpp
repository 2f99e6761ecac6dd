// Steps of MuJoCo with laws at the contacts; see ilaw_mujoco.hpp.
// SPDX-License-Identifier: BSD-3-Clause
#include "ilaw_mujoco.hpp"

#include <ilaw/arrays.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace ilaw::mujoco {
namespace {

// Laws need a positive definite H. Along directions in which neither body gives way, it is this part of the
// largest eigenvalue; directions below twice of it count as such.
constexpr double least_delassus = 0x1p-40;

interface create(const std::string& name, parameters& law_parameters, bool has_model_friction) {
  if (has_model_friction) law_parameters.per_node("friction");
  ilaw_setup setup{};
  setup.struct_size = sizeof setup;
  setup.dimension = 3;
  setup.delassus_form = ILAW_DELASSUS_FULL;
  setup.frame = ILAW_FRAME_GLOBAL;
  setup.numbers = ILAW_NUMBERS_DOUBLE;
  law_parameters.give(setup);
  return {library(name), "", setup};
}

// coupled.h takes weighted sets of bodies. MuJoCo factors M = L^T D L, so D^(1/2) L v are the velocities of
// pseudo-bodies of mass 1. Degrees of freedom of a kinematic tree stand together, three to a pseudo-body;
// those of two trees share none, or the trees would seem to be coupled.
std::vector<int> pseudo_bodies(const mjModel* model) {
  std::vector<int> dof;
  for (int i = 0; i < model->nv; ++i) {
    const bool begins_tree =
        i == 0 || model->body_rootid[model->dof_bodyid[i]] != model->body_rootid[model->dof_bodyid[i - 1]];
    if (begins_tree) dof.resize((dof.size() + 2) / 3 * 3, -1);
    dof.push_back(i);
  }
  dof.resize((dof.size() + 2) / 3 * 3, -1);
  return dof;
}

// Eigenvalues of the 3 x 3 matrix root root^T, the largest and the smallest.
std::pair<double, double> extreme_eigenvalues(const double* root, int nv) {
  double h[9], values[3], vectors[9], quaternion[4];
  mju_mulMatMatT(h, root, root, 3, nv, 3);
  mju_eig3(values, vectors, quaternion, h);
  return {std::max({values[0], values[1], values[2]}), std::min({values[0], values[1], values[2]})};
}

double squared_distance(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  const double difference[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  return mju_dot3(difference, difference);
}

}  // namespace

stepper::stepper(const mjModel* model, const std::string& law, parameters law_parameters,
                 const options& given)
    : model_(model),
      given_(given),
      law_(create(law, law_parameters, given.has_model_friction)),
      info_(law_.info()),
      dof_(pseudo_bodies(model)) {
  if (model->opt.integrator != mjINT_EULER)
    throw error(ILAW_INVALID_ARGUMENT, "the integrator of the model is not Euler");
  if (info_.per_node_parameter_count > (given.has_model_friction ? 1U : 0U))
    throw error(ILAW_INVALID_PARAMETER, "a parameter per node other than the friction of the model");
  const auto nv = static_cast<std::size_t>(model->nv);
  for (std::vector<double>* array : {&v_before_, &force_}) array->resize(nv);
}

ilaw_coupled_report stepper::kick_and_move(mjData* data, double kick) {
  kick_ = kick;
  std::copy_n(data->qvel, model_->nv, v_before_.begin());
  advance_without_contact(data);
  find_contacts(data);
  const ilaw_coupled_report report = solve(data);
  apply_impulses(data);
  move(data);
  return report;
}

// The parts of mj_step up to the new velocity. Contacts are found, but excluded from MuJoCo's constraints.
void stepper::advance_without_contact(mjData* data) {
  const mjModel* m = model_;
  mj_checkPos(m, data);
  mj_checkVel(m, data);
  mj_kinematics(m, data);
  mj_comPos(m, data);
  mj_camlight(m, data);
  mj_tendon(m, data);
  mj_crb(m, data);
  mj_factorM(m, data);
  mj_collision(m, data);
  for (int k = 0; k < data->ncon; ++k) data->contact[k].exclude = std::max(data->contact[k].exclude, 1);
  mj_makeConstraint(m, data);
  mj_transmission(m, data);
  mj_projectConstraint(m, data);
  mj_sensorPos(m, data);
  mj_fwdVelocity(m, data);
  mj_sensorVel(m, data);
  if (mjcb_control) mjcb_control(m, data);
  mj_fwdActuation(m, data);
  mj_fwdAcceleration(m, data);
  mj_fwdConstraint(m, data);
  std::copy_n(data->qacc, m->nv, data->qacc_warmstart);
  // Damping of joints is implicit, as in mj_Euler: (M + h D) (v_free - v) = h f. Contacts see M + h D, too.
  for (int i = 0; i < m->nv; ++i) data->qM[m->dof_Madr[i]] += kick_ * m->dof_damping[i];
  mj_factorM(m, data);
  mju_add(force_.data(), data->qfrc_smooth, data->qfrc_constraint, m->nv);
  mj_solveM(m, data, data->qacc, force_.data(), 1);
  mju_addToScl(data->qvel, data->qacc, kick_, m->nv);
}

void stepper::find_contacts(mjData* data) {
  std::swap(before_, memory_);
  memory_.clear();
  contacts_ = {};
  for (int k = 0; k < data->ncon; ++k)
    if (data->contact[k].exclude == 1) add_contact(data, data->contact[k]);
  fill_weights();
}

// The normal of MuJoCo points from the first geom into the second, which is the law's body.
void stepper::add_contact(mjData* data, const mjContact& contact) {
  const int nv = model_->nv, size = 3 * nv;
  std::vector<double> other(static_cast<std::size_t>(size)), jacobian(other), root(other);
  mj_jac(model_, data, jacobian.data(), nullptr, contact.pos, model_->geom_bodyid[contact.geom2]);
  mj_jac(model_, data, other.data(), nullptr, contact.pos, model_->geom_bodyid[contact.geom1]);
  mju_subFrom(jacobian.data(), other.data(), size);
  mj_solveM2(model_, data, root.data(), jacobian.data(), 3);
  if (mju_isZero(root.data(), size)) return;  // neither body moves there
  contacts_.jacobian.insert(contacts_.jacobian.end(), jacobian.begin(), jacobian.end());
  contacts_.root.insert(contacts_.root.end(), root.begin(), root.end());
  contacts_.gap.push_back(contact.dist);
  contacts_.normal.insert(contacts_.normal.end(), contact.frame, contact.frame + 3);
  contacts_.friction.push_back(contact.dim == 1 ? 0.0 : contact.friction[0]);
  remember_contact(data, contact);
}

void stepper::remember_contact(const mjData* data, const mjContact& contact) {
  contact_memory now{.geoms = {contact.geom1, contact.geom2}, .state = {}};
  double from_geom[3];
  mju_sub3(from_geom, contact.pos, data->geom_xpos + 3 * contact.geom2);
  mju_rotVecMatT(now.place.data(), from_geom, data->geom_xmat + 9 * contact.geom2);
  contact_memory* nearest = nullptr;
  for (contact_memory& old : before_)
    if (old.geoms == now.geoms &&
        (!nearest || squared_distance(old.place, now.place) < squared_distance(nearest->place, now.place)))
      nearest = &old;
  if (nearest) {
    now.impulse = nearest->impulse;
    now.state = std::move(nearest->state);
    nearest->geoms = {-1, -1};  // no other contact has it
  } else {
    now.state.resize(info_.state_size);
    contacts_.is_new.push_back(static_cast<std::int32_t>(memory_.size()));
  }
  contacts_.impulse.insert(contacts_.impulse.end(), now.impulse.begin(), now.impulse.end());
  contacts_.state.insert(contacts_.state.end(), now.state.begin(), now.state.end());
  memory_.push_back(std::move(now));
}

// The columns of root as 3 x 3 matrices of pseudo-bodies. A contact that has no way in some direction has a
// pseudo-body of its own besides, which makes H positive definite.
void stepper::fill_weights() {
  const auto nv = static_cast<std::size_t>(model_->nv);
  const std::size_t shared = dof_.size() / 3;
  std::vector<std::vector<std::int32_t>> bodies(contacts_.count());
  std::vector<std::vector<double>> weights(contacts_.count());
  for (std::size_t k = 0; k < contacts_.count(); ++k) {
    const double* root = &contacts_.root[3 * nv * k];
    const auto add = [&](std::size_t body, const double* matrix) {
      bodies[k].push_back(static_cast<std::int32_t>(body));
      weights[k].insert(weights[k].end(), matrix, matrix + 9);
    };
    for (std::size_t b = 0; b < shared; ++b) {
      double matrix[9] = {};
      for (std::size_t row = 0; row < 3; ++row)
        for (std::size_t column = 0; column < 3; ++column)
          if (const int dof = dof_[3 * b + column]; dof >= 0)
            matrix[3 * row + column] = root[row * nv + static_cast<std::size_t>(dof)];
      if (!mju_isZero(matrix, 9)) add(b, matrix);
    }
    const auto [largest, smallest] = extreme_eigenvalues(root, model_->nv);
    const double w = std::sqrt(least_delassus * largest);
    const double own[9] = {w, 0, 0, 0, w, 0, 0, 0, w};
    if (smallest < 2 * least_delassus * largest) add(shared + k, own);
    contacts_.ends = std::max(contacts_.ends, static_cast<std::uint32_t>(bodies[k].size()));
  }
  for (std::size_t k = 0; k < contacts_.count(); ++k) {
    bodies[k].resize(contacts_.ends, -1);
    weights[k].resize(std::size_t{9} * contacts_.ends);
    contacts_.body.insert(contacts_.body.end(), bodies[k].begin(), bodies[k].end());
    contacts_.weight.insert(contacts_.weight.end(), weights[k].begin(), weights[k].end());
  }
  contacts_.wall.assign(contacts_.count(), -1);
  contacts_.energy.assign(ILAW_ENERGY_COUNT * contacts_.count(), 0.0);
}

ilaw_batch stepper::batch(const mjData* data) {
  const auto state_size = static_cast<std::int64_t>(info_.state_size);
  friction_input_ = input(contacts_.friction.data(), 1, 0);
  ilaw_batch made{};
  made.struct_size = sizeof made;
  made.node_count = static_cast<std::int64_t>(contacts_.count());
  made.time = data->time;
  made.velocity_step = kick_;
  made.position_step = model_->opt.timestep;
  made.gap = input(contacts_.gap.data(), 1, 0);
  made.area = input(&given_.area, 0, 0);
  made.normal = input(contacts_.normal.data(), 3, 1);
  if (given_.has_model_friction) made.per_node_parameters = &friction_input_;
  made.state_in = input(contacts_.state.data(), state_size, 1);
  made.state_out = output(contacts_.state.data(), state_size, 1);
  made.impulse = output(contacts_.impulse.data(), 3, 1);
  if (law_.law().outputs & ILAW_OUTPUT_ENERGY)
    made.energy = output(contacts_.energy.data(), ILAW_ENERGY_COUNT, 1);
  return made;
}

// D^(1/2) L v = D^(-1/2) L^(-T) M v: mj_mulM2 of MuJoCo 2.2.2 is wrong for branches of more than one joint.
std::vector<double> stepper::pseudo_velocity(mjData* data, const double* v) {
  std::vector<double> half(static_cast<std::size_t>(model_->nv));
  std::vector<double> velocity(dof_.size() + 3 * contacts_.count());
  mj_mulM(model_, data, half.data(), v);
  mj_solveM2(model_, data, half.data(), half.data(), 1);
  for (std::size_t s = 0; s < dof_.size(); ++s)
    if (dof_[s] >= 0) velocity[s] = half[static_cast<std::size_t>(dof_[s])];
  return velocity;
}

ilaw_coupled_report stepper::solve(mjData* data) {
  if (contacts_.count() == 0) {
    ilaw_coupled_report none{};
    none.struct_size = sizeof none;
    return none;
  }
  ilaw_batch first = batch(data);
  first.node_count = static_cast<std::int64_t>(contacts_.is_new.size());
  first.index = contacts_.is_new.data();
  if (info_.state_size > 0 && first.node_count > 0 && law_.initialise(first) != ILAW_OK)
    throw error(ILAW_INVALID_ARGUMENT, "the law does not initialise the new contacts");

  const std::vector<double> v_free = pseudo_velocity(data, data->qvel);
  const std::vector<double> v_before = pseudo_velocity(data, v_before_.data());

  const double inverse_mass = 1.0;
  ilaw_bodies bodies{};
  bodies.struct_size = sizeof bodies;
  bodies.dimension = 3;
  bodies.count = bodies.owned_count = static_cast<std::int64_t>(v_free.size() / 3);
  bodies.inverse_mass = input(&inverse_mass, 0, 0);
  bodies.v_free = input(v_free.data(), 3, 1);
  bodies.v_previous = input(v_before.data(), 3, 1);
  const ilaw_batch all = batch(data);
  ilaw_contacts group =
      contacts_of(law_, ILAW_DELASSUS_FULL, all, contacts_.body.data(), contacts_.wall.data());
  group.body_count = contacts_.ends;
  group.body_weight = input(contacts_.weight.data(), std::int64_t{9} * contacts_.ends, 1);
  group.weight_size = 9;
  ilaw_coupled_options solver_options{};
  solver_options.most_sweeps = given_.most_iterations;
  solver_options.tolerance = given_.tolerance;
  const ilaw_coupled_report report = solver_.solve(bodies, group, solver_options);
  if (report.bad_count > 0) throw error(ILAW_BAD_NODES, report.reason ? report.reason : "bad input");
  return report;
}

void stepper::apply_impulses(mjData* data) {
  const auto size = static_cast<std::size_t>(model_->nv);
  std::fill(force_.begin(), force_.end(), 0.0);
  std::vector<double> generalized(size);
  for (std::size_t k = 0; k < contacts_.count(); ++k) {
    std::copy_n(&contacts_.impulse[3 * k], 3, memory_[k].impulse.begin());
    std::copy_n(contacts_.state.begin() + static_cast<std::ptrdiff_t>(info_.state_size * k), info_.state_size,
                memory_[k].state.begin());
    mju_mulMatTVec(generalized.data(), &contacts_.jacobian[3 * size * k], &contacts_.impulse[3 * k], 3,
                   model_->nv);
    mju_addTo(force_.data(), generalized.data(), model_->nv);
  }
  // Constraint forces and accelerations with the contacts, for those who read them.
  mju_addToScl(data->qfrc_constraint, force_.data(), 1.0 / kick_, model_->nv);
  mj_solveM(model_, data, force_.data(), force_.data(), 1);
  mju_addTo(data->qvel, force_.data(), model_->nv);
  mju_addToScl(data->qacc, force_.data(), 1.0 / kick_, model_->nv);
}

void stepper::move(mjData* data) const {
  for (int i = 0; i < model_->na; ++i) {
    data->act[i] += model_->opt.timestep * data->act_dot[i];
    const int actuator = model_->nu - model_->na + i;
    const double* range = model_->actuator_actrange + 2 * actuator;
    if (model_->actuator_actlimited[actuator]) data->act[i] = mju_clip(data->act[i], range[0], range[1]);
  }
  mj_integratePos(model_, data->qpos, data->qvel, model_->opt.timestep);
  data->time += model_->opt.timestep;
}

}  // namespace ilaw::mujoco
