// Blocks whose Poisson's ratio is close to 1/2: beams in bending and a bonded pad in compression against
// closed forms, and the critical step. Elements with mean dilatation do not lock, full ones do.
#include "model/box.hpp"

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>

#include <map>
#include <string>

namespace ilaw::host {
namespace {

constexpr double young = 3.0;

double shear_modulus(double poisson) { return 0.5 * young / (1.0 + poisson); }

struct Grid {
  Eigen::Vector3d corner, size;
  std::array<int, 3> elements;

  int node(int x, int y, int z) const { return x + (elements[0] + 1) * (y + (elements[1] + 1) * z); }
};

Solids block_of(const Grid& grid, double poisson, Element element) {
  return Solids({box_of({"b",
                         grid.corner,
                         grid.size,
                         {0.0, 0.0, 0.0},
                         grid.elements,
                         {MaterialLaw::linear, young, poisson, 2.0},
                         element})});
}

// Displacements of some degrees of freedom, and forces on the others.
struct Conditions {
  std::map<int, double> displacements, forces;
};

// Column by column, of all nodes at once that are three apart and so share no element.
Eigen::SparseMatrix<double> stiffness_of(const Solids& block, const Grid& grid) {
  std::vector<Eigen::Triplet<double>> entries;
  const int nx = grid.elements[0], ny = grid.elements[1], nz = grid.elements[2];
  const auto near = [](int from, int all, int offset) { return from + offset >= 0 && from + offset <= all; };
  for (int shift = 0; shift < 27; ++shift)
    for (int axis = 0; axis < 3; ++axis) {
      Dofs u = Dofs::Zero(block.mass().size()), force = u;
      const auto for_each = [&](auto visit) {
        for (int z = shift / 9; z <= nz; z += 3)
          for (int y = shift / 3 % 3; y <= ny; y += 3)
            for (int x = shift % 3; x <= nx; x += 3) visit(x, y, z);
      };
      for_each([&](int x, int y, int z) { u[3 * grid.node(x, y, z) + axis] = 1.0; });
      block.add_internal_forces(u, force);
      for_each([&](int x, int y, int z) {
        for (int k = 0; k < 27; ++k) {
          const int dx = k % 3 - 1, dy = k / 3 % 3 - 1, dz = k / 9 - 1;
          if (!near(x, nx, dx) || !near(y, ny, dy) || !near(z, nz, dz)) continue;
          for (int row = 0; row < 3; ++row) {
            const int dof = 3 * grid.node(x + dx, y + dy, z + dz) + row;
            entries.emplace_back(dof, 3 * grid.node(x, y, z) + axis, -force[dof]);
          }
        }
      });
    }
  Eigen::SparseMatrix<double> stiffness(block.mass().size(), block.mass().size());
  stiffness.setFromTriplets(entries.begin(), entries.end());
  return stiffness;
}

// Displacements at rest under the conditions.
Dofs solved(const Solids& block, const Grid& grid, const Conditions& given) {
  const Eigen::SparseMatrix<double> all = stiffness_of(block, grid);
  Dofs u = Dofs::Zero(all.rows()), load = u;
  for (const auto& [dof, value] : given.displacements) u[dof] = value;
  for (const auto& [dof, value] : given.forces) load[dof] += value;
  load -= all * u;
  std::vector<int> place(static_cast<std::size_t>(all.rows()), -1);
  int count = 0;
  for (int dof = 0; dof < all.rows(); ++dof)
    if (!given.displacements.count(dof)) place[static_cast<std::size_t>(dof)] = count++;
  std::vector<Eigen::Triplet<double>> entries;
  Dofs right(count);
  for (int column = 0; column < all.cols(); ++column) {
    const int to = place[static_cast<std::size_t>(column)];
    if (to < 0) continue;
    right[to] = load[column];
    for (Eigen::SparseMatrix<double>::InnerIterator entry(all, column); entry; ++entry)
      if (const int row = place[static_cast<std::size_t>(entry.row())]; row >= 0)
        entries.emplace_back(row, to, entry.value());
  }
  Eigen::SparseMatrix<double> free(count, count);
  free.setFromTriplets(entries.begin(), entries.end());
  const Dofs found = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(free).solve(right);
  for (int dof = 0; dof < all.rows(); ++dof)
    if (const int at = place[static_cast<std::size_t>(dof)]; at >= 0) u[dof] = found[at];
  return u;
}

// Plane strain: nothing moves along y.
void hold_thickness(const Grid& grid, Conditions& given) {
  for (int node = 0; node <= grid.node(grid.elements[0], grid.elements[1], grid.elements[2]); ++node)
    given.displacements[3 * node + 1] = 0.0;
}

// Forces of a traction t(z) on the end x_max, by Gauss's two points per element: exact for cubics.
void pull_end(const Grid& grid, int axis, double (*traction)(double), Conditions& given) {
  const int nx = grid.elements[0], ny = grid.elements[1], nz = grid.elements[2];
  const double dz = grid.size[2] / nz, dy = grid.size[1] / ny;
  for (int z = 0; z < nz; ++z)
    for (int y = 0; y < ny; ++y)
      for (const double s : {0.5 - 0.5 / std::sqrt(3.0), 0.5 + 0.5 / std::sqrt(3.0)}) {
        const double part = 0.5 * dz * dy * traction(grid.corner[2] + (z + s) * dz);
        for (int side = 0; side < 4; ++side) {
          const double share = 0.5 * (side < 2 ? 1.0 - s : s);
          given.forces[3 * grid.node(nx, y + side % 2, z + side / 2) + axis] += share * part;
        }
      }
}

// ---- bending --------------------------------------------------------------------------------------------

// A cantilever of length L and depth D under the load P at its end, in plane strain: beam theory with shear,
// which is exact for parabolic shear traction (Timoshenko and Goodier 1970, section 21; Augarde and Deeks
// 2008, eqs. 5 and 6), E' = E/(1 - nu^2), nu' = nu/(1 - nu):
//   u_x = P z ((6 L - 3 x) x + (2 + nu')(z^2 - D^2/4))/(6 E' I),
//   u_z = -P (3 nu' z^2 (L - x) + (4 + 5 nu') D^2 x/4 + (3 L - x) x^2)/(6 E' I).
// Its root follows that solution. Returned: the end's deflection over the exact one.
constexpr double beam_length = 10.0, load = 1e-3;
double parabola(double z) { return -6.0 * load * (0.25 - z * z); }

double cantilever(double poisson, Element element, int depth) {
  const Grid grid{{0.0, 0.0, -0.5}, {beam_length, 1.0, 1.0}, {10 * depth, 1, depth}};
  const double E = young / (1.0 - poisson * poisson), nu = poisson / (1.0 - poisson), EI = E / 12.0;
  Conditions given;
  hold_thickness(grid, given);
  for (int z = 0; z <= depth; ++z)
    for (int y = 0; y < 2; ++y) {
      const double at = -0.5 + static_cast<double>(z) / depth;
      const int root = 3 * grid.node(0, y, z);
      given.displacements[root] = load * at * (2.0 + nu) * (at * at - 0.25) / (6.0 * EI);
      given.displacements[root + 2] = -load * 3.0 * nu * at * at * beam_length / (6.0 * EI);
    }
  pull_end(grid, 2, parabola, given);
  const Dofs u = solved(block_of(grid, poisson, element), grid, given);
  const double L = beam_length, exact = -load * ((4.0 + 5.0 * nu) * L / 4.0 + 2.0 * L * L * L) / (6.0 * EI);
  return u[3 * grid.node(10 * depth, 0, depth / 2) + 2] / exact;
}

void print(const char* what, double poisson, double mean, double full) {
  std::printf("%s, nu %g: mean dilatation %.3f, full %.3f\n", what, poisson, mean, full);
}

// With n square elements over the depth an element bends by e_xx = k z alone, without the e_zz = -nu' e_xx of
// the beam: the part 1/n^2 of the beam's energy that stands for bending within elements is 4 G/3 in place of
// E' = 2 G/(1 - nu), and the shear of a bent element adds G. So it gives way by (1 - 7 (1 - nu)/6)/n^2 too
// much, whatever Poisson's ratio.
TEST(MeanDilatation, BendsACantileverAsBeamTheorySays) {
  for (const double poisson : {0.3, 0.499, 0.4999}) {
    for (const int n : {4, 6}) {
      const double excess = (1.0 - 7.0 / 6.0 * (1.0 - poisson)) / (n * n);
      EXPECT_NEAR(cantilever(poisson, Element::mean_dilatation, n), 1.0 + excess, 0.05 * excess)
          << poisson << ", n = " << n;
    }
    print("cantilever", poisson, cantilever(poisson, Element::mean_dilatation, 4),
          cantilever(poisson, Element::full, 4));
  }
  EXPECT_LE(cantilever(0.499, Element::full, 4), 0.5);
  EXPECT_LE(cantilever(0.4999, Element::full, 4), 0.1);
}

// A beam of square section bent by moments at its ends, in space: the curvature is M/(E I), with sides that
// bend the other way by nu times that. u_x = k x z, u_z = -k (x^2 + nu (z^2 - y^2))/2, u_y = -k nu y z.
double bent_beam(double poisson, Element element, int depth) {
  const double length = 4.0, curvature = 1e-3;
  const Grid grid{{0.0, -0.5, -0.5}, {length, 1.0, 1.0}, {4 * depth, depth, depth}};
  Conditions given;
  for (int z = 0; z <= depth; ++z)
    for (int y = 0; y <= depth; ++y) given.displacements[3 * grid.node(0, y, z)] = 0.0;
  const int middle = depth / 2;
  given.displacements[3 * grid.node(0, middle, middle) + 1] = 0.0;
  given.displacements[3 * grid.node(0, middle, middle) + 2] = 0.0;
  given.displacements[3 * grid.node(0, middle, depth) + 1] = 0.0;
  pull_end(
      grid, 0, [](double z) { return young * 1e-3 * z; }, given);
  const Dofs u = solved(block_of(grid, poisson, element), grid, given);
  return u[3 * grid.node(4 * depth, middle, middle) + 2] / (-0.5 * curvature * length * length);
}

TEST(MeanDilatation, BendsABeamInSpaceByItsMoment) {
  for (const double poisson : {0.499, 0.4999}) {
    const double mean = bent_beam(poisson, Element::mean_dilatation, 4),
                 full = bent_beam(poisson, Element::full, 4);
    EXPECT_NEAR(mean, 1.0, 0.03) << poisson;
    EXPECT_LE(full, 0.8) << poisson;
    print("beam", poisson, mean, full);
  }
}

// ---- a pressed pad --------------------------------------------------------------------------------------

// A long pad of width 2a and thickness t between rigid plates that it sticks to, pressed by the strain e.
// Where a >> t the pressure drives a parabolic flow (G/12) t^2 p'' = p/K - e, K the bulk modulus, so that
//   mean pressure = K e (1 - tanh(b a)/(b a)) + 4 G e,  b^2 = 12 G/(K t^2),
// which is Gent and Lindley's (1959) 4 G e (1 + (a/t)^2) for K = inf. The second term is that of a pad that
// is not held, here 1 %. A quarter of the pad; returned: mean pressure over that.
double pressed_pad(double poisson, Element element, int layers) {
  const double a = 10.0, t = 1.0, strain = 1e-3;
  const int columns = 20 * layers;
  const Grid grid{{0.0, 0.0, 0.0}, {a, 1.0, 0.5 * t}, {columns, 1, layers}};
  Conditions given;
  hold_thickness(grid, given);
  for (int y = 0; y < 2; ++y) {
    for (int z = 0; z <= layers; ++z) given.displacements[3 * grid.node(0, y, z)] = 0.0;
    for (int x = 0; x <= columns; ++x) {
      given.displacements[3 * grid.node(x, y, 0) + 2] = 0.0;
      given.displacements[3 * grid.node(x, y, layers)] = 0.0;
      given.displacements[3 * grid.node(x, y, layers) + 2] = -0.5 * strain * t;
    }
  }
  const Solids block = block_of(grid, poisson, element);
  const Dofs u = solved(block, grid, given);
  Dofs force = Dofs::Zero(u.size());
  block.add_internal_forces(u, force);
  double pressure = 0.0;
  for (int x = 0; x <= columns; ++x)
    for (int y = 0; y < 2; ++y) pressure += force[3 * grid.node(x, y, layers) + 2] / a;
  const double G = shear_modulus(poisson), K = young / (3.0 * (1.0 - 2.0 * poisson));
  const double ba = a / t * std::sqrt(12.0 * G / K);
  return pressure / (strain * (K * (1.0 - std::tanh(ba) / ba) + 4.0 * G));
}

TEST(MeanDilatation, PressesABondedPadAsGentAndLindleySay) {
  for (const double poisson : {0.499, 0.4999}) {
    const double mean = pressed_pad(poisson, Element::mean_dilatation, 3),
                 full = pressed_pad(poisson, Element::full, 3);
    EXPECT_NEAR(mean, 1.0, 0.03) << poisson;
    if (poisson == 0.4999) {
      EXPECT_GE(full, 1.3) << "poisson " << poisson;
    }
    print("pad", poisson, mean, full);
  }
}

// ---- the critical step ----------------------------------------------------------------------------------

// 2/omega_max of M^-1/2 K M^-1/2.
double exact_critical_step(const Solids& block, const Grid& grid) {
  const Eigen::VectorXd root = block.mass().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled =
      root.asDiagonal() * Eigen::MatrixXd(stiffness_of(block, grid)) * root.asDiagonal();
  return 2.0 / std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled, Eigen::EigenvaluesOnly)
                             .eigenvalues()
                             .maxCoeff());
}

// A bound from below, the limit itself for one element, and never smaller than with full elements: the mean
// dilatation lowers the energy of every motion.
TEST(MeanDilatation, HasACriticalStepThatIsABound) {
  double least = 1.0;
  for (const double poisson : {0.0, 0.3, 0.45, 0.499, 0.4999})
    for (const std::array<int, 3>& elements :
         {std::array{1, 1, 1}, std::array{5, 4, 3}, std::array{1, 2, 6}, std::array{7, 1, 1}}) {
      const Grid grid{{0.0, 0.0, 0.0}, {1.0, 0.8, 0.7}, elements};
      const Solids block = block_of(grid, poisson, Element::mean_dilatation);
      const double bound = block.critical_step(), limit = exact_critical_step(block, grid);
      EXPECT_LE(bound, limit * (1.0 + 1e-12)) << poisson << ", " << elements[0];
      EXPECT_GE(bound, block_of(grid, poisson, Element::full).critical_step() * (1.0 - 1e-12))
          << poisson << ", " << elements[0];
      if (elements[0] * elements[1] * elements[2] == 1) {
        EXPECT_NEAR(bound, limit, 1e-12 * limit);
      }
      least = std::min(least, bound / limit);
    }
  std::printf("critical step: %.2f of the limit at least\n", least);
}

// A cube that swells and shrinks: the energy 9 K e^2/2 per volume at the strain e against corners that move
// at e' h/2 along all axes, so omega^2 = 12 K/(rho h^2) and the critical step is (h/c) sqrt(1 - 2 nu),
// c = sqrt(E/rho). It is the fastest motion of both elements where nu >= 0.
TEST(MeanDilatation, HasTheCriticalStepOfACubeThatSwells) {
  for (const double poisson : {0.0, 0.3, 0.45, 0.499, 0.4999})
    for (const Element element : {Element::full, Element::mean_dilatation}) {
      const Grid grid{{0.0, 0.0, 0.0}, {0.3, 0.3, 0.3}, {1, 1, 1}};
      const double exact = 0.3 * std::sqrt(2.0 / young * (1.0 - 2.0 * poisson));
      EXPECT_NEAR(block_of(grid, poisson, element).critical_step(), exact, 1e-10 * exact) << poisson;
    }
}

}  // namespace
}  // namespace ilaw::host
