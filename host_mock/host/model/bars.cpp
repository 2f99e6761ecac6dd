// SPDX-License-Identifier: BSD-3-Clause
#include "model/bars.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace ilaw::host {
namespace {

void add_bar(const BarSetup& bar, Nodes& nodes, Eigen::Index first) {
  const double element_length = bar.length / bar.elements;
  const double element_mass = bar.density * bar.section * element_length;
  nodes.mass.segment(first, bar.elements + 1).setConstant(element_mass);
  nodes.mass[first] = nodes.mass[first + bar.elements] = 0.5 * element_mass;
  nodes.velocity.segment(first, bar.elements + 1).setConstant(bar.velocity);
  for (int k = 0; k <= bar.elements; ++k)
    nodes.position[first + k] = bar.start + bar.length * k / bar.elements;
  const int left = static_cast<int>(first), right = left + bar.elements;
  NodeSet& whole = nodes.sets[bar.name];
  whole.nodes.resize(static_cast<std::size_t>(bar.elements) + 1);
  std::iota(whole.nodes.begin(), whole.nodes.end(), left);
  whole.areas.assign(whole.nodes.size(), bar.section);
  nodes.sets[bar.name + ".left"] = {{left}, {bar.section}, {}};
  nodes.sets[bar.name + ".right"] = {{right}, {bar.section}, {}};
  NodeSet& all = nodes.sets["all"];
  all.nodes.insert(all.nodes.end(), whole.nodes.begin(), whole.nodes.end());
  all.areas.insert(all.areas.end(), whole.areas.begin(), whole.areas.end());
}

Nodes nodes_of(const std::vector<BarSetup>& bars) {
  Eigen::Index count = 0;
  for (const BarSetup& bar : bars) count += bar.elements + 1;
  Nodes nodes{1, Dofs(count), Dofs(count), Dofs(count), {}};
  Eigen::Index first = 0;
  for (const BarSetup& bar : bars) {
    add_bar(bar, nodes, first);
    first += bar.elements + 1;
  }
  return nodes;
}

}  // namespace

Bars::Bars(const std::vector<BarSetup>& bars)
    : Model(nodes_of(bars)), critical_step_(std::numeric_limits<double>::infinity()) {
  mesh_.nodes_per_cell = 2;
  int first = 0;
  for (const BarSetup& bar : bars) {
    const double element_length = bar.length / bar.elements;
    runs_.push_back({first, bar.elements, bar.young * bar.section / element_length, bar.section,
                     element_length, bar.density});
    critical_step_ = std::min(critical_step_, element_length * std::sqrt(bar.density / bar.young));
    for (int k = 0; k < bar.elements; ++k) {
      mesh_.cells.push_back(first + k);
      mesh_.cells.push_back(first + k + 1);
    }
    first += bar.elements + 1;
  }
}

void Bars::add_internal_forces(const Dofs& u, Dofs& force) const {
  for (const Run& run : runs_)
    for (int k = run.first; k < run.first + run.elements; ++k) {
      const double tension = run.stiffness * (u[k + 1] - u[k]);
      force[k] += tension;
      force[k + 1] -= tension;
    }
}

double Bars::potential(const Dofs& u) const {
  double energy = 0.0;
  for (const Run& run : runs_)
    for (int k = run.first; k < run.first + run.elements; ++k)
      energy += 0.5 * run.stiffness * (u[k + 1] - u[k]) * (u[k + 1] - u[k]);
  return energy;
}

std::vector<Eigen::Matrix3d> Bars::stresses(const Dofs& u) const {
  std::vector<Eigen::Matrix3d> stresses;
  for (const Run& run : runs_)
    for (int k = run.first; k < run.first + run.elements; ++k) {
      Eigen::Matrix3d& stress = stresses.emplace_back(Eigen::Matrix3d::Zero());
      stress(0, 0) = run.stiffness * (u[k + 1] - u[k]) / run.section;
    }
  return stresses;
}

// Half of the mass is at each end.
std::vector<VolumeElement> Bars::volume_elements() const {
  std::vector<VolumeElement> elements;
  for (const Run& run : runs_)
    for (int k = run.first; k < run.first + run.elements; ++k) {
      const double length = run.element_length, mass = run.density * run.section * length;
      Eigen::Matrix3Xd gradients = Eigen::Matrix3Xd::Zero(3, 2);
      gradients.row(0) << -1.0 / length, 1.0 / length;
      elements.push_back({{k, k + 1},
                          gradients,
                          mass,
                          length,
                          length * std::sqrt(run.stiffness / mass),
                          4.0 / (length * length)});
    }
  return elements;
}

}  // namespace ilaw::host
