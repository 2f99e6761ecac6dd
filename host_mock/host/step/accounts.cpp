// SPDX-License-Identifier: BSD-3-Clause
#include "step/accounts.hpp"

#include "base/bytes.hpp"
#include "base/words.hpp"
#include "step/coupled_step.hpp"

#include <algorithm>
#include <numeric>

namespace ilaw::host {
namespace {

// Part of the largest energy that interfaces may put in before a warning: a penalty that suits its
// step puts in far less.
constexpr double much_energy = 0.1;
// Kinetic energy over the energy put in that ends a run, in addition to the steps to the fourth: unstable
// runs reach it in some tens of steps.
constexpr double unstable_growth = 1e6;
// The same at the end of a run: up to 0.99 of the critical step it is at most 1/(1 - 0.99^2) = 50.
constexpr double growth_at_end = 100.0;
// Part of the energy below which contacts that do not agree differ by rounding.
constexpr double rounding_energy = 1e-13;
// The same of a step whose contacts do not agree, before the run ends.
constexpr double wrong_energy = 1e-3;

// One by one: the bytes between them mean nothing, and equal runs write equal checkpoints.
template <class Any, class Work>
void for_each_member(Any& tally, Work work) {
  for (auto* count : {&tally.active, &tally.skipped, &tally.sweeps, &tally.unconverged, &tally.worst_node,
                      &tally.left_surface})
    work(*count);
  work(tally.sweeps_max);
  for (auto* value : {&tally.coupling_residual_max, &tally.coupling_tolerance, &tally.coupling_energy,
                      &tally.penetration_max, &tally.stable_step, &tally.viscous_step})
    work(*value);
  for (auto& count : tally.status_counts) work(count);
}

}  // namespace

void Accounts::add_solution(const ilaw_coupled_report& solution, double tolerance, std::int64_t worst_node) {
  if (solution.message && solution.residual >= tally_.coupling_residual_max) tally_.worst_node = worst_node;
  tally_.coupling_tolerance = tolerance;
  tally_.sweeps += solution.sweeps;
  tally_.sweeps_max = std::max(tally_.sweeps_max, static_cast<int>(solution.sweeps));
  tally_.coupling_residual_max = std::max(tally_.coupling_residual_max, solution.residual);
  tally_.coupling_energy += solution.energy_error;
  tally_.stable_step = std::min(tally_.stable_step, solution.stable_velocity_step);
  if (solution.message) ++tally_.unconverged;
}

bool Accounts::is_wrong(const Model& model, const ilaw_coupled_report& solution, const Dofs& v_before) const {
  if (solution.energy_error <= wrong_energy * energy_.largest()) return false;
  return !(solution.energy_error <= wrong_energy * kinetic_energy(model, v_before));
}

void Accounts::add_step(const Model& model, const Interfaces& interfaces, const StepRecord& step) {
  energy_.add_external(step.external_work);
  if (step.damping_impulse) energy_.add_damping(*step.damping_impulse, step.v_before, step.v);
  if (!model.is_linear()) energy_.add_internal(step.internal_impulse, step.v_before, step.v);
  add_energies(interfaces);
  note_rounding(step.speed);
  note_contacts(interfaces, step.time);
  for (const auto& interface : interfaces) add_counts(*interface);
}

void Accounts::start(const Model& model, const Dofs& u, const Dofs& u_next, const Dofs& v) {
  energy_.start(model, u, u_next, v);
  total_mass_ = model.mass().sum();
}

// The work of r_0 is the change of kinetic energy that it makes: the account begins before it, and then books
// it like that of any step.
void Accounts::add_start(const Interfaces& interfaces, double speed) {
  for (const auto& interface : interfaces) {
    energy_.take_from_initial(interface->sums().work);
    tally_.stable_step = std::min(tally_.stable_step, interface->sums().stable_step);
  }
  add_energies(interfaces);
  note_rounding(speed);
  note_contacts(interfaces, 0.0);
}

void Accounts::note_contacts(const Interfaces& interfaces, double time) {
  for (std::size_t i = 0; i < interfaces.size(); ++i) {
    const auto& statuses = interfaces[i]->sums().statuses;
    const auto touching =
        std::accumulate(statuses.begin(), statuses.end(), std::int64_t{0}) - statuses[ILAW_FREE];
    if (touching > 0) first_contact_[i] = std::min(first_contact_[i], time);
  }
}

void Accounts::add_energies(const Interfaces& interfaces) {
  double stored = 0.0;
  for (const auto& interface : interfaces) {
    const ContactSums& sums = interface->sums();
    energy_.add_interface(sums.work, sums.relative_work);
    energy_.add_dissipation(sums.energy, sums.least_dissipation);
    stored += sums.energy[ILAW_ENERGY_STORED];
  }
  energy_.set_stored(stored);
}

// Impulses that stop a motion leave the rounding of its energy, also where a body rests: what a step gives it
// they take.
void Accounts::note_rounding(double speed) {
  rounding_energy_ += 0.5 * std::numeric_limits<double>::epsilon() * total_mass_ * speed * speed;
}

void Accounts::add_counts(const Interface& interface) {
  const ContactSums& sums = interface.sums();
  tally_.penetration_max = std::max(tally_.penetration_max, sums.penetration);
  tally_.left_surface += sums.left;
  tally_.stable_step = std::min(tally_.stable_step, sums.stable_step);
  for (std::size_t k = 0; k < sums.statuses.size(); ++k) tally_.status_counts[k] += sums.statuses[k];
  const auto active = static_cast<std::int64_t>(interface.active().size());
  const auto skipped = static_cast<std::int64_t>(interface.nodes().size()) - active;
  tally_.active += active;
  tally_.skipped += skipped;
  tally_.status_counts[ILAW_FREE] += skipped;
}

// Below the critical step the kinetic energy of a linear model is at most 1/(1 - cfl^2) times what the scheme
// conserves, and that is at most what was put in. At the critical step a disturbance of the fastest vibration
// grows by the same amplitude in every step, and disturbances in all of n steps to n^2/2 of one: energy as
// n^4. Beyond it all grow by a factor in every step. Where nothing was put in, rounding of positions moves
// bodies.
bool Accounts::has_diverged(const Model& model, const Dofs& v, double speed, double dt, std::int64_t steps,
                            bool is_end) const {
  const auto n = static_cast<double>(steps);
  const double growth = is_end ? growth_at_end : unstable_growth + n * n * n * n;
  // A body at rest moves by the rounding of what reactions take from it in a step.
  const double most = growth * energy_.put_in() + rounding_energy_;
  if (!(0.5 * total_mass_ * speed * speed > most)) return false;
  const double rounding =
      std::numeric_limits<double>::epsilon() * model.position().cwiseAbs().maxCoeff() / dt;
  return kinetic_energy(model, v) > std::max(most, unstable_growth * total_mass_ * rounding * rounding);
}

std::string Accounts::step_warning(double dt) const {
  if (dt > tally_.viscous_step)
    return formatted(
        "the time step is %g, where bulk viscosity is stable up to %g: a body is compressed too fast for it",
        dt, tally_.viscous_step);
  if (!(dt > tally_.stable_step)) return "";
  return formatted(
      "the time step is %g, where a law is stable up to %g at its nodes: an explicit spring is too stiff for it",
      dt, tally_.stable_step);
}

std::vector<std::string> Accounts::warnings(std::int64_t steps, double dt, const EnergyReport& energy) const {
  std::vector<std::string> warnings;
  if (tally_.unconverged > 0 && tally_.coupling_energy > rounding_energy * energy.scale)
    warnings.push_back(formatted(
        "contacts that share nodes are not solved in %lld of %lld steps, the start included: residual up to %.1e at node %lld after %d "
        "sweeps, expected %g; the energy is wrong by up to %.2g, where %.2g is the largest in the run",
        static_cast<long long>(tally_.unconverged), static_cast<long long>(steps) + 1,
        tally_.coupling_residual_max, static_cast<long long>(tally_.worst_node),
        static_cast<int>(CoupledStep::most_sweeps), tally_.coupling_tolerance, tally_.coupling_energy,
        energy.scale));
  if (tally_.left_surface > 0)
    warnings.push_back(formatted(
        "%lld node(s) went over the border of a surface while they touched it: beyond it only bonds hold them; a node "
        "that shall stay needs a surface that reaches farther",
        static_cast<long long>(tally_.left_surface)));
  if (const std::string warning = step_warning(dt); !warning.empty()) warnings.push_back(warning);
  if (energy.reaction_work > much_energy * energy.scale + rounding_energy_ + tally_.coupling_energy)
    warnings.push_back(formatted(
        "interfaces put in the energy %.2g, where %.2g is the largest in the run: an explicit penalty too stiff "
        "for the time step does, and one that is pressed in at the start; contact, friction and bonds do not",
        energy.reaction_work, energy.scale));
  return warnings;
}

void Accounts::save(std::ostream& out) const {
  energy_.save(out);
  write_value(out, rounding_energy_);
  write_array(out, first_contact_.data(), first_contact_.size());
  for_each_member(tally_, [&out](const auto& member) { write_value(out, member); });
}

void Accounts::load(std::istream& in) {
  energy_.load(in);
  read_value(in, rounding_energy_);
  read_array(in, first_contact_.data(), first_contact_.size());
  for_each_member(tally_, [&in](auto& member) { read_value(in, member); });
}

}  // namespace ilaw::host
