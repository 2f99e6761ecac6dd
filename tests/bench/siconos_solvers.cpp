// Seconds that solvers of Siconos take to a residual of 1e-4 and of 1e-8, on problems in files.
//
// Usage: ilaw_bench_siconos_solvers [--limit SECONDS] FILE...
// Files, W and residual are those of ilaw_bench_coupled_convergence. A solver runs in a process of its own,
// since some do not return or crash. A row has the problem, the solver and the seconds to either residual.
// SPDX-License-Identifier: BSD-3-Clause
#include "problem_files.hpp"

#include <FrictionContactProblem.h>
#include <Friction_cst.h>
#include <NonSmoothDrivers.h>
#include <SiconosNumerics.h>
#include <SolverOptions.h>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace {

struct Solver {
  const char* name;
  int id;
};
constexpr Solver solvers[] = {{"NSGS", SICONOS_FRICTION_3D_NSGS},     {"NSGSV", SICONOS_FRICTION_3D_NSGSV},
                              {"PROX", SICONOS_FRICTION_3D_PROX},     {"TFP", SICONOS_FRICTION_3D_TFP},
                              {"NSN_AC", SICONOS_FRICTION_3D_NSN_AC}, {"DSFP", SICONOS_FRICTION_3D_DSFP},
                              {"FPP", SICONOS_FRICTION_3D_FPP},       {"EG", SICONOS_FRICTION_3D_EG},
                              {"NSN_FB", SICONOS_FRICTION_3D_NSN_FB}, {"ACLMFP", SICONOS_FRICTION_3D_ACLMFP},
                              {"NSN_NM", SICONOS_FRICTION_3D_NSN_NM}, {"PFP", SICONOS_FRICTION_3D_PFP},
                              {"ADMM", SICONOS_FRICTION_3D_ADMM}};

// As Siconos reads it: W in sparse blocks of 3 x 3, each by columns.
void write(const Problem& problem, const char* name) {
  std::ofstream file(name);
  file.precision(17);
  const int n = problem.contacts;
  std::vector<std::map<int, std::array<double, 9>>> blocks(static_cast<std::size_t>(n));
  std::size_t count = 0;
  for (std::size_t i = 0; i < problem.w.size(); ++i)
    for (const auto& [j, value] : problem.w[i])
      blocks[i / 3]
          .try_emplace(j / 3, std::array<double, 9>{})
          .first->second[3 * static_cast<std::size_t>(j % 3) + i % 3] = value;
  for (const auto& row : blocks) count += row.size();
  file << "3\n" << n << "\n1\n" << 3 * n << ' ' << 3 * n << '\n' << count << '\n' << n << ' ' << n << '\n';
  for (int side = 0; side < 2; ++side, file << '\n')
    for (int k = 1; k <= n; ++k) file << 3 * k << ' ';
  file << n + 1 << ' ' << count << '\n';
  std::size_t start = 0;
  for (const auto& row : blocks) {
    file << start << ' ';
    start += row.size();
  }
  file << start << '\n';
  for (const auto& row : blocks)
    for (const auto& entry : row) file << entry.first << ' ';
  file << '\n';
  std::size_t number = 0;
  for (const auto& row : blocks)
    for (const auto& entry : row) {
      file << number++ << '\n';
      for (const double value : entry.second) file << value << '\n';
    }
  for (const double value : problem.q) file << value << '\n';
  for (const double value : problem.friction) file << value << '\n';
}

struct Solved {
  double seconds = -1.0;  // not solved
};

// One solution from zero, in this process.
std::vector<double> solve_once(const Problem& problem, FrictionContactProblem* theirs, int id,
                               double tolerance) {
  SolverOptions* options = solver_options_create(id);
  options->iparam[SICONOS_IPARAM_MAX_ITER] = 10000000;
  options->dparam[SICONOS_DPARAM_TOL] = tolerance;
  std::vector<double> reaction(problem.w.size()), velocity(problem.w.size());
  fc3d_driver(theirs, reaction.data(), velocity.data(), options);
  solver_options_delete(options);
  return reaction;
}

// Tolerances are tried from coarse to fine, as with the solver of ilaw. Short solutions are repeated.
Solved solve(const Problem& problem, const char* file, int id, double target, double limit) {
  FrictionContactProblem* theirs = frictionContact_new_from_filename(file);
  for (double tolerance = target; tolerance > 1e-15; tolerance *= 0.1) {
    std::vector<double> reaction;
    const double seconds = mean_seconds([&] { reaction = solve_once(problem, theirs, id, tolerance); });
    if (natural_map(problem, reaction) < target && seconds < limit) return {seconds};
  }
  return {};
}

Solved solve_apart(const Problem& problem, const char* file, int id, double target, double limit) {
  int channel[2];
  if (pipe(channel) != 0) return {};
  std::fflush(stdout);  // else the child has a copy of it
  const pid_t child = fork();
  if (child == 0) {
    const auto most = static_cast<rlim_t>(std::ceil(limit));
    const rlimit processor{most, most};
    setrlimit(RLIMIT_CPU, &processor);
    if (std::freopen("/dev/null", "w", stdout) == nullptr ||
        std::freopen("/dev/null", "w", stderr) == nullptr)
      _exit(1);
    const Solved solved = solve(problem, file, id, target, limit);
    if (::write(channel[1], &solved, sizeof solved) != sizeof solved) _exit(1);
    _exit(0);
  }
  close(channel[1]);
  Solved solved;
  if (::read(channel[0], &solved, sizeof solved) != sizeof solved) solved = {};
  close(channel[0]);
  waitpid(child, nullptr, 0);
  return solved;
}

}  // namespace

int main(int argc, char** argv) {
  ProblemFiles files;
  if (const auto code =
          files.parse(argc, argv, "Seconds of Siconos' solvers to a residual of 1e-4 and of 1e-8"))
    return *code;
  char copy[] = "/tmp/ilaw_problem_XXXXXX.dat";  // without an extension Siconos does not read it
  const int handle = mkstemps(copy, 4);
  if (handle < 0) return 1;
  close(handle);
  files.for_each([&](const std::string& name, Problem& problem) {
    make_semidefinite(problem, factor(problem));
    write(problem, copy);
    for (const Solver& solver : solvers) {
      std::printf("%-36s %-8s", name.c_str(), solver.name);
      for (const double target : {1e-4, 1e-8}) {
        const Solved solved = solve_apart(problem, copy, solver.id, target, files.limit);
        solved.seconds < 0.0 ? std::printf(" %9s", "-") : std::printf(" %9.5f", solved.seconds);
      }
      std::printf("\n");
      std::fflush(stdout);
    }
  });
  std::remove(copy);
  return 0;
}
