// SPDX-License-Identifier: BSD-3-Clause
#include "study/errors.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace ilaw::host {
namespace {

// A watched node in its contact.
struct WatchedContact {
  const Interface* interface;
  int contact_index;
  std::size_t watched;
};

std::vector<WatchedContact> watched_contacts(Scene& scene, const Dofs& u) {
  std::vector<WatchedContact> contacts;
  for (std::size_t w = 0; w < scene.output.watch.size(); ++w)
    for (const auto& interface : scene.interfaces) {
      const std::vector<int>& nodes = interface->nodes();
      const auto found = std::find(nodes.begin(), nodes.end(), scene.output.watch[w]);
      if (found != nodes.end())
        contacts.push_back(
            {interface.get(), interface->contact_index_of(static_cast<int>(found - nodes.begin()), u), w});
    }
  return contacts;
}

void note_instants(const std::vector<WatchedContact>& contacts, double time, Trace& trace) {
  for (const WatchedContact& contact : contacts) {
    if (!contact.interface->is_active(contact.contact_index)) continue;
    ContactInstants& instants = trace.instants[contact.watched];
    if (!contact.interface->impulse(contact.contact_index).isZero(0.0)) {
      if (std::isnan(instants.first_impulse)) instants.first_impulse = time;
      instants.last_impulse = time;
    }
    if (contact.interface->status(contact.contact_index) == ILAW_BROKEN) instants.last_rupture = time;
  }
}

Dofs watched_part(const Dofs& all, const Scene& scene) {
  const Eigen::Index d = scene.model->dimension();
  Dofs part(static_cast<Eigen::Index>(scene.output.watch.size()) * d);
  for (std::size_t w = 0; w < scene.output.watch.size(); ++w)
    part.segment(static_cast<Eigen::Index>(w) * d, d) = all.segment(scene.output.watch[w] * d, d);
  return part;
}

// The reference at step k of a trace.
struct Sample {
  Dofs displacement, velocity;
};

// Linear between entries, constant beyond the ends. In the step of a jump velocities are between
// both sides.
Dofs between(const std::vector<Dofs>& entries, double at) {
  at = std::clamp(at, 0.0, static_cast<double>(entries.size() - 1));
  const auto before = static_cast<std::size_t>(at);
  const std::size_t after = std::min(before + 1, entries.size() - 1);
  const double part = at - static_cast<double>(before);
  return (1.0 - part) * entries[before] + part * entries[after];
}

template <class Reference>
Errors errors_with(const Trace& trace, const std::vector<ContactInstants>& instants, Reference reference) {
  double error_square = 0.0, square = 0.0, error_max = 0.0, largest = 0.0, v_error = 0.0, v_sum = 0.0;
  for (std::size_t k = 0; k < trace.displacement.size(); ++k) {
    const Sample wanted = reference((static_cast<double>(k) + 1.0) * trace.dt);
    const Dofs u_error = trace.displacement[k] - wanted.displacement;
    error_square += u_error.squaredNorm();
    square += wanted.displacement.squaredNorm();
    error_max = std::max(error_max, u_error.cwiseAbs().maxCoeff());
    largest = std::max(largest, wanted.displacement.cwiseAbs().maxCoeff());
    v_error += (trace.velocity[k] - wanted.velocity).cwiseAbs().sum();
    v_sum += wanted.velocity.cwiseAbs().sum();
  }
  double instant = ContactInstants::none;
  for (std::size_t w = 0; w < instants.size(); ++w)
    for (const auto moment :
         {&ContactInstants::first_impulse, &ContactInstants::last_impulse, &ContactInstants::last_rupture})
      instant = std::fmax(instant, std::abs(trace.instants[w].*moment - instants[w].*moment));
  return {std::sqrt(error_square / square), error_max / largest, v_error / v_sum, instant};
}

}  // namespace

Trace trace_of(Scene& scene) {
  const auto start = std::chrono::steady_clock::now();
  Integrator integrator(*scene.model, scene.loads, scene.interfaces, scene.dt);
  const std::vector<WatchedContact> contacts = watched_contacts(scene, integrator.displacement());
  Trace trace;
  trace.dt = scene.dt;
  trace.steps = scene.steps;
  trace.dimension = scene.model->dimension();
  trace.instants.resize(scene.output.watch.size());
  while (integrator.steps() < scene.steps) {
    integrator.step();
    trace.displacement.push_back(watched_part(integrator.displacement(), scene));
    trace.velocity.push_back(watched_part(integrator.velocity(), scene));
    note_instants(contacts, integrator.time(), trace);
  }
  trace.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return trace;
}

Errors errors_against(const std::vector<ExactNode>& exact, const Trace& trace) {
  std::vector<ContactInstants> instants;
  instants.reserve(exact.size());
  for (const ExactNode& node : exact) instants.push_back(node.instants);
  return errors_with(trace, instants, [&](double time) {
    Sample sample{Dofs(static_cast<Eigen::Index>(exact.size())),
                  Dofs(static_cast<Eigen::Index>(exact.size()))};
    for (std::size_t w = 0; w < exact.size(); ++w) {
      sample.displacement[static_cast<Eigen::Index>(w)] = exact[w].displacement(time);
      sample.velocity[static_cast<Eigen::Index>(w)] = exact[w].velocity(time + 0.5 * trace.dt);
    }
    return sample;
  });
}

Errors errors_against(const Trace& reference, const Trace& trace) {
  return errors_with(trace, reference.instants, [&](double time) {
    return Sample{between(reference.displacement, time / reference.dt - 1.0),
                  between(reference.velocity, (time + 0.5 * trace.dt) / reference.dt - 1.5)};
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
