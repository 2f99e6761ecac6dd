// pair - a deformable block is thrown on another one: mpirun -n 4 ./dealii_pair --law coulomb
// SPDX-License-Identifier: BSD-3-Clause
#include <deal.II/base/conditional_ostream.h>
#include <deal.II/base/mpi.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <fstream>
#include <iostream>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "law.hpp"
#include "pair_contact.hpp"

namespace {

using dealii::Utilities::MPI::max;
using dealii::Utilities::MPI::sum;

struct options {
  std::string law = "coulomb", out;
  unsigned cells = 4;
  double step = 0.0, end = 0.3;
};

// The lower block is larger, and its mesh does not match.
block_options upper_block(unsigned cells) {
  block_options made;
  made.size = {1.0, 1.0, 0.5};
  made.corner = {0.3173, 0.2291, 0.513};
  made.cells = cells;
  return made;
}
block_options lower_block(unsigned cells) {
  block_options made;
  made.size = {1.7, 1.5, 0.5};
  made.cells = cells + 1;
  return made;
}

// A block in central differences: u at whole steps, v at half steps.
class moving_block {
 public:
  moving_block(const block& body, const std::array<double, 3>& velocity) : body_(body) {
    for (auto* made : {&u_, &v_, &before_, &internal_, &scratch_}) *made = body.make_vector();
    for (const block::node& at : body.nodes())
      for (unsigned c = 0; c < 3; ++c) v_.local_element(at.dof + c) = velocity[c];
  }

  // Moves and kicks without the interface. Returns v M v/2 + u_n K u_n+1/2, which only the interface changes.
  double step(double h) {
    before_ = u_;
    u_.add(h, v_);
    body_.forces(u_, internal_);
    const double energy = kinetic() + 0.5 * (before_ * internal_);
    before_ = v_;
    scratch_ = internal_;
    scratch_.scale(body_.inverse_mass());
    v_.add(-h, scratch_);
    return energy;
  }

  pair_contact::motion motion() { return {u_, before_, v_}; }
  double kinetic() {
    scratch_ = v_;
    scratch_.scale(body_.mass());
    return 0.5 * (scratch_ * v_);
  }
  std::array<double, 3> momentum() const {
    std::array<double, 3> total{};
    for (const block::node& at : body_.nodes())
      for (unsigned c = 0; c < 3; ++c)
        total[c] += body_.mass().local_element(at.dof + c) * v_.local_element(at.dof + c);
    for (double& component : total) component = sum(component, MPI_COMM_WORLD);
    return total;
  }
  std::vector<std::array<double, 9>> rows() const {  // places, displacements and velocities
    std::vector<std::array<double, 9>> own;
    for (const block::node& at : body_.nodes()) {
      auto& row = own.emplace_back();
      for (unsigned c = 0; c < 3; ++c) {
        row[c] = at.place[c];
        row[3 + c] = u_.local_element(at.dof + c);
        row[6 + c] = v_.local_element(at.dof + c);
      }
    }
    return own;
  }

 private:
  const block& body_;
  distributed_vector u_, v_, before_, internal_, scratch_;
};

class pair_run {
 public:
  pair_run(const block& upper, const block& lower, const std::string& law, double h)
      : blocks_{{moving_block(upper, {{0.5, 0.2, -1.0}}), moving_block(lower, {{0.0, 0.0, 0.0}})}},
        contact_(upper, lower, create_law(law), h),
        h_(h),
        start_(blocks_[0].kinetic()),
        momentum_(blocks_[0].momentum()) {}

  void step() {
    const double energy = blocks_[0].step(h_) + blocks_[1].step(h_);
    identity_ = std::max(identity_, std::abs(energy - start_ - work_) / start_);
    const std::clock_t began = std::clock();
    work_ += contact_.apply({{blocks_[0].motion(), blocks_[1].motion()}}, ++steps_ * h_);
    seconds_ += static_cast<double>(std::clock() - began) / CLOCKS_PER_SEC;
  }

  double momentum_error() const {
    const auto upper = blocks_[0].momentum(), lower = blocks_[1].momentum();
    double error = 0.0;
    for (unsigned c = 0; c < 3; ++c) error = std::max(error, std::abs(upper[c] + lower[c] - momentum_[c]));
    return error / std::abs(momentum_[2]);
  }
  const pair_contact& contact() const { return contact_; }
  double identity() const { return identity_; }
  double work() const { return work_ / start_; }
  int steps() const { return steps_; }
  double milliseconds() const { return 1e3 * max(seconds_, MPI_COMM_WORLD) / steps_; }

  void write(const std::string& path) const {
    std::ofstream file;
    if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0) file.open(path);
    file.precision(std::numeric_limits<double>::max_digits10);
    file << "x,y,z,ux,uy,uz,vx,vy,vz\n";
    for (const moving_block& body : blocks_)
      for (const auto& of_rank : dealii::Utilities::MPI::gather(MPI_COMM_WORLD, body.rows()))
        for (const auto& row : of_rank)
          for (std::size_t c = 0; c < row.size(); ++c) file << row[c] << (c + 1 < row.size() ? ',' : '\n');
  }

 private:
  std::array<moving_block, 2> blocks_;
  pair_contact contact_;
  double h_;
  int steps_ = 0;
  double start_, work_ = 0.0, identity_ = 0.0, seconds_ = 0.0;
  std::array<double, 3> momentum_;
};

options read(int argc, char** argv) {
  options given;
  CLI::App app("A deformable block is thrown on another one (contact, coulomb)");
  app.add_option("--law", given.law)->check(CLI::IsMember({"contact", "coulomb"}))->capture_default_str();
  app.add_option("--cells", given.cells, "along an edge of length 1")->capture_default_str();
  app.add_option("--dt", given.step, "default: 0.9 of the critical step");
  app.add_option("--end", given.end)->capture_default_str();
  app.add_option("--out", given.out, "file for the nodes, in CSV");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::exit(app.exit(error));
  }
  return given;
}

void run(const options& given) {
  const block upper(upper_block(given.cells)), lower(lower_block(given.cells));
  const double h =
      given.step > 0.0 ? given.step : 0.9 * std::min(upper.critical_step(), lower.critical_step());
  pair_run pair(upper, lower, given.law, h);
  const auto steps = std::lround(given.end / h);
  for (long n = 0; n < steps; ++n) pair.step();
  if (!given.out.empty()) pair.write(given.out);
  const double momentum = pair.momentum_error(), milliseconds = pair.milliseconds();
  const unsigned ranks = dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD);
  const bool is_first = dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0;
  dealii::ConditionalOStream out(std::cout, is_first);
  out << "ranks " << ranks << "\nsteps " << pair.steps() << "\nidentity " << pair.identity() << "\nmomentum "
      << momentum << "\nwork " << pair.work() << "\nmilliseconds_of_interface " << milliseconds;
  const char* names[] = {"upper", "lower"};
  for (unsigned k = 0; k < 2; ++k) {
    const block_side& side = pair.contact().sides()[k];
    out << "\nnodes_of_" << names[k] << ' ' << side.size() << "\nranks_of_" << names[k] << ' '
        << sum(side.dofs().empty() ? 0u : 1u, MPI_COMM_WORLD);
  }
  out << std::endl;
}
}  // namespace

int main(int argc, char** argv) {
  const options given = read(argc, argv);
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  try {
    run(given);
  } catch (const std::exception& refused) {
    std::cerr << "dealii_pair: " << refused.what() << std::endl;
    MPI_Abort(MPI_COMM_WORLD, 1);  // the other ranks wait in a collective call
  }
}
