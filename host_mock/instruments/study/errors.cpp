// SPDX-License-Identifier: BSD-3-Clause
#include "study/errors.hpp"

#include "base/clock.hpp"

#include <algorithm>
#include <cmath>

namespace ilaw::host {
namespace {

// A watched node in its contact.
struct WatchedContact {
  const Interface* interface;
  int node_index;
  std::size_t watched;
};

std::vector<WatchedContact> watched_contacts(const Scene& scene) {
  std::vector<WatchedContact> contacts;
  for (std::size_t w = 0; w < scene.output.watch.size(); ++w)
    for (const auto& interface : scene.interfaces) {
      const std::vector<int>& nodes = interface->nodes();
      const auto found = std::find(nodes.begin(), nodes.end(), scene.output.watch[w]);
      if (found != nodes.end())
        contacts.push_back({interface.get(), static_cast<int>(found - nodes.begin()), w});
    }
  return contacts;
}

void note_instants(const std::vector<WatchedContact>& contacts, double time, Trace& trace) {
  for (const WatchedContact& contact : contacts) {
    const int contact_index = contact.interface->contact_at(contact.node_index);
    if (!contact.interface->is_active(contact_index)) continue;
    ContactInstants& instants = trace.instants[contact.watched];
    if (!contact.interface->impulse(contact_index).isZero(0.0)) {
      if (std::isnan(instants.first_impulse)) instants.first_impulse = time;
      instants.last_impulse = time;
    }
    if (contact.interface->status(contact_index) == ILAW_BROKEN) instants.last_rupture = time;
  }
}

Dofs watched_part(const Dofs& all, const Scene& scene) {
  const Eigen::Index d = scene.model->dimension();
  Dofs part(static_cast<Eigen::Index>(scene.output.watch.size()) * d);
  for (std::size_t w = 0; w < scene.output.watch.size(); ++w)
    part.segment(static_cast<Eigen::Index>(w) * d, d) = all.segment(scene.output.watch[w] * d, d);
  return part;
}

// The reference at step k of a trace: displacement, and what belongs to the half step after it.
struct Sample {
  Dofs displacement, velocity, impulse;  // impulse: empty where it is not known
  double work = ContactInstants::none;
};

// Linear between entries, constant beyond the ends. In the step of a jump velocities are between
// both sides.
template <class Entry>
Entry interpolated(const std::vector<Entry>& entries, double at) {
  at = std::clamp(at, 0.0, static_cast<double>(entries.size() - 1));
  const auto before = static_cast<std::size_t>(at);
  const std::size_t after = std::min(before + 1, entries.size() - 1);
  const double part = at - static_cast<double>(before);
  return (1.0 - part) * entries[before] + part * entries[after];
}

// Mean size of errors over that of what they are errors of.
struct MeanError {
  double error = 0.0, size = 0.0;
  void add(const Dofs& found, const Dofs& wanted) {
    error += found.size() == wanted.size() ? (found - wanted).cwiseAbs().sum() : ContactInstants::none;
    size += wanted.cwiseAbs().sum();
  }
  double relative() const { return error / size; }
};

template <class Reference>
Errors errors_with(const Trace& trace, const std::vector<ContactInstants>& instants, double energy,
                   Reference reference) {
  double error_square = 0.0, square = 0.0, error_max = 0.0, largest = 0.0, work_error = 0.0;
  MeanError velocity, impulse;
  for (std::size_t k = 0; k < trace.displacement.size(); ++k) {
    const Sample wanted = reference((static_cast<double>(k) + 1.0) * trace.dt);
    const Dofs u_error = trace.displacement[k] - wanted.displacement;
    error_square += u_error.squaredNorm();
    square += wanted.displacement.squaredNorm();
    error_max = std::max(error_max, u_error.cwiseAbs().maxCoeff());
    largest = std::max(largest, wanted.displacement.cwiseAbs().maxCoeff());
    velocity.add(trace.velocity[k], wanted.velocity);
    impulse.add(trace.impulse[k], wanted.impulse);
    work_error += std::abs(trace.work[k] - wanted.work);
  }
  double instant = ContactInstants::none;
  for (std::size_t w = 0; w < instants.size(); ++w)
    for (const auto moment :
         {&ContactInstants::first_impulse, &ContactInstants::last_impulse, &ContactInstants::last_rupture})
      instant = std::fmax(instant, std::abs(trace.instants[w].*moment - instants[w].*moment));
  return {std::sqrt(error_square / square),
          error_max / largest,
          velocity.relative(),
          instant,
          impulse.relative(),
          work_error / static_cast<double>(trace.work.size()) / energy};
}

// Impulse of an interface on its nodes, all together.
void add_impulses(const Interfaces& interfaces, Dofs& sums) {
  const Eigen::Index d = sums.size() / static_cast<Eigen::Index>(std::max<std::size_t>(interfaces.size(), 1));
  for (std::size_t i = 0; i < interfaces.size(); ++i)
    for (const std::int32_t contact_index : interfaces[i]->active())
      sums.segment(static_cast<Eigen::Index>(i) * d, d) += interfaces[i]->impulse(contact_index);
}

// Errors are of motions, impulses and their work.
void ask_no_energies(const Interfaces& interfaces) {
  for (const auto& interface : interfaces) interface->ask_energies(false);
}

}  // namespace

Trace trace_of(Scene& scene) {
  const double start = clock_seconds(CLOCK_PROCESS_CPUTIME_ID);
  ask_no_energies(scene.interfaces);
  Integrator integrator(*scene.model, scene.loads, scene.interfaces, scene.dt, scene.prestress);
  const std::vector<WatchedContact> contacts = watched_contacts(scene);
  Trace trace;
  trace.dt = scene.dt;
  trace.steps = scene.steps;
  trace.dimension = scene.model->dimension();
  trace.instants.resize(scene.output.watch.size());
  Dofs impulse = Dofs::Zero(static_cast<Eigen::Index>(scene.interfaces.size()) * trace.dimension);
  integrator.start();
  add_impulses(scene.interfaces, impulse);
  while (integrator.steps() < scene.steps) {
    integrator.step();
    trace.displacement.push_back(watched_part(integrator.displacement(), scene));
    trace.velocity.push_back(watched_part(integrator.velocity(), scene));
    add_impulses(scene.interfaces, impulse);
    trace.impulse.push_back(impulse);
    trace.work.push_back(integrator.interface_work());
    note_instants(contacts, integrator.time(), trace);
  }
  trace.seconds = clock_seconds(CLOCK_PROCESS_CPUTIME_ID) - start;
  trace.energy = integrator.energy().scale;
  trace.penetration = integrator.tally().penetration_max;
  return trace;
}

double seconds_of(Scene& scene) {
  ask_no_energies(scene.interfaces);
  Integrator integrator(*scene.model, scene.loads, scene.interfaces, scene.dt, scene.prestress);
  integrator.start();
  const double start = clock_seconds(CLOCK_PROCESS_CPUTIME_ID);
  while (integrator.steps() < scene.steps) integrator.step();
  return clock_seconds(CLOCK_PROCESS_CPUTIME_ID) - start;
}

Errors errors_against(const std::vector<ExactNode>& exact, const Trace& trace) {
  const auto stride = static_cast<std::size_t>(trace.dimension);
  std::vector<ContactInstants> instants;
  for (std::size_t w = 0; w < exact.size(); w += stride) instants.push_back(exact[w].instants);
  std::vector<const ExactNode*> given;  // those whose impulse is known
  for (const ExactNode& node : exact)
    if (node.impulse) given.push_back(&node);
  const auto sampled = [](std::size_t size, auto&& value) {
    Dofs values(static_cast<Eigen::Index>(size));
    for (std::size_t k = 0; k < size; ++k) values[static_cast<Eigen::Index>(k)] = value(k);
    return values;
  };
  const ExactNode* working = given.empty() ? nullptr : given.front();
  return errors_with(trace, instants, working ? working->energy : ContactInstants::none, [&](double time) {
    const double after = time + 0.5 * trace.dt;
    return Sample{sampled(exact.size(), [&](std::size_t k) { return exact[k].displacement(time); }),
                  sampled(exact.size(), [&](std::size_t k) { return exact[k].velocity(after); }),
                  sampled(given.size(), [&](std::size_t k) { return given[k]->impulse(after); }),
                  working && working->work ? working->work(after) : ContactInstants::none};
  });
}

Errors errors_against(const Trace& reference, const Trace& trace) {
  return errors_with(trace, reference.instants, reference.energy, [&](double time) {
    const double half = (time + 0.5 * trace.dt) / reference.dt - 1.5;
    return Sample{interpolated(reference.displacement, time / reference.dt - 1.0),
                  interpolated(reference.velocity, half), interpolated(reference.impulse, half),
                  interpolated(reference.work, half)};
  });
}

double order_of(const std::vector<double>& h, const std::vector<double>& errors, double scale) {
  double sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
  std::size_t count = 0;
  for (std::size_t k = 0; k < h.size(); ++k) {
    if (!std::isfinite(errors[k])) return ContactInstants::none;
    if (!(errors[k] > rounding_level * scale)) continue;
    const double x = std::log(h[k]), y = std::log(errors[k]);
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
    ++count;
  }
  // Two points make a slope of chance.
  if (count < 3) return ContactInstants::none;
  const auto n = static_cast<double>(count);
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

}  // namespace ilaw::host
