// SPDX-License-Identifier: BSD-3-Clause
#include "step/temperatures.hpp"

#include "base/bytes.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>

namespace ilaw::host {

Temperatures::Temperatures(const ThermalModel& model, const Loads& loads, const Interfaces& interfaces)
    : model_(model),
      rise_(Dofs::Zero(model.capacity().size())),
      free_rise_(rise_),
      temperature_(rise_),
      capacity_(model.capacity()),
      softness_(rise_),
      heat_(rise_) {
  for (const auto& load : loads) {
    const HeatLoad* const heat = load->heat();
    if (heat && !heat->holds()) fluxes_.push_back(heat);
    if (!heat || !heat->holds()) continue;
    for (const int node : heat->set().nodes) {
      held_.push_back({node, heat});
      capacity_[node] = std::numeric_limits<double>::infinity();
    }
  }
  for (int node = 0; node < static_cast<int>(rise_.size()); ++node)
    if (model_.has_temperature(node)) softness_[node] = 1.0 / capacity_[node];
  publish();
  for (const auto& interface : interfaces)
    if (ContactHeat* const heat = interface->heat()) heat->read(temperature_.data(), capacity_.data());
}

void Temperatures::publish() { temperature_ = model_.initial_temperature() + free_rise_; }

void Temperatures::hold(double time) {
  for (const auto& [node, load] : held_) {
    const double held = load->at(time) - model_.initial_temperature()[node];
    sums_.supplied += static_cast<Sum>(model_.capacity()[node]) * (static_cast<Sum>(held) - free_rise_[node]);
    free_rise_[node] = held;
  }
}

// Where a step fails, its sums are dropped with its temperatures.
void Temperatures::conduct(StepTimes step) {
  sums_ = sums_before_;
  held_at_ = 0.5 * (step.after + step.until);
  heat_.setZero();
  free_rise_ = rise_;
  publish();
  model_.add_conduction(temperature_, step.duration(), heat_);
  for (const HeatLoad* load : fluxes_) {
    const double heat = step.duration() * load->at(step.after);
    for (std::size_t k = 0; k < load->set().nodes.size(); ++k) {
      heat_[load->set().nodes[k]] += heat * load->set().areas[k];
      sums_.supplied += heat * load->set().areas[k];
    }
  }
  for (Eigen::Index node = 0; node < heat_.size(); ++node)
    if (heat_[node] != 0.0) free_rise_[node] += heat_[node] / model_.capacity()[node];
  hold(held_at_);
  publish();
}

void Temperatures::add_friction(const Interface& interface, std::int32_t contact) {
  const ContactHeat::Flow& flow = interface.heat()->flow(static_cast<std::size_t>(contact));
  sums_.friction += static_cast<Sum>(flow.body) + flow.counterpart;
  const ContactPoint& point = interface.point(contact);
  if (point.partners.empty()) sums_.obstacles += flow.counterpart;
  point.for_each_side(
      interface.node_of(contact), [&](int node, double weight) { heat_[node] += weight * flow.body; },
      [&](int node, double weight) { heat_[node] += weight * flow.counterpart; });
}

// Calls visit(interface, contact, conductance) for the contacts that conduct in this step.
template <class Visit>
void Temperatures::for_each_conducting(const Interfaces& interfaces, Visit visit) const {
  for (const auto& interface : interfaces) {
    if (!interface->heat()) continue;
    for (const std::int32_t contact : interface->active())
      if (const double conductance = interface->heat()->flow(static_cast<std::size_t>(contact)).per_kelvin;
          conductance > 0.0)
        visit(*interface, contact, conductance);
  }
}

// From the temperatures before the step on, while conduction, loads and friction heat the nodes evenly.
void Temperatures::exchange(const Interfaces& interfaces) {
  exchange_.clear();
  for_each_conducting(interfaces, [&](Interface& interface, std::int32_t contact, double conductance) {
    const ContactPoint& point = interface.point(contact);
    exchange_.add(conductance, point.partners.empty() ? interface.heat()->obstacle_temperature() : 0.0,
                  interface.node_of(contact), point);
  });
  if (exchange_.count() == 0) return;
  const Dofs before = model_.initial_temperature() + rise_;
  const Dofs change = free_rise_ - rise_ + heat_.cwiseProduct(softness_);
  const Dofs& conducted = exchange_.solve({before, change, softness_});
  exchange_.add_heat(heat_);
  Eigen::Index place = 0;
  for_each_conducting(interfaces, [&](Interface& interface, std::int32_t contact, double) {
    const double heat = conducted[place++];
    interface.add_conducted_heat(heat);
    if (interface.point(contact).partners.empty()) sums_.obstacles -= heat;
  });
}

bool Temperatures::take(const Interfaces& interfaces) {
  heat_.setZero();
  for (const auto& interface : interfaces)
    if (interface->heat())
      for (const std::int32_t contact : interface->active()) add_friction(*interface, contact);
  exchange(interfaces);
  for (Eigen::Index node = 0; node < heat_.size(); ++node)
    if (heat_[node] != 0.0) free_rise_[node] += heat_[node] / model_.capacity()[node];
  hold(held_at_);
  if (!free_rise_.allFinite()) return false;
  rise_ = free_rise_;
  publish();
  for (const Sum sum : {sums_.obstacles, sums_.friction, sums_.supplied})
    sums_.largest = std::max(sums_.largest, std::abs(static_cast<double>(sum)));
  sums_.largest = std::max(sums_.largest, model_.capacity().dot(rise_.cwiseAbs()));
  sums_before_ = sums_;
  return true;
}

Temperatures::Sum Temperatures::stored() const {
  Sum sum = 0;
  for (Eigen::Index node = 0; node < rise_.size(); ++node)
    sum += static_cast<Sum>(model_.capacity()[node]) * rise_[node];
  return sum;
}

HeatReport Temperatures::report() const {
  const Sums& sums = sums_before_;
  const Sum open = stored() + sums.obstacles - sums.friction - sums.supplied;
  HeatReport report{static_cast<double>(stored()),
                    static_cast<double>(sums.obstacles),
                    static_cast<double>(sums.friction),
                    static_cast<double>(sums.supplied),
                    sums.largest > 0.0 ? std::abs(static_cast<double>(open)) / sums.largest : 0.0,
                    std::numeric_limits<double>::infinity(),
                    -std::numeric_limits<double>::infinity()};
  for (int node = 0; node < static_cast<int>(rise_.size()); ++node) {
    if (!model_.has_temperature(node)) continue;
    report.lowest = std::min(report.lowest, at(node));
    report.highest = std::max(report.highest, at(node));
  }
  return report;
}

void Temperatures::save(std::ostream& out) const {
  write_array(out, rise_.data(), static_cast<std::size_t>(rise_.size()));
  for (const Sum sum : {sums_before_.obstacles, sums_before_.friction, sums_before_.supplied})
    write_value(out, sum);
  write_value(out, sums_before_.largest);
}

void Temperatures::load(std::istream& in) {
  read_array(in, rise_.data(), static_cast<std::size_t>(rise_.size()));
  for (Sum* const sum : {&sums_before_.obstacles, &sums_before_.friction, &sums_before_.supplied})
    read_value(in, *sum);
  read_value(in, sums_before_.largest);
  sums_ = sums_before_;
  free_rise_ = rise_;
  publish();
}

}  // namespace ilaw::host
