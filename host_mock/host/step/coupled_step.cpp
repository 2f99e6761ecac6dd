// SPDX-License-Identifier: BSD-3-Clause
#include "step/coupled_step.hpp"

#include "base/bytes.hpp"
#include "base/parallel.hpp"
#include "base/words.hpp"
#include "step/dof_loops.hpp"

#include <ilaw/arrays.hpp>

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

namespace ilaw::host {

bool share_nodes(const Model& model, const Interfaces& interfaces) {
  std::vector<bool> seen(static_cast<std::size_t>(model.node_count()));
  for (const auto& interface : interfaces) {
    if (interface->setup().counterpart->shares_partners()) return true;
    if (interface->setup().has_driven_nodes) return true;  // blocks of contacts have one H per node
    for (const std::vector<int>* nodes : {&interface->nodes(), &interface->setup().counterpart->partners()})
      for (const int node : *nodes)
        if (std::vector<bool>::reference mark = seen[static_cast<std::size_t>(node)]; mark)
          return true;
        else
          mark = true;
  }
  return false;
}

CoupledStep::CoupledStep(const Model& model, Interfaces& interfaces)
    : model_(model), body_(static_cast<std::size_t>(model.node_count()), -1) {
  interfaces_.reserve(interfaces.size());
  for (const auto& interface : interfaces) {
    interfaces_.emplace_back(*interface);
    has_driven_nodes_ = has_driven_nodes_ || interface->setup().has_driven_nodes;
  }
}

// Which contacts may act follows from a bound on speeds. Where impulses leave a node faster, the step is
// solved again with a larger one: whether that happens does not depend on which contacts are active. With
// ILAW_HOSTILE each step is solved twice, because a try must leave nothing behind.
const ilaw_coupled_report& CoupledStep::solve(StepView step, const double* inverse_mass, Dofs& v) {
  const double speed = std::max(step.speed_before, step.speed_after);
  step.speed_after = 2.0 * speed;
  open(step);
  if (!nodes_.empty()) v_free_ = v;
  for (bool is_last_try = !is_hostile;; is_last_try = true) {
    const ilaw_bodies bodies = gather(step, inverse_mass, v);
    try {
      report_ = solver_.solve(bodies, given_, options_of(step, speed));
    } catch (const ilaw::coupled_error& refused) {
      refuse(refused);
    }
    scatter(step, v);
    if (nodes_.empty()) return report_;
    if (!(report_.message && forget_forces())) {  // else once more, from rest
      const double fastest = largest_speed(v, model_.dimension());
      if (fastest > step.speed_after)
        step.speed_after = 2.0 * fastest;
      else if (is_last_try)
        return report_;
    }
    v = v_free_;
    open(step);
  }
}

void CoupledStep::open(const StepView& step) {
  given_.clear();
  for (CoupledInterface& interface : interfaces_) given_.push_back(&interface.open(step));
  number_bodies();
}

void CoupledStep::number_bodies() {
  for (const std::int32_t node : nodes_) body_[static_cast<std::size_t>(node)] = -1;
  nodes_.clear();
  for (CoupledInterface& interface : interfaces_)
    interface.group().for_each_body([&](std::int32_t node) {
      std::int32_t& body = body_[static_cast<std::size_t>(node)];
      if (body < 0) nodes_.push_back(node);
      body = 0;
    });
  std::sort(nodes_.begin(), nodes_.end());
  for (std::size_t b = 0; b < nodes_.size(); ++b)
    body_[static_cast<std::size_t>(nodes_[b])] = static_cast<std::int32_t>(b);
  for (CoupledInterface& interface : interfaces_)
    interface.group().for_each_body(
        [&](std::int32_t& node) { node = body_[static_cast<std::size_t>(node)]; });
}

// Rounding of a difference of coordinates, as a velocity.
double CoupledStep::rounding_of_gaps(const StepView& step) const {
  const int d = model_.dimension();
  double largest = 0.0;
  for (const std::int32_t node : nodes_)
    for (Eigen::Index dof = Eigen::Index{d} * node; dof < Eigen::Index{d} * (node + 1); ++dof)
      largest = std::max(largest, std::fabs(model_.position()[dof] + step.u[dof]));
  return roundings_of_gaps * std::numeric_limits<double>::epsilon() * largest / step.dt;
}

// OpenMP's threads, which the rest of the step uses.
void CoupledStep::run_on_threads(void*, std::uint32_t threads, ilaw_work_function part, void* work) {
#pragma omp parallel num_threads(static_cast <int>(threads))
  part(work, static_cast<std::uint32_t>(omp_get_thread_num()),
       static_cast<std::uint32_t>(omp_get_num_threads()));
}

ilaw_coupled_options CoupledStep::options_of(const StepView& step, double speed) const {
  static const ilaw_threads pool{sizeof pool, 0, nullptr, run_on_threads};
  ilaw_coupled_options options{};
  options.most_sweeps = most_sweeps;
  options.tolerance = tolerance_;
  options.speed = speed;
  options.rounding = rounding_of_gaps(step);
  options.threads = static_cast<std::uint32_t>(omp_get_max_threads());
  options.pool = &pool;
  return options;
}

ilaw_bodies CoupledStep::gather(const StepView& step, const double* inverse_mass, const Dofs& v) {
  const auto d = static_cast<std::size_t>(model_.dimension());
  for (std::vector<double>* values : {&inverse_mass_, &velocity_, &previous_})
    values->resize(d * nodes_.size());
  for (std::size_t b = 0; b < nodes_.size(); ++b)
    for (std::size_t c = 0; c < d; ++c) {
      const std::size_t dof = d * static_cast<std::size_t>(nodes_[b]) + c;
      inverse_mass_[d * b + c] = inverse_mass[dof];
      velocity_[d * b + c] = v[static_cast<Eigen::Index>(dof)];
      previous_[d * b + c] = step.v_before[static_cast<Eigen::Index>(dof)];
    }
  const int dimension = model_.dimension();
  ilaw_bodies bodies{};
  bodies.struct_size = sizeof bodies;
  bodies.dimension = static_cast<std::uint32_t>(dimension);
  bodies.count = bodies.owned_count = static_cast<std::int64_t>(nodes_.size());
  bodies.inverse_mass = ilaw::input(inverse_mass_.data(), dimension, has_driven_nodes_ ? 1 : 0);
  bodies.v_free = ilaw::input(velocity_.data(), dimension, 1);
  bodies.v_previous = ilaw::input(previous_.data(), dimension, 1);
  bodies.velocity = ilaw::output(velocity_.data(), dimension, 1);
  return bodies;
}

// Throws, what ended a solve.
void CoupledStep::refuse(const ilaw::coupled_error& refused) const {
  if (refused.code() == ILAW_OUT_OF_MEMORY) throw std::bad_alloc();
  const ilaw_coupled_report& report = refused.report();
  if (report.bad_group < 0) throw;
  const CoupledInterface& interface = interfaces_[static_cast<std::size_t>(report.bad_group)];
  if (report.bad_contact >= 0) interface.refuse_driven(static_cast<std::size_t>(report.bad_contact));
  interface.refuse(refused.code(), report.reason);
}

void CoupledStep::scatter(const StepView& step, Dofs& v) {
  for (std::size_t i = 0; i < interfaces_.size(); ++i) {
    const bool is_bad = report_.bad_group == static_cast<std::int64_t>(i);
    interfaces_[i].check(report_, is_bad ? report_.bad_contact : -1, step.dt);
  }
  for (CoupledInterface& interface : interfaces_) interface.take();
  const auto d = static_cast<std::size_t>(model_.dimension());
  for (std::size_t b = 0; b < nodes_.size(); ++b)
    for (std::size_t c = 0; c < d; ++c)
      v[static_cast<Eigen::Index>(d * static_cast<std::size_t>(nodes_[b]) + c)] = velocity_[d * b + c];
}

// Incompatible laws push each other up; or they go on until one of them breaks, and begin anew. A long
// column, which more iterations would solve, does neither: it is told by its length.
std::string CoupledStep::explain() const {
  constexpr double beyond_rounding = 1e-6;
  constexpr std::int64_t most_named = 50;
  if (!report_.message || report_.worst_group < 0) return "";
  const bool is_stuck = report_.residual > beyond_rounding && report_.island_contacts <= most_named;
  if (!report_.other_law && !is_stuck) return "";
  return formatted(
      "contacts that share node %d of interface '%s' have no common solution, or it is not found; the energy is "
      "wrong by %.3g: %s",
      static_cast<int>(worst_node()),
      interfaces_[static_cast<std::size_t>(report_.worst_group)].interface().name().c_str(),
      report_.energy_error, report_.message);
}

std::int64_t CoupledStep::worst_node() const {
  if (report_.worst_group < 0) return -1;
  const CoupledInterface& worst = interfaces_[static_cast<std::size_t>(report_.worst_group)];
  return worst.interface().node_of(worst.group().contact(static_cast<std::size_t>(report_.worst_contact)));
}

void CoupledStep::check_results(const StepView& step, const Dofs& v) const {
  for (const CoupledInterface& interface : interfaces_) {
    interface.check_driven(step, v);
    interface.check_results(step.dt);
  }
}

void CoupledStep::accept(const StepView& step, const Dofs& v) {
  constexpr double most_growth = 1e4;  // the weight of a column over that of a body
  for (CoupledInterface& interface : interfaces_) {
    interface.accept(step, v);
    interface.group().keep_forces(step.velocity_step());
  }
  // Impulses that run away would begin where they ended.
  if (report_.message || report_.speed > most_growth * report_.first_speed) forget_forces();
}

// Whether there were any.
bool CoupledStep::forget_forces() {
  bool had_some = false;
  for (CoupledInterface& interface : interfaces_) {
    had_some = had_some || !interface.group().kept().empty();
    interface.group().forget_forces();
  }
  return had_some;
}

void CoupledStep::save(std::ostream& out) const {
  write_value(out, tolerance_);
  for (const CoupledInterface& interface : interfaces_) {
    std::vector<int> nodes;
    for (const std::int32_t contact : interface.group().kept())
      nodes.push_back(interface.interface().node_index_of(contact));
    write_sized(out, nodes);
    write_sized(out, interface.group().kept_forces());
  }
}

void CoupledStep::load(std::istream& in, const Dofs& u) {
  const auto d = static_cast<std::size_t>(model_.dimension());
  read_value(in, tolerance_);
  for (CoupledInterface& part : interfaces_) {
    Interface& interface = part.interface();
    ContactList contacts;
    for (const int node : ContactArrays::load_nodes(in, interface.nodes().size()))
      contacts.push_back(interface.contact_index_of(node, u));
    std::vector<double> forces = read_sized<double>(in, d * contacts.size());
    if (forces.size() != d * contacts.size()) refuse_damaged();
    part.group().keep(std::move(contacts), std::move(forces));
  }
}

}  // namespace ilaw::host
