// SPDX-License-Identifier: BSD-3-Clause
#include "results/forces.hpp"

#include "base/bytes.hpp"

#include <array>
#include <string>
#include <utility>

namespace ilaw::host {

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
  if (sums_.empty()) return;
  for (std::size_t k = 0; k < sums_.size(); ++k)
    add(scene_.output.forces[k], sums_[k], integrator, scene_.dt);
  ++steps_;
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
  std::array<double, 3> arm{}, p{};
  for (std::size_t c = 0; c < static_cast<std::size_t>(d); ++c) {
    const Eigen::Index dof = node * d + static_cast<Eigen::Index>(c);
    arm[c] = scene_.model->position()[dof] + displacement[dof] - (*force.about)[static_cast<Eigen::Index>(c)];
    p[c] = impulse[c];
  }
  const auto about = [&](std::size_t c) {
    return arm[(c + 1) % 3] * p[(c + 2) % 3] - arm[(c + 2) % 3] * p[(c + 1) % 3];
  };
  for (Eigen::Index c = 0; c < sum.moment.size(); ++c)
    sum.moment[c] += about(d == 2 ? 2 : static_cast<std::size_t>(c));
}

void Forces::add_names(std::vector<std::string>& names) const {
  for (std::size_t k = 0; k < sums_.size(); ++k) {
    const std::string& name = scene_.output.forces[k].name;
    for (Eigen::Index c = 0; c < sums_[k].impulse.size(); ++c)
      names.push_back(name + ".F" + std::to_string(c));
    for (Eigen::Index c = 0; c < sums_[k].moment.size(); ++c)
      names.push_back(name + ".M" + std::to_string(c));
  }
}

void Forces::write_row(CsvWriter& table, double time) {
  const double duration = static_cast<double>(steps_) * scene_.dt;
  for (Resultant& sum : sums_) {
    for (const double impulse : sum.impulse) table << impulse / duration;
    for (const double moment : sum.moment) table << moment / duration;
    if (const double force = sum.impulse.norm() / duration; force > sum.largest) {
      sum.largest = force;
      sum.largest_at = time;
    }
    sum.total += sum.impulse;
    sum.impulse.setZero();
    sum.moment.setZero();
  }
  steps_ = 0;
}

nlohmann::json Forces::summary() const {
  nlohmann::json all = nlohmann::json::object();
  for (std::size_t k = 0; k < sums_.size(); ++k) {
    const Dofs impulse = sums_[k].total + sums_[k].impulse;
    all[scene_.output.forces[k].name] = {{"impulse", std::vector<double>(impulse.begin(), impulse.end())},
                                         {"largest", sums_[k].largest},
                                         {"largest_at", sums_[k].largest_at}};
  }
  return all;
}

void Forces::save(std::ostream& out) const {
  write_value(out, steps_);
  for (const Resultant& sum : sums_) {
    for (const Dofs* part : {&sum.impulse, &sum.moment, &sum.total})
      write_array(out, part->data(), static_cast<std::size_t>(part->size()));
    write_value(out, sum.largest);
    write_value(out, sum.largest_at);
  }
}

void Forces::load(std::istream& in) {
  read_value(in, steps_);
  for (Resultant& sum : sums_) {
    for (Dofs* part : {&sum.impulse, &sum.moment, &sum.total})
      read_array(in, part->data(), static_cast<std::size_t>(part->size()));
    read_value(in, sum.largest);
    read_value(in, sum.largest_at);
  }
}

}  // namespace ilaw::host
