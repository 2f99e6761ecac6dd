// SPDX-License-Identifier: BSD-3-Clause
#include "model/thermal_model.hpp"

#include "model/mesh_body.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace ilaw::host {
namespace {

using Conductances = std::map<std::pair<int, int>, double>;

template <int N, int P>
void add_element(const SolidElement<N, P>& element, double conductivity, Conductances& found) {
  Eigen::Matrix<double, N, N> sum = Eigen::Matrix<double, N, N>::Zero();
  for (std::size_t g = 0; g < P; ++g)
    sum += conductivity * element.weights[g] * element.gradients[g].transpose() * element.gradients[g];
  for (std::size_t a = 0; a < N; ++a)
    for (std::size_t b = 0; b < a; ++b)
      found[std::minmax(element.nodes[a], element.nodes[b])] -=
          sum(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b));
}

template <std::size_t N, class Visit>
void for_each_cell(const std::vector<int>& cells, Visit visit) {
  std::array<int, N> nodes;
  for (std::size_t k = 0; k < cells.size(); k += N) {
    std::copy_n(cells.begin() + static_cast<std::ptrdiff_t>(k), N, nodes.begin());
    visit(nodes);
  }
}

// Between the nodes of a body.
Conductances conductances_of(const Model& model, const ThermalBody& body, const std::vector<bool>& is_own) {
  Conductances found;
  if (!(body.conductivity > 0.0)) return found;
  const auto own = [&](int node) { return is_own[static_cast<std::size_t>(node)]; };
  for_each_cell<8>(model.mesh().cells, [&](const std::array<int, 8>& nodes) {
    if (own(nodes[0])) add_element(hexahedron_of(nodes, model.position()), body.conductivity, found);
  });
  for_each_cell<4>(model.mesh().tetrahedra, [&](const std::array<int, 4>& nodes) {
    if (own(nodes[0])) add_element(tetrahedron_of(nodes, model.position()), body.conductivity, found);
  });
  return found;
}

}  // namespace

ThermalModel::ThermalModel(const Model& model, const std::vector<ThermalBody>& bodies)
    : capacity_(Dofs::Zero(model.node_count())), initial_temperature_(Dofs::Zero(model.node_count())) {
  for (const ThermalBody& body : bodies) add_body(model, body);
}

void ThermalModel::add_body(const Model& model, const ThermalBody& body) {
  std::vector<bool> is_own(static_cast<std::size_t>(model.node_count()));
  for (const int node : body.nodes) {
    is_own[static_cast<std::size_t>(node)] = true;
    capacity_[node] = model.mass()[Eigen::Index{node} * model.dimension()] * body.specific_heat;
    initial_temperature_[node] = body.initial_temperature;
  }
  Dofs diagonal = Dofs::Zero(model.node_count()), others = diagonal;
  for (const auto& [nodes, conductance] : conductances_of(model, body, is_own)) {
    links_.push_back({nodes.first, nodes.second, conductance});
    for (const int node : {nodes.first, nodes.second}) {
      diagonal[node] += conductance;
      others[node] += std::abs(conductance);
    }
  }
  for (const int node : body.nodes)
    if (const double step = 2.0 * capacity_[node] / (diagonal[node] + others[node]); step < stable_step_.step)
      stable_step_ = {step, body.name};
}

void ThermalModel::add_conduction(const Dofs& temperature, double time, Dofs& heat) const {
  for (const Link& link : links_) {
    const double flow = time * link.conductance * (temperature[link.other] - temperature[link.one]);
    heat[link.one] += flow;
    heat[link.other] -= flow;
  }
}

}  // namespace ilaw::host
