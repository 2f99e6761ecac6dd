// Conditions and energy of every law for each form of H, on half a million random steps each. `ilaw check`
// has what holds for any law: the frame, units, mirrors, layouts, tables.
//
// A case of the section "properties" names the "statuses" that must occur, and what its law is:
//   friction, friction_2   the cone that its impulse stays in; 0
//   restitution            of all directions; 0
//   inertia                "isotropic" where it has a solution for no other H; any
//   is_rigid               stops what it bonds or closes; true
//   is_predictive          acts on the next gap; false
//   keeps_energy           its energy is not the scheme's to bound; true
//   sees_past_motion       its energy belongs to a path, of which v^- is the end; false
#include "laws/random_nodes.hpp"

#include "support/sizes.hpp"

#include <set>
#include <tuple>

namespace ilaw::testing {
namespace {

constexpr std::size_t node_count = 500, steps = 50;
constexpr int histories = 5;  // in 2D and 3D together up to a quarter of a million random steps

struct Law {
  explicit Law(const LawCase& given)
      : law(given.law),
        parameters(given.parameters),
        statuses(given.more.at("statuses").get<std::vector<std::string>>()),
        friction(given.more.value("friction", 0.0)),
        friction_2(given.more.value("friction_2", friction)),
        restitution(given.more.value("restitution", 0.0)),
        inertia(inertia_of(given)),
        is_rigid(given.more.value("is_rigid", true)),
        is_predictive(given.more.value("is_predictive", false)),
        keeps_energy(given.more.value("keeps_energy", true)),
        sees_past_motion(given.more.value("sees_past_motion", false)) {}

  std::string law;
  Parameters parameters;
  std::vector<std::string> statuses;
  double friction, friction_2, restitution;
  Inertia inertia;
  bool is_rigid, is_predictive, keeps_energy, sees_past_motion;
};

int status_of(const std::string& name) {
  static const std::map<std::string, int> statuses = {
      {"free", ILAW_FREE},     {"closed", ILAW_CLOSED}, {"stick", ILAW_STICK},  {"slip", ILAW_SLIP},
      {"bonded", ILAW_BONDED}, {"broken", ILAW_BROKEN}, {"healed", ILAW_HEALED}};
  return statuses.at(name);
}

// Signorini, the cone, and maximum dissipation in it: no impulse of the cone takes more from the slip u_T
// than r_N |(mu_1 u_1, mu_2 u_2)|.
void expect_contact(const Law& law, bool open, const Vector& r, const Vector& u, double tolerance) {
  if (open || r[0] == 0.0) {
    ASSERT_EQ(r, (Vector{}));
    ASSERT_TRUE(open || u[0] >= -tolerance) << u[0];
    return;
  }
  ASSERT_GT(r[0], 0.0);
  ASSERT_NEAR(u[0], 0.0, tolerance);
  if (law.friction == 0.0) {
    ASSERT_EQ(std::hypot(r[1], r[2]), 0.0);
    return;
  }
  ASSERT_LE(std::hypot(r[1] / law.friction, r[2] / law.friction_2), r[0] * (1.0 + 8 * ulp));
  const double most = r[0] * std::hypot(law.friction * u[1], law.friction_2 * u[2]);
  ASSERT_NEAR(-(r[1] * u[1] + r[2] * u[2]), most, tolerance * length(r));
}

class AnyLaw : public ::testing::TestWithParam<Combination> {
 protected:
  // Histories that start unloaded, open or just closed; the gap follows the motion. Velocities are drawn
  // anew, without external force (v_free = v^-); on the path of a law that sees one they change by random
  // kicks.
  template <class Evaluate>
  void follow(Runner& run, Evaluate evaluate) {
    const int count = part_of(histories);
    for (int history = 0; history < count && !HasFailure(); ++history) {
      for (double& gap : nodes.gap) gap = nodes.uniform(0.0, 4.0) * RandomNodes::step;
      std::fill(run.v.begin(), run.v.end(), Vector{});
      run.initialise();
      for (std::size_t k = 0; k < steps && !HasFailure(); ++k) {
        draw_motion(run.v);
        run.time += RandomNodes::step;
        evaluate(k);
        for (std::size_t i = 0; i < nodes.count; ++i) nodes.gap[i] += RandomNodes::step * run.v[i][0];
      }
    }
  }

  void draw_motion(const std::vector<Vector>& v) {
    nodes.draw();
    nodes.v_previous = law.sees_past_motion ? v : nodes.v_free;
    for (std::size_t i = 0; i < nodes.count && law.sees_past_motion; ++i)
      for (std::size_t c = 0; c < 3; ++c) nodes.v_free[i][c] += v[i][c];
  }

  // Size of what cancels in v_free + H r.
  double natural_velocity(std::size_t i, const Vector& r) const {
    const Matrix& h = nodes.h[i];
    double size = 0.0;
    for (std::size_t a = 0; a < nodes.dimension; ++a) {
      size += std::abs(nodes.v_free[i][a]);
      for (std::size_t b = 0; b < nodes.dimension; ++b) size += std::abs(h[a][b] * r[b]);
    }
    return size;
  }

  void expect_equations(const Runner& run, std::size_t i) const {
    const Vector &r = run.r[i], &v = run.v[i];
    const int status = run.status[i];
    const double tolerance = 16 * ulp * natural_velocity(i, r);
    Vector u = v;
    for (std::size_t c = 0; c < 3; ++c) u[c] += law.restitution * nodes.v_previous[i][c];
    if (law.is_predictive) u[0] += std::max(nodes.gap[i], 0.0) / RandomNodes::step;
    if (status == ILAW_FREE) {
      ASSERT_EQ(r, (Vector{}));
    }
    if (status == ILAW_BONDED && law.is_rigid) {
      ASSERT_LE(length(v), 2.0 * tolerance);
    } else if (law.is_rigid) {
      expect_contact(law, !law.is_predictive && nodes.gap[i] > 0.0, r, u, tolerance);
      ASSERT_TRUE(status != ILAW_STICK || std::hypot(u[1], u[2]) <= 2.0 * tolerance);
    } else if (status != ILAW_BONDED && status != ILAW_BROKEN) {
      ASSERT_GE(r[0], 0.0);
      ASSERT_LE(std::hypot(r[1], r[2]), law.friction * r[0] * (1.0 + 8 * ulp));
    }
  }

  // The impulse takes from the kinetic energy at least what the interface stores more than before; no part
  // that dissipates is negative.
  void expect_no_energy_created(const Runner& run, std::size_t i, double stored) const {
    const Vector& r = run.r[i];
    for (std::size_t part = 0; part < ILAW_ENERGY_STORED; ++part) ASSERT_GE(run.energy[i][part], 0.0);
    if (!law.keeps_energy) return;
    const double work = 0.5 * (dot(r, nodes.v_previous[i]) + dot(r, run.v[i]));
    const double now = run.energy[i][ILAW_ENERGY_STORED];
    const double natural = length(r) * (natural_velocity(i, r) + length(nodes.v_previous[i]));
    ASSERT_LE(work + now - stored, 32 * ulp * (natural + std::abs(now) + std::abs(stored)));
  }

  const Law law{std::get<0>(GetParam())};
  RandomNodes nodes{node_count, std::get<2>(GetParam()), std::get<1>(GetParam()), law.inertia, 11};
};

TEST_P(AnyLaw, KeepsItsConditions) {
  Runner run(law.law, law.parameters, nodes);
  std::array<int, ILAW_STATUS_COUNT> seen{};
  std::vector<double> stored(nodes.count);
  follow(run, [&](std::size_t k) {
    if (k == 0) std::fill(stored.begin(), stored.end(), 0.0);
    ASSERT_EQ(run.evaluate(), ILAW_OK) << run.report.reason;
    for (std::size_t i = 0; i < nodes.count; ++i) {
      ++seen[run.status[i]];
      expect_equations(run, i);
      expect_no_energy_created(run, i, stored[i]);
      stored[i] = run.energy[i][ILAW_ENERGY_STORED];
    }
  });
  for (const std::string& status : law.statuses)
    EXPECT_GT(seen[static_cast<std::size_t>(status_of(status))], 40 * part_of(histories)) << status;
}

// A node that was stopped leaves with the rounding of its free velocity, which is no slip.
TEST_P(AnyLaw, TakesRoundingForRest) {
  constexpr std::size_t few_steps = 5;
  Runner run(law.law, law.parameters, nodes), rounded(law.law, law.parameters, nodes);
  follow(run, [&](std::size_t k) {
    if (k >= few_steps) return;
    for (Vector& v : nodes.v_previous) v[1] = v[2] = 0.0;
    ASSERT_EQ(run.evaluate(), ILAW_OK) << run.report.reason;
    for (std::size_t i = 0; i < nodes.count; ++i)
      for (std::size_t c = 1; c < nodes.dimension; ++c) nodes.v_previous[i][c] = 2 * ulp * nodes.v_free[i][c];
    rounded.state = run.before;
    rounded.time = run.time;
    ASSERT_EQ(rounded.evaluate(), ILAW_OK) << rounded.report.reason;
    for (std::size_t i = 0; i < nodes.count; ++i)
      for (std::size_t c = 0; c < 3; ++c)
        ASSERT_NEAR(run.r[i][c], rounded.r[i][c], 1e-9 * (1.0 + length(run.r[i])));
  });
}

INSTANTIATE_TEST_SUITE_P(Laws, AnyLaw, ::testing::ValuesIn(combinations_of(law_cases("properties"))),
                         name_of_combination);

// A law without cases would be left out of all this, and of the tests of the kit.
TEST(EveryLaw, BringsItsCases) {
  for (const std::string& law : laws_of_tree())
    for (const char* section : {"contract", "properties", "benchmarks"})
      EXPECT_FALSE(section_of(law, section).empty())
          << "tests/laws/" << law << "/cases.json has no section " << section;
}

}  // namespace
}  // namespace ilaw::testing
