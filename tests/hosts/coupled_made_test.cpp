// Problems made from their solutions: whatever ilaw/coupled.h calls solved is audited by the laws alone, by
// the momentum of the bodies and by work, in the scale of the velocities that it was given. Since a solution
// exists, no laws may be said to push against each other without end.
//
// ILAW_MADE_SEED and ILAW_MADE_PROBLEMS: another seed, and the number of problems of a kind.
// SPDX-License-Identifier: BSD-3-Clause
#include "stress/made_problem.hpp"

#include "support/law_runner.hpp"
#include "support/sizes.hpp"

#include <chrono>
#include <memory>

namespace ilaw::testing {
namespace coupled_made {
namespace {

using ilaw::host::Draw;
using ilaw::host::MadeAudit;
using ilaw::host::MadeProblem;
using ilaw::host::MadeSetup;

using Numbers = std::map<std::string, double>;
struct Law {
  std::string name;
  Numbers numbers;
  std::map<std::string, std::string> choices{};
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
  const auto pressed = [](MadeSetup& s) { s.normals = MadeSetup::Normals::pressed, s.mass_decades = 3.8; };
  const auto rounded = [](MadeSetup& s) { s.rounds_gaps = true; };
  const std::vector<Law> moreau{{"contact", {}, {{"activation", "moreau"}}},
                                {"coulomb", {{"restitution", 0.5}}, {{"activation", "moreau"}}}};
  const auto held = [](MadeSetup& s) { s.no_freedom = 0.3; };
  const auto turning = [](MadeSetup& s) { s.rotate = true; };
  const auto facets = [](MadeSetup& s) { s.ends = 4; };
  const auto axes = [](MadeSetup& s) { s.ends = 4, s.has_axes = true; };
  const auto turning_facets = [](MadeSetup& s) { s.ends = 3, s.rotate = true; };
  const std::vector<Law> rolling{{"rolling", {{"rolling_friction", 0.02}, {"twisting_friction", 0.01}}}};
  const std::vector<Law> bouncing{{"contact", {{"restitution", 0.6}}},
                                  {"coulomb", {{"restitution", 0.8}, {"tangential_restitution", 0.3}}}};
  constexpr ilaw_delassus_form transverse = ILAW_DELASSUS_TRANSVERSE, spins = ILAW_DELASSUS_TRANSVERSE_SPIN;
  constexpr ilaw_delassus_form scalar = ILAW_DELASSUS_SCALAR, full = ILAW_DELASSUS_FULL;
  return {
      {"two_contacts", scalar, friction, sized(1, 2), 0.05},
      {"three_contacts", scalar, friction, sized(1, 3), 0.05},
      {"four_contacts", scalar, friction, sized(1, 4), 0.05},
      {"two_bodies", scalar, friction, sized(2, 4), 0.05},
      {"five_bodies", scalar, friction, sized(5, 12), 0.1},
      {"twenty_bodies", scalar, friction, sized(20, 50), 0.25},
      {"two_wedged", scalar, friction, with(sized(1, 2), wedged), 0.05},
      {"four_wedged", scalar, friction, with(sized(2, 4), wedged), 0.05},
      {"redundant", scalar, friction, with(sized(3, 12), redundant), 0.1},
      {"six_decades_few", scalar, friction, with(sized(5, 12), six_decades), 0.15},
      {"six_decades", scalar, friction, with(sized(20, 50), six_decades), 0.45},
      {"pressed", scalar, friction, with(sized(4, 6), pressed), 0.3},
      {"rounded_gaps", scalar, moreau, with(sized(5, 9), rounded), 0.1},
      {"held_axes", full, friction, with(sized(2, 4), held), 0.1},
      {"held_axes_many", full, friction, with(sized(20, 50), held), 0.45},
      {"turning", full, friction, with(sized(5, 12), turning), 0.1},
      {"spheres", transverse, friction, sized(5, 12), 0.15},
      {"rolling", spins, rolling, sized(5, 12), 0.15},
      {"facets", scalar, friction, with(sized(12, 12), facets), 0.1},
      {"facets_of_axes", full, friction, with(sized(12, 12), axes), 0.1},
      {"facets_that_turn", full, friction, with(sized(9, 12), turning_facets), 0.1},
      {"bouncing", scalar, {bouncing[0]}, sized(5, 12), 0.1},
      {"bouncing_spheres", transverse, bouncing, sized(5, 12), 0.1},
      {"impacts", scalar, {{"impact", {{"restitution", 0.7}}}}, sized(5, 9), 0.3},
      {"one_point", scalar, friction, sized(2, 1), 0.0},
      {"one_turning", full, friction, with(sized(2, 1), turning), 0.0},
      {"one_sphere", transverse, friction, sized(2, 1), 0.0},
      {"one_rolling", spins, rolling, sized(2, 1), 0.0},
      {"one_facet", scalar, friction, with(sized(8, 1), facets), 0.0},
      {"one_of_axes", full, friction, with(sized(8, 1), axes), 0.0},
      {"bonds", scalar, bonds, sized(5, 9), 0.1},
      {"softening", scalar, softening, sized(5, 12), 0.3},
      {"two_hundred", scalar, friction, sized(80, 200), 0.6},
  };
}

ilaw::interface made_law(const Law& law, ilaw_delassus_form form, double mu) {
  Numbers numbers = law.numbers;
  if (law.name == "coulomb" || law.name == "rolling" || law.name == "impact") numbers["friction"] = mu;
  return make_law(law.name, SetupBuilder({numbers, law.choices}, 3, form, ILAW_FRAME_GLOBAL));
}

int number(const char* name, int otherwise) {
  const char* given = std::getenv(name);
  return given ? std::atoi(given) : otherwise;
}

// Problem k of a kind.
struct Drawn {
  Drawn(const Kind& kind, int seed, int k) {
    Draw draw(static_cast<std::uint64_t>(seed) * 1000003U + static_cast<std::uint64_t>(k));
    MadeSetup setup = kind.setup;
    if (!setup.rounds_gaps) setup.gap = std::vector<double>{0.0, 1e-6, 0.1}[static_cast<std::size_t>(k % 3)];
    const double mu = std::vector<double>{0.1, 0.5, 1.0, 2.0}[static_cast<std::size_t>(k / 3 % 4)];
    for (const Law& law : kind.laws) laws.push_back(made_law(law, kind.form, mu));
    std::vector<const ilaw::interface*> pointers;
    for (const ilaw::interface& law : laws) pointers.push_back(&law);
    problem = std::make_unique<MadeProblem>(pointers, kind.form, setup, draw);
  }
  std::vector<ilaw::interface> laws;
  std::unique_ptr<MadeProblem> problem;
};

struct Counts {
  int problems = 0, wrong = 0, momentum = 0, work = 0, opposed = 0, unsolved = 0, ill_posed = 0;
  double worst = 0.0, sweeps = 0.0;
};

class MadeOf : public ::testing::TestWithParam<Kind> {};

TEST_P(MadeOf, IsSolvedInTheScaleOfItsInput) {
  const Kind& kind = GetParam();
  const bool is_large = kind.setup.contacts > 100;
  const int first_seed = number("ILAW_MADE_SEED", 1),
            problems = number("ILAW_MADE_PROBLEMS", is_large ? part_of(24) : 24);
  const bool prints = std::getenv("ILAW_MADE_PRINTS") != nullptr;
  Counts counts;
  ilaw::coupled solver;
  const auto start = std::chrono::steady_clock::now();
  for (int k = 0; k < problems; ++k) {
    Drawn drawn(kind, first_seed, k);
    MadeProblem& problem = *drawn.problem;
    const MadeAudit made = problem.audit_of_solution();
    if (made.residual > 1e-9) {  // a law whose answer is not known to that: no measure
      ++counts.ill_posed;
      continue;
    }
    ASSERT_LE(made.momentum, 1e-12) << k;
    ilaw_coupled_options options{};
    options.tolerance = k % 3 != 1 && k % 2 ? 1e-6 : 1e-10;  // which closes no gap of 1e-6
    const double most = 10.0 * options.tolerance;
    const ilaw_coupled_report report = problem.solve(solver, options);
    const MadeAudit found = problem.audit(report);
    ++counts.problems;
    counts.sweeps += report.sweeps;
    counts.opposed += report.law != nullptr;
    // With its own H a contact alone is solved in the first iteration, and the second one sees that.
    EXPECT_TRUE(kind.setup.contacts > 1 || report.sweeps <= 2) << k << ": " << report.sweeps;
    counts.momentum += !report.message && found.momentum > 1e-9;
    counts.work += found.work > 1e-9;
    if (report.message)
      ++counts.unsolved;
    else if (found.residual > most) {
      ++counts.wrong;
      counts.worst = std::max(counts.worst, found.residual / most);
    }
    if (prints && (report.message || found.residual > most))
      std::printf("  %d: residual %.1e says %.1e, sweeps %u, method %u: %s\n", k, found.residual,
                  report.residual, report.sweeps, report.method, report.message ? report.message : "solved");
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::printf(
      "%-16s %6d problems: wrong %d (%.1e), momentum %d, work %d, opposed %d, unsolved %d; %.1f iterations, %.2f s\n",
      kind.name.c_str(), counts.problems, counts.wrong, counts.worst, counts.momentum, counts.work,
      counts.opposed, counts.unsolved, counts.sweeps / counts.problems, seconds);
  EXPECT_LE(counts.ill_posed, 0.1 * problems);  // most of them with restitution
  EXPECT_EQ(counts.wrong, 0);
  EXPECT_EQ(counts.momentum, 0);
  EXPECT_EQ(counts.work, 0);
  EXPECT_EQ(counts.opposed, 0);
  EXPECT_LE(counts.unsolved, kind.unsolved * counts.problems);
}

INSTANTIATE_TEST_SUITE_P(Problems, MadeOf, ::testing::ValuesIn(kinds()),
                         [](const auto& kind) { return kind.param.name; });

// Iterations leave out contacts that are out of reach. Where the last of them solves the others, and one has
// come within reach, nothing is solved: 214 said so of impulses that the audit finds off by 1.8 of the scale.
TEST(Made, ABudgetThatEndsIsNoSolution) {
  const std::vector<Kind> all = kinds();
  for (const Kind& kind : all) {
    if (kind.setup.contacts > 12) continue;
    int solved = 0;
    for (int k = 203; k < 215; ++k)
      for (const std::uint32_t most : {1U, 3U, 10U, 30U, 300U}) {
        Drawn drawn(kind, 2, k);
        if (drawn.problem->audit_of_solution().residual > 1e-9) continue;
        ilaw::coupled solver;
        ilaw_coupled_options options{};
        options.most_sweeps = most;
        const ilaw_coupled_report report = drawn.problem->solve(solver, options);
        if (report.message) continue;
        ++solved;
        EXPECT_LE(drawn.problem->audit(report).residual, 1e-8) << kind.name << ' ' << k << ' ' << most;
      }
    EXPECT_GT(solved, 0) << kind.name;
  }
}

// A tie that moved before does no work in one direction alone: impulses that grow without end in the other
// one are no proof that laws contradict each other. These problems have a solution that the iterations do not
// find.
TEST(Made, TiesThatMovedBeforeAreNotBlamed) {
  const std::vector<Kind> all = kinds();
  const auto bonds = std::find_if(all.begin(), all.end(), [](const Kind& k) { return k.name == "bonds"; });
  for (const int k : {783, 1263, 1329, 4110, 5376, 5727, 7493, 15021}) {
    Drawn drawn(*bonds, 52001, k);
    ilaw::coupled solver;
    EXPECT_EQ(drawn.problem->solve(solver, {}).law, nullptr) << k;
  }
}

// Union and split: what is found of problems that share no body is found of both together, in either order.
TEST(Made, TogetherAreAsEachAlone) {
  const ilaw::interface law = made_law({"contact", {}}, ILAW_DELASSUS_SCALAR, 0.0);  // velocities are unique
  const auto made = [&](int bodies, int contacts, std::uint64_t seed) {
    Draw draw(seed);
    MadeSetup setup;
    setup.bodies = bodies;
    setup.contacts = contacts;
    return MadeProblem({&law}, ILAW_DELASSUS_SCALAR, setup, draw);
  };
  int unsolved = 0, stalled = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed)
    for (const std::uint32_t most : {1000U, 150U, 40U}) {
      MadeProblem one = made(20, 50, 1000 + seed), other = made(2, 3, 2000 + seed);
      MadeProblem both = one, turned = other;
      both.add(other);
      turned.add(one);
      ilaw_coupled_options options{};
      options.most_sweeps = most;
      ilaw::coupled solver;
      const ilaw_coupled_report a = one.solve(solver, options);
      const bool a_message = a.message != nullptr;
      const ilaw_coupled_report b = other.solve(solver, options);
      const bool b_message = b.message != nullptr;
      unsolved += a_message || b_message;
      stalled += a.stalled || b.stalled;
      for (MadeProblem* problem : {&both, &turned}) {
        const ilaw_coupled_report found = problem->solve(solver, options);
        EXPECT_EQ(found.message != nullptr, a_message || b_message) << seed << ", " << most;
        EXPECT_EQ(found.bad_count, a.bad_count + b.bad_count);
        EXPECT_EQ(found.bad_group, -1);
        EXPECT_EQ(found.law, nullptr);
        EXPECT_EQ(found.other_law, nullptr);
        EXPECT_EQ(found.worst_contact >= 0, a_message || b_message);
        if (a_message || b_message) {
          EXPECT_GE(found.island_contacts, 1);
          EXPECT_LE(found.island_contacts, 50);
          EXPECT_GE(found.mass_ratio, 1.0);
        } else {
          const std::vector<double> v = problem->velocities(), v_a = one.velocities(),
                                    v_b = other.velocities();
          const std::vector<double>&first = problem == &both ? v_a : v_b,
                &second = problem == &both ? v_b : v_a;
          for (std::size_t i = 0; i < v.size(); ++i)
            EXPECT_NEAR(v[i], i < first.size() ? first[i] : second[i - first.size()], 1e-5) << seed;
          EXPECT_LE(problem->audit(found).work, 1e-9);
          EXPECT_LE(found.energy_error, 1e-8);
        }
      }
    }
  EXPECT_GT(unsolved, 0);
  EXPECT_GE(unsolved, stalled);
}

}  // namespace
}  // namespace coupled_made
}  // namespace ilaw::testing
