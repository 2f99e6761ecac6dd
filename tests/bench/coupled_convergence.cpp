// Iterations and seconds that coupled contacts take to a residual of 1e-4 and of 1e-8, on problems in files.
//
// Usage: ilaw_bench_coupled_convergence [--limit SECONDS] FILE...
// A file is of FCLIB (*.hdf5, the group fclib_local) or a text as Siconos writes it (FrictionContactProblem):
// the dimension 3, the number of contacts, the matrix W as dense (0) or in sparse 3 x 3 blocks (1),
// velocities without impulses q, coefficients of friction. W is made symmetric and scaled to a mean diagonal
// of 1. The residual is that of Siconos: the natural map over |q|. The solver knows bodies, so W is factored
// into B B', and a column of three is a body that gives way alike in all directions; rows of B are the
// weights of a contact.
// SPDX-License-Identifier: BSD-3-Clause
#include "problem_files.hpp"

#include <ilaw/arrays.hpp>
#include <ilaw/coupled.hpp>
#include <ilaw/loader.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

namespace {

class Benchmark {
 public:
  Benchmark(const Problem& problem, const std::vector<Row>& b, const ilaw::library& library);
  struct Solved {
    double seconds, residual;
    ilaw_coupled_report report;
  };
  Solved solve(double tolerance, std::uint32_t iterations);

 private:
  const Problem& problem_;
  ilaw::interface law_;
  ilaw::coupled solver_;
  std::uint32_t width_ = 1;
  std::vector<std::int32_t> body_, wall_;
  std::vector<double> weight_, still_, velocity_, against_, normal_, impulse_;
};

ilaw::interface friction_law(const Problem& problem, const ilaw::library& library) {
  const bool is_one = std::adjacent_find(problem.friction.begin(), problem.friction.end(),
                                         std::not_equal_to<>()) == problem.friction.end();
  ilaw_argument friction{};
  friction.struct_size = sizeof friction;
  friction.kind = is_one ? ILAW_KIND_VALUE_NUMBER : ILAW_KIND_VALUE_PER_NODE;
  friction.name = "friction";
  friction.number = problem.friction.front();
  const ilaw_argument* arguments[] = {&friction};
  ilaw_setup setup{};
  setup.struct_size = sizeof setup;
  setup.dimension = 3;
  setup.delassus_form = ILAW_DELASSUS_FULL;
  setup.frame = ILAW_FRAME_GLOBAL;
  setup.numbers = ILAW_NUMBERS_DOUBLE;
  setup.arguments = arguments;
  setup.argument_count = 1;
  return {library, "", setup};
}

Benchmark::Benchmark(const Problem& problem, const std::vector<Row>& b, const ilaw::library& library)
    : problem_(problem), law_(friction_law(problem, library)) {
  const auto count = static_cast<std::size_t>(problem.contacts);
  std::vector<std::map<int, std::array<double, 9>>> blocks(count);
  for (std::size_t k = 0; k < count; ++k) {
    for (std::size_t row = 0; row < 3; ++row)
      for (const auto& [column, value] : b[3 * k + row])
        blocks[k]
            .try_emplace(column / 3, std::array<double, 9>{})
            .first->second[3 * row + static_cast<std::size_t>(column % 3)] = value;
    width_ = std::max(width_, static_cast<std::uint32_t>(blocks[k].size()));
  }
  for (const auto& of_contact : blocks) {
    for (const auto& [body, block] : of_contact) {
      body_.push_back(body);
      weight_.insert(weight_.end(), block.begin(), block.end());
    }
    body_.resize((body_.size() + width_ - 1) / width_ * width_, -1);
    weight_.resize(9 * body_.size());
    normal_.insert(normal_.end(), {1.0, 0.0, 0.0});
  }
  wall_.assign(count, -1);
  still_.assign(3 * count, 0.0);
  velocity_ = impulse_ = still_;
  for (const double x : problem.q) against_.push_back(-x);
}

Benchmark::Solved Benchmark::solve(double tolerance, std::uint32_t iterations) {
  const double one = 1.0, gap = 0.0;
  const ilaw_input friction = ilaw::input(problem_.friction.data(), 1, 0);
  ilaw_batch batch{};
  batch.struct_size = sizeof batch;
  batch.node_count = problem_.contacts;
  batch.time = batch.velocity_step = batch.position_step = 1.0;
  batch.gap = ilaw::input(&gap, 0, 0);
  batch.normal = ilaw::input(normal_.data(), 3, 1);
  batch.impulse = ilaw::output(impulse_.data(), 3, 1);
  batch.per_node_parameters = &friction;
  ilaw_bodies bodies{};
  bodies.struct_size = sizeof bodies;
  bodies.dimension = 3;
  bodies.count = bodies.owned_count = problem_.contacts;
  bodies.inverse_mass = ilaw::input(&one, 0, 0);
  bodies.v_free = bodies.v_previous = ilaw::input(still_.data(), 3, 1);
  bodies.velocity = ilaw::output(velocity_.data(), 3, 1);
  ilaw_contacts contacts = ilaw::contacts_of(law_, ILAW_DELASSUS_FULL, batch, body_.data(), wall_.data());
  contacts.wall_velocity = ilaw::input(against_.data(), 3, 1);
  contacts.wall_previous = ilaw::input(still_.data(), 3, 1);  // no velocity before: nothing bounces
  contacts.body_count = width_;
  contacts.body_weight = ilaw::input(weight_.data(), 9 * std::int64_t{width_}, 1);
  contacts.weight_size = 9;
  ilaw_coupled_options options{};
  options.tolerance = tolerance;
  options.most_sweeps = iterations;
  ilaw_coupled_report report{};
  const double seconds = mean_seconds([&] {
    std::fill(impulse_.begin(), impulse_.end(), 0.0);
    report = solver_.solve(bodies, contacts, options);
  });
  return {seconds, natural_map(problem_, impulse_), report};
}

// Tolerances of the solver are tried from coarse to fine: its residual is another one than that of the table.
void print_row(const char* name, Problem& problem, const ilaw::library& library, double limit) {
  static const char* const methods[] = {"Gauss-Seidel", "conjugate", "Anderson", "Douglas-Rachford",
                                        "Newton"};
  const std::vector<Row> b = factor(problem);
  const double changed = make_semidefinite(problem, b);
  Benchmark benchmark(problem, b, library);
  std::printf("%-36s %6d %9.1e %8.1e", name, problem.contacts, problem.asymmetry, changed);
  const double per_iteration = benchmark.solve(1e-300, 50).seconds / 50.0;
  const auto most = static_cast<std::uint32_t>(std::min(1e6, 1.0 + limit / per_iteration));
  double least = 1e300, tolerance = 1e-3;
  const char* method = "";
  for (const double target : {1e-4, 1e-8}) {
    bool reached = false;
    for (double spent = 0.0; !reached && tolerance > 1e-15 && spent < limit; tolerance *= 0.1) {
      const Benchmark::Solved solved = benchmark.solve(tolerance, most);
      least = std::min(least, solved.residual);
      method = methods[solved.report.method];
      spent = solved.seconds;
      if (!(solved.residual < target) || solved.seconds > limit) continue;
      reached = true;
      std::printf(" %8u %9.5f", solved.report.sweeps, solved.seconds);
    }
    if (!reached) std::printf(" %8s %9s", "-", "-");
  }
  std::printf(" %9.1e  %s\n", least, method);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  ProblemFiles files;
  if (const auto code = files.parse(argc, argv, "Iterations and seconds of coupled contacts to a residual"))
    return *code;
  const ilaw::library library("coulomb");
  std::printf("%-36s %6s %9s %8s %8s %9s %8s %9s %9s  %s\n", "problem", "count", "W - W'", "W by", "to 1e-4",
              "s", "to 1e-8", "s", "residual", "method");
  files.for_each([&](const std::string& name, Problem& problem) {
    print_row(name.c_str(), problem, library, files.limit);
  });
  return 0;
}
