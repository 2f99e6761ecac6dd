// Bodies with meshes from files: elements against closed forms, and equality with boxes.
#include "host_runner.hpp"
#include "mesh_writer.hpp"
#include "solid_fields.hpp"

#include "model/box.hpp"
#include "model/elements.hpp"
#include "model/solids.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include <numbers>

namespace ilaw::host::testing::mesh {
namespace {

constexpr double young = 3.0, poisson = 0.3, density = 2.0;

struct Kind {
  bool tetrahedra;
  MaterialLaw law;
  Element element;
  double ratio = poisson;

  Material material() const { return {law, young, ratio, density}; }
  double mu() const { return young / (2.0 * (1.0 + ratio)); }
  double lambda() const { return young * ratio / ((1.0 + ratio) * (1.0 - 2.0 * ratio)); }
};

std::string name_of(const Kind& kind) {
  return std::string(kind.tetrahedra ? "tetrahedra" : "hexahedra") +
         (kind.law == MaterialLaw::linear ? "_linear" : "_neo_hookean") +
         (kind.element == Element::full ? "" : "_mean_dilatation");
}

std::vector<Kind> all_kinds() {
  std::vector<Kind> kinds;
  for (const bool tetrahedra : {false, true})
    for (const MaterialLaw law : {MaterialLaw::linear, MaterialLaw::neo_hookean})
      for (const Element element : {Element::full, Element::mean_dilatation})
        kinds.push_back({tetrahedra, law, element});
  return kinds;
}

MeshSetup setup_of(const WrittenMesh& mesh, const Kind& kind) {
  MeshData data{mesh.nodes, mesh.cells, {}};
  MeshTopology topology = topology_of(data);
  return {"m", std::move(data), std::move(topology), {0, 0, 0}, {0, 0, 0}, kind.material(), kind.element};
}
Solids solids_of(const WrittenMesh& mesh, const Kind& kind) { return Solids({setup_of(mesh, kind)}); }

// A box whose inner nodes are moved about.
WrittenMesh distorted(bool tetrahedra) {
  Random random(7);
  return box_mesh({4, 3, 3}, {2.0, 1.2, 0.9}, tetrahedra, [&](const Eigen::Vector3d& x) {
    const Eigen::Vector3d by(random(-0.08, 0.08), random(-0.08, 0.08), random(-0.08, 0.08));
    const bool inside = x[0] > 1e-9 && x[0] < 2.0 - 1e-9 && x[1] > 1e-9 && x[1] < 1.2 - 1e-9 && x[2] > 1e-9 &&
                        x[2] < 0.9 - 1e-9;
    return Eigen::Vector3d(inside ? x + by : x);
  });
}

class MeshKinds : public ::testing::TestWithParam<Kind> {};
INSTANTIATE_TEST_SUITE_P(All, MeshKinds, ::testing::ValuesIn(all_kinds()),
                         [](const auto& kind) { return name_of(kind.param); });

// A constant strain on a distorted mesh: no force inside, and the stress of the closed form in every element.
TEST_P(MeshKinds, PassThePatchTest) {
  const Kind kind = GetParam();
  const Solids model = solids_of(distorted(kind.tetrahedra), kind);
  Eigen::Matrix3d gradient;
  gradient << 0.11, 0.05, -0.02, 0.03, -0.07, 0.04, -0.06, 0.02, 0.09;
  const Dofs u = linear_field(model, gradient);
  const Eigen::Matrix3d one = Eigen::Matrix3d::Identity(), F = one + gradient;
  const double J = F.determinant();
  const Eigen::Matrix3d stress =
      kind.law == MaterialLaw::linear
          ? Eigen::Matrix3d(kind.lambda() * gradient.trace() * one +
                            kind.mu() * (gradient + gradient.transpose()))
          : Eigen::Matrix3d((kind.mu() * (F * F.transpose() - one) + kind.lambda() * std::log(J) * one) / J);
  for (const Eigen::Matrix3d& found : model.stresses(u)) EXPECT_LT((found - stress).norm(), 1e-13);
  const Dofs force = forces(model, u);
  const auto& boundary = model.sets().at("m.boundary").nodes;
  const std::set<int> outside(boundary.begin(), boundary.end());
  ASSERT_LT(outside.size(), static_cast<std::size_t>(model.node_count()));
  for (int node = 0; node < model.node_count(); ++node)
    EXPECT_TRUE(outside.contains(node) || force.segment<3>(3 * node).norm() < 1e-14) << node;
  EXPECT_GT(force.norm(), 0.1);
}

// Forces are the derivative of the stored energy.
TEST_P(MeshKinds, AreTheGradientOfTheirEnergy) {
  const Kind kind = GetParam();
  const Solids model = solids_of(distorted(kind.tetrahedra), kind);
  const Dofs u = random_field(model, 0.02, std::mt19937_64(1)),
             along = random_field(model, 1.0, std::mt19937_64(2));
  const double h = 1e-5;
  const double slope = (model.potential(u + h * along) - model.potential(u - h * along)) / (2.0 * h);
  const Dofs force = forces(model, u);
  EXPECT_NEAR(-force.dot(along), slope, 1e-9 * force.norm() * along.norm());
}

// A large rotation and translation, of a solid that is made for them.
TEST_P(MeshKinds, FeelNoRigidRotation) {
  const Kind kind = GetParam();
  if (kind.law == MaterialLaw::linear) GTEST_SKIP() << "for small displacements";
  const Solids model = solids_of(distorted(kind.tetrahedra), kind);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(2.1, Eigen::Vector3d(1, -2, 3).normalized()).toRotationMatrix();
  Dofs u = linear_field(model, turn - Eigen::Matrix3d::Identity());
  for (Eigen::Index k = 0; k < u.size(); k += 3) u.segment<3>(k) += Eigen::Vector3d(10, 20, -5);
  EXPECT_LT(forces(model, u).norm(), 1e-13);
  EXPECT_LT(std::abs(model.potential(u)), 1e-13);
}

TEST_P(MeshKinds, HaveTheMassAndAreaOfTheirShape) {
  const Kind kind = GetParam();
  const Solids model = solids_of(distorted(kind.tetrahedra), kind);
  EXPECT_NEAR(model.mass().sum(), 3.0 * density * 2.0 * 1.2 * 0.9, 1e-13);
  EXPECT_GT(model.mass().minCoeff(), 0.0);
  for (const auto& [name, area] : {std::pair{"m.x_max", 1.2 * 0.9}, std::pair{"m.y_min", 2.0 * 0.9},
                                   std::pair{"m.boundary", 2.0 * (1.2 * 0.9 + 2.0 * 0.9 + 2.0 * 1.2)}}) {
    const NodeSet& set = model.sets().at(name);
    double sum = 0.0;
    for (const double one : set.areas) sum += one;
    EXPECT_NEAR(sum, area, 1e-13) << name;
  }
}

// Facets are counter-clockwise seen from outside: their area vectors sum to zero, and enclose the volume.
TEST_P(MeshKinds, HaveFacetsThatPointOutwards) {
  const Kind kind = GetParam();
  const WrittenMesh mesh = distorted(kind.tetrahedra);
  const Solids model = solids_of(mesh, kind);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double volume = 0.0;
  for (const auto& facet : model.sets().at("m.boundary").facets)
    for (const auto& [i, j, k] : {std::array<int, 3>{0, 1, 2}, std::array<int, 3>{0, 2, 3}}) {
      const auto at = [&](int corner) {
        return mesh.nodes[static_cast<std::size_t>(facet[static_cast<std::size_t>(corner)])];
      };
      sum += 0.5 * (at(j) - at(i)).cross(at(k) - at(i));
      volume += at(i).dot(at(j).cross(at(k))) / 6.0;
    }
  EXPECT_LT(sum.norm(), 1e-14);
  EXPECT_NEAR(volume, 2.0 * 1.2 * 0.9, 1e-14);
}

// ---- the critical step ----------------------------------------------------------------------------------

// The largest displacement in free vibration from random velocities.
double amplitude(const Model& model, double dt, int steps) {
  Dofs u = Dofs::Zero(model.mass().size()), v = random_field(model, 1e-6, std::mt19937_64(3));
  double largest = 0.0;
  for (int n = 0; n < steps; ++n) {
    u += dt * v;
    v += dt * forces(model, u).cwiseQuotient(model.mass());
    largest = std::max(largest, u.cwiseAbs().maxCoeff());
  }
  return largest;
}

TEST_P(MeshKinds, AreStableUpToTheCriticalStep) {
  const Kind kind = GetParam();
  const Solids model = solids_of(distorted(kind.tetrahedra), kind);
  for (const double part : {0.999, 0.7137, 0.3719})
    EXPECT_LT(amplitude(model, part * model.critical_step(), 3000), 1e-3) << part;
}

// The bound of one full element is the critical step itself.
TEST(Mesh, CriticalStepOfOneElementIsSharp) {
  for (const bool tetrahedra : {false, true}) {
    const Kind kind{tetrahedra, MaterialLaw::linear, Element::full};
    WrittenMesh mesh = box_mesh({1, 1, 1}, {1.0, 0.7, 0.4}, tetrahedra);
    if (tetrahedra) {
      mesh.cells = {{CellKind::tetrahedron, {0, 1, 2, 3, 0, 0, 0, 0}}};
      mesh.nodes = {{0, 0, 0}, {1, 0.1, 0}, {0.2, 0.8, 0}, {0.3, 0.2, 0.5}};
    }
    const Solids model = solids_of(mesh, kind);
    EXPECT_LT(amplitude(model, 0.999 * model.critical_step(), 20000), 0.1);
    EXPECT_GT(amplitude(model, 1.001 * model.critical_step(), 20000), 1e3);
  }
}

// ---- boxes ----------------------------------------------------------------------------------------------

Solids block_of(const std::array<int, 3>& elements, const Kind& kind) {
  return Solids(
      {box_of({"m", {0, 0, 0}, {2.0, 1.2, 0.9}, {0, 0, 0}, elements, kind.material(), kind.element})});
}

TEST_P(MeshKinds, AreThoseOfABox) {
  const Kind kind = GetParam();
  if (kind.tetrahedra) GTEST_SKIP() << "boxes are of hexahedra";
  const Solids mesh = solids_of(box_mesh({4, 3, 2}, {2.0, 1.2, 0.9}, false), kind);
  const Solids box = block_of({4, 3, 2}, kind);
  const auto near = [](const Dofs& a, const Dofs& b) { return (a - b).norm() <= 1e-14 * b.norm(); };
  EXPECT_TRUE(near(mesh.mass(), box.mass()));
  EXPECT_TRUE(near(mesh.position(), box.position()));
  EXPECT_NEAR(mesh.critical_step(), box.critical_step(), 1e-13 * box.critical_step());
  const Dofs u = random_field(box, 0.02, std::mt19937_64(4));
  EXPECT_LT((forces(mesh, u) - forces(box, u)).norm(), 1e-13 * forces(box, u).norm());
  EXPECT_NEAR(mesh.potential(u), box.potential(u), 1e-13 * box.potential(u));
  // A block lists its cells in another order: by their first nodes.
  const auto stress_at = [&](const Model& model, int first) {
    const std::vector<int>& cells = model.mesh().cells;
    std::size_t cell = 0;
    while (cells[8 * cell] != first) ++cell;
    return model.stresses(u)[cell];
  };
  for (const int first : {0, 6, 20, 27})
    EXPECT_LT((stress_at(mesh, first) - stress_at(box, first)).norm(), 1e-13) << first;
  for (const auto& [name, set] : box.sets()) {
    const NodeSet& own = mesh.sets().at(name);
    EXPECT_EQ(std::set<int>(own.nodes.begin(), own.nodes.end()),
              std::set<int>(set.nodes.begin(), set.nodes.end()));
    EXPECT_EQ(own.facets.size(), set.facets.size()) << name;
    for (std::size_t k = 0; k < set.nodes.size(); ++k) {
      const auto at = std::find(own.nodes.begin(), own.nodes.end(), set.nodes[k]) - own.nodes.begin();
      EXPECT_NEAR(own.areas[static_cast<std::size_t>(at)], set.areas[k], 1e-14) << name;
    }
  }
}

// ---- near incompressibility -----------------------------------------------------------------------------

Dofs at_rest(const Solids& model, const Dofs& load, const std::vector<bool>& held) {
  std::vector<Eigen::Index> free;
  for (std::size_t k = 0; k < held.size(); ++k)
    if (!held[k]) free.push_back(static_cast<Eigen::Index>(k));
  const auto count = static_cast<Eigen::Index>(free.size());
  Eigen::MatrixXd stiffness(count, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const Dofs unit = Dofs::Unit(load.size(), free[static_cast<std::size_t>(k)]),
               force = -forces(model, unit);
    for (Eigen::Index i = 0; i < count; ++i) stiffness(i, k) = force[free[static_cast<std::size_t>(i)]];
  }
  Eigen::VectorXd right(count);
  for (Eigen::Index i = 0; i < count; ++i) right[i] = load[free[static_cast<std::size_t>(i)]];
  const Eigen::VectorXd solved = stiffness.ldlt().solve(right);
  Dofs u = Dofs::Zero(load.size());
  for (Eigen::Index i = 0; i < count; ++i) u[free[static_cast<std::size_t>(i)]] = solved[i];
  return u;
}

// A quarter of a thick tube under a pressure inside, in plane strain: Lame's radial displacement at the inner
// radius a is (1+nu) p a ((1-2nu) a^2 + b^2) / (E (b^2 - a^2)). Returns the part of it that a mesh finds.
double tube_part(Element element, double ratio, bool tetrahedra, int n) {
  const double a = 1.0, b = 2.0, pressure = 0.01, quarter = 0.5 * std::numbers::pi;
  const Kind kind{tetrahedra, MaterialLaw::linear, element, ratio};
  const WrittenMesh mesh =
      box_mesh({n, 2 * n, 1}, {b - a, quarter, 0.1}, tetrahedra, [&](const Eigen::Vector3d& x) {
        const double r = a + x[0];
        return Eigen::Vector3d(r * std::cos(x[1]), r * std::sin(x[1]), x[2]);
      });
  const Solids model = solids_of(mesh, kind);
  std::vector<bool> held(static_cast<std::size_t>(model.mass().size()));
  Dofs load = Dofs::Zero(model.mass().size());
  std::vector<int> inside;
  for (int node = 0; node < model.node_count(); ++node) {
    const Eigen::Vector3d x = mesh.nodes[static_cast<std::size_t>(node)];
    const auto dof = static_cast<std::size_t>(3 * node);
    held[dof] = std::abs(x[0]) < 1e-9;
    held[dof + 1] = std::abs(x[1]) < 1e-9;
    held[dof + 2] = true;
    if (std::abs(x.head<2>().norm() - a) > 1e-9) continue;
    inside.push_back(node);
    const double end = held[dof] || held[dof + 1] ? 0.5 : 1.0;
    load.segment<3>(3 * node).head<2>() =
        end * pressure * a * quarter / (2 * n) * 0.05 * x.head<2>().normalized();
  }
  const Dofs u = at_rest(model, load, held);
  double mean = 0.0;
  for (const int node : inside)
    mean += u.segment<3>(3 * node).dot(mesh.nodes[static_cast<std::size_t>(node)]) /
            mesh.nodes[static_cast<std::size_t>(node)].head<2>().norm() / static_cast<double>(inside.size());
  const double exact =
      (1.0 + ratio) * pressure * a * ((1.0 - 2.0 * ratio) * a * a + b * b) / (young * (b * b - a * a));
  return mean / exact;
}

TEST(Mesh, TetrahedraOfATubeDoNotLock) {
  for (const double ratio : {0.3, 0.49, 0.4999}) {
    const double coarse = tube_part(Element::mean_dilatation, ratio, true, 4),
                 fine = tube_part(Element::mean_dilatation, ratio, true, 7);
    std::printf("tube, nu %g: mean dilatation %.3f, full %.3f\n", ratio, fine,
                tube_part(Element::full, ratio, true, 7));
    EXPECT_NEAR(fine, 1.0, 0.02) << ratio;
    EXPECT_LT(std::abs(fine - 1.0), std::abs(coarse - 1.0) / 2.0) << ratio;
  }
  EXPECT_LT(tube_part(Element::full, 0.4999, true, 7), 0.8);
}

TEST(Mesh, HexahedraOfATubeDoNotLock) {
  EXPECT_NEAR(tube_part(Element::mean_dilatation, 0.4999, false, 7), 1.0, 0.01);
  EXPECT_LT(tube_part(Element::full, 0.4999, false, 7), 0.7);
}

// ---- surfaces -------------------------------------------------------------------------------------------

// The weights of a triangle's corners give the point below a node, of a body over triangles of no symmetry.
TEST(Mesh, TrianglesInterpolateTheirCorners) {
  const MeshFile file(box_mesh({4, 3, 2}, {2.0, 1.2, 0.9}, true, [](const Eigen::Vector3d& x) {
    return Eigen::Vector3d(x[0] + 0.3 * x[1], x[1], x[2]);
  }));
  const double height = 0.05;
  json source = scene_of_blocks(
      {block("b", {0.41, 0.13, 0.9 + height}, {1.43, 0.97, 0.2}, {5, 4, 1}, elastic(1, 0, 1))},
      {law_between("b.z_min", {{"surface", "m.z_max"}, {"discretization", "node_to_facet"}}, "contact")});
  source["model"]["type"] = "solids";
  source["model"]["meshes"] = {{{"name", "m"}, {"file", file.path()}, {"material", elastic(1, 0, 1)}}};
  const Scene scene = scene_of(until_at_cfl(1, 0.9, source));
  const std::vector<int>& nodes = scene.interfaces[0]->nodes();
  const Counterpart& surface = *scene.interfaces[0]->setup().counterpart;
  const Dofs u = Dofs::Zero(scene.model->mass().size());
  ASSERT_EQ(nodes.size(), 30U);
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const ContactPoint contact = surface.contact_point(static_cast<int>(k), u, 0.0);
    Eigen::Vector3d offset = Eigen::Vector3d::Zero();
    contact.for_each_node(nodes[k], [&](int node, double weight) {
      offset += weight * scene.model->position().segment<3>(3 * Eigen::Index{node});
    });
    EXPECT_LT((offset - Eigen::Vector3d(0, 0, height)).norm(), 1e-14) << k;
    EXPECT_NEAR(contact.gap, height, 1e-14) << k;
  }
}

}  // namespace
}  // namespace ilaw::host::testing::mesh
