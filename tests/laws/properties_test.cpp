// What every law keeps for each form of H, on a million random steps each: its conditions, the energy, the
// frame, the units; and the limits in which laws meet.
#include "laws/random_nodes.hpp"

#include <limits>
#include <map>
#include <ostream>
#include <string>
#include <tuple>

namespace ilaw::testing {
namespace {

constexpr double inf_value = std::numeric_limits<double>::infinity();
constexpr double ulp = std::numeric_limits<double>::epsilon();
constexpr std::size_t node_count = 1000, histories = 10, steps = 50;  // in 2D and 3D together: a million

struct Law {
  const char* name;
  const char* law;
  Parameters parameters;
  std::vector<int> statuses;  // that must occur
  double friction = 0.0, friction_2 = 0.0;
  double restitution = 0.0;  // of all directions
  Inertia inertia = Inertia::any;
  bool is_rigid = true;  // stops what it bonds or closes
  bool is_predictive = false;
  bool keeps_energy = true;
  bool sees_past_motion = false;  // its energy belongs to a path, of which v^- is the end
};

std::ostream& operator<<(std::ostream& out, const Law& law) { return out << law.name; }

const std::map<std::string, double> postit_numbers = {{"friction", 0.4},
                                                      {"adhesion_limit", 2.0},
                                                      {"efficiency_decrease", 20.0},
                                                      {"memory", 4.0 * RandomNodes::step},
                                                      {"tangent_influence", 0.8},
                                                      {"buckets", 4.0}};

const std::map<std::string, std::string> moreau{{"activation", "moreau"}};

const std::vector<Law> laws = {
    {.name = "contact", .law = "contact", .parameters = {{}, moreau}, .statuses = {ILAW_FREE, ILAW_CLOSED}},
    {.name = "contact_that_bounces",
     .law = "contact",
     .parameters = {{{"restitution", 0.6}}, moreau},
     .statuses = {ILAW_FREE, ILAW_CLOSED},
     .restitution = 0.6},
    {.name = "contact_predictive",
     .law = "contact",
     .parameters = {{}, {{"activation", "predictive"}}},
     .statuses = {ILAW_FREE, ILAW_CLOSED},
     .is_predictive = true},
    {.name = "coulomb",
     .law = "coulomb",
     .parameters = {{{"friction", 0.4}}, moreau},
     .statuses = {ILAW_FREE, ILAW_STICK, ILAW_SLIP},
     .friction = 0.4,
     .friction_2 = 0.4},
    {.name = "coulomb_predictive",
     .law = "coulomb",
     .parameters = {{{"friction", 0.4}}, {{"activation", "predictive"}}},
     .statuses = {ILAW_FREE, ILAW_STICK, ILAW_SLIP},
     .friction = 0.4,
     .friction_2 = 0.4,
     .is_predictive = true},
    {.name = "coulomb_elliptical",
     .law = "coulomb",
     .parameters = {{{"friction", 0.8}, {"friction_2", 0.2}}, moreau},
     .statuses = {ILAW_FREE, ILAW_STICK, ILAW_SLIP},
     .friction = 0.8,
     .friction_2 = 0.2},
    {.name = "coulomb_that_bounces",
     .law = "coulomb",
     .parameters = {{{"friction", 0.4}, {"restitution", 0.6}, {"tangential_restitution", 0.6}}, moreau},
     .statuses = {ILAW_FREE, ILAW_STICK, ILAW_SLIP},
     .friction = 0.4,
     .friction_2 = 0.4,
     .restitution = 0.6},
    {.name = "coulomb_that_decays",  // slips on less than the cone that it is checked against
     .law = "coulomb",
     .parameters = {{{"friction", 0.5}, {"kinetic_friction", 0.2}, {"decay", 3.0}}, moreau},
     .statuses = {ILAW_FREE, ILAW_STICK, ILAW_SLIP},
     .friction = 0.5,
     .friction_2 = 0.5,
     .is_rigid = false},
    {.name = "postit_saturated",  // its breaking step holds on up to the limit
     .law = "postit",
     .parameters = {postit_numbers, {{"rupture", "saturated"}}},
     .statuses = {ILAW_FREE, ILAW_BONDED, ILAW_BROKEN, ILAW_HEALED},
     .friction = 0.4,
     .friction_2 = 0.4,
     .is_rigid = false},
    {.name = "cohesive_camacho_ortiz",
     .law = "cohesive",
     .parameters = {{{"strength", 500.0}, {"toughness", 0.5}, {"strength_2", 800.0}, {"friction", 0.4}},
                    {{"shape", "camacho_ortiz"}}},
     .statuses = {ILAW_FREE, ILAW_STICK, ILAW_SLIP, ILAW_BONDED, ILAW_BROKEN},
     .friction = 0.4,
     .friction_2 = 0.4,
     .inertia = Inertia::isotropic,
     .is_rigid = false,
     .sees_past_motion = true},
    {.name = "postit",
     .law = "postit",
     .parameters = {postit_numbers, {}},
     .statuses = {ILAW_FREE, ILAW_BONDED, ILAW_BROKEN, ILAW_HEALED},
     .friction = 0.4,
     .friction_2 = 0.4},
    {.name = "tie",
     .law = "tie",
     .parameters = {{{"strength", 5.0}, {"memory", 4.0 * RandomNodes::step}, {"buckets", 4.0}}, {}},
     .statuses = {ILAW_FREE, ILAW_CLOSED, ILAW_BONDED, ILAW_BROKEN}},
    {.name = "tie_unbreakable", .law = "tie", .parameters = {}, .statuses = {ILAW_BONDED}},
    {.name = "penalty_implicit",
     .law = "penalty",
     .parameters = {{{"stiffness", 0x1p20}, {"tangential_stiffness", 0x1p18}, {"friction", 0.4}},
                    {{"integration", "implicit"}}},
     .statuses = {ILAW_FREE, ILAW_STICK, ILAW_SLIP},
     .friction = 0.4,
     .friction_2 = 0.4,
     .is_rigid = false},
    {.name = "penalty_hertz",
     .law = "penalty",
     .parameters = {{{"stiffness", 0x1p26}, {"exponent", 1.5}, {"damping", 100.0}},
                    {{"integration", "implicit"}}},
     .statuses = {ILAW_FREE, ILAW_CLOSED},
     .is_rigid = false},
    {.name = "penalty_explicit",  // its energy is the scheme's to bound, see its page
     .law = "penalty",
     .parameters = {{{"stiffness", 0x1p18}, {"tangential_stiffness", 0x1p18}, {"friction", 0.4}}, {}},
     .statuses = {ILAW_FREE, ILAW_STICK, ILAW_SLIP},
     .friction = 0.4,
     .friction_2 = 0.4,
     .is_rigid = false,
     .keeps_energy = false},
    {.name = "cohesive_bilinear",
     .law = "cohesive",
     .parameters = {{{"strength", 500.0}, {"toughness", 0.5}, {"friction", 0.4}}, {}},
     .statuses = {ILAW_FREE, ILAW_STICK, ILAW_SLIP, ILAW_BONDED, ILAW_BROKEN},
     .friction = 0.4,
     .friction_2 = 0.4,
     .inertia = Inertia::isotropic,
     .is_rigid = false,
     .sees_past_motion = true},
    {.name = "cohesive_mixed_mode",  // soft enough for one solution, see its page
     .law = "cohesive",
     .parameters = {{{"strength", 500.0},
                     {"toughness", 0.8},
                     {"strength_2", 900.0},
                     {"toughness_2", 1.6},
                     {"mixing_exponent", 2.0},
                     {"stiffness", 2e6},
                     {"delay_time", 0.25 * RandomNodes::step}},
                    {{"shape", "exponential"}}},
     .statuses = {ILAW_FREE, ILAW_BONDED, ILAW_BROKEN},
     .inertia = Inertia::isotropic,
     .is_rigid = false,
     .sees_past_motion = true}};

using Drawn = std::tuple<Law, std::uint32_t, std::uint32_t>;

std::string name_of(const ::testing::TestParamInfo<Drawn>& drawn) {
  const std::uint32_t form = std::get<1>(drawn.param);
  return std::string(std::get<0>(drawn.param).name) +
         (form == ILAW_DELASSUS_SCALAR     ? "_scalar_"
          : form == ILAW_DELASSUS_DIAGONAL ? "_diagonal_"
                                           : "_full_") +
         std::to_string(std::get<2>(drawn.param)) + "D";
}

double length(const Vector& a) { return std::sqrt(dot(a, a)); }

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

class AnyLaw : public ::testing::TestWithParam<Drawn> {
 protected:
  // Histories that start unloaded, open or just closed; the gap follows the motion. Velocities are drawn
  // anew, without external force (v_free = v^-); on the path of a law that sees one they change by random
  // kicks.
  template <class Evaluate>
  void follow(std::initializer_list<Runner*> runners, Evaluate evaluate) {
    Runner& first = **runners.begin();
    for (std::size_t history = 0; history < histories && !HasFailure(); ++history) {
      for (double& gap : nodes.gap) gap = nodes.uniform(0.0, 4.0) * RandomNodes::step;
      std::fill(first.v.begin(), first.v.end(), Vector{});
      for (Runner* runner : runners) runner->initialise();
      for (std::size_t k = 0; k < steps && !HasFailure(); ++k) {
        draw_motion(first.v);
        const double time = first.time + RandomNodes::step;
        for (Runner* runner : runners) runner->time = time;
        evaluate(k);
        for (std::size_t i = 0; i < nodes.count; ++i) nodes.gap[i] += RandomNodes::step * first.v[i][0];
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

  // The impulse takes from the kinetic energy at least what the interface stores more than before; no part of
  // the output is negative. A reaction that meets a node already moving away under a force may give back what
  // that force put in.
  void expect_no_energy_created(const Runner& run, std::size_t i, double stored) const {
    const Vector& r = run.r[i];
    for (const double part : run.energy[i]) ASSERT_GE(part, 0.0);
    if (!law.keeps_energy || (law.sees_past_motion && (r[0] > 0.0 || run.named("opening", i) == 0.0))) return;
    const double work = 0.5 * (dot(r, nodes.v_previous[i]) + dot(r, run.v[i]));
    const double now = run.energy[i][ILAW_ENERGY_STORED];
    const double natural = length(r) * (natural_velocity(i, r) + length(nodes.v_previous[i]));
    ASSERT_LE(work + now - stored, 32 * ulp * (natural + now + stored));
  }

  const Law& law = std::get<0>(GetParam());
  RandomNodes nodes{node_count, std::get<2>(GetParam()), std::get<1>(GetParam()), law.inertia, 11};
};

TEST_P(AnyLaw, KeepsItsConditions) {
  Runner run(law.law, law.parameters, nodes);
  std::array<int, ILAW_STATUS_COUNT> seen{};
  std::vector<double> stored(nodes.count);
  follow({&run}, [&](std::size_t k) {
    if (k == 0) std::fill(stored.begin(), stored.end(), 0.0);
    ASSERT_EQ(run.evaluate(), ILAW_OK) << run.report.reason;
    for (std::size_t i = 0; i < nodes.count; ++i) {
      ++seen[run.status[i]];
      expect_equations(run, i);
      expect_no_energy_created(run, i, stored[i]);
      stored[i] = run.energy[i][ILAW_ENERGY_STORED];
    }
  });
  for (const int status : law.statuses) EXPECT_GT(seen[static_cast<std::size_t>(status)], 500) << status;
}

// Mass, length and time in other units: the same bits, scaled, by the units that the law declares.
TEST_P(AnyLaw, IsTheSameInOtherUnits) {
  const Units units{0x1p+20, 0x1p-12, 0x1p+7};
  Runner run(law.law, law.parameters, nodes), scaled(law.law, law.parameters, nodes, false, units);
  follow({&run, &scaled}, [&](std::size_t) {
    ASSERT_EQ(run.evaluate(), ILAW_OK) << run.report.reason;
    ASSERT_EQ(scaled.evaluate(), ILAW_OK) << scaled.report.reason;
    ASSERT_EQ(run.status, scaled.status);
    for (std::size_t i = 0; i < nodes.count; ++i) {
      ASSERT_EQ(run.r[i], scaled.local(i, scaled.r[i], units.impulse()));
      ASSERT_EQ(run.v[i], scaled.local(i, scaled.v[i], units.velocity()));
      for (std::size_t e = 0; e < 4; ++e) ASSERT_EQ(run.energy[i][e], scaled.energy[i][e] / units.energy());
    }
  });
}

// From the same state, in axes turned at random: the same impulse, turned. H, turned to them and back, is
// rounded, and that is amplified by H^-1.
TEST_P(AnyLaw, IsIndifferentToTheFrame) {
  Runner run(law.law, law.parameters, nodes), turned(law.law, law.parameters, nodes, true);
  follow({&run, &turned}, [&](std::size_t) {
    ASSERT_EQ(run.evaluate(), ILAW_OK) << run.report.reason;
    ASSERT_EQ(turned.evaluate_from(run.before), ILAW_OK) << turned.report.reason;
    for (std::size_t i = 0; i < nodes.count; ++i) {
      const Vector r = turned.local(i, turned.r[i], 1.0);
      const double tolerance = 1e-11 * (0.01 + length(run.r[i]));
      for (std::size_t c = 0; c < 3; ++c) ASSERT_NEAR(r[c], run.r[i][c], tolerance) << "node " << i;
    }
  });
}

const auto forms =
    ::testing::Values(std::uint32_t{ILAW_DELASSUS_SCALAR}, std::uint32_t{ILAW_DELASSUS_DIAGONAL},
                      std::uint32_t{ILAW_DELASSUS_FULL});
INSTANTIATE_TEST_SUITE_P(Laws, AnyLaw,
                         ::testing::Combine(::testing::ValuesIn(laws), forms, ::testing::Values(2U, 3U)),
                         name_of);

}  // namespace
}  // namespace ilaw::testing
