// The law for diagonal and full H, elliptical cones and kinetic friction, through the ABI.
#include "../../local_problem/draw.hpp"
#include "law_runner.hpp"

#include <limits>

namespace ilaw::testing {
namespace {

constexpr double inf_value = std::numeric_limits<double>::infinity();
constexpr double ulp = std::numeric_limits<double>::epsilon();

// Many closed contacts at once, each with its own full H.
class Contacts {
 public:
  Contacts(const Parameters& parameters, std::size_t count, std::uint32_t frame = ILAW_FRAME_LOCAL,
           bool tangent = false)
      : interface_(
            make_law("coulomb", SetupBuilder(parameters, 3, ILAW_DELASSUS_FULL, frame, 1e-3, tangent))),
        q(count),
        previous(count),
        normal(count),
        tangents(count),
        r(count),
        v(count),
        h(count),
        status(count) {}

  std::int32_t step() {
    ilaw_batch b{};
    b.struct_size = sizeof b;
    b.node_count = static_cast<std::int64_t>(q.size());
    b.velocity_step = b.position_step = 1e-3;
    b.v_free = {q[0].data(), 3, 1};
    b.v_previous = {previous[0].data(), 3, 1};
    b.normal = {normal[0].data(), 3, 1};
    b.tangent = {tangents[0].data(), 3, 1};
    b.delassus = {h[0].data(), 6, 1};
    b.gap = {&closed_, 0, 1};
    b.impulse = {r[0].data(), 3, 1};
    b.velocity = {v[0].data(), 3, 1};
    b.status = status.data();
    b.status_stride = 1;
    report.struct_size = sizeof report;
    return interface_.evaluate(b, &report);
  }

 private:
  ilaw::interface interface_;
  double closed_ = 0.0;

 public:
  std::vector<Vector> q, previous, normal, tangents, r, v;
  std::vector<std::array<double, 6>> h;
  std::vector<std::uint8_t> status;
  ilaw_report report{};
};

double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

void fill(Contacts& contacts, Draw& draw) {
  for (std::size_t i = 0; i < contacts.q.size(); ++i) {
    kit::local_problem p{};
    draw.fill_coupled(p, 0.05);
    draw.fill_pressed_velocity(p, 1.0);
    std::copy(p.h, p.h + 6, contacts.h[i].begin());
    std::copy(p.q, p.q + 3, contacts.q[i].begin());
    if (i % 4 == 0) contacts.q[i][0] *= -1.0;
  }
}

// The plugin is compiled for other processors and with other flags than this test: the same bits all the
// same.
TEST(CoulombAnyH, GivesTheBitsOfTheLocalSolver) {
  for (const double friction_2 : {0.4, 0.1}) {
    Contacts contacts({{{"friction", 0.4}, {"friction_2", friction_2}}, {}}, 100000);
    Draw draw(41);
    fill(contacts, draw);
    ASSERT_EQ(contacts.step(), ILAW_OK);
    for (std::size_t i = 0; i < contacts.q.size(); ++i) {
      kit::local_problem p{{}, {}, {0.4, friction_2}};
      std::copy(contacts.h[i].begin(), contacts.h[i].end(), p.h);
      std::copy(contacts.q[i].begin(), contacts.q[i].end(), p.q);
      double r[3];
      const kit::contact_mode mode = kit::solve(p, r);
      ASSERT_EQ(contacts.r[i], (Vector{r[0], r[1], r[2]})) << "contact " << i;
      ASSERT_EQ(contacts.status[i], mode == kit::contact_mode::slip    ? ILAW_SLIP
                                    : mode == kit::contact_mode::stick ? ILAW_STICK
                                                                       : ILAW_FREE);
    }
  }
}

// Without force and restitution the work r.(v^- + v)/2 is never positive: r.v is the dissipation by slip, and
// r.v^- = r.v - r.H r.
TEST(CoulombAnyH, NeverCreatesEnergyAndDissipatesAtMost) {
  Contacts contacts({{{"friction", 0.5}, {"friction_2", 0.2}}, {}}, 100000);
  Draw draw(42);
  fill(contacts, draw);
  ASSERT_EQ(contacts.step(), ILAW_OK);
  for (std::size_t i = 0; i < contacts.q.size(); ++i) {
    const Vector &r = contacts.r[i], &v = contacts.v[i];
    const double natural = (1.0 + dot(r, r)) * 30.0;
    ASSERT_LE(dot(r, contacts.q[i]) + dot(r, v), 1e-14 * natural);
    // No impulse of the ellipse takes more from this slip.
    const double angle = draw.uniform(0.0, 6.2832);
    const double other = r[0] * (0.5 * std::cos(angle) * v[1] + 0.2 * std::sin(angle) * v[2]);
    ASSERT_LE(r[1] * v[1] + r[2] * v[2], other + 1e-14 * natural);
  }
}

// A rotation of the host's axes turns the impulses with it.
TEST(CoulombAnyH, IsIndifferentToTheFrame) {
  constexpr std::size_t count = 20000;
  const Parameters parameters{{{"friction", 0.5}, {"friction_2", 0.2}}, {}};
  Contacts local(parameters, count), global(parameters, count, ILAW_FRAME_GLOBAL, true);
  Draw draw(43);
  fill(local, draw);
  for (std::size_t i = 0; i < count; ++i) {
    // Columns n, t1, n x t1 of a random rotation.
    Vector n{draw.normal(), draw.normal(), draw.normal()}, t{draw.normal(), draw.normal(), draw.normal()};
    for (double size = std::sqrt(dot(n, n)); double& x : n) x /= size;
    const double along = dot(n, t);
    for (std::size_t c = 0; c < 3; ++c) t[c] -= along * n[c];
    for (double size = std::sqrt(dot(t, t)); double& x : t) x /= size;
    const Vector s{n[1] * t[2] - n[2] * t[1], n[2] * t[0] - n[0] * t[2], n[0] * t[1] - n[1] * t[0]};
    const auto turned = [&](const Vector& a) {
      return Vector{n[0] * a[0] + t[0] * a[1] + s[0] * a[2], n[1] * a[0] + t[1] * a[1] + s[1] * a[2],
                    n[2] * a[0] + t[2] * a[1] + s[2] * a[2]};
    };
    const auto& h = local.h[i];
    const Vector rows[] = {{h[0], h[3], h[4]}, {h[3], h[1], h[5]}, {h[4], h[5], h[2]}};
    Vector columns[3];  // Q H, whose rows turned again give Q H Q^T
    for (std::size_t c = 0; c < 3; ++c) columns[c] = turned({rows[0][c], rows[1][c], rows[2][c]});
    const auto entry = [&](std::size_t a, std::size_t b) {
      return turned({columns[0][a], columns[1][a], columns[2][a]})[b];
    };
    global.h[i] = {entry(0, 0), entry(1, 1), entry(2, 2), entry(0, 1), entry(0, 2), entry(1, 2)};
    global.q[i] = turned(local.q[i]);
    global.normal[i] = n;
    global.tangents[i] = t;
  }
  ASSERT_EQ(local.step(), ILAW_OK);
  ASSERT_EQ(global.step(), ILAW_OK);
  for (std::size_t i = 0; i < count; ++i) {
    const Vector &n = global.normal[i], &t = global.tangents[i];
    const double tolerance = 1e-11 * (1.0 + local.r[i][0]);  // the turned H is rounded, and amplified by H^-1
    ASSERT_NEAR(dot(n, global.r[i]), local.r[i][0], tolerance) << "contact " << i;
    ASSERT_NEAR(dot(t, global.r[i]), local.r[i][1], tolerance) << "contact " << i;
  }
}

// H = diag(h_N, h_1, h_2): r_N = -q_N/h_N stands alone, and sliding is r_i = -q_i/(h_i + a) with a > 0 the
// root of |r_T| = mu r_N, which decreases in a.
TEST(CoulombAnyH, SlidesOnADiagonalHAtTheRootOfItsOneEquation) {
  NodeRun node("coulomb", {{{"friction", 0.5}}, {}}, 1e-3, ILAW_DELASSUS_DIAGONAL);
  Draw draw(44);
  for (int k = 0; k < 5000; ++k) {
    node.h = {draw.decade(-1, 1), draw.decade(-2, 2), draw.decade(-2, 2)};
    const Vector q{-draw.uniform(0.1, 1.0), draw.normal(), draw.normal()};
    ASSERT_EQ(node.step(q), ILAW_OK);
    const double limit = -0.5 * q[0] / node.h[0];
    const auto length = [&](double a) { return std::hypot(q[1] / (node.h[1] + a), q[2] / (node.h[2] + a)); };
    double low = 0.0, high = std::hypot(q[1], q[2]) / limit;
    for (int step = 0; step < 200; ++step) {
      const double a = 0.5 * (low + high);
      (length(a) > limit ? low : high) = a;
    }
    ASSERT_NEAR(node.r[0], -q[0] / node.h[0], 4 * ulp * node.r[0]);
    ASSERT_NEAR(node.r[1], -q[1] / (node.h[1] + low), 1e-13 * limit + 1e-15);
    ASSERT_NEAR(node.r[2], -q[2] / (node.h[2] + low), 1e-13 * limit + 1e-15);
  }
}

TEST(CoulombAnyH, AnEllipseHasItsOwnCoefficientAlongEachAxis) {
  NodeRun node("coulomb", {{{"friction", 0.5}, {"friction_2", 0.2}}, {}});
  ASSERT_EQ(node.step({-1.0, 9.0, 0.0}), ILAW_OK);
  EXPECT_EQ(node.status, ILAW_SLIP);
  EXPECT_NEAR(node.r[1], -0.5, 2 * ulp);
  EXPECT_EQ(node.r[2], 0.0);
  ASSERT_EQ(node.step({-1.0, 0.0, 9.0}), ILAW_OK);
  EXPECT_NEAR(node.r[2], -0.2, 2 * ulp);
  EXPECT_EQ(node.r[1], 0.0);
  // In between, the ellipse's normal is opposite to the slip: v_i proportional to r_i/mu_i^2.
  ASSERT_EQ(node.step({-1.0, 3.0, 4.0}), ILAW_OK);
  EXPECT_NEAR(std::hypot(node.r[1] / 0.5, node.r[2] / 0.2), 1.0, 4 * ulp);
  EXPECT_NEAR(node.v[1] * node.r[2] / 0.04, node.v[2] * node.r[1] / 0.25, 1e-14);
}

TEST(CoulombAnyH, AnEllipseNeedsTangents) {
  const Parameters parameters{{{"friction", 0.5}, {"friction_2", 0.2}}, {}};
  try {
    make_law("coulomb", SetupBuilder(parameters, 3, ILAW_DELASSUS_SCALAR, ILAW_FRAME_GLOBAL));
    FAIL() << "accepted";
  } catch (const std::exception& error) {
    EXPECT_NE(std::string(error.what()).find("tell the two tangential axes apart"), std::string::npos)
        << error.what();
  }
  make_law("coulomb", SetupBuilder(parameters, 3, ILAW_DELASSUS_SCALAR, ILAW_FRAME_GLOBAL, 1e-3, true));
}

// mu(v) = mu_k + (mu - mu_k) exp(-decay |v_T|), at the velocity before the step.
TEST(CoulombAnyH, FallsToTheKineticCoefficientWithTheSlipSpeed) {
  for (const double decay : {0.0, 0.7, inf_value}) {
    NodeRun node("coulomb", {{{"friction", 0.5}, {"kinetic_friction", 0.2}, {"decay", decay}}, {}});
    for (const double speed : {0.0, 0.3, 2.0, 500.0}) {
      node.v_previous = {0.0, 0.6 * speed, -0.8 * speed};
      ASSERT_EQ(node.step({-1.0, 6.0, -8.0}), ILAW_OK);
      const double left = speed == 0.0 ? 1.0 : std::exp(-decay * speed);
      const double expected = 0.2 + 0.3 * left;
      ASSERT_NEAR(node.r[1], -0.6 * expected, 4 * ulp) << "decay " << decay << ", speed " << speed;
      ASSERT_NEAR(node.r[2], 0.8 * expected, 4 * ulp);
    }
  }
}

TEST(CoulombAnyH, AKineticCoefficientAboveTheStaticOneDoesNothing) {
  NodeRun plain("coulomb", {{{"friction", 0.3}}, {}});
  NodeRun above("coulomb", {{{"friction", 0.3}, {"kinetic_friction", 0.4}, {"decay", 1.0}}, {}});
  Draw draw(45);
  for (int k = 0; k < 1000; ++k) {
    const Vector q{-std::abs(draw.normal()), draw.normal(), draw.normal()};
    plain.v_previous = above.v_previous = {0.0, draw.normal(), draw.normal()};
    ASSERT_EQ(plain.step(q), ILAW_OK);
    ASSERT_EQ(above.step(q), ILAW_OK);
    ASSERT_EQ(plain.r, above.r);
  }
}

// Mass m on a spring k, pressed with N on a belt of speed V. It sticks until k x = mu N, then slips about x_k
// = mu_k N/k as x = x_k + A cos(wt) + (V/w) sin(wt), A = (mu - mu_k) N/k, w^2 = k/m, until its speed is V
// again: that is when tan(wt/2) = -A w/V, at x_k - A. Period: 2 A/V + (2 pi - 2 atan(A w/V))/w.
TEST(CoulombAnyH, OscillatesBetweenStickAndSlipWithThePeriodOfTheClosedForm) {
  constexpr double k = 4.0, weight = 10.0, belt = 0.3, mu = 0.5, mu_k = 0.3, w = 2.0, amplitude = 0.5;
  const double period = 2.0 * amplitude / belt + (2.0 * M_PI - 2.0 * std::atan(amplitude * w / belt)) / w;
  const auto measured = [&](double dt) {
    NodeRun node("coulomb", {{{"friction", mu}, {"kinetic_friction", mu_k}}, {}}, dt);
    double x = 0.0, v = belt, first = 0.0, last = 0.0;
    int releases = 0;
    bool stuck = true;
    for (int step = 0; releases < 6; ++step) {
      x += dt * v;
      node.v_previous = {0.0, v - belt, 0.0};
      EXPECT_EQ(node.step({-dt * weight, v - belt - dt * k * x, 0.0}), ILAW_OK);
      v = node.v[1] + belt;
      if (stuck && node.status == ILAW_SLIP) {
        if (releases++ == 0) first = dt * step;
        last = dt * step;
        EXPECT_NEAR(x, mu * weight / k, 2.0 * dt * belt);
      }
      stuck = node.status == ILAW_STICK;
    }
    return (last - first) / 5.0;
  };
  EXPECT_NEAR(measured(1e-2), period, 2e-2);
  EXPECT_NEAR(measured(1e-3), period, 2e-3);
}

// Limits between laws for a full H, bit for bit: no friction is contact, no adhesion is coulomb.
TEST(CoulombAnyH, MeetsContactAndPostit) {
  NodeRun smooth("coulomb", {{{"friction", 0.0}}, {}}, 1e-3, ILAW_DELASSUS_FULL);
  NodeRun contact("contact", {}, 1e-3, ILAW_DELASSUS_FULL);
  NodeRun rough("coulomb", {{{"friction", 0.4}}, {}}, 1e-3, ILAW_DELASSUS_FULL);
  NodeRun postit("postit", {{{"friction", 0.4}, {"adhesion_limit", 0.0}}, {}}, 1e-3, ILAW_DELASSUS_FULL);
  Draw draw(46);
  for (int k = 0; k < 20000; ++k) {
    kit::local_problem p{};
    draw.fill_coupled(p, 0.1);
    std::copy(p.h, p.h + 6, smooth.h.begin());
    contact.h = rough.h = postit.h = smooth.h;
    const Vector q{draw.normal(), draw.normal(), draw.normal()};
    for (NodeRun* node : {&smooth, &contact, &rough, &postit}) ASSERT_EQ(node->step(q), ILAW_OK);
    ASSERT_EQ(smooth.r, contact.r);
    ASSERT_EQ(rough.r, postit.r);
    ASSERT_EQ(rough.status, postit.status);
  }
}

// Infinite friction that would have to pull: refused, with the reason.
TEST(CoulombAnyH, SaysWhereThereIsNoSolution) {
  NodeRun node("coulomb", {{{"friction", inf_value}}, {}}, 1e-3, ILAW_DELASSUS_FULL);
  node.h = {1.0, 1.0, 1.0, 0.9, 0.0, 0.0};
  EXPECT_EQ(node.step({-0.1, -1.0, 0.0}), ILAW_BAD_NODES);
  EXPECT_STREQ(node.report.reason, "the law's equations have no solution for this H");
  EXPECT_EQ(node.r, (Vector{}));
  EXPECT_EQ(node.step({-0.1, 0.01, 0.0}), ILAW_OK);
  EXPECT_EQ(node.status, ILAW_STICK);
}

}  // namespace
}  // namespace ilaw::testing
