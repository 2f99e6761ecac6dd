// SPDX-License-Identifier: BSD-3-Clause
#include "model/mesh_body.hpp"

#include "base/parallel.hpp"
#include "model/solid_element.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <string>

namespace ilaw::host {
namespace {

// Elements that are worth a thread; in a box below fewest_in_box threads cost more than they bring.
constexpr std::ptrdiff_t element_chunk = chunk_of(128);
constexpr std::size_t fewest_in_box = 512;

// Corners of the reference cube, in VTK's order.
constexpr std::array<std::array<int, 3>, 8> reference_corners{
    {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}}};

Eigen::Vector3d reference_corner(std::size_t k) {
  return Eigen::Map<const Eigen::Vector3i>(reference_corners[k].data()).cast<double>();
}

// Values and derivatives, by the reference coordinates, of the trilinear shape functions.
Eigen::Matrix<double, 1, 8> shapes_at(const Eigen::Vector3d& at) {
  Eigen::Matrix<double, 1, 8> shapes;
  for (std::size_t a = 0; a < 8; ++a)
    shapes[static_cast<Eigen::Index>(a)] = 0.125 * (1.0 + reference_corner(a).array() * at.array()).prod();
  return shapes;
}
Eigen::Matrix<double, 3, 8> derivatives_at(const Eigen::Vector3d& at) {
  Eigen::Matrix<double, 3, 8> derivatives;
  for (std::size_t a = 0; a < 8; ++a) {
    const Eigen::Vector3d s = reference_corner(a), along = 1.0 + s.array() * at.array();
    derivatives.col(static_cast<Eigen::Index>(a)) =
        0.125 *
        Eigen::Vector3d(s[0] * along[1] * along[2], along[0] * s[1] * along[2], along[0] * along[1] * s[2]);
  }
  return derivatives;
}

// The Gauss points: at the corners of a cube within.
Eigen::Vector3d gauss_point(std::size_t g) { return reference_corner(g) / std::sqrt(3.0); }

template <int N>
Eigen::Matrix<double, 3, N> corner_positions(const std::array<int, N>& nodes, const Dofs& position) {
  Eigen::Matrix<double, 3, N> x;
  for (std::size_t a = 0; a < N; ++a)
    x.col(static_cast<Eigen::Index>(a)) = position.segment<3>(3 * Eigen::Index{nodes[a]});
  return x;
}

// An isoparametric element: dN/dx = J^-T dN/dxi with J = dx/dxi.
template <int N, int P>
void add_point(SolidElement<N, P>& element, std::size_t g, const Eigen::Matrix<double, 3, N>& x,
               const Eigen::Matrix<double, 3, N>& derivatives, double reference_volume) {
  const Eigen::Matrix3d jacobian = x * derivatives.transpose();
  const double determinant = jacobian.determinant();
  if (!(determinant > 0.0))
    throw MeshError("an element with the node " + std::to_string(element.nodes[0]) + ": found the Jacobian " +
                    std::to_string(determinant) +
                    " inside it, expected a positive one: the element is inverted");
  element.gradients[g] = jacobian.inverse().transpose() * derivatives;
  element.weights[g] = determinant * reference_volume;
  element.volume += element.weights[g];
}

// The sums of the rows of the consistent mass.
Eigen::Matrix<double, 1, 8> lumped_volumes(const Hexahedron& element) {
  Eigen::Matrix<double, 1, 8> volumes = Eigen::Matrix<double, 1, 8>::Zero();
  for (std::size_t g = 0; g < 8; ++g) volumes += element.weights[g] * shapes_at(gauss_point(g));
  return volumes;
}
Eigen::Matrix<double, 1, 4> lumped_volumes(const Tetrahedron& element) {
  return Eigen::Matrix<double, 1, 4>::Constant(0.25 * element.volume);
}

template <class Nodes, int N, int P>
VolumeElement volume_element_of(const SolidElement<N, P>& element, const Nodes& nodes,
                                const Material& material) {
  Eigen::Matrix<double, 3, N> mean = Eigen::Matrix<double, 3, N>::Zero();
  for (std::size_t g = 0; g < P; ++g) mean += element.weights[g] / element.volume * element.gradients[g];
  const double response =
      element.volume * (mean.colwise().squaredNorm().array() / lumped_volumes(element).array()).sum();
  return {{nodes.begin(), nodes.end()},
          mean,
          material.density * element.volume,
          std::cbrt(element.volume),
          std::sqrt((material.lame() + 2.0 * material.shear_modulus()) / material.density),
          response};
}

// Of a symmetric matrix.
double largest_eigenvalue(const Eigen::MatrixXd& matrix) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly)
      .eigenvalues()
      .maxCoeff();
}

// That of M^-1 K of an element, K column by column from the forces of unit displacements.
template <int N, int P>
double largest_eigenvalue(const SolidElement<N, P>& element, const Material& material, Element kind) {
  const Material linear{MaterialLaw::linear, material.young, material.poisson, material.density};
  Eigen::MatrixXd stiffness(3 * N, 3 * N);
  for (Eigen::Index k = 0; k < 3 * N; ++k) {
    Eigen::Matrix<double, 3, N> u = Eigen::Matrix<double, 3, N>::Zero();
    u(k % 3, k / 3) = 1.0;
    const Eigen::Matrix<double, 3, N> force = DeformedElement<N, P>(element, u, linear, kind).force();
    stiffness.col(k) = Eigen::Map<const Eigen::Matrix<double, 3 * N, 1>>(force.data());
  }
  Eigen::VectorXd scale(3 * N);
  const Eigen::Matrix<double, 1, N> volumes = lumped_volumes(element);
  for (Eigen::Index k = 0; k < 3 * N; ++k) scale[k] = 1.0 / std::sqrt(material.density * volumes[k / 3]);
  const Eigen::MatrixXd scaled = scale.asDiagonal() * stiffness * scale.asDiagonal();
  return largest_eigenvalue(0.5 * (scaled + scaled.transpose()));
}

template <int N, int P>
double largest_eigenvalue(const std::vector<SolidElement<N, P>>& elements, const Material& material,
                          Element kind) {
  std::vector<double> values(elements.size());
  for_each_chunk(static_cast<std::ptrdiff_t>(elements.size()), element_chunk,
                 [&](std::ptrdiff_t, std::ptrdiff_t begin, std::ptrdiff_t end) {
                   for (auto k = static_cast<std::size_t>(begin); k < static_cast<std::size_t>(end); ++k)
                     values[k] = largest_eigenvalue(elements[k], material, kind);
                 });
  return values.empty() ? 0.0 : *std::max_element(values.begin(), values.end());
}

// ---- boxes ----------------------------------------------------------------------------------------------

using StrainMatrix = Eigen::Matrix<double, 6, 24>;

// Strain-displacement matrix of linear elasticity, engineering shear strains.
StrainMatrix strain_matrix(const Eigen::Matrix<double, 3, 8>& gradients) {
  StrainMatrix b = StrainMatrix::Zero();
  for (int a = 0; a < 8; ++a) {
    const double x = gradients(0, a), y = gradients(1, a), z = gradients(2, a);
    b.block<6, 3>(0, 3 * a) << x, 0, 0, 0, y, 0, 0, 0, z, y, x, 0, 0, z, y, z, 0, x;
  }
  return b;
}

// B at all integration points; with mean dilatation the dilatational part of each is the mean (B-bar,
// Hughes 1980).
std::array<StrainMatrix, 8> strain_matrices(const Hexahedron& box, Element element) {
  using Row = Eigen::Matrix<double, 1, 24>;
  std::array<StrainMatrix, 8> matrices;
  Row mean = Row::Zero();
  for (std::size_t g = 0; g < 8; ++g) {
    matrices[g] = strain_matrix(box.gradients[g]);
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

Eigen::Matrix<double, 24, 24> stiffness_of_box(const Hexahedron& box, const Material& material,
                                               Element element) {
  Eigen::Matrix<double, 24, 24> stiffness = Eigen::Matrix<double, 24, 24>::Zero();
  for (const StrainMatrix& b : strain_matrices(box, element)) {
    const Eigen::Matrix<double, 24, 6> stresses = box.weights[0] * b.transpose() * elasticity(material);
    // By coefficients: on aarch64 Eigen's product of large matrices multiplies and adds with one rounding.
    stiffness += stresses.lazyProduct(b);
  }
  return 0.5 * (stiffness + stiffness.transpose());  // to the last bit
}

// The gradients of a product of linear functions.
Hexahedron box_element(const Eigen::Vector3d& size) {
  Hexahedron box{{}, {}, {}, size.prod()};
  box.weights.fill(size.prod() / 8.0);
  for (std::size_t g = 0; g < 8; ++g) {
    const auto shape = [&](std::size_t corner, std::size_t axis) {  // of one direction, at the Gauss point
      const double at = 0.5 + 0.5 * reference_corners[g][axis] / std::sqrt(3.0);
      return reference_corners[corner][axis] < 0 ? 1.0 - at : at;
    };
    for (std::size_t a = 0; a < 8; ++a)
      for (std::size_t axis = 0; axis < 3; ++axis)
        box.gradients[g](static_cast<Eigen::Index>(axis), static_cast<Eigen::Index>(a)) =
            reference_corners[a][axis] / size[static_cast<Eigen::Index>(axis)] * shape(a, (axis + 1) % 3) *
            shape(a, (axis + 2) % 3);
  }
  return box;
}

template <int N>
std::array<int, N> shifted(std::array<int, N> nodes, int by) {
  for (int& node : nodes) node += by;
  return nodes;
}

}  // namespace

Hexahedron hexahedron_of(const std::array<int, 8>& nodes, const Dofs& position) {
  Hexahedron element{nodes, {}, {}, 0.0};
  for (std::size_t g = 0; g < 8; ++g)
    add_point(element, g, corner_positions<8>(nodes, position), derivatives_at(gauss_point(g)), 1.0);
  return element;
}

Tetrahedron tetrahedron_of(const std::array<int, 4>& nodes, const Dofs& position) {
  Tetrahedron element{nodes, {}, {}, 0.0};
  Eigen::Matrix<double, 3, 4> derivatives;
  derivatives << -1.0, 1.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 1.0;
  add_point(element, 0, corner_positions<4>(nodes, position), derivatives, 1.0 / 6.0);
  return element;
}

MeshBody::MeshBody(const MeshTopology& topology, const Dofs& position, int first, const Material& material,
                   Element element)
    : first_(first),
      material_(material),
      element_(element),
      layer_(topology.layer),
      node_count_(static_cast<int>(topology.sets.at("").nodes.size())) {
  for (const auto& nodes : topology.hexahedra) hexahedra_.push_back(shifted<8>(nodes, first));
  if (is_box()) {
    shapes_.push_back(box_element(topology.element_size));
    stiffness_ = stiffness_of_box(shapes_[0], material, element);
    return;
  }
  for (const auto& nodes : hexahedra_) shapes_.push_back(hexahedron_of(nodes, position));
  for (const auto& nodes : topology.tetrahedra)
    tetrahedra_.push_back(tetrahedron_of(shifted<4>(nodes, first), position));
  index_corners();
  corner_forces_.resize(3, static_cast<Eigen::Index>(corners_.size()));
  if (!averages_at_nodes()) return;
  nodal_.resize(first_corner_.size() - 1);
  tetrahedron_gradients_.resize(tetrahedra_.size());
}

void MeshBody::index_corners() {
  std::vector<std::vector<std::size_t>> of_node(static_cast<std::size_t>(node_count_));
  std::size_t corner = 0;
  for (const std::array<int, 8>& nodes : hexahedra_)
    for (const int node : nodes) of_node[static_cast<std::size_t>(node - first_)].push_back(corner++);
  for (const Tetrahedron& element : tetrahedra_)
    for (const int node : element.nodes) of_node[static_cast<std::size_t>(node - first_)].push_back(corner++);
  for (const std::vector<std::size_t>& corners : of_node) {
    first_corner_.push_back(corners_.size());
    corners_.insert(corners_.end(), corners.begin(), corners.end());
  }
  first_corner_.push_back(corners_.size());
}

void MeshBody::add_mass(Dofs& mass) const {
  if (is_box()) {  // whole numbers of eighths: to the last bit
    for (const std::array<int, 8>& nodes : hexahedra_)
      for (const int node : nodes) mass.segment<3>(3 * Eigen::Index{node}).array() += 0.125;
    mass.segment(3 * Eigen::Index{first_}, 3 * node_count_) *= material_.density * shapes_[0].volume;
    return;
  }
  const auto add = [&](const auto& nodes, const auto& volumes) {
    for (std::size_t a = 0; a < nodes.size(); ++a)
      mass.segment<3>(3 * Eigen::Index{nodes[a]}).array() +=
          material_.density * volumes[static_cast<Eigen::Index>(a)];
  };
  for (std::size_t k = 0; k < hexahedra_.size(); ++k) add(hexahedra_[k], lumped_volumes(shapes_[k]));
  for (const Tetrahedron& element : tetrahedra_) add(element.nodes, lumped_volumes(element));
}

void MeshBody::add_volume_elements(std::vector<VolumeElement>& all) const {
  for (std::size_t k = 0; k < hexahedra_.size(); ++k)
    all.push_back(volume_element_of(shape(k), hexahedra_[k], material_));
  for (const Tetrahedron& element : tetrahedra_)
    all.push_back(volume_element_of(element, element.nodes, material_));
}

double MeshBody::critical_step() const {
  if (is_box()) {
    const double corner_mass = shapes_[0].weights[0] * material_.density;
    return 2.0 / std::sqrt(largest_eigenvalue(stiffness_) / corner_mass);
  }
  return 2.0 / std::sqrt(std::max(largest_eigenvalue(shapes_, material_, element_),
                                  largest_eigenvalue(tetrahedra_, material_, Element::full)));
}

// ---- tetrahedra with the dilatations of their nodes -----------------------------------------------------

// Calls visit for the tetrahedra at a node.
template <class Visit>
void MeshBody::for_each_corner(int node, Visit visit) const {
  const std::size_t first_column = 8 * hexahedra_.size();
  const auto k = static_cast<std::size_t>(node);
  for (std::size_t i = first_corner_[k]; i < first_corner_[k + 1]; ++i)
    if (corners_[i] >= first_column) visit((corners_[i] - first_column) / 4);
}

double MeshBody::mean_distortion(int node) const {
  const MeanDilatation solid{material_.shear_modulus(), material_.lame(),
                             nodal_[static_cast<std::size_t>(node)].dilatation};
  double sum = 0.0, volume = 0.0;
  for_each_corner(node, [&](std::size_t e) {
    const Eigen::Matrix3d& F = tetrahedron_gradients_[e];
    sum += tetrahedra_[e].volume * solid.scale(F.determinant()) * F.squaredNorm();
    volume += tetrahedra_[e].volume;
  });
  return sum / volume;
}

void MeshBody::find_nodal_dilatations(const Dofs& u) const {
  const bool linear = is_linear();
  const auto each = [](std::size_t count, auto visit) {
    for_each_chunk(static_cast<std::ptrdiff_t>(count), element_chunk,
                   [&](std::ptrdiff_t, std::ptrdiff_t begin, std::ptrdiff_t end) {
                     for (std::ptrdiff_t k = begin; k < end; ++k) visit(static_cast<std::size_t>(k));
                   });
  };
  each(tetrahedra_.size(), [&](std::size_t e) {
    Eigen::Matrix3d& gradient = tetrahedron_gradients_[e];
    gradient = gather(tetrahedra_[e].nodes, u) * tetrahedra_[e].gradients[0].transpose();
    if (!linear) gradient += Eigen::Matrix3d::Identity();
  });
  each(nodal_.size(), [&](std::size_t node) {
    double sum = 0.0, volume = 0.0;
    for_each_corner(static_cast<int>(node), [&](std::size_t e) {
      const Eigen::Matrix3d& gradient = tetrahedron_gradients_[e];
      sum += tetrahedra_[e].volume * (linear ? gradient.trace() : gradient.determinant());
      volume += tetrahedra_[e].volume;
    });
    if (!(volume > 0.0)) return;
    nodal_[node].dilatation = sum / volume;
    if (!linear)
      nodal_[node].pressure =
          MeanDilatation{material_.shear_modulus(), material_.lame(), nodal_[node].dilatation}.pressure(
              mean_distortion(static_cast<int>(node)));
  });
}

// The first Piola-Kirchhoff stress of a tetrahedron, a fourth of the derivative of the energy by F for each
// node.
Eigen::Matrix3d MeshBody::nodal_stress(std::size_t tetrahedron) const {
  const Eigen::Matrix3d& gradient = tetrahedron_gradients_[tetrahedron];
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const int node : tetrahedra_[tetrahedron].nodes) {
    const NodalDilatation& nodal = nodal_[static_cast<std::size_t>(node - first_)];
    if (is_linear()) {
      sum += 0.25 * linear_stress(material_, gradient, nodal.dilatation);
      continue;
    }
    const MeanDilatation solid{material_.shear_modulus(), material_.lame(), nodal.dilatation};
    const double volume = gradient.determinant();
    sum += 0.25 * solid.stress(nodal.pressure, gradient, volume, solid.scale(volume));
  }
  return sum;
}

double MeshBody::nodal_energy(const Dofs& u) const {
  find_nodal_dilatations(u);
  double sum = 0.0;
  for (std::size_t e = 0; e < tetrahedra_.size(); ++e)
    for (const int node : tetrahedra_[e].nodes) {
      const Eigen::Matrix3d& gradient = tetrahedron_gradients_[e];
      const double dilatation = nodal_[static_cast<std::size_t>(node - first_)].dilatation;
      const MeanDilatation solid{material_.shear_modulus(), material_.lame(), dilatation};
      sum += 0.25 * tetrahedra_[e].volume *
             (is_linear() ? linear_energy(material_, gradient, dilatation)
                          : solid.energy(solid.scale(gradient.determinant()) * gradient.squaredNorm()));
    }
  return sum;
}

// ---- the body as a whole --------------------------------------------------------------------------------

DeformedElement<8, 8> MeshBody::deformed_hexahedron(std::size_t number, const Dofs& u) const {
  return {shape(number), gather(hexahedra_[number], u), material_, element_};
}

MeshBody::CornerForces MeshBody::hexahedron_force(std::size_t number, const Dofs& u) const {
  if (!keeps_stiffness()) return deformed_hexahedron(number, u).force();
  CornerForces force;
  force.reshaped() = stiffness_ * gather(hexahedra_[number], u).reshaped();
  return force;
}

double MeshBody::hexahedron_energy(std::size_t number, const Dofs& u) const {
  if (!keeps_stiffness()) return deformed_hexahedron(number, u).energy();
  const Eigen::Matrix<double, 24, 1> local = gather(hexahedra_[number], u).reshaped();
  return 0.5 * local.dot(stiffness_ * local);
}

void MeshBody::add_box_forces(const Dofs& u, Dofs& force) const {
  [[maybe_unused]] const bool many = hexahedra_.size() >= fewest_in_box;
  const std::size_t layers = hexahedra_.size() / layer_;
  for (std::size_t parity = 0; parity < 2; ++parity) {
#pragma omp parallel for schedule(static) if (many)
    for (std::size_t layer = parity; layer < layers; layer += 2)
      for (std::size_t k = layer * layer_; k < (layer + 1) * layer_; ++k) {
        const CornerForces forces = hexahedron_force(k, u);
        for (std::size_t a = 0; a < 8; ++a)
          force.segment<3>(3 * Eigen::Index{hexahedra_[k][a]}) -= forces.col(static_cast<Eigen::Index>(a));
      }
  }
}

void MeshBody::add_internal_forces(const Dofs& u, Dofs& force) const {
  if (is_box()) return add_box_forces(u, force);
  if (averages_at_nodes()) find_nodal_dilatations(u);
  const auto hexahedra = static_cast<std::ptrdiff_t>(hexahedra_.size());
  for_each_chunk(hexahedra, element_chunk, [&](std::ptrdiff_t, std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t k = begin; k < end; ++k)
      corner_forces_.middleCols<8>(8 * k) = hexahedron_force(static_cast<std::size_t>(k), u);
  });
  const auto tetrahedra = static_cast<std::ptrdiff_t>(tetrahedra_.size());
  for_each_chunk(tetrahedra, element_chunk, [&](std::ptrdiff_t, std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t k = begin; k < end; ++k) {
      const Tetrahedron& element = tetrahedra_[static_cast<std::size_t>(k)];
      auto forces = corner_forces_.middleCols<4>(8 * hexahedra + 4 * k);
      if (averages_at_nodes())
        forces = element.volume * nodal_stress(static_cast<std::size_t>(k)) * element.gradients[0];
      else
        forces = DeformedElement<4, 1>(element, gather(element.nodes, u), material_, element_).force();
    }
  });
  const auto nodes = static_cast<std::ptrdiff_t>(first_corner_.size()) - 1;
  for_each_chunk(nodes, element_chunk, [&](std::ptrdiff_t, std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t node = begin; node < end; ++node)
      for (std::size_t i = first_corner_[static_cast<std::size_t>(node)];
           i < first_corner_[static_cast<std::size_t>(node) + 1]; ++i)
        force.segment<3>(3 * (first_ + node)) -= corner_forces_.col(static_cast<Eigen::Index>(corners_[i]));
  });
}

void MeshBody::add_potential(const Dofs& u, double& sum) const {
  for (std::size_t k = 0; k < hexahedra_.size(); ++k) sum += hexahedron_energy(k, u);
  if (averages_at_nodes()) {
    sum += nodal_energy(u);
    return;
  }
  for (const Tetrahedron& element : tetrahedra_)
    sum += DeformedElement<4, 1>(element, gather(element.nodes, u), material_, element_).energy();
}

void MeshBody::add_stresses(const Dofs& u, std::vector<Eigen::Matrix3d>& of_hexahedra,
                            std::vector<Eigen::Matrix3d>& of_tetrahedra) const {
  for (std::size_t k = 0; k < hexahedra_.size(); ++k)
    of_hexahedra.push_back(deformed_hexahedron(k, u).mean_stress());
  if (averages_at_nodes()) find_nodal_dilatations(u);
  for (std::size_t e = 0; e < tetrahedra_.size(); ++e) {
    const Tetrahedron& element = tetrahedra_[e];
    if (!averages_at_nodes()) {
      of_tetrahedra.push_back(
          DeformedElement<4, 1>(element, gather(element.nodes, u), material_, element_).mean_stress());
      continue;
    }
    const Eigen::Matrix3d& F = tetrahedron_gradients_[e];
    of_tetrahedra.push_back(is_linear() ? nodal_stress(e)
                                        : Eigen::Matrix3d(nodal_stress(e) * F.transpose() / F.determinant()));
  }
}

}  // namespace ilaw::host
