// Blocks of hexahedra: patch tests, invariances, consistency of forces and energy.
#include "model/box.hpp"

#include "host_runner.hpp"
#include "model/bars.hpp"
#include "solid_fields.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

namespace ilaw::host {

using Kind = std::pair<MaterialLaw, Element>;

static std::string name_of(const Kind& kind) {
  return std::string(kind.first == MaterialLaw::linear ? "linear" : "neo_hookean") +
         (kind.second == Element::full ? "" : "_mean_dilatation");
}

}  // namespace ilaw::host

namespace ilaw::host::testing {
namespace {

constexpr double young = 3.0, poisson = 0.3, density = 2.0;
// Lame constants by their definition.
constexpr double mu = young / (2.0 * (1.0 + poisson));
constexpr double lambda = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));

constexpr Kind linear{MaterialLaw::linear, Element::full},
    neo_hookean{MaterialLaw::neo_hookean, Element::full},
    linear_mean{MaterialLaw::linear, Element::mean_dilatation},
    neo_hookean_mean{MaterialLaw::neo_hookean, Element::mean_dilatation};

Solids block_of(Kind kind, std::array<int, 3> elements = {4, 3, 2}) {
  return Solids({box_of({"b",
                         {0.5, -1.0, 2.0},
                         {2.0, 1.2, 0.6},
                         {0.0, 0.0, 0.0},
                         elements,
                         {kind.first, young, poisson, density},
                         kind.second})});
}

Eigen::Matrix3d random_matrix(double size, std::mt19937_64& random) {
  std::uniform_real_distribution<double> draw(-size, size);
  return Eigen::Matrix3d::NullaryExpr([&] { return draw(random); });
}

// First Piola-Kirchhoff stress for the displacement gradient G.
Eigen::Matrix3d stress(MaterialLaw law, const Eigen::Matrix3d& G) {
  if (law == MaterialLaw::linear)
    return lambda * G.trace() * Eigen::Matrix3d::Identity() + mu * (G + G.transpose());
  const Eigen::Matrix3d F = Eigen::Matrix3d::Identity() + G, turned = F.inverse().transpose();
  return mu * (F - turned) + lambda * std::log(F.determinant()) * turned;
}

struct Side {
  const char* name;
  Eigen::Vector3d normal;
  double area;
};
const std::vector<Side> sides{{"b.x_min", {-1, 0, 0}, 0.72}, {"b.x_max", {1, 0, 0}, 0.72},
                              {"b.y_min", {0, -1, 0}, 1.2},  {"b.y_max", {0, 1, 0}, 1.2},
                              {"b.z_min", {0, 0, -1}, 2.4},  {"b.z_max", {0, 0, 1}, 2.4}};

// ---- geometry -------------------------------------------------------------------------------------------

// Where no face is named a node offers the length of its area vector: of all faces that meet there.
TEST(Block, NodesOfTheWholeOfferTheAreasOfAllTheirFaces) {
  const Solids block = block_of(linear);
  std::vector<Eigen::Vector3d> vectors(static_cast<std::size_t>(block.node_count()), Eigen::Vector3d::Zero());
  for (const Side& side : sides) {
    const NodeSet& face = block.sets().at(side.name);
    for (std::size_t k = 0; k < face.nodes.size(); ++k)
      vectors[static_cast<std::size_t>(face.nodes[k])] += face.areas[k] * side.normal.cwiseAbs();
  }
  const NodeSet& whole = block.sets().at("all");
  ASSERT_EQ(whole.nodes.size(), vectors.size());
  for (std::size_t k = 0; k < whole.nodes.size(); ++k)
    EXPECT_NEAR(whole.areas[k], vectors[static_cast<std::size_t>(whole.nodes[k])].norm(), 1e-15)
        << "node " << whole.nodes[k];
}

TEST(Block, HasTheMassAndTheFacesOfItsBox) {
  const Solids block = block_of(linear);
  ASSERT_EQ(block.node_count(), 5 * 4 * 3);
  EXPECT_NEAR(block.mass().sum(), 3.0 * density * 2.0 * 1.2 * 0.6, 1e-14);
  EXPECT_GT(block.mass().minCoeff(), 0.0);
  for (const Side& side : sides) {
    const NodeSet& face = block.sets().at(side.name);
    double area = 0.0;
    for (const double part : face.areas) area += part;
    EXPECT_NEAR(area, side.area, 1e-14) << side.name;
    Eigen::Vector3d outward = Eigen::Vector3d::Zero();
    const auto corner = [&](int node) { return block.position().segment<3>(3 * node); };
    for (const std::array<int, 4>& facet : face.facets)
      outward += 0.5 * Eigen::Vector3d(corner(facet[2]) - corner(facet[0]))
                           .cross(Eigen::Vector3d(corner(facet[3]) - corner(facet[1])));
    EXPECT_NEAR((outward - side.area * side.normal).norm(), 0.0, 1e-14) << side.name;
  }
}

// ---- statics --------------------------------------------------------------------------------------------

class BlockOf : public ::testing::TestWithParam<Kind> {};
INSTANTIATE_TEST_SUITE_P(Material, BlockOf,
                         ::testing::Values(linear, neo_hookean, linear_mean, neo_hookean_mean),
                         [](const auto& kind) { return name_of(kind.param); });
class NeoHookeanBlock : public ::testing::TestWithParam<Kind> {};
INSTANTIATE_TEST_SUITE_P(Element, NeoHookeanBlock, ::testing::Values(neo_hookean, neo_hookean_mean),
                         [](const auto& kind) { return name_of(kind.param); });

// u = G x has the same stress P everywhere: nodes inside feel nothing, those of a face the force -P n times
// their part of its area.
TEST_P(BlockOf, PassesThePatchTest) {
  std::mt19937_64 random(1);
  const Solids block = block_of(GetParam());
  for (int draw = 0; draw < 200; ++draw) {
    const Eigen::Matrix3d G = random_matrix(0.2, random), P = stress(GetParam().first, G);
    Dofs exact = Dofs::Zero(block.mass().size());
    for (const Side& side : sides) {
      const NodeSet& face = block.sets().at(side.name);
      for (std::size_t k = 0; k < face.nodes.size(); ++k)
        exact.segment<3>(3 * face.nodes[k]) -= face.areas[k] * P * side.normal;
    }
    EXPECT_LE((forces(block, linear_field(block, G)) - exact).cwiseAbs().maxCoeff(), 1e-14) << draw;
  }
}

// A turn of the deformed body turns its forces with it: f(Q (x + u) - x) = Q f(u).
TEST_P(NeoHookeanBlock, TurnsItsForcesWithTheBody) {
  std::mt19937_64 random(2);
  const Solids block = block_of(GetParam());
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(2.0, Eigen::Vector3d(1, 1, -3).normalized()).matrix();
  for (int draw = 0; draw < 20; ++draw) {
    const Dofs u = random_field(block, 0.03, random), x = block.position();
    Dofs turned(u.size());
    Dofs exact = forces(block, u);
    for (int node = 0; node < block.node_count(); ++node) {
      turned.segment<3>(3 * node) = turn * (x + u).segment<3>(3 * node) - x.segment<3>(3 * node);
      exact.segment<3>(3 * node) = (turn * exact.segment<3>(3 * node)).eval();
    }
    EXPECT_LE((forces(block, turned) - exact).cwiseAbs().maxCoeff(), 1e-13) << "draw " << draw;
  }
}

// u = (x y z, 0, 0) from the corner of the box bends and twists every element, and lies in its shape
// functions: 2x2x2 points integrate its energy exactly, 1/2 of (lambda + 2 mu) y^2 z^2 + mu (x^2 z^2 + x^2
// y^2).
TEST(LinearBlock, HasTheExactEnergyOfATrilinearField) {
  const Solids block = block_of(linear);
  Dofs u = Dofs::Zero(block.mass().size());
  for (int node = 0; node < block.node_count(); ++node)
    u[3 * node] = (block.position().segment<3>(3 * node) - block.position().head<3>()).prod();
  const double a = 2.0, b = 1.2, c = 0.6, volume = a * b * c;
  const double exact =
      0.5 * volume / 9.0 * ((lambda + 2.0 * mu) * b * b * c * c + mu * a * a * (c * c + b * b));
  EXPECT_NEAR(block.potential(u), exact, 1e-14);
}

// The same on elements that reach from side to side of b and c: their dilatation y z has the mean b c/4, and
// what it deviates, in the square b^2 c^2 (1/9 - 1/16), no longer costs bulk modulus.
TEST(MeanDilatation, HasTheExactEnergyOfATrilinearField) {
  const Solids full = block_of(linear, {4, 1, 1}), block = block_of(linear_mean, {4, 1, 1});
  Dofs u = Dofs::Zero(block.mass().size());
  for (int node = 0; node < block.node_count(); ++node)
    u[3 * node] = (block.position().segment<3>(3 * node) - block.position().head<3>()).prod();
  const double b = 1.2, c = 0.6, volume = 2.0 * b * c, bulk = lambda + 2.0 / 3.0 * mu;
  const double saved = 0.5 * bulk * volume * b * b * c * c * (1.0 / 9.0 - 1.0 / 16.0);
  EXPECT_NEAR(block.potential(u), full.potential(u) - saved, 1e-14);
}

// The stiffness, column by column: symmetric, and zero for the six motions of a rigid body alone, so no
// hourglass modes.
TEST_P(BlockOf, HasASymmetricStiffnessWithSixRigidMotions) {
  if (GetParam().first != MaterialLaw::linear) GTEST_SKIP() << "its stress is that of the patch test";
  for (const std::array<int, 3>& elements : {std::array{1, 1, 1}, std::array{3, 2, 1}}) {
    const Solids block = block_of(GetParam(), elements);
    const Eigen::Index size = block.mass().size();
    Eigen::MatrixXd stiffness(size, size);
    for (Eigen::Index column = 0; column < size; ++column)
      stiffness.col(column) = -forces(block, Dofs::Unit(size, column));
    EXPECT_LE((stiffness - stiffness.transpose()).cwiseAbs().maxCoeff(), 1e-14);
    const Eigen::VectorXd modes = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(stiffness).eigenvalues();
    EXPECT_LE(modes.head<6>().cwiseAbs().maxCoeff(), 1e-13);
    EXPECT_GE(modes[6], 1e-2);
  }
}

}  // namespace
}  // namespace ilaw::host::testing
