// 1e5 random frictional contacts beside the solvers of Siconos (numerics): who finds a solution, how exactly,
// how fast.
#include "draw.hpp"
#include "natural_map.hpp"
#include "support/law_batch.hpp"

#include <cstdio>
#include <ctime>

extern "C" {
#include <FrictionContactProblem.h>
#include <Friction_cst.h>
#include <NonSmoothDrivers.h>
#include <NumericsMatrix.h>
#include <SolverOptions.h>
#include <fc3d_Solvers.h>
}

namespace ilaw::testing {
namespace {

using kit::local_coulomb;

std::vector<local_coulomb> random_problems(int count, double friction) {
  Draw draw(31);
  std::vector<local_coulomb> problems(static_cast<std::size_t>(count));
  for (local_coulomb& p : problems) {
    draw.fill_coupled(p, 0.05);
    draw.fill_pressed_velocity(p, 1.0);
    p.mu[0] = p.mu[1] = friction;
  }
  return problems;
}

double relative_residual(const local_coulomb& p, const double* r) {
  return static_cast<double>(natural_map_residual(p, r) / norm({p.q[0], p.q[1], p.q[2]}));
}

// One contact in Siconos's terms: a column-major 3x3.
class SiconosContact {
 public:
  explicit SiconosContact(int solver) : options_(solver_options_create(solver)) {
    options_->dparam[SICONOS_DPARAM_TOL] = 1e-24;  // acts on the squared residual
    options_->iparam[SICONOS_IPARAM_MAX_ITER] = 1000;
    problem_ =
        frictionContactProblem_new_with_data(3, 1, NM_create_from_data(NM_DENSE, 3, 3, matrix_), q_, &mu_);
  }
  ~SiconosContact() {
    problem_->M->matrix0 = problem_->q = problem_->mu = nullptr;  // they are this object's
    frictionContactProblem_free(problem_);
    solver_options_delete(options_);
    std::free(options_);  // which Siconos 4.4 clears only, whatever its header says
  }
  SiconosContact(const SiconosContact&) = delete;
  SiconosContact& operator=(const SiconosContact&) = delete;

  int solve(const local_coulomb& p, double* r) {
    const double full[] = {p.h[0], p.h[3], p.h[4], p.h[3], p.h[1], p.h[5], p.h[4], p.h[5], p.h[2]};
    std::copy(full, full + 9, matrix_);
    std::copy(p.q, p.q + 3, q_);
    mu_ = p.mu[0];
    double v[3] = {};
    std::fill(r, r + 3, 0.0);
    return fc3d_driver(problem_, r, v, options_);
  }

 private:
  SolverOptions* options_;
  FrictionContactProblem* problem_;
  double matrix_[9], q_[3], mu_;
};

// Time of this process alone: other work on the machine does not count.
class Stopwatch {
 public:
  double nanoseconds() const {
    return 1e9 * static_cast<double>(std::clock() - start_) / static_cast<double>(CLOCKS_PER_SEC);
  }

 private:
  std::clock_t start_ = std::clock();
};

TEST(Siconos, FindsTheSameSolutionsLessExactly) {
  const std::vector<local_coulomb> problems = random_problems(100000, 0.3);
  std::vector<std::array<double, 3>> ours(problems.size()), theirs(problems.size());
  const Stopwatch own_watch;
  for (std::size_t k = 0; k < problems.size(); ++k)
    ASSERT_NE(kit::solve(problems[k], ours[k].data()), kit::contact_mode::none) << "k " << k;
  const double own_time = own_watch.nanoseconds() / static_cast<double>(problems.size());
  SiconosContact siconos(SICONOS_FRICTION_3D_ONECONTACT_NSN_GP);
  const Stopwatch their_watch;
  for (std::size_t k = 0; k < problems.size(); ++k) siconos.solve(problems[k], theirs[k].data());
  const double their_time = their_watch.nanoseconds() / static_cast<double>(problems.size());
  double worst = 0.0;
  int failed = 0, compared = 0, elsewhere = 0;
  for (std::size_t k = 0; k < problems.size(); ++k) {
    worst = std::max(worst, relative_residual(problems[k], ours[k].data()));
    const double residual = relative_residual(problems[k], theirs[k].data());
    failed += residual > 1e-8;
    if (residual > 1e-11) continue;
    ++compared;
    double distance = 0.0;
    for (std::size_t c = 0; c < 3; ++c) distance = std::max(distance, std::abs(ours[k][c] - theirs[k][c]));
    elsewhere += distance > 1e-6 * (1.0 + ours[k][0]);
  }
  EXPECT_LE(worst, 1e-14);
  EXPECT_GT(compared, 90000);
  EXPECT_LE(elsewhere, 5);  // where several solutions exist, as in one draw of 1e5
  std::printf(
      "natural-map residual over |q|: ours at most %.2g; Siconos above 1e-8 in %d; other solutions %d\n",
      worst, failed, elsewhere);
  std::printf("ns per problem: ours %.0f, Siconos %.0f\n", own_time, their_time);
}

// All problems as one batch of the law coulomb: contacts that touch, and move as their velocity says.
LawBatch batch_of(const std::vector<local_coulomb>& problems, double friction) {
  LawBatch batch(make_law("coulomb", SetupBuilder({{{"friction", friction}}, {}}, 3, ILAW_DELASSUS_FULL)),
                 problems.size());
  batch.velocity_step = batch.position_step = 1.0;
  batch.gap.assign(problems.size(), -1.0);
  for (std::size_t i = 0; i < problems.size(); ++i) {
    std::copy_n(problems[i].q, 3, batch.v_free[i].begin());
    std::copy_n(problems[i].h, 6, batch.h[i].begin());
  }
  batch.v_previous = batch.v_free;
  return batch;
}

TEST(Siconos, SolversBesideTheLaw) {
  const std::vector<local_coulomb> problems = random_problems(100000, 0.3);
  const auto count = static_cast<double>(problems.size());
  LawBatch batch = batch_of(problems, 0.3);
  ASSERT_EQ(batch.evaluate(), ILAW_OK);  // and the arrays are in reach
  constexpr int repetitions = 10;
  const Stopwatch own_watch;
  for (int k = 0; k < repetitions; ++k) batch.evaluate();
  const double own_time = own_watch.nanoseconds() / count / repetitions;
  double worst = 0.0;
  for (std::size_t k = 0; k < problems.size(); ++k)
    worst = std::max(worst, relative_residual(problems[k], batch.r[k].data()));
  EXPECT_LE(worst, 1e-14);
  std::printf("coulomb: %.0f ns per contact, residual over |q| at most %.2g\n", own_time, worst);

  struct Solver {
    const char* name;
    int id;
  };
  constexpr Solver solvers[] = {
      {"NSN", SICONOS_FRICTION_3D_ONECONTACT_NSN},
      {"NSN_GP", SICONOS_FRICTION_3D_ONECONTACT_NSN_GP},
      {"NSN_GP_HYBRID", SICONOS_FRICTION_3D_ONECONTACT_NSN_GP_HYBRID},
      {"QUARTIC", SICONOS_FRICTION_3D_ONECONTACT_QUARTIC},
      {"QUARTIC_NU", SICONOS_FRICTION_3D_ONECONTACT_QUARTIC_NU},
      {"iterated projection", SICONOS_FRICTION_3D_ONECONTACT_ProjectionOnConeWithLocalIteration}};
  for (const Solver& solver : solvers) {
    SiconosContact siconos(solver.id);
    std::array<double, 3> r{};
    int failed = 0;
    const Stopwatch watch;
    for (const local_coulomb& p : problems) {
      siconos.solve(p, r.data());
      failed += !(relative_residual(p, r.data()) <= 1e-8);
    }
    const double time = watch.nanoseconds() / count;
    std::printf("Siconos %s: %.0f ns, %.1f times that, fails on %d\n", solver.name, time, time / own_time,
                failed);
  }
}

}  // namespace
}  // namespace ilaw::testing
