// SPDX-License-Identifier: BSD-3-Clause
#include "results/forces.hpp"

#include "base/bytes.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <utility>

namespace ilaw::host {
namespace {

using nlohmann::json;

std::vector<double> list_of(const Dofs& values) { return {values.begin(), values.end()}; }

void read(const json& list, Dofs& values) {
  const auto found = list.get<std::vector<double>>();
  if (found.size() != static_cast<std::size_t>(values.size())) refuse_damaged();
  std::copy(found.begin(), found.end(), values.begin());
}

}  // namespace

Forces::Forces(const Scene& scene, Integrator& integrator) : scene_(scene) {
  const int d = scene.model->dimension();
  for (const ForceSetup& force : scene.output.forces) {
    for (const std::size_t load : force.loads) integrator.keep_load_impulse(load);
    const Eigen::Index moments = !force.about ? 0 : d == 2 ? 1 : 3;
    sums_.push_back({Dofs::Zero(d), Dofs::Zero(moments), Dofs::Zero(d)});
    if (!force.loads.empty()) of_load_ = Dofs::Zero(scene.model->mass().size());
  }
}

void Forces::add_start(const Integrator& integrator) {
  const double duration = 0.5 * scene_.dt;
  for (std::size_t k = 0; k < sums_.size(); ++k) {
    Resultant& sum = sums_[k];
    add(scene_.output.forces[k], sum, integrator, duration);
    sum.largest = sum.impulse.norm() / duration;
    sum.total += sum.impulse;
    sum.impulse.setZero();
    sum.moment.setZero();
  }
}

void Forces::add_step(const Integrator& integrator) {
  for (std::size_t k = 0; k < sums_.size(); ++k) {
    add(scene_.output.forces[k], sums_[k], integrator, scene_.dt);
    ++sums_[k].steps;
  }
}

void Forces::add(const ForceSetup& force, Resultant& sum, const Integrator& integrator, double duration) {
  const Dofs& u = integrator.displacement();
  if (force.interface >= 0) {
    for (const auto& [number, sign] : {std::pair{force.interface, 1.0}, std::pair{force.other_side, -1.0}}) {
      if (number < 0) continue;
      const Interface& interface = *scene_.interfaces[static_cast<std::size_t>(number)];
      for (const std::int32_t contact : interface.active())
        add_at(interface.node_of(contact), Vector(sign * interface.impulse(contact)).data(), force, sum, u);
    }
    return;
  }
  if (!force.springs.empty()) {
    for (const Spring& spring : force.springs) {
      const Vector impulse = duration * pull_of(*scene_.model, spring, {u, integrator.velocity_before()});
      add_at(spring.node, impulse.data(), force, sum, u);
    }
    return;
  }
  of_load_.setZero();
  for (const std::size_t load : force.loads) integrator.add_load_impulse(load, of_load_);
  const Eigen::Index d = scene_.model->dimension();
  const std::vector<int>& nodes = force.nodes.empty() ? scene_.model->sets().at("all").nodes : force.nodes;
  for (const int node : nodes) add_at(node, &of_load_[node * d], force, sum, u);
}

// The moment is that of the impulse where the node is now.
void Forces::add_at(int node, const double* impulse, const ForceSetup& force, Resultant& sum,
                    const Dofs& displacement) const {
  const Eigen::Index d = scene_.model->dimension();
  for (Eigen::Index c = 0; c < d; ++c) sum.impulse[c] += impulse[c];
  if (!force.about) return;
  Eigen::Vector3d arm = Eigen::Vector3d::Zero(), p = arm;
  for (Eigen::Index c = 0; c < d; ++c) {
    arm[c] = scene_.model->position()[node * d + c] + displacement[node * d + c] - (*force.about)[c];
    p[c] = impulse[c];
  }
  sum.moment += arm.cross(p).tail(sum.moment.size());
}

std::vector<std::string> Forces::names() const {
  std::vector<std::string> names;
  for (std::size_t k = 0; k < sums_.size(); ++k) {
    const std::string& name = scene_.output.forces[k].name;
    for (Eigen::Index c = 0; c < sums_[k].impulse.size(); ++c)
      names.push_back(name + ".F" + std::to_string(c));
    for (Eigen::Index c = 0; c < sums_[k].moment.size(); ++c)
      names.push_back(name + ".M" + std::to_string(c));
  }
  return names;
}

void Forces::close_row(double time) {
  means_.clear();
  for (Resultant& sum : sums_) {
    const double duration = static_cast<double>(sum.steps) * scene_.dt;
    for (const Dofs* whole : {&sum.impulse, &sum.moment})
      for (const double part : *whole) means_.push_back(part / duration);
    if (const double force = sum.impulse.norm() / duration; force > sum.largest) {
      sum.largest = force;
      sum.largest_at = time;
    }
    sum.total += sum.impulse;
    sum.impulse.setZero();
    sum.moment.setZero();
    sum.steps = 0;
  }
}

json Forces::about(std::size_t k) const {
  const std::optional<Vector>& point = scene_.output.forces[k].about;
  return point ? json(list_of(*point)) : json();
}

json Forces::points() const {
  json all = json::array();
  for (std::size_t k = 0; k < sums_.size(); ++k) all.push_back(about(k));
  return all;
}

json Forces::summary() const {
  json all = json::object();
  for (std::size_t k = 0; k < sums_.size(); ++k) {
    all[scene_.output.forces[k].name] = {{"impulse", list_of(sums_[k].total + sums_[k].impulse)},
                                         {"largest", sums_[k].largest},
                                         {"largest_at", sums_[k].largest_at}};
  }
  return all;
}

json Forces::state() const {
  json all = json::object();
  for (std::size_t k = 0; k < sums_.size(); ++k) {
    const Resultant& sum = sums_[k];
    all[scene_.output.forces[k].name] = {
        {"about", about(k)},           {"impulse", list_of(sum.impulse)}, {"moment", list_of(sum.moment)},
        {"total", list_of(sum.total)}, {"largest", sum.largest},          {"largest_at", sum.largest_at},
        {"steps", sum.steps}};
  }
  return all;
}

// With a moment about another point the row that was begun is left to the rows before it.
std::vector<std::string> Forces::load(const json& state) {
  std::vector<std::string> unknown;
  for (std::size_t k = 0; k < sums_.size(); ++k) {
    const std::string& name = scene_.output.forces[k].name;
    if (!state.contains(name)) {
      unknown.push_back(name);
      continue;
    }
    Resultant& sum = sums_[k];
    const json& found = state.at(name);
    read(found.at("total"), sum.total);
    found.at("largest").get_to(sum.largest);
    found.at("largest_at").get_to(sum.largest_at);
    read(found.at("impulse"), sum.impulse);
    if (found.at("about") == about(k)) {
      read(found.at("moment"), sum.moment);
      found.at("steps").get_to(sum.steps);
    } else {
      sum.total += sum.impulse;
      sum.impulse.setZero();
    }
  }
  return unknown;
}

}  // namespace ilaw::host
