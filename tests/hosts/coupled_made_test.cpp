// Problems made from their solutions: whatever ilaw/coupled.h calls solved is audited by the laws alone, by
// the momentum of the bodies and by work, in the scale of the velocities that it was given. Since a solution
// exists, no laws may be called incompatible.
//
// ILAW_MADE_SEED and ILAW_MADE_PROBLEMS: another seed, and the number of problems of a kind.
// SPDX-License-Identifier: BSD-3-Clause
#include "stress/made_problem.hpp"

#include "coupled_scene.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

namespace {

using ilaw::host::Draw;
using ilaw::host::MadeAudit;
using ilaw::host::MadeProblem;
using ilaw::host::MadeSetup;

struct Law {
  std::string name;
  std::vector<std::pair<const char*, double>> numbers;
};

struct Kind {
  std::string name;
  ilaw_delassus_form form;
  std::vector<Law> laws;
  MadeSetup setup;
  double unsolved;  // largest part of the problems that may stay unsolved
};

std::vector<Kind> kinds() {
  const auto sized = [](int bodies, int contacts) {
    MadeSetup setup;
    setup.bodies = bodies;
    setup.contacts = contacts;
    return setup;
  };
  const auto with = [](MadeSetup setup, auto change) {
    change(setup);
    return setup;
  };
  const std::vector<Law> friction{{"coulomb", {}}};
  const std::vector<Law> bonds{{"coulomb", {}}, {"contact", {}}, {"tie", {}}};
  const std::vector<Law> softening{
      {"coulomb", {}},
      {"postit", {{"adhesion_limit", 2.0}, {"initial_adhesion", 0.5}, {"memory", 0.01}}},
      {"cohesive", {{"strength", 500.0}, {"toughness", 4.0}, {"friction", 0.4}}}};
  const auto six_decades = [](MadeSetup& s) { s.mass_decades = 6.0; };
  const auto wedged = [](MadeSetup& s) { s.normals = MadeSetup::Normals::wedged; };
  const auto redundant = [](MadeSetup& s) { s.normals = MadeSetup::Normals::redundant; };
  const auto held = [](MadeSetup& s) { s.no_freedom = 0.3; };
  const auto turning = [](MadeSetup& s) { s.rotate = true; };
  constexpr ilaw_delassus_form scalar = ILAW_DELASSUS_SCALAR, full = ILAW_DELASSUS_FULL;
  return {
      {"two_contacts", scalar, friction, sized(1, 2), 0.02},
      {"three_contacts", scalar, friction, sized(1, 3), 0.02},
      {"four_contacts", scalar, friction, sized(1, 4), 0.02},
      {"two_bodies", scalar, friction, sized(2, 4), 0.02},
      {"five_bodies", scalar, friction, sized(5, 12), 0.02},
      {"twenty_bodies", scalar, friction, sized(20, 50), 0.05},
      {"two_wedged", scalar, friction, with(sized(1, 2), wedged), 0.02},
      {"four_wedged", scalar, friction, with(sized(2, 4), wedged), 0.02},
      {"redundant", scalar, friction, with(sized(3, 12), redundant), 0.05},
      {"six_decades_few", scalar, friction, with(sized(5, 12), six_decades), 0.05},
      {"six_decades", scalar, friction, with(sized(20, 50), six_decades), 0.3},
      {"held_axes", full, friction, with(sized(2, 4), held), 0.05},
      {"held_axes_many", full, friction, with(sized(20, 50), held), 0.3},
      {"turning", full, friction, with(sized(5, 12), turning), 0.05},
      {"spheres", ILAW_DELASSUS_TRANSVERSE, friction, sized(5, 12), 0.05},
      {"rolling",
       ILAW_DELASSUS_TRANSVERSE_SPIN,
       {{"rolling", {{"rolling_friction", 0.02}, {"twisting_friction", 0.01}}}},
       sized(5, 12),
       0.1},
      {"bonds", scalar, bonds, sized(5, 9), 0.05},
      {"softening", scalar, softening, sized(5, 12), 0.2},
      {"two_hundred", scalar, friction, sized(80, 200), 0.1},
  };
}

ilaw::interface made_law(const Law& law, ilaw_delassus_form form, double mu) {
  std::vector<std::pair<const char*, double>> numbers = law.numbers;
  if (law.name == "coulomb" || law.name == "rolling") numbers.emplace_back("friction", mu);
  return coupled_scene::create(law.name, form, numbers);
}

int number(const char* name, int otherwise) {
  const char* given = std::getenv(name);
  return given ? std::atoi(given) : otherwise;
}

struct Counts {
  int problems = 0, wrong = 0, momentum = 0, work = 0, incompatible = 0, unsolved = 0, ill_posed = 0;
  double worst = 0.0;
};

class Made : public ::testing::TestWithParam<Kind> {};

TEST_P(Made, IsSolvedInTheScaleOfItsInput) {
  const Kind& kind = GetParam();
  const int first_seed = number("ILAW_MADE_SEED", 1), problems = number("ILAW_MADE_PROBLEMS", 24);
  const bool prints = std::getenv("ILAW_MADE_PRINTS") != nullptr;
  Counts counts;
  ilaw::coupled solver;
  const auto start = std::chrono::steady_clock::now();
  for (int k = 0; k < problems; ++k) {
    Draw draw(static_cast<std::uint64_t>(first_seed) * 1000003U + static_cast<std::uint64_t>(k));
    MadeSetup setup = kind.setup;
    setup.gap = std::vector<double>{0.0, 1e-6, 0.1}[static_cast<std::size_t>(k % 3)];
    const double mu = std::vector<double>{0.1, 0.5, 1.0, 2.0}[static_cast<std::size_t>(k / 3 % 4)];
    std::vector<ilaw::interface> laws;
    for (const Law& law : kind.laws) laws.push_back(made_law(law, kind.form, mu));
    std::vector<const ilaw::interface*> pointers;
    for (const ilaw::interface& law : laws) pointers.push_back(&law);
    MadeProblem problem(pointers, kind.form, setup, draw);
    const MadeAudit made = problem.audit_of_solution();
    if (made.residual > 1e-9) {  // a law whose answer is not known to that: no measure
      ++counts.ill_posed;
      continue;
    }
    ASSERT_LE(made.momentum, 1e-12) << k;
    const ilaw_coupled_report report = problem.solve(solver, {});
    const MadeAudit found = problem.audit(report);
    ++counts.problems;
    counts.incompatible += report.law != nullptr;
    counts.momentum += found.momentum > 1e-9;
    counts.work += found.work > 1e-9;
    if (report.message)
      ++counts.unsolved;
    else if (found.residual > 1e-8) {
      ++counts.wrong;
      counts.worst = std::max(counts.worst, found.residual);
    }
    if (prints && (report.message || found.residual > 1e-8))
      std::printf("  %d: residual %.1e says %.1e, sweeps %u, method %u: %s\n", k, found.residual,
                  report.residual, report.sweeps, report.method, report.message ? report.message : "solved");
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::printf(
      "%-16s %6d problems: wrong %d (%.1e), momentum %d, work %d, incompatible %d, unsolved %d; %.2f s\n",
      kind.name.c_str(), counts.problems, counts.wrong, counts.worst, counts.momentum, counts.work,
      counts.incompatible, counts.unsolved, seconds);
  EXPECT_LE(counts.ill_posed, 0.05 * problems);
  EXPECT_EQ(counts.wrong, 0);
  EXPECT_EQ(counts.momentum, 0);
  EXPECT_EQ(counts.work, 0);
  EXPECT_EQ(counts.incompatible, 0);
  EXPECT_LE(counts.unsolved, kind.unsolved * counts.problems);
}

INSTANTIATE_TEST_SUITE_P(Problems, Made, ::testing::ValuesIn(kinds()),
                         [](const auto& kind) { return kind.param.name; });

}  // namespace
