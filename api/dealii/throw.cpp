// throw - a block is thrown on a plane, or glued to it and peeled off: mpirun -n 2 ./dealii_throw --law rccm
// SPDX-License-Identifier: BSD-3-Clause
#include <deal.II/base/conditional_ostream.h>
#include <deal.II/base/mpi.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "law.hpp"
#include "plane_contact.hpp"

namespace {

using dealii::Utilities::MPI::max;
using dealii::Utilities::MPI::sum;

struct options {
  std::string law = "coulomb", out;
  block_options block;
  double step = 0.0, end = 0.4, gap = 0.013, pull = 10.0;
};

// Central differences. The errors are relative to the largest energy or work so far; both are identities.
class throw_run {
 public:
  throw_run(const block& body, const options& given, double h)
      : body_(body), contact_(body, create_law(given.law), h, given.gap), h_(h), pull_(given.pull) {
    for (auto* made : {&u_, &v_, &before_, &internal_, &mean_}) *made = body.make_vector();
    lift_ = body.areas(block::pulled_side);
    for (const block::node& at : body.nodes())
      for (unsigned c = 0; c < 3; ++c) {
        const bool is_hanging = body.inverse_mass().local_element(at.dof) == 0.0;
        const std::array<double, 3> thrown{{0.5, 0.0, -1.0}};
        if (given.gap > 0.0 && !is_hanging) v_.local_element(at.dof + c) = thrown[c];
        if (c < 2) lift_.local_element(at.dof + c) = 0.0;
      }
    start_ = largest_ = kinetic();
  }

  void step() {
    const distributed_vector u_before = u_;
    u_.add(h_, v_);
    body_.forces(u_, internal_);
    check_energy(u_before);
    const double traction = pull_ * ++steps_ * h_;
    before_ = v_;
    mean_ = internal_;
    mean_.sadd(-h_, h_ * traction, lift_);
    mean_.scale(body_.inverse_mass());
    v_ += mean_;

    const std::clock_t began = std::clock();
    contact_.apply(u_, before_, v_, steps_ * h_);
    seconds_of_law_ += static_cast<double>(std::clock() - began) / CLOCKS_PER_SEC;

    mean_ = before_;
    mean_.sadd(0.5, 0.5, v_);
    internal_work_ -= h_ * (internal_ * mean_);
    outside_work_ += h_ * traction * (lift_ * mean_) + sum(contact_.work(), MPI_COMM_WORLD);
  }

  double balance() const { return balance_ / largest_; }
  double identity() const { return identity_ / largest_; }
  double seconds_of_law() const { return seconds_of_law_; }
  const plane_contact& contact() const { return contact_; }
  double kinetic() {
    mean_ = v_;
    mean_.scale(body_.mass());
    return 0.5 * (mean_ * v_);
  }

  void write(const std::string& folder) {
    distributed_vector nodal = body_.make_vector();
    contact_.fill(nodal);
    body_.write(u_, nodal, {"status", "gap", "state"}, folder);
    std::vector<std::array<double, 12>> rows;
    for (const auto& [dof, place] : body_.nodes()) {
      if (body_.inverse_mass().local_element(dof) == 0.0) continue;
      std::array<double, 12>& row = rows.emplace_back();
      for (unsigned c = 0; c < 3; ++c) {
        row[c] = place[c];
        row[3 + c] = u_.local_element(dof + c);
        row[6 + c] = v_.local_element(dof + c);
        row[9 + c] = nodal.local_element(dof + c);
      }
    }
    const auto of_ranks = dealii::Utilities::MPI::gather(MPI_COMM_WORLD, rows);
    if (of_ranks.empty() || dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) != 0) return;
    std::ofstream file(folder + "/nodes.csv");
    file.precision(std::numeric_limits<double>::max_digits10);
    file << "x,y,z,ux,uy,uz,vx,vy,vz,status,gap,state\n";
    for (const auto& of_rank : of_ranks)
      for (const auto& row : of_rank)
        for (std::size_t c = 0; c < row.size(); ++c) file << row[c] << (c + 1 < row.size() ? ',' : '\n');
  }

 private:
  // balance: kinetic energy against the works of all forces. identity: v M v/2 + u_n K u_n+1/2 against those
  // from outside (linear materials).
  void check_energy(const distributed_vector& u_before) {
    const double energy = kinetic(), stored = 0.5 * (u_before * internal_);
    largest_ = std::max({largest_, energy, std::abs(stored), std::abs(outside_work_)});
    balance_ = std::max(balance_, std::abs(energy - start_ - internal_work_ - outside_work_));
    identity_ = std::max(identity_, std::abs(energy + stored - start_ - outside_work_));
  }

  const block& body_;
  plane_contact contact_;
  double h_, pull_;
  distributed_vector u_, v_, before_, internal_, mean_, lift_;
  int steps_ = 0;
  double start_, largest_, internal_work_ = 0.0, outside_work_ = 0.0, balance_ = 0.0, identity_ = 0.0;
  double seconds_of_law_ = 0.0;
};

options read(int argc, char** argv) {
  options given;
  CLI::App app("A block is thrown on a plane (contact, coulomb), or glued to it and peeled off (rccm)");
  app.add_option("--law", given.law)
      ->check(CLI::IsMember({"contact", "coulomb", "rccm"}))
      ->capture_default_str();
  app.add_option("--cells", given.block.cells, "along an edge of length 1")->capture_default_str();
  app.add_option("--refine", given.block.refinements, "times, the cells at the plane")->capture_default_str();
  app.add_option("--poisson", given.block.poisson)->capture_default_str();
  app.add_option("--dt", given.step, "default: 0.9 of the critical step");
  app.add_option("--end", given.end)->capture_default_str();
  app.add_option("--out", given.out, "folder for block.vtu and nodes.csv");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::exit(app.exit(error));
  }
  if (given.law == "rccm")
    given.gap = 0.0;
  else
    given.pull = 0.0;
  return given;
}

void run(const options& given) {
  const block body(given.block);
  const double h = given.step > 0.0 ? given.step : 0.9 * body.critical_step();
  throw_run thrown(body, given, h);
  const auto steps = std::lround(given.end / h);
  const std::clock_t began = std::clock();
  for (long n = 0; n < steps; ++n) thrown.step();
  const double seconds = static_cast<double>(std::clock() - began) / CLOCKS_PER_SEC;
  if (!given.out.empty()) {
    std::filesystem::create_directories(given.out);
    thrown.write(given.out);
  }
  const std::size_t nodes = sum(body.nodes().size(), MPI_COMM_WORLD);
  const std::size_t at_plane = sum(thrown.contact().size(), MPI_COMM_WORLD);
  const double milliseconds = 1e3 * max(seconds, MPI_COMM_WORLD) / static_cast<double>(steps);
  const double share = max(thrown.seconds_of_law() / seconds, MPI_COMM_WORLD);
  const unsigned ranks = dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD);
  const bool is_first = dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0;
  dealii::ConditionalOStream(std::cout, is_first)
      << "ranks " << ranks << "\nnodes " << nodes << "\ninterface_nodes " << at_plane << "\ndt " << h
      << "\nsteps " << steps << "\nbalance " << thrown.balance() << "\nidentity " << thrown.identity()
      << "\nmilliseconds_per_step " << milliseconds << "\nshare_of_law " << share << std::endl;
}
}  // namespace

int main(int argc, char** argv) {
  const options given = read(argc, argv);
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  try {
    run(given);
  } catch (const std::exception& refused) {
    std::cerr << "dealii_throw: " << refused.what() << std::endl;
    MPI_Abort(MPI_COMM_WORLD, 1);  // the other ranks wait in a collective call
  }
}
