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

// How many contacts may have each node.
std::vector<int> users_of_nodes(const Scene& scene) {
  std::vector<int> users(static_cast<std::size_t>(scene.model->node_count()));
  for (const auto& interface : scene.interfaces)
    for (const std::vector<int>* nodes : {&interface->nodes(), &interface->setup().counterpart->partners()})
      for (const int node : *nodes) ++users[static_cast<std::size_t>(node)];
  return users;
}

// Nodes that are driven have a small H, within which the solver of coupled contacts finds their impulses.
bool is_coupled(const Interface& interface, const std::vector<int>& users) {
  const auto is_shared = [&](int node) { return users[static_cast<std::size_t>(node)] > 1; };
  const std::vector<int>&nodes = interface.nodes(), &partners = interface.setup().counterpart->partners();
  return interface.setup().has_driven_nodes || interface.setup().counterpart->shares_partners() ||
         std::any_of(nodes.begin(), nodes.end(), is_shared) ||
         std::any_of(partners.begin(), partners.end(), is_shared);
}

}  // namespace

Audit::Audit(const Scene& scene, const Integrator& integrator)
    : scene_(scene), integrator_(integrator), inverse_mass_(scene.model->mass().cwiseInverse()) {
  const std::vector<int> users = users_of_nodes(scene);
  for (const auto& interface : scene.interfaces)
    interfaces_.push_back(
        std::make_unique<AuditedInterface>(*interface, *scene.model, is_coupled(*interface, users)));
}

Audit::~Audit() = default;

void Audit::open() try {
  if (integrator_.prestressed() && !integrator_.has_started()) check_equilibrium();
  work_before_ = integrator_.interface_work();
  for (const auto& interface : interfaces_) interface->open(integrator_.displacement());
} catch (const AuditFailure& failure) {
  throw AuditFailure(std::string("audit: prestress: ") + failure.what());
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
  const std::int64_t n = integrator_.steps();
  const double speed = std::max({largest_speed(v, d), largest_speed(integrator_.velocity_before(), d),
                                 largest_speed(v_smooth, d), largest_speed(change, d)});
  const double farthest = (scene_.model->position() + u).cwiseAbs().maxCoeff();
  for (const auto& interface : interfaces_)
    interface->close({u, v, integrator_.velocity_before(), v_smooth, integrator_.time_of(n - 1),
                      integrator_.time(), integrator_.time_of(n + 1), scene_.dt, speed, farthest,
                      is_start()});
} catch (const AuditFailure& failure) {
  throw AuditFailure("audit: " + step_text() + failure.what());
}

// What is driven has no equation.
void Audit::leave_out_driven(Dofs& of_dofs) const {
  for (const auto& load : scene_.loads)
    for (const int node : load->prescribed_nodes())
      for (const int axis : load->prescribed_axes())
        of_dofs[Eigen::Index{node} * scene_.model->dimension() + axis] = 0.0;
}

// Forces of the equilibrium, by the model, the loads and the last impulses of interfaces, which a half step
// of the velocity had. A body without loads and contacts has no other force that the rest is small to.
void Audit::check_equilibrium() const {
  const Dofs& u = integrator_.displacement();
  Dofs contact = integrator_.interface_impulse() / velocity_step(), loads = Dofs::Zero(u.size());
  for (const auto& load : scene_.loads) load->add_force(integrator_.time(), u, loads);
  const double largest = std::max(loads.norm(), contact.norm());
  Dofs open = loads + contact;
  scene_.model->add_internal_forces(u, open);
  leave_out_driven(open);
  if (largest == 0.0 || open.norm() <= (1.0 + 1e-6) * scene_.prestress->tolerance * largest) return;
  throw AuditFailure(formatted("forces: of %.9g the part %.3g is open, expected at most %g", largest,
                               open.norm() / largest, scene_.prestress->tolerance));
}

// m (v - v_before) = h f_ext + shocks - h f_int + r, degree of freedom by degree of freedom. Loads that
// correct velocities, but for motions, whose nodes have no such equation, follow from the velocities that
// they leave.
void Audit::check_momentum(const Dofs& contact) const {
  const Model& model = *scene_.model;
  const Dofs &u = integrator_.displacement(), &v = integrator_.velocity(),
             &before = integrator_.velocity_before();
  const StepTimes times = integrator_.times_of(integrator_.steps());
  Dofs external = Dofs::Zero(u.size()), internal = external, left = contact, ignored = external;
  for (const auto& load : scene_.loads) load->add_force(times.after, u, external);
  external *= velocity_step();
  for (const auto& load : scene_.loads)
    if (!is_start()) load->add_impulse(times, external);
  model.add_internal_forces(u, internal);
  internal *= velocity_step();
  Dofs expected = before + (external + internal).cwiseProduct(inverse_mass_);
  for (const bool damps_by_mass : {false, true})
    for (const auto& load : scene_.loads) {
      if (!load->corrects() || load->acts_on_driven() == damps_by_mass || !load->prescribed_nodes().empty())
        continue;
      load->correct(times, {u, before}, expected, ignored);
      load->transmit(times, left);
    }
  expected += left.cwiseProduct(inverse_mass_);
  const Dofs scale =
      before.cwiseAbs() + v.cwiseAbs() +
      inverse_mass_.cwiseProduct(external.cwiseAbs() + internal.cwiseAbs() + contact.cwiseAbs());
  const double rounded = 64.0 * std::numeric_limits<double>::epsilon() * scale.maxCoeff();
  const int d = model.dimension();
  Dofs off = v - expected;
  leave_out_driven(off);
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    if (std::abs(off[i]) <= bound_of_momentum * scale[i] + rounded) continue;
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
