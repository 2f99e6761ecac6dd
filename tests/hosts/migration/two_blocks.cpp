// two_blocks.cpp - an explicit code with MPI: an elastic block falls on another one, and slides.
//
// Plane strain without Poisson's ratio, bilinear elements, lumped mass, central differences. Every rank has
// all nodes, and some of the elements and contacts; nodal forces are summed over ranks. Contact is a penalty
// with Coulomb friction. Usage: two_blocks SLIP_SPEED STIFFNESS
// SPDX-License-Identifier: BSD-3-Clause
#include <mpi.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

namespace {

using std::size_t;
using vec = std::array<double, 2>;
constexpr double density = 1000.0, young = 1e7, friction = 0.3, fall = 1.0, width = 0.2, height = 1.0;
constexpr double wave_speed = 100.0, first_gap = 1e-3, cfl = 0.8, end = 0.025;
constexpr double rim = 1e-3;   // of an edge, by which it goes on
constexpr double creep = 0.3;  // slip speed below which friction is viscous, so that it is stable

vec operator+(vec a, vec b) { return {a[0] + b[0], a[1] + b[1]}; }
vec operator-(vec a, vec b) { return {a[0] - b[0], a[1] - b[1]}; }
vec operator*(double s, vec a) { return {s * a[0], s * a[1]}; }
double dot(vec a, vec b) { return a[0] * b[0] + a[1] * b[1]; }

struct pair {  // of a point and the closest edge
  size_t edge;
  double gap;
  vec normal;                    // into the upper block
  std::array<double, 2> weight;  // of the nodes of the edge
};

struct element {
  std::array<std::int32_t, 4> node;
  vec size;
};

class two_blocks {
 public:
  two_blocks(double slip_speed, double stiffness) : stiffness_(stiffness) {
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks_);
    add_block(4, 20, -height);
    first_above_ = x_0_.size();
    add_block(5, 25, first_gap);
    u_.resize(x_0_.size());
    v_.resize(x_0_.size());
    f_.resize(x_0_.size());
    std::fill(v_.begin() + static_cast<std::ptrdiff_t>(first_above_), v_.end(), vec{slip_speed, -fall});
    h_ = cfl * 0.04 / wave_speed / std::sqrt(2.0);
    h_ = std::min(h_, cfl * std::sqrt(*std::min_element(mass_.begin(), mass_.end()) / stiffness));
  }

  void run() {
    const double kinetic = kinetic_energy();
    for (; time_ < end; time_ += h_, ++steps_) {
      for (size_t i = 0; i < u_.size(); ++i) u_[i] = u_[i] + h_ * v_[i];
      std::fill(f_.begin(), f_.end(), vec{});
      stored_ = 0.0;
      for (size_t e = static_cast<size_t>(rank_); e < elements_.size(); e += static_cast<size_t>(ranks_))
        add_forces(elements_[e]);
      add_contact();
      sum_over_ranks(f_.data()->data(), 2 * f_.size());
      for (size_t i = 0; i < v_.size(); ++i) v_[i] = v_[i] + h_ / mass_[i] * f_[i];
    }
    report(kinetic);
  }

 private:
  // A block of nx by ny elements whose lower side is at y; its nodes are numbered along x first.
  void add_block(std::int32_t nx, std::int32_t ny, double y) {
    const auto first = static_cast<std::int32_t>(x_0_.size()), row = nx + 1;
    const vec size{width / nx, height / ny};
    for (std::int32_t j = 0; j <= ny; ++j)
      for (std::int32_t i = 0; i <= nx; ++i) x_0_.push_back({i * size[0], y + j * size[1]});
    mass_.resize(x_0_.size());
    for (std::int32_t j = 0; j < ny; ++j)
      for (std::int32_t i = 0; i < nx; ++i) {
        const std::int32_t k = first + i + j * row;
        elements_.push_back({{k, k + 1, k + row + 1, k + row}, size});
        for (std::int32_t n : elements_.back().node)
          mass_[static_cast<size_t>(n)] += density * size[0] * size[1] / 4;
      }
    const bool is_above = first > 0;
    for (std::int32_t i = 0; i < nx + is_above; ++i) {
      if (is_above)
        points_.push_back(first + i);
      else  // with the points on its right
        edges_.insert(edges_.end(), {ny * row + i + 1, ny * row + i});
    }
  }

  vec place(std::int32_t node) const {
    return x_0_[static_cast<size_t>(node)] + u_[static_cast<size_t>(node)];
  }

  void add_forces(const element& e) {
    const double g = 1.0 / std::sqrt(3.0), area = e.size[0] * e.size[1] / 4;
    constexpr std::array<vec, 4> corner{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
    for (const vec at : corner) {
      std::array<vec, 4> slope;
      double xx = 0.0, yy = 0.0, xy = 0.0;
      for (size_t a = 0; a < 4; ++a) {
        const vec c = corner[a], moved = u_[static_cast<size_t>(e.node[a])];
        slope[a] = {c[0] * (1 + c[1] * g * at[1]) / 2 / e.size[0],
                    c[1] * (1 + c[0] * g * at[0]) / 2 / e.size[1]};
        xx += young * slope[a][0] * moved[0];
        yy += young * slope[a][1] * moved[1];
        xy += young / 2 * (slope[a][1] * moved[0] + slope[a][0] * moved[1]);
      }
      stored_ += area * (xx * xx + yy * yy + 2 * xy * xy) / 2 / young;
      for (size_t a = 0; a < 4; ++a)
        f_[static_cast<size_t>(e.node[a])] =
            f_[static_cast<size_t>(e.node[a])] -
            area * vec{xx * slope[a][0] + xy * slope[a][1], xy * slope[a][0] + yy * slope[a][1]};
    }
  }

  pair closest(std::int32_t point) const {
    const vec x = place(point);
    pair best{0, 1e30, {}, {}};
    for (size_t e = 0; e < edges_.size() / 2; ++e) {
      const vec a = place(edges_[2 * e]), along = place(edges_[2 * e + 1]) - a;
      const double s = dot(x - a, along) / dot(along, along), length = std::sqrt(dot(along, along));
      const vec normal = {along[1] / length, -along[0] / length};
      const double gap = dot(x - a, normal);
      if (s >= -rim && s <= 1.0 + rim && gap < best.gap) best = {e, gap, normal, {1.0 - s, s}};
    }
    return best;
  }

  void add_contact() {
    for (size_t k = static_cast<size_t>(rank_); k < points_.size(); k += static_cast<size_t>(ranks_)) {
      const pair found = closest(points_[k]);
      if (found.gap >= 0.0) continue;
      deepest_ = std::min(deepest_, found.gap);
      const auto point = static_cast<size_t>(points_[k]);
      const auto node = [&](size_t c) { return static_cast<size_t>(edges_[2 * found.edge + c]); };
      const vec slip = v_[point] - found.weight[0] * v_[node(0)] - found.weight[1] * v_[node(1)];
      const vec tangent{found.normal[1], -found.normal[0]};
      const double press = -stiffness_ * found.gap,
                   rub = -friction * press * std::clamp(dot(slip, tangent) / creep, -1.0, 1.0);
      const vec force = press * found.normal + rub * tangent;
      f_[point] = f_[point] + force;
      for (size_t c = 0; c < 2; ++c) f_[node(c)] = f_[node(c)] - found.weight[c] * force;
    }
  }

  // Values of all nodes: a rank has added its part. All ranks get the same bits.
  static void sum_over_ranks(double* values, size_t count) {
    MPI_Allreduce(MPI_IN_PLACE, values, static_cast<int>(count), MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
  }

  double kinetic_energy() const {
    double sum = 0.0;
    for (size_t i = 0; i < v_.size(); ++i) sum += mass_[i] / 2 * dot(v_[i], v_[i]);
    return sum;
  }

  void report(double kinetic) {
    sum_over_ranks(&stored_, 1);
    MPI_Allreduce(MPI_IN_PLACE, &deepest_, 1, MPI_DOUBLE, MPI_MIN, MPI_COMM_WORLD);
    vec below{}, above{};
    for (size_t i = 0; i < v_.size(); ++i) {
      vec& mean = i < first_above_ ? below : above;
      mean = mean + mass_[i] / (density * width * height) * v_[i];
    }
    if (rank_ == 0)
      std::printf("steps %d  penetration %.3e  below %.17g %.17g  above %.17g %.17g  lost %.12g\n", steps_,
                  -deepest_, below[0], below[1], above[0], above[1], kinetic - kinetic_energy() - stored_);
  }

  std::vector<vec> x_0_, u_, v_, f_;
  std::vector<double> mass_;
  std::vector<element> elements_;
  std::vector<std::int32_t> points_, edges_;  // of the upper block; two nodes each, of the lower one
  size_t first_above_ = 0;
  double stiffness_, h_ = 0.0, time_ = 0.0, deepest_ = 0.0, stored_ = 0.0;
  int rank_ = 0, ranks_ = 1, steps_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  if (argc == 3) two_blocks(std::atof(argv[1]), std::atof(argv[2])).run();
  MPI_Finalize();
  return argc == 3 ? 0 : 2;
}
