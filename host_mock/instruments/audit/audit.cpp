// SPDX-License-Identifier: BSD-3-Clause
#include "audit/audit.hpp"

#include "audit/audited_interface.hpp"
#include "base/words.hpp"
#include "step/dof_loops.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ilaw::host {
namespace {

constexpr double bound_of_momentum = 1e-11, bound_of_work = 1e-9;

}  // namespace

Audit::Audit(const Scene& scene, const Integrator& integrator)
    : scene_(scene), integrator_(integrator), inverse_mass_(scene.model->mass().cwiseInverse()) {
  for (const auto& interface : scene.interfaces)
    interfaces_.push_back(std::make_unique<AuditedInterface>(*interface, *scene.model));
}

Audit::~Audit() = default;

void Audit::open() {
  work_before_ = integrator_.interface_work();
  for (const auto& interface : interfaces_) interface->open(integrator_.displacement());
}

std::string Audit::step_text() const {
  return formatted("step %lld, time %g: ", static_cast<long long>(integrator_.steps()), integrator_.time());
}

void Audit::close() try {
  const Dofs &u = integrator_.displacement(), &v = integrator_.velocity();
  Dofs impulse = Dofs::Zero(u.size());
  for (const auto& interface : interfaces_) interface->add_impulses(impulse);
  check_momentum(impulse);
  check_work(impulse);
  if (interfaces_.empty()) return;
  const double* inverse = scene_.interfaces.front()->inverse_mass();  // what loads leave of an impulse
  const Dofs change = impulse.cwiseProduct(Eigen::Map<const Dofs>(inverse, impulse.size())),
             v_smooth = v - change;
  const Eigen::Index d = scene_.model->dimension();
  const double speed = std::max({largest_speed(v, d), largest_speed(integrator_.velocity_before(), d),
                                 largest_speed(v_smooth, d), largest_speed(change, d)});
  const double farthest = (scene_.model->position() + u).cwiseAbs().maxCoeff();
  for (const auto& interface : interfaces_)
    interface->close(
        {u, v, integrator_.velocity_before(), v_smooth, integrator_.time(), scene_.dt, speed, farthest});
} catch (const AuditFailure& failure) {
  throw AuditFailure("audit: " + step_text() + failure.what());
}

// m (v - v_before) = h f_ext + shocks - h f_int + r, degree of freedom by degree of freedom. Loads that
// correct velocities, but for motions, whose nodes have no such equation, follow from the velocities that
// they leave.
void Audit::check_momentum(const Dofs& contact) const {
  const Model& model = *scene_.model;
  const Dofs &u = integrator_.displacement(), &v = integrator_.velocity(),
             &before = integrator_.velocity_before();
  const StepTimes times{integrator_.time() - scene_.dt, integrator_.time()};
  Dofs external = Dofs::Zero(u.size()), internal = external, left = contact, ignored = external;
  for (const auto& load : scene_.loads) load->add_force(times.after, u, external);
  external *= scene_.dt;
  for (const auto& load : scene_.loads) load->add_impulse(times, external);
  model.add_internal_forces(u, internal);
  internal *= scene_.dt;
  Dofs expected = before + (external + internal).cwiseProduct(inverse_mass_);
  std::vector<bool> is_driven(static_cast<std::size_t>(u.size()), false);
  for (const bool damps_by_mass : {true, false})
    for (const auto& load : scene_.loads) {
      if (!load->corrects() || load->acts_on_driven() == damps_by_mass || !load->prescribed_nodes().empty())
        continue;
      load->correct(times, {u, before}, expected, ignored);
      load->transmit(times, left);
    }
  for (const auto& load : scene_.loads)
    for (const int node : load->prescribed_nodes())
      for (const int axis : load->prescribed_axes())
        is_driven[static_cast<std::size_t>(Eigen::Index{node} * model.dimension() + axis)] = true;
  expected += left.cwiseProduct(inverse_mass_);
  const Dofs scale =
      before.cwiseAbs() + v.cwiseAbs() +
      inverse_mass_.cwiseProduct(external.cwiseAbs() + internal.cwiseAbs() + contact.cwiseAbs());
  const double rounded = 64.0 * std::numeric_limits<double>::epsilon() * scale.maxCoeff();
  const int d = model.dimension();
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    if (is_driven[static_cast<std::size_t>(i)] ||
        std::abs(v[i] - expected[i]) <= bound_of_momentum * scale[i] + rounded)
      continue;
    throw AuditFailure(formatted("node %d: momentum along axis %d: velocity %.9g, impulses make %.9g",
                                 static_cast<int>(i / d), static_cast<int>(i % d), v[i], expected[i]));
  }
}

// The work that the run has booked for its interfaces in this step.
void Audit::check_work(const Dofs& impulse) const {
  const Dofs mean = 0.5 * (integrator_.velocity_before() + integrator_.velocity());
  const double work = impulse.dot(mean), booked = integrator_.interface_work() - work_before_;
  const double scale = impulse.cwiseAbs().dot(mean.cwiseAbs()) +
                       1e-6 * (std::abs(work_before_) + std::abs(integrator_.interface_work()));
  if (std::abs(work - booked) <= bound_of_work * scale) return;
  throw AuditFailure(formatted("energy: interfaces did the work %.9g, the run books %.9g", work, booked));
}

}  // namespace ilaw::host
