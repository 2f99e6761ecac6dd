// Blocks of hexahedra beyond what mesh_test.cpp asks of all meshes, which equal them: areas of edges,
// energies of bending, stiffness without hourglass modes, and the critical step with and without mean
// dilatation.
#include "host_runner.hpp"
#include "model/box.hpp"
#include "solid_fields.hpp"

#include <Eigen/Eigenvalues>

namespace ilaw::host::testing::blocks {
namespace {

constexpr double young = 3.0, density = 2.0;

Solids block_of(Element element, std::array<int, 3> elements = {4, 3, 2}, double poisson = 0.3,
                std::array<double, 3> size = {2.0, 1.2, 0.6}) {
  return Solids({box_of({"b",
                         {0.5, -1.0, 2.0},
                         {size[0], size[1], size[2]},
                         {0.0, 0.0, 0.0},
                         elements,
                         {MaterialLaw::linear, young, poisson, density},
                         element})});
}

// Column by column.
Eigen::MatrixXd stiffness_of(const Solids& block) {
  const Eigen::Index size = block.mass().size();
  Eigen::MatrixXd stiffness(size, size);
  for (Eigen::Index column = 0; column < size; ++column)
    stiffness.col(column) = -forces(block, Dofs::Unit(size, column));
  return stiffness;
}

// Where no face is named a node offers the length of its area vector: of all faces that meet there.
TEST(Block, NodesOfTheWholeOfferTheAreasOfAllTheirFaces) {
  const Solids block = block_of(Element::full);
  std::vector<Eigen::Vector3d> vectors(static_cast<std::size_t>(block.node_count()), Eigen::Vector3d::Zero());
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    for (const char* side : {"_min", "_max"}) {
      const NodeSet& face = block.sets().at(std::string("b.") + "xyz"[axis] + side);
      for (std::size_t k = 0; k < face.nodes.size(); ++k)
        vectors[static_cast<std::size_t>(face.nodes[k])][axis] += face.areas[k];
    }
  const NodeSet& whole = block.sets().at("all");
  ASSERT_EQ(whole.nodes.size(), vectors.size());
  for (std::size_t k = 0; k < whole.nodes.size(); ++k)
    EXPECT_NEAR(whole.areas[k], vectors[static_cast<std::size_t>(whole.nodes[k])].norm(), 1e-15) << k;
}

// u = (x y z, 0, 0) from the corner of the box bends and twists every element, and lies in its shape
// functions: 2x2x2 points integrate its energy exactly, 1/2 of (lambda + 2 mu) y^2 z^2 + mu (x^2 z^2 + x^2
// y^2). On elements that reach from side to side of b and c the dilatation y z has the mean b c/4, and what
// it deviates, in the square b^2 c^2 (1/9 - 1/16), costs no bulk modulus with mean dilatation.
TEST(Block, HasTheExactEnergyOfATrilinearField) {
  const double a = 2.0, b = 1.2, c = 0.6, volume = a * b * c, mu = young / 2.6,
               lambda = young * 0.3 / (1.3 * 0.4);
  const double exact =
                   0.5 * volume / 9.0 * ((lambda + 2.0 * mu) * b * b * c * c + mu * a * a * (c * c + b * b)),
               saved = 0.5 * (lambda + 2.0 / 3.0 * mu) * volume * b * b * c * c * (1.0 / 9.0 - 1.0 / 16.0);
  for (const Element element : {Element::full, Element::mean_dilatation}) {
    const Solids block = block_of(element, {4, 1, 1});
    Dofs u = Dofs::Zero(block.mass().size());
    for (int node = 0; node < block.node_count(); ++node)
      u[3 * node] = (block.position().segment<3>(3 * node) - block.position().head<3>()).prod();
    EXPECT_NEAR(block.potential(u), element == Element::full ? exact : exact - saved, 1e-14);
  }
}

// Zero for the six motions of a rigid body alone, so no hourglass modes.
TEST(Block, HasASymmetricStiffnessWithSixRigidMotions) {
  for (const Element element : {Element::full, Element::mean_dilatation})
    for (const std::array<int, 3>& elements : {std::array{1, 1, 1}, std::array{3, 2, 1}}) {
      const Eigen::MatrixXd stiffness = stiffness_of(block_of(element, elements));
      EXPECT_LE((stiffness - stiffness.transpose()).cwiseAbs().maxCoeff(), 1e-14);
      const Eigen::VectorXd modes = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(stiffness).eigenvalues();
      EXPECT_LE(modes.head<6>().cwiseAbs().maxCoeff(), 1e-13);
      EXPECT_GE(modes[6], 1e-2);
    }
}

// A bound from below of 2/omega_max, which it is for one element, and never smaller than with full elements:
// the mean dilatation lowers the energy of every motion.
TEST(Block, HasACriticalStepThatIsABound) {
  for (const double poisson : {0.0, 0.3, 0.45, 0.499, 0.4999})
    for (const std::array<int, 3>& elements :
         {std::array{1, 1, 1}, std::array{4, 3, 2}, std::array{1, 2, 6}, std::array{7, 1, 1}}) {
      const Solids block = block_of(Element::mean_dilatation, elements, poisson, {1.0, 0.8, 0.7});
      const Eigen::VectorXd root = block.mass().cwiseSqrt().cwiseInverse();
      const Eigen::MatrixXd scaled = root.asDiagonal() * stiffness_of(block) * root.asDiagonal();
      const double bound = block.critical_step(),
                   limit = 2.0 / std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(
                                               scaled, Eigen::EigenvaluesOnly)
                                               .eigenvalues()
                                               .maxCoeff());
      EXPECT_LE(bound, limit * (1.0 + 1e-12)) << poisson << ", " << elements[0];
      EXPECT_GE(bound,
                block_of(Element::full, elements, poisson, {1.0, 0.8, 0.7}).critical_step() * (1.0 - 1e-12));
      EXPECT_TRUE(elements[0] * elements[1] * elements[2] > 1 || bound > limit * (1.0 - 1e-12)) << poisson;
    }
}

// A cube that swells and shrinks: the energy 9 K e^2/2 per volume at the strain e against corners that move
// at e' h/2 along all axes, so omega^2 = 12 K/(rho h^2) and the critical step is (h/c) sqrt(1 - 2 nu), c =
// sqrt(E/rho). It is the fastest motion of both elements where nu >= 0.
TEST(Block, HasTheCriticalStepOfACubeThatSwells) {
  for (const double poisson : {0.0, 0.3, 0.45, 0.499, 0.4999})
    for (const Element element : {Element::full, Element::mean_dilatation}) {
      const double exact = 0.3 * std::sqrt(density / young * (1.0 - 2.0 * poisson));
      EXPECT_NEAR(block_of(element, {1, 1, 1}, poisson, {0.3, 0.3, 0.3}).critical_step(), exact,
                  1e-10 * exact);
    }
}

}  // namespace
}  // namespace ilaw::host::testing::blocks
