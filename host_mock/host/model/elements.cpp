// SPDX-License-Identifier: BSD-3-Clause
#include "model/elements.hpp"

#include "base/words.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace ilaw::host {
namespace {

// The neighbours of each corner of a hexahedron in VTK's order, right-handed.
constexpr std::array<std::array<std::size_t, 3>, 8> neighbours = {
    {{1, 3, 4}, {2, 0, 5}, {3, 1, 6}, {0, 2, 7}, {7, 5, 0}, {4, 6, 1}, {5, 7, 2}, {6, 4, 3}}};

constexpr std::array<std::array<std::size_t, 3>, 4> tetrahedron_neighbours = {
    {{1, 2, 3}, {2, 0, 3}, {0, 1, 3}, {0, 2, 1}}};

const std::array<std::size_t, 3>& neighbours_of(std::size_t corner, int count) {
  return count == 4 ? tetrahedron_neighbours[corner] : neighbours[corner];
}

// The nodes of an element.
class Cell {
 public:
  Cell(const Model& model, const int* nodes, int count) : model_(model), nodes_(nodes), count_(count) {}

  std::size_t corners() const { return static_cast<std::size_t>(count_); }

  Vector at(std::size_t corner, const Dofs& u) const { return model_.position(nodes_[corner], u); }
  bool is_inverted(const Dofs& u) const {
    if (model_.dimension() == 1) return !(at(1, u)[0] > at(0, u)[0]);
    for (std::size_t k = 0; k < corners(); ++k) {
      const auto& [i, j, l] = neighbours_of(k, count_);
      const Eigen::Vector3d x = at(k, u), a = at(i, u), b = at(j, u), c = at(l, u);
      if (!((a - x).cross(b - x).dot(c - x) > 0.0)) return true;
    }
    return false;
  }

 private:
  const Model& model_;
  const int* nodes_;
  int count_;
};

template <class Visit>
void for_each_cell(const Model& model, Visit visit) {
  const Mesh& mesh = model.mesh();
  std::size_t number = 0;
  const auto visit_all = [&](const std::vector<int>& cells, int count) {
    for (std::size_t first = 0; first < cells.size(); first += static_cast<std::size_t>(count))
      visit(Cell(model, &cells[first], count), number++);
  };
  if (mesh.nodes_per_cell > 0) visit_all(mesh.cells, mesh.nodes_per_cell);
  visit_all(mesh.tetrahedra, 4);
}

}  // namespace

CornerQuality worst_corner(const Eigen::Vector3d* corners, int count) {
  CornerQuality worst{std::numeric_limits<double>::infinity(), -1};
  for (int corner = 0; corner < count; ++corner) {
    const auto& [i, j, l] = neighbours_of(static_cast<std::size_t>(corner), count);
    const Eigen::Vector3d &x = corners[corner], a = (corners[i] - x).normalized(),
                          b = (corners[j] - x).normalized(), c = (corners[l] - x).normalized();
    const double quality = a.cross(b).dot(c) * (count == 4 ? std::sqrt(2.0) : 1.0);
    if (!(quality >= worst.scaled_jacobian)) worst = {quality, corner};
  }
  return worst;
}

double shortest_edge(const Model& model) {
  const Dofs undeformed = Dofs::Zero(model.position().size());
  double shortest = std::numeric_limits<double>::infinity();
  for_each_cell(model, [&](const Cell& cell, std::size_t /*number*/) {
    if (model.dimension() == 1) {
      shortest = std::min(shortest, (cell.at(1, undeformed) - cell.at(0, undeformed)).norm());
      return;
    }
    // The edges of a box are those at one corner; of other elements all count.
    for (std::size_t k = 0; k < cell.corners(); ++k)
      for (const std::size_t end : neighbours_of(k, static_cast<int>(cell.corners())))
        if (end > k)
          shortest = std::min(shortest, (cell.at(end, undeformed) - cell.at(k, undeformed)).norm());
  });
  return shortest;
}

std::vector<int> inverted_elements(const Model& model, const Dofs& u) {
  std::vector<int> found;
  for_each_cell(model, [&](const Cell& cell, std::size_t number) {
    if (cell.is_inverted(u)) found.push_back(static_cast<int>(number));
  });
  return found;
}

InvertedElement first_inverted(const Model& model, const Dofs& u) {
  const Dofs undeformed = Dofs::Zero(u.size());
  InvertedElement found;
  for_each_cell(model, [&](const Cell& cell, std::size_t number) {
    if (found.number >= 0 || !cell.is_inverted(u)) return;
    found = {static_cast<int>(number), Vector::Zero(model.dimension())};
    for (std::size_t k = 0; k < cell.corners(); ++k)
      found.centre += cell.at(k, undeformed) / static_cast<double>(cell.corners());
  });
  return found;
}

std::string advice_on_divergence(const Model& model, const Dofs& u, double dt) {
  std::string text;
  if (const InvertedElement inverted = first_inverted(model, u); inverted.number >= 0) {
    text = "; element " + std::to_string(inverted.number) + ", at (";
    for (Eigen::Index c = 0; c < inverted.centre.size(); ++c)
      text += (c > 0 ? ", " : "") + in_digits(inverted.centre[c], 4);
    text += ") of the undeformed body, is turned inside out";
  }
  const double critical = model.critical_step();
  if (!std::isfinite(critical)) return text + "; a smaller 'dt' may cure it";
  if (dt > 0.99 * critical)
    return text + "; the critical step is " + in_digits(critical, 4) + ", 0.9 of it \"cfl\": 0.9";
  return text + "; half the step is \"cfl\": " + in_digits(0.5 * dt / critical, 4);
}

}  // namespace ilaw::host
