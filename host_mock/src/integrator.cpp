// SPDX-License-Identifier: BSD-3-Clause
#include "integrator.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>
#include <stdexcept>

namespace ilaw::host {
namespace {

class Stopwatch {
 public:
  explicit Stopwatch(double& seconds) : seconds_(seconds), start_(std::chrono::steady_clock::now()) {}
  ~Stopwatch() {
    seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  double& seconds_;
  std::chrono::steady_clock::time_point start_;
};

bool share_nodes(const std::vector<std::unique_ptr<Interface>>& interfaces) {
  std::set<int> seen;
  for (const auto& interface : interfaces)
    for (int node : interface->nodes())
      if (!seen.insert(node).second) return true;
  return false;
}

// Block Gauss-Seidel stops when impulses move velocities by no more than this part of the largest velocity.
constexpr double coupling_tolerance = 1e-14;
constexpr int most_sweeps = 1000;

}  // namespace

Integrator::Integrator(const Model& model, const Loads& loads,
                       std::vector<std::unique_ptr<Interface>>& interfaces, double dt)
    : model_(model),
      loads_(loads),
      interfaces_(interfaces),
      dt_(dt),
      coupled_(share_nodes(interfaces)),
      u_(Dofs::Zero(model.mass().size())),
      v_(model.initial_velocity()),
      v_before_(v_),
      v_free_(v_),
      external_impulse_(u_),
      interface_impulse_(u_),
      others_(u_),
      status_counts_(ILAW_STATUS_COUNT) {
  for (const auto& interface : interfaces_) interface->initialise(u_, 0.0);
  Dofs force = Dofs::Zero(u_.size());
  for (const auto& load : loads_) load->add_force(0.0, force);
  model_.add_internal_forces(u_, force);
  v_ += 0.5 * dt_ * force.cwiseQuotient(model_.mass());
  energy_.start(model_, u_, u_ + dt_ * v_, v_);
}

void Integrator::step() {
  const StepTimes times{time(), static_cast<double>(steps_ + 1) * dt_};
  v_before_ = v_;
  u_ += dt_ * v_;
  free_velocity(times);
  solve_interfaces(times.after);
  v_ = v_free_ + interface_impulse_.cwiseQuotient(model_.mass());
  ++steps_;
  if (!v_.allFinite()) {
    Eigen::Index dof = 0;
    while (std::isfinite(v_[dof])) ++dof;
    throw std::runtime_error("the motion diverged: velocity " + std::to_string(v_[dof]) + " at node " +
                             std::to_string(dof / model_.dimension()) + ", step " + std::to_string(steps_) +
                             ", time " + std::to_string(times.after));
  }
  account();
}

void Integrator::free_velocity(StepTimes step) {
  const Stopwatch watch(seconds_.internal_forces);
  external_impulse_.setZero();
  for (const auto& load : loads_) load->add_force(step.after, external_impulse_);
  external_impulse_ *= dt_;
  for (const auto& load : loads_) load->add_impulse(step, external_impulse_);
  others_.setZero();
  model_.add_internal_forces(u_, others_);
  v_free_ = v_before_ + (external_impulse_ + dt_ * others_).cwiseQuotient(model_.mass());
}

void Integrator::solve_interfaces(double time) {
  const Stopwatch watch(seconds_.interfaces);
  interface_impulse_.setZero();
  for (const auto& interface : interfaces_) {
    interface->forget_impulse();
    interface->locate(u_, time, dt_);
    asked_ += static_cast<std::int64_t>(interface->nodes().size());
  }
  int sweeps = 1;
  double change = sweep(time);
  const double scale = std::max(v_free_.cwiseAbs().maxCoeff(), v_before_.cwiseAbs().maxCoeff());
  while (coupled_ && change > coupling_tolerance * scale && sweeps < most_sweeps) {
    change = sweep(time);
    ++sweeps;
  }
  for (const auto& interface : interfaces_) interface->accept();
  if (!coupled_) return;
  sweeps_max_ = std::max(sweeps_max_, sweeps);
  if (scale > 0.0) coupling_residual_max_ = std::max(coupling_residual_max_, change / scale);
}

// Evaluates every interface once, each against the impulses of the others; returns the largest change of
// velocity.
double Integrator::sweep(double time) {
  const Eigen::Index d = model_.dimension();
  double change = 0.0;
  for (const auto& interface : interfaces_) {
    const auto count = static_cast<int>(interface->nodes().size());
    for (int k = 0; k < count; ++k) add_impulse(*interface, k, -1.0);
    others_ = v_free_ + interface_impulse_.cwiseQuotient(model_.mass());
    previous_.resize(count * d);
    for (int k = 0; k < count; ++k) previous_.segment(k * d, d) = interface->impulse(k);
    interface->evaluate(others_, v_before_, time, dt_);
    for (int k = 0; k < count; ++k) {
      add_impulse(*interface, k, 1.0);
      const double mass = model_.mass()[interface->nodes()[static_cast<std::size_t>(k)] * d];
      change = std::max(change,
                        (interface->impulse(k) - previous_.segment(k * d, d)).cwiseAbs().maxCoeff() / mass);
    }
  }
  return change;
}

void Integrator::add_impulse(const Interface& interface, int place, double sign) {
  const Eigen::Index d = model_.dimension();
  interface_impulse_.segment(interface.nodes()[static_cast<std::size_t>(place)] * d, d) +=
      sign * interface.impulse(place);
}

void Integrator::account() {
  energy_.add_step(v_before_, v_, external_impulse_, interface_impulse_);
  const Eigen::Index d = model_.dimension();
  double stored = 0.0;
  for (const auto& interface : interfaces_) {
    const Dofs drift = interface->obstacle_velocity() + interface->obstacle_velocity_before();
    for (int k = 0; k < static_cast<int>(interface->nodes().size()); ++k) {
      const Eigen::Index node = interface->nodes()[static_cast<std::size_t>(k)] * d;
      penetration_max_ = std::max(penetration_max_, -interface->gap(k));
      ++status_counts_[static_cast<std::size_t>(interface->status(k))];
      for (int part = 0; part < ILAW_ENERGY_STORED; ++part)
        energy_.add_dissipation(part, interface->energy(k, part));
      stored += interface->energy(k, ILAW_ENERGY_STORED);
      energy_.add_relative_work(
          0.5 * interface->impulse(k).dot(v_before_.segment(node, d) + v_.segment(node, d) - drift));
    }
  }
  energy_.set_stored(stored);
}

EnergyReport Integrator::energy() const { return energy_.report(model_, u_, u_ + dt_ * v_, v_); }

}  // namespace ilaw::host
