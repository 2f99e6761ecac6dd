// SPDX-License-Identifier: BSD-3-Clause
#include "model/blocks.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace ilaw::host {
namespace {

// Below it threads cost more than they bring.
constexpr std::int64_t fewest_for_threads = 512;

// Corners of the unit cube in VTK's order.
constexpr std::array<std::array<int, 3>, 8> corner_of{
    {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};

// A structured grid of nodes, x fastest.
struct Grid {
  std::array<int, 3> elements;
  int first;

  int node(int x, int y, int z) const { return first + x + (elements[0] + 1) * (y + (elements[1] + 1) * z); }
  int node_count() const { return (elements[0] + 1) * (elements[1] + 1) * (elements[2] + 1); }
};

// A face: its axis, its side, and the two axes in it such that first x second points out of the
// block.
struct Face {
  const char* name;
  int axis, side, first, second;
};
constexpr std::array<Face, 6> faces{{{"x_min", 0, 0, 2, 1},
                                     {"x_max", 0, 1, 1, 2},
                                     {"y_min", 1, 0, 0, 2},
                                     {"y_max", 1, 1, 2, 0},
                                     {"z_min", 2, 0, 1, 0},
                                     {"z_max", 2, 1, 0, 1}}};

// Part of an element's extent that belongs to a node of a line of elements: half at the ends.
double share(int position, int elements) { return position == 0 || position == elements ? 0.5 : 1.0; }

NodeSet face_of(const Grid& grid, const Eigen::Vector3d& element_size, const Face& face) {
  NodeSet set;
  std::array<int, 3> at{};
  at[static_cast<std::size_t>(face.axis)] = face.side * grid.elements[static_cast<std::size_t>(face.axis)];
  const auto a = static_cast<std::size_t>(face.first), b = static_cast<std::size_t>(face.second);
  const auto node = [&](int i, int j) {
    at[a] = i;
    at[b] = j;
    return grid.node(at[0], at[1], at[2]);
  };
  const double facet_area = element_size[face.first] * element_size[face.second];
  for (int j = 0; j <= grid.elements[b]; ++j)
    for (int i = 0; i <= grid.elements[a]; ++i) {
      set.nodes.push_back(node(i, j));
      set.areas.push_back(facet_area * share(i, grid.elements[a]) * share(j, grid.elements[b]));
      if (i < grid.elements[a] && j < grid.elements[b])
        set.facets.push_back({node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)});
    }
  return set;
}

// Length of the area vectors of all faces together: what a node offers to whatever it touches where
// no face is named.
std::vector<double> boundary_areas(const std::string& block, const Grid& grid,
                                   const std::map<std::string, NodeSet>& sets) {
  std::vector<Eigen::Vector3d> vectors(static_cast<std::size_t>(grid.node_count()), Eigen::Vector3d::Zero());
  for (const Face& face : faces) {
    const NodeSet& set = sets.at(block + "." + face.name);
    for (std::size_t k = 0; k < set.nodes.size(); ++k)
      vectors[static_cast<std::size_t>(set.nodes[k] - grid.first)][face.axis] += set.areas[k];
  }
  std::vector<double> areas;
  areas.reserve(vectors.size());
  for (const Eigen::Vector3d& vector : vectors) areas.push_back(vector.norm());
  return areas;
}

void add_nodes(const BlockSetup& block, const Grid& grid, Nodes& nodes) {
  const Eigen::Vector3d element_size =
      block.size.array() / Eigen::Map<const Eigen::Array3i>(block.elements.data()).cast<double>();
  const double element_mass = block.material.density * element_size.prod();
  NodeSet& whole = nodes.sets[block.name];
  for (int z = 0; z <= grid.elements[2]; ++z)
    for (int y = 0; y <= grid.elements[1]; ++y)
      for (int x = 0; x <= grid.elements[0]; ++x) {
        const int node = grid.node(x, y, z);
        const double part =
            share(x, grid.elements[0]) * share(y, grid.elements[1]) * share(z, grid.elements[2]);
        nodes.mass.segment<3>(3 * node).setConstant(part * element_mass);
        nodes.position.segment<3>(3 * node) =
            block.corner + Eigen::Vector3d(x, y, z).cwiseProduct(element_size);
        nodes.velocity.segment<3>(3 * node) = block.velocity;
        whole.nodes.push_back(node);
      }
  for (const Face& face : faces) nodes.sets[block.name + "." + face.name] = face_of(grid, element_size, face);
  whole.areas = boundary_areas(block.name, grid, nodes.sets);
  NodeSet& all = nodes.sets["all"];
  all.nodes.insert(all.nodes.end(), whole.nodes.begin(), whole.nodes.end());
  all.areas.insert(all.areas.end(), whole.areas.begin(), whole.areas.end());
}

Nodes nodes_of(const std::vector<BlockSetup>& blocks) {
  Eigen::Index count = 0;
  for (const BlockSetup& block : blocks) count += Grid{block.elements, 0}.node_count();
  Nodes nodes{3, Dofs(3 * count), Dofs(3 * count), Dofs(3 * count), {}};
  int first = 0;
  for (const BlockSetup& block : blocks) {
    const Grid grid{block.elements, first};
    add_nodes(block, grid, nodes);
    first += grid.node_count();
  }
  return nodes;
}

using Gradients = Eigen::Matrix<double, 3, 8>;
using StrainMatrix = Eigen::Matrix<double, 6, 24>;

// Strain-displacement matrix of linear elasticity, engineering shear strains.
StrainMatrix strain_matrix(const Gradients& gradients) {
  StrainMatrix b = StrainMatrix::Zero();
  for (int a = 0; a < 8; ++a) {
    const double x = gradients(0, a), y = gradients(1, a), z = gradients(2, a);
    b.block<6, 3>(0, 3 * a) << x, 0, 0, 0, y, 0, 0, 0, z, y, x, 0, 0, z, y, z, 0, x;
  }
  return b;
}

// B at all integration points; with mean dilatation the dilatational part of each is the mean (B-bar,
// Hughes 1980).
std::array<StrainMatrix, 8> strain_matrices(const std::array<Gradients, 8>& gradients, Element element) {
  using Row = Eigen::Matrix<double, 1, 24>;
  std::array<StrainMatrix, 8> matrices;
  Row mean = Row::Zero();
  for (std::size_t g = 0; g < 8; ++g) {
    matrices[g] = strain_matrix(gradients[g]);
    mean += 0.125 * matrices[g].topRows<3>().colwise().sum();
  }
  if (element == Element::mean_dilatation)
    for (StrainMatrix& b : matrices) {
      const Row missing = (mean - b.topRows<3>().colwise().sum()) / 3.0;
      b.topRows<3>().rowwise() += missing;
    }
  return matrices;
}

Eigen::Matrix<double, 6, 6> elasticity(const Material& material) {
  Eigen::Matrix<double, 6, 6> c = Eigen::Matrix<double, 6, 6>::Zero();
  c.topLeftCorner<3, 3>().setConstant(material.lame());
  c.diagonal().head<3>().array() += 2.0 * material.shear_modulus();
  c.diagonal().tail<3>().setConstant(material.shear_modulus());
  return c;
}

// Gradients of the shape functions of a box at Gauss point (gx, gy, gz), each 0 or 1.
Gradients gradients_at(const Eigen::Vector3d& element_size, const std::array<int, 3>& gauss) {
  Gradients gradients;
  const auto shape = [&](int corner, int axis) {  // of one direction, at the Gauss point
    const auto k = static_cast<std::size_t>(axis);
    const double at = 0.5 + (gauss[k] == 0 ? -0.5 : 0.5) / std::sqrt(3.0);
    return corner_of[static_cast<std::size_t>(corner)][k] == 0 ? 1.0 - at : at;
  };
  for (int a = 0; a < 8; ++a)
    for (int axis = 0; axis < 3; ++axis) {
      const int sign = corner_of[static_cast<std::size_t>(a)][static_cast<std::size_t>(axis)] == 0 ? -1 : 1;
      gradients(axis, a) = sign / element_size[axis] * shape(a, (axis + 1) % 3) * shape(a, (axis + 2) % 3);
    }
  return gradients;
}

}  // namespace

int Blocks::Block::element_first(const std::array<int, 3>& at) const {
  return Grid{elements, first}.node(at[0], at[1], at[2]);
}

Blocks::ElementVector Blocks::Block::gather(const Dofs& u, int element_first) const {
  ElementVector local;
  const Eigen::Vector3d carried = u.segment<3>(3 * element_first);
  for (int a = 0; a < 8; ++a)
    local.segment<3>(3 * a) =
        u.segment<3>(3 * (element_first + corners[static_cast<std::size_t>(a)])) - carried;
  return local;
}

Blocks::Deformation Blocks::Block::deformation(const ElementVector& u) const {
  const Eigen::Map<const Eigen::Matrix<double, 3, 8>> displacement(u.data());
  Deformation found{};
  double volume = 0.0;
  for (std::size_t g = 0; g < 8; ++g) {
    found.gradients[g] = Eigen::Matrix3d::Identity() + displacement * gradients[g].transpose();
    found.volumes[g] = found.gradients[g].determinant();
    volume += 0.125 * found.volumes[g];
  }
  found.solid = {material.shear_modulus(), material.lame(), volume};
  for (std::size_t g = 0; g < 8; ++g) found.scales[g] = found.solid.scale(found.volumes[g]);
  return found;
}

Blocks::ElementVector Blocks::Block::mean_dilatation_force(const ElementVector& u) const {
  const Deformation at = deformation(u);
  double mean_distortion = 0.0;
  for (std::size_t g = 0; g < 8; ++g) mean_distortion += 0.125 * at.distortion(g);
  const double pressure = at.solid.pressure(mean_distortion);
  Eigen::Matrix<double, 3, 8> force = Eigen::Matrix<double, 3, 8>::Zero();
  for (std::size_t g = 0; g < 8; ++g)
    force += weight * at.solid.stress(pressure, at.gradients[g], at.volumes[g], at.scales[g]) * gradients[g];
  return Eigen::Map<const ElementVector>(force.data());
}

Blocks::ElementVector Blocks::Block::internal_force(const ElementVector& u) const {
  if (material.law == MaterialLaw::linear) return stiffness * u;
  if (element == Element::mean_dilatation) return mean_dilatation_force(u);
  const Eigen::Map<const Eigen::Matrix<double, 3, 8>> displacement(u.data());
  Eigen::Matrix<double, 3, 8> force = Eigen::Matrix<double, 3, 8>::Zero();
  for (const Gradients& gradient : gradients) {
    const Eigen::Matrix3d F = Eigen::Matrix3d::Identity() + displacement * gradient.transpose();
    force += weight * neo_hookean_stress(material.shear_modulus(), material.lame(), F) * gradient;
  }
  return Eigen::Map<const ElementVector>(force.data());
}

double Blocks::Block::energy(const ElementVector& u) const {
  if (material.law == MaterialLaw::linear) return 0.5 * u.dot(stiffness * u);
  double sum = 0.0;
  if (element == Element::mean_dilatation) {
    const Deformation at = deformation(u);
    for (std::size_t g = 0; g < 8; ++g) sum += weight * at.solid.energy(at.distortion(g));
    return sum;
  }
  const Eigen::Map<const Eigen::Matrix<double, 3, 8>> displacement(u.data());
  for (const Gradients& gradient : gradients)
    sum += weight * neo_hookean_energy(material.shear_modulus(), material.lame(),
                                       Eigen::Matrix3d::Identity() + displacement * gradient.transpose());
  return sum;
}

// Cauchy's stress is P F^T / J; its mean over the deformed element weighs a point by its J.
Eigen::Matrix3d Blocks::Block::mean_stress(const ElementVector& u) const {
  const Deformation at = deformation(u);
  const double mu = material.shear_modulus(), lambda = material.lame();
  if (material.law == MaterialLaw::linear) {
    Eigen::Matrix3d gradient = -Eigen::Matrix3d::Identity();
    for (const Eigen::Matrix3d& F : at.gradients) gradient += 0.125 * F;
    return lambda * gradient.trace() * Eigen::Matrix3d::Identity() + mu * (gradient + gradient.transpose());
  }
  double pressure = 0.0;
  if (element == Element::mean_dilatation) {
    double mean_distortion = 0.0;
    for (std::size_t g = 0; g < 8; ++g) mean_distortion += 0.125 * at.distortion(g);
    pressure = at.solid.pressure(mean_distortion);
  }
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (std::size_t g = 0; g < 8; ++g) {
    const Eigen::Matrix3d& F = at.gradients[g];
    const Eigen::Matrix3d P = element == Element::mean_dilatation
                                  ? at.solid.stress(pressure, F, at.volumes[g], at.scales[g])
                                  : neo_hookean_stress(mu, lambda, F);
    sum += 0.125 * P * F.transpose();
  }
  return sum / at.solid.volume;
}

template <class Visit>
void Blocks::Block::for_each_element(int layer, Visit visit) const {
  const auto axis = static_cast<std::size_t>(layer_axis);
  std::array<int, 3> from{0, 0, 0}, to = elements;
  from[axis] = layer;
  to[axis] = layer + 1;
  for (int z = from[2]; z < to[2]; ++z)
    for (int y = from[1]; y < to[1]; ++y)
      for (int x = from[0]; x < to[0]; ++x) visit(element_first({x, y, z}));
}

Blocks::Block Blocks::make_block(const BlockSetup& setup, int first) {
  Block block{};
  block.first = first;
  block.elements = setup.elements;
  block.layer_axis = static_cast<int>(std::max_element(setup.elements.begin(), setup.elements.end()) -
                                      setup.elements.begin());
  block.material = setup.material;
  const Eigen::Vector3d element_size(setup.size[0] / setup.elements[0], setup.size[1] / setup.elements[1],
                                     setup.size[2] / setup.elements[2]);
  block.weight = element_size.prod() / 8.0;
  block.element = setup.element;
  block.stiffness.setZero();
  for (std::size_t g = 0; g < 8; ++g) block.gradients[g] = gradients_at(element_size, corner_of[g]);
  for (const StrainMatrix& b : strain_matrices(block.gradients, setup.element))
    block.stiffness += block.weight * b.transpose() * elasticity(setup.material) * b;
  block.stiffness = 0.5 * (block.stiffness + block.stiffness.transpose()).eval();  // to the last bit
  const Grid grid{setup.elements, 0};
  for (std::size_t a = 0; a < 8; ++a)
    block.corners[a] = grid.node(corner_of[a][0], corner_of[a][1], corner_of[a][2]);
  return block;
}

double Blocks::critical_step_of(const Block& block) {
  const Eigen::SelfAdjointEigenSolver<ElementMatrix> modes(block.stiffness, Eigen::EigenvaluesOnly);
  const double corner_mass = block.weight * block.material.density;  // an eighth of the element's
  return 2.0 / std::sqrt(modes.eigenvalues().maxCoeff() / corner_mass);
}

Blocks::Blocks(const std::vector<BlockSetup>& blocks)
    : Model(nodes_of(blocks)), critical_step_(std::numeric_limits<double>::infinity()) {
  mesh_.nodes_per_cell = 8;
  int first = 0;
  for (const BlockSetup& setup : blocks) {
    blocks_.push_back(make_block(setup, first));
    critical_step_ = std::min(critical_step_, critical_step_of(blocks_.back()));
    add_cells(blocks_.back());
    first += Grid{setup.elements, 0}.node_count();
  }
}

void Blocks::add_cells(const Block& block) {
  for (int layer = 0; layer < block.elements[static_cast<std::size_t>(block.layer_axis)]; ++layer)
    block.for_each_element(layer, [&](int element) {
      for (int corner : block.corners) mesh_.cells.push_back(element + corner);
    });
}

bool Blocks::is_linear() const {
  return std::all_of(blocks_.begin(), blocks_.end(),
                     [](const Block& block) { return block.material.law == MaterialLaw::linear; });
}

void Blocks::add_internal_forces(const Dofs& u, Dofs& force) const {
  for (const Block& block : blocks_) {
    const int layers = block.elements[static_cast<std::size_t>(block.layer_axis)];
    [[maybe_unused]] const bool many = block.element_count() >= fewest_for_threads;
    for (int parity = 0; parity < 2; ++parity) {
#pragma omp parallel for schedule(static) if (many)
      for (int layer = parity; layer < layers; layer += 2)
        block.for_each_element(layer, [&](int element) {
          const ElementVector local = block.internal_force(block.gather(u, element));
          for (int a = 0; a < 8; ++a)
            force.segment<3>(3 * (element + block.corners[static_cast<std::size_t>(a)])) -=
                local.segment<3>(3 * a);
        });
    }
  }
}

// In the order of the mesh's cells.
std::vector<Eigen::Matrix3d> Blocks::stresses(const Dofs& u) const {
  std::vector<Eigen::Matrix3d> stresses;
  for (const Block& block : blocks_)
    for (int layer = 0; layer < block.elements[static_cast<std::size_t>(block.layer_axis)]; ++layer)
      block.for_each_element(
          layer, [&](int element) { stresses.push_back(block.mean_stress(block.gather(u, element))); });
  return stresses;
}

double Blocks::potential(const Dofs& u) const {
  double energy = 0.0;
  for (const Block& block : blocks_)
    for (int layer = 0; layer < block.elements[static_cast<std::size_t>(block.layer_axis)]; ++layer)
      block.for_each_element(layer, [&](int element) { energy += block.energy(block.gather(u, element)); });
  return energy;
}

}  // namespace ilaw::host
