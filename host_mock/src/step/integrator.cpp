// SPDX-License-Identifier: BSD-3-Clause
#include "step/integrator.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <istream>
#include <ostream>
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

// Whether an impulse of one contact may change the velocity of another.
bool share_nodes(const std::vector<std::unique_ptr<Interface>>& interfaces) {
  std::set<int> seen;
  for (const auto& interface : interfaces) {
    if (interface->setup().counterpart->shares_partners()) return true;
    for (const std::vector<int>* nodes : {&interface->nodes(), &interface->setup().counterpart->partners()})
      for (const int node : *nodes)
        if (!seen.insert(node).second) return true;
  }
  return false;
}

bool any_corrects(const Loads& loads) {
  return std::any_of(loads.begin(), loads.end(), [](const auto& load) { return load->corrects(); });
}

// Calls f(i) for all degrees of freedom, with threads where there are many. f touches those of i alone.
template <class F>
void for_each_dof(Eigen::Index count, F f) {
  constexpr Eigen::Index many = 1 << 16;
#pragma omp parallel for schedule(static) if (count > many)
  for (Eigen::Index i = 0; i < count; ++i) f(i);
}

double largest_speed(const Dofs& v, Eigen::Index d) {
  double largest = 0.0;
  const Eigen::Index nodes = v.size() / d;
  constexpr Eigen::Index many = 1 << 16;
#pragma omp parallel for schedule(static) reduction(max : largest) if (nodes > many)
  for (Eigen::Index node = 0; node < nodes; ++node) {
    double square = 0.0;
    for (Eigen::Index c = 0; c < d; ++c) square += v[node * d + c] * v[node * d + c];
    largest = std::max(largest, square);
  }
  return std::sqrt(largest);
}

// Block Gauss-Seidel stops at this residual. It is fast where contacts share few nodes; along a column of n
// of them it takes n^2 sweeps, and is accelerated where it took some already.
constexpr double coupling_tolerance = 1e-14;
constexpr int most_sweeps = 1000, patience = 20;

// Part of the largest energy that interfaces may put in before a warning: a penalty that suits its step puts
// in far less.
constexpr double much_energy = 0.1;

}  // namespace

Integrator::Integrator(const Model& model, const Loads& loads,
                       std::vector<std::unique_ptr<Interface>>& interfaces, double dt)
    : model_(model),
      loads_(loads),
      interfaces_(interfaces),
      dt_(dt),
      coupled_(share_nodes(interfaces)),
      corrects_(any_corrects(loads)),
      u_(Dofs::Zero(model.mass().size())),
      v_(model.initial_velocity()),
      v_before_(v_),
      external_impulse_(u_),
      internal_impulse_(u_),
      inverse_mass_(model.mass().cwiseInverse()) {
  for (const auto& interface : interfaces_)
    if (coupled_) interface->set_coupled();
  Dofs force = Dofs::Zero(u_.size());
  for (const auto& load : loads_) load->add_force(0.0, force);
  model_.add_internal_forces(u_, force);
  v_ += 0.5 * dt_ * force.cwiseQuotient(model_.mass());
  for (const auto& load : loads_) load->start(dt_, v_before_, v_);
  energy_.start(model_, u_, u_ + dt_ * v_, v_);
}

void Integrator::step() {
  const StepTimes times{time(), static_cast<double>(steps_ + 1) * dt_};
  v_before_ = v_;
  for_each_dof(u_.size(), [&](Eigen::Index i) { u_[i] += dt_ * v_[i]; });
  free_velocity(times);
  check_motion(times.after);
  solve_interfaces(times.after);
  check_motion(times.after);
  ++steps_;
  account();
}

// Before the laws are asked, too: they must not be blamed.
void Integrator::check_motion(double time) const {
  if (v_.allFinite()) return;
  Eigen::Index dof = 0;
  while (std::isfinite(v_[dof])) ++dof;
  throw std::runtime_error("the motion diverged: velocity " + std::to_string(v_[dof]) + " at node " +
                           std::to_string(dof / model_.dimension()) + ", step " + std::to_string(steps_ + 1) +
                           ", time " + std::to_string(time));
}

void Integrator::free_velocity(StepTimes step) {
  const Stopwatch watch(seconds_.internal_forces);
  if (!loads_.empty()) {
    external_impulse_.setZero();
    for (const auto& load : loads_) load->add_force(step.after, external_impulse_);
    external_impulse_ *= dt_;
    for (const auto& load : loads_) load->add_impulse(step, external_impulse_);
  }
  if (model_.has_internal_forces()) {
    internal_impulse_.setZero();
    model_.add_internal_forces(u_, internal_impulse_);
  }
  for_each_dof(v_.size(), [&](Eigen::Index i) {
    internal_impulse_[i] *= dt_;
    v_[i] += (external_impulse_[i] + internal_impulse_[i]) * inverse_mass_[i];
  });
  if (corrects_) correct(step);
}

// What a load takes off or adds, times the mass, is its impulse.
void Integrator::correct(StepTimes step) {
  const Dofs uncorrected = v_;
  for (const auto& load : loads_) load->correct(step, v_before_, v_);
  external_impulse_ += model_.mass().cwiseProduct(v_ - uncorrected);
}

void Integrator::solve_interfaces(double time) {
  const Stopwatch watch(seconds_.interfaces);
  const Eigen::Index d = model_.dimension();
  const StepView step{u_, v_before_, time, dt_, largest_speed(v_before_, d), largest_speed(v_, d)};
  if (coupled_) {
    solve_coupled(step);
  } else {
    open_interfaces(step);
    sweep(step);
  }
  for (const auto& interface : interfaces_) interface->accept(dt_);
}

// Which contacts may act follows from a bound on speeds. Where impulses of other contacts make a node faster,
// the step is solved again with a larger one: whether that happens does not depend on who was asked.
void Integrator::solve_coupled(StepView step) {
  const double speed = std::max(step.speed_before, step.speed_after);
  const Dofs v_free = v_;
  step.speed_after = 2.0 * speed;
  int sweeps = 0;
  double left = 0.0;
  for (bool bounded = false; !bounded;) {
    open_interfaces(step);
    v_ = v_free;
    double fastest = 0.0;
    Anderson anderson;
    std::vector<double> impulses_before;
    for (sweeps = 0, left = 1.0; left > coupling_tolerance && sweeps < most_sweeps; ++sweeps) {
      if (sweeps == patience) impulses_before = impulses();
      if (sweeps > patience && sweeps % 2 == 0)
        fastest = std::max(fastest, accelerate(anderson, impulses_before));
      fastest = std::max(fastest, sweep(step));
      left = residual(speed);
    }
    bounded = !(fastest > step.speed_after);
    step.speed_after = 2.0 * fastest;
  }
  tally_.sweeps += sweeps;
  tally_.sweeps_max = std::max(tally_.sweeps_max, sweeps);
  tally_.coupling_residual_max = std::max(tally_.coupling_residual_max, left);
  if (left > coupling_tolerance) ++tally_.unconverged;
}

// Every impulse is what its law answered to some velocity of its contact: how far the contact is from that
// velocity, relative to the largest velocity there is, or that an impulse makes. Zero where all laws hold.
double Integrator::residual(double speed) const {
  double change = 0.0, size = speed;
  for (const auto& interface : interfaces_) {
    const Residual residual = interface->residual(v_);
    change = std::max(change, residual.change);
    size = std::max(size, residual.size);
  }
  return size > 0.0 ? change / size : 0.0;
}

std::vector<double> Integrator::impulses() const {
  std::vector<double> impulses;
  for (const auto& interface : interfaces_) interface->append_impulses(impulses);
  return impulses;
}

// Two sweeps took impulses_before to those there are, which are taken further. Returns the largest speed of a
// node that was moved.
double Integrator::accelerate(Anderson& anderson, std::vector<double>& impulses_before) {
  const std::vector<double> now = impulses();
  const auto count = static_cast<Eigen::Index>(now.size());
  const Eigen::Map<const Dofs> image(now.data(), count), before(impulses_before.data(), count);
  const Dofs correction = anderson.correction(image, image - before);
  const double* next = correction.data();
  double fastest = 0.0;
  for (const auto& interface : interfaces_) fastest = std::max(fastest, interface->add_impulses(next, v_));
  impulses_before = impulses();
  return fastest;
}

void Integrator::open_interfaces(const StepView& step) {
  for (const auto& interface : interfaces_) interface->open_step(step);
}

// Evaluates every contact once, each against the impulses of the others. Returns the largest speed of a node
// that was moved.
double Integrator::sweep(const StepView& step) {
  double fastest = 0.0;
  for (const auto& interface : interfaces_)
    for (int colour = 0; colour < interface->colours(); ++colour)
      fastest = std::max(fastest, interface->solve(colour, v_, step));
  return fastest;
}

void Integrator::account() {
  if (!loads_.empty()) energy_.add_external(external_impulse_, v_before_, v_);
  if (!model_.is_linear()) energy_.add_internal(internal_impulse_, v_before_, v_);
  for (const auto& interface : interfaces_) account(*interface);
  double stored = 0.0;
  for (const auto& interface : interfaces_)
    for (const std::int32_t contact_index : interface->active())
      stored += interface->energy(contact_index, ILAW_ENERGY_STORED);
  energy_.set_stored(stored);
}

void Integrator::account(const Interface& interface) {
  const Vector drift = interface.obstacle_velocity() + interface.obstacle_velocity_before();
  double work = 0.0, relative_work = 0.0;
  for (const std::int32_t contact_index : interface.active()) {
    tally_.penetration_max = std::max(tally_.penetration_max, -interface.gap(contact_index));
    ++tally_.status_counts[static_cast<std::size_t>(interface.status(contact_index))];
    // Also where there is no impulse: a penalty that lets go may still have stored something.
    for (int part = 0; part < ILAW_ENERGY_STORED; ++part)
      energy_.add_dissipation(part, interface.energy(contact_index, part));
    if (interface.status(contact_index) == ILAW_FREE && interface.impulse(contact_index).isZero(0.0))
      continue;
    const Vector sum = interface.relative(contact_index, v_before_) + interface.relative(contact_index, v_);
    work += 0.5 * interface.impulse(contact_index).dot(sum);
    relative_work += 0.5 * interface.impulse(contact_index).dot(sum - drift);
  }
  energy_.add_interface(work, relative_work);
  const auto active = static_cast<std::int64_t>(interface.active().size());
  const auto skipped = static_cast<std::int64_t>(interface.nodes().size()) - active;
  tally_.active += active;
  tally_.skipped += skipped;
  tally_.status_counts[ILAW_FREE] += skipped;
}

Dofs Integrator::interface_impulse() const {
  Dofs impulse = Dofs::Zero(u_.size());
  for (const auto& interface : interfaces_)
    for (const std::int32_t contact_index : interface->active())
      interface->add_impulse(contact_index, impulse);
  return impulse;
}

std::vector<std::string> Integrator::warnings() const {
  std::vector<std::string> warnings;
  const auto say = [&](const char* format, auto... values) {
    std::array<char, 256> text{};
    std::snprintf(text.data(), text.size(), format, values...);
    warnings.emplace_back(text.data());
  };
  if (tally_.unconverged > 0)
    say("contacts that share nodes are not solved in %lld of %lld steps: residual up to %.1e after %d sweeps, "
        "expected %g",
        static_cast<long long>(tally_.unconverged), static_cast<long long>(steps_),
        tally_.coupling_residual_max, most_sweeps, coupling_tolerance);
  const EnergyReport energy = this->energy();
  if (energy.reaction_work > much_energy * energy.scale)
    say("interfaces put in the energy %.2g, where %.2g is the largest in the run: an explicit penalty too stiff "
        "for the time step does, and one that is pressed in at the start; contact, friction and bonds do not",
        energy.reaction_work, energy.scale);
  return warnings;
}

EnergyReport Integrator::energy() const { return energy_.report(model_, u_, u_ + dt_ * v_, v_); }

Vector Integrator::angular_momentum() const {
  const Eigen::Index d = model_.dimension();
  std::array<long double, 3> sum{};
  for (Eigen::Index i = 0; i < u_.size(); i += d) {
    std::array<long double, 3> x{}, p{};
    for (Eigen::Index c = 0; c < d; ++c) {
      x[static_cast<std::size_t>(c)] = static_cast<long double>(model_.position()[i + c]) + u_[i + c];
      p[static_cast<std::size_t>(c)] = static_cast<long double>(model_.mass()[i + c]) * v_[i + c];
    }
    for (std::size_t c = 0; c < 3; ++c)
      sum[c] += x[(c + 1) % 3] * p[(c + 2) % 3] - x[(c + 2) % 3] * p[(c + 1) % 3];
  }
  Vector momentum(d == 1 ? 0 : d == 2 ? 1 : 3);
  for (Eigen::Index c = 0; c < momentum.size(); ++c)
    momentum[c] = static_cast<double>(sum[static_cast<std::size_t>(d == 2 ? 2 : c)]);
  return momentum;
}

void Integrator::save(std::ostream& out) const {
  out.write(reinterpret_cast<const char*>(&steps_), sizeof steps_);
  for (const Dofs* dofs : {&u_, &v_})
    out.write(reinterpret_cast<const char*>(dofs->data()),
              static_cast<std::streamsize>(dofs->size()) * static_cast<std::streamsize>(sizeof(double)));
  energy_.save(out);
  out.write(reinterpret_cast<const char*>(&tally_), sizeof tally_);
  for (const auto& interface : interfaces_) interface->save(out);
}

void Integrator::load(std::istream& in) {
  in.read(reinterpret_cast<char*>(&steps_), sizeof steps_);
  for (Dofs* dofs : {&u_, &v_})
    in.read(reinterpret_cast<char*>(dofs->data()),
            static_cast<std::streamsize>(dofs->size()) * static_cast<std::streamsize>(sizeof(double)));
  energy_.load(in);
  in.read(reinterpret_cast<char*>(&tally_), sizeof tally_);
  for (const auto& interface : interfaces_) interface->load(in, u_);
  if (!in) throw std::runtime_error("the checkpoint is damaged");
}

}  // namespace ilaw::host
