// RCCM: the identity of its dissipation, its order against the ODE, its limits.
#include "support/law_runner.hpp"

namespace ilaw::testing {
namespace {

struct Adhesion {
  double normal, tangential, energy, viscosity, friction;

  Parameters parameters() const {
    return {{{"normal_stiffness", normal},
             {"tangential_stiffness", tangential},
             {"adhesion_energy", energy},
             {"viscosity", viscosity},
             {"friction", friction}},
            {}};
  }
  double square(const Vector& w) const {
    return normal * w[0] * w[0] + tangential * (w[1] * w[1] + w[2] * w[2]);
  }
};
Vector mean_opening(const NodeRun& node) {
  return {node.named("mean_opening"), node.named("mean_slip_1"), node.named("mean_slip_2")};
}

// A mass of any inertia is pushed at random. Each step: the opening moves by the mean velocity; adhesion
// follows its equation; where nothing touches, the impulse is -h A k C (w^- + w^+)/2; rupture is A (w d + b
// d^2/h), and all parts are the work.
TEST(Rccm, DissipatesWhatItsEquationSays) {
  Random random(1);
  int weakened = 0, broken = 0, touched = 0;
  for (int bond = 0; bond < 300 && !::testing::Test::HasFailure(); ++bond) {
    const std::uint32_t forms[] = {ILAW_DELASSUS_SCALAR, ILAW_DELASSUS_TRANSVERSE, ILAW_DELASSUS_FULL};
    const std::uint32_t form = forms[bond % 3];
    const double step = random.decades(-3.0, -1.0), stiff = random.decades(-3.0, -0.7) / (step * step);
    const Adhesion law{stiff, stiff * random.between(0.3, 3.0),
                       random.decades(-2.0, 0.0) * stiff * step * step,
                       bond % 4 ? random.decades(-3.0, 0.0) * stiff * step * step * step : 0.0,
                       bond % 2 ? random.between(0.0, 1.5) : 0.0};
    NodeRun node("rccm", law.parameters(), step, form);
    node.h = {1.0, form == ILAW_DELASSUS_FULL ? 1.4 : 0.7, 0.8, 0.3, -0.2, 0.1};
    node.area = random.between(0.5, 2.0);
    if (form == ILAW_DELASSUS_SCALAR) node.h = {1.0};
    Vector push{};
    for (int k = 0; k < 200; ++k) {
      if (k % 20 == 0) push = random.vector(0.5 * step * stiff * step);
      const double before = node.named("intensity"), stored = node.energy[ILAW_ENERGY_STORED];
      if (before == 0.0) break;
      const Vector w = mean_opening(node), v_before = node.v;
      Vector free = node.v;
      for (std::size_t c = 0; c < 3; ++c)
        free[c] += push[c] + 0.3 * random.between(-1.0, 1.0) * std::abs(push[c]);
      if (node.step(free) != ILAW_OK) break;  // several solutions
      const double after = node.named("intensity"), lost = before - after;
      const Vector y = mean_opening(node);
      const double pushed = std::abs(node.r[0]) + std::abs(node.r[1]) + std::abs(node.r[2]);
      for (std::size_t c = 0; c < 3; ++c) {
        const double rounding =
            16 * ulp * (step * (std::abs(v_before[c]) + std::abs(free[c]) + 2.0 * pushed) + std::abs(w[c]));
        ASSERT_NEAR(y[c], w[c] + 0.5 * step * (v_before[c] + node.v[c]), rounding)
            << "bond " << bond << ", step " << k;
      }
      const double q = 0.5 * (law.square(w) + law.square(y));
      const double balance = 0.5 * (before + after) * q - law.energy - law.viscosity * lost / step;
      const double size = q + law.energy + law.viscosity / step;
      ASSERT_GE(lost, 0.0);
      if (lost == 0.0) {
        ASSERT_LE(balance, 1e-13 * size);
      } else if (after > 0.0) {
        ASSERT_NEAR(balance, 0.0, 2e-13 * size) << "bond " << bond << ", step " << k;
        const double taken = node.area * (law.energy * lost + law.viscosity * lost * lost / step);
        ASSERT_NEAR(node.energy[ILAW_ENERGY_RUPTURE], taken, 2e-13 * node.area * size);
        ++weakened;
      } else {
        ASSERT_GE(balance, -2e-13 * size);
        ++broken;
      }
      const double k_mean = 0.5 * (before * before + after * after);
      const Vector stiffness{law.normal, law.tangential, law.tangential};
      Vector rest = node.r;
      double scale = 0.0;
      for (std::size_t c = 0; c < 3; ++c) {
        rest[c] += step * node.area * k_mean * stiffness[c] * 0.5 * (w[c] + y[c]);
        scale += std::abs(node.r[c]) +
                 step * node.area * k_mean * stiffness[c] * (std::abs(w[c]) + std::abs(y[c]));
      }
      const bool pressed = rest[0] > 1e-12 * scale;
      touched += pressed;
      ASSERT_GE(rest[0], -1e-12 * scale);
      const double limit = pressed ? law.friction * (1.0 - 0.5 * (before + after)) * rest[0] : 0.0;
      ASSERT_LE(std::hypot(rest[1], rest[2]), limit + 1e-12 * scale) << "bond " << bond << ", step " << k;
      double work = node.energy[ILAW_ENERGY_STORED] - stored,
             terms = node.energy[ILAW_ENERGY_STORED] + stored;
      for (std::size_t c = 0; c < 3; ++c) {
        work += node.energy[c] + 0.5 * node.r[c] * (v_before[c] + node.v[c]);
        terms += std::abs(node.r[c]) * (std::abs(v_before[c]) + std::abs(free[c]) + 2.0 * pushed);
      }
      ASSERT_NEAR(work, 0.0, 1e-13 * terms) << "bond " << bond << ", step " << k;
    }
  }
  EXPECT_GT(weakened, 1000);
  EXPECT_GT(broken, 10);
  EXPECT_GT(touched, 1000);
}

// b beta' = -(beta q - w)^+, q = C_N (v t)^2 + C_T (u t)^2, from t = 0.5 to 1.5, by Runge and Kutta's fourth
// order.
double intensity_of_ode(const Adhesion& law, const Vector& velocity) {
  constexpr int steps = 100000;
  const double rate = law.square(velocity);
  const auto slope = [&](double t, double beta) {
    return -std::max(beta * rate * t * t - law.energy, 0.0) / law.viscosity;
  };
  double beta = 1.0;
  for (int k = 0; k < steps; ++k) {
    const double h = 1.0 / steps, t = 0.5 + k * h, a = slope(t, beta),
                 b = slope(t + 0.5 * h, beta + 0.5 * h * a), c = slope(t + 0.5 * h, beta + 0.5 * h * b),
                 d = slope(t + h, beta + h * c);
    beta += h / 6.0 * (a + 2.0 * b + 2.0 * c + d);
  }
  return beta;
}
// The same by the law, on a mass that the bond does not slow.
double intensity_of_law(const Adhesion& law, const Vector& velocity, int steps) {
  const double h = 1.0 / steps, at = 0.5 + 0.5 * h;
  NodeRun node("rccm", law.parameters(), h);
  node.h[0] = 1e-14;
  node.v_previous = velocity;
  node.state = {1.0};
  for (const double time : {at, 0.5})
    for (const double component : velocity) node.state.push_back(time * component);
  for (int k = 0; k < steps; ++k) EXPECT_EQ(node.step(velocity), ILAW_OK);
  return node.named("intensity");
}

TEST(Rccm, ConvergesToItsEquationAtSecondOrder) {
  const Adhesion law{40.0, 25.0, 0.7, 0.9, 0.0};
  const Vector velocity{0.3, 0.2, 0.1};
  const double exact = intensity_of_ode(law, velocity);
  EXPECT_GT(exact, 0.05);
  EXPECT_LT(exact, 0.9);
  double last = 0.0;
  for (const int steps : {50, 113, 257, 601}) {
    const double constant = std::abs(intensity_of_law(law, velocity, steps) - exact) * steps * steps;
    if (last > 0.0) {
      EXPECT_NEAR(constant / last, 1.0, 0.05) << steps;
    }
    last = constant;
  }
  EXPECT_GT(last, 1e-3);
}

// Without viscosity the mean adhesion of a step times its mean energy is w, and adhesion is w/q to what it
// changes by in a step.
TEST(Rccm, FollowsTheEnergyWithoutViscosity) {
  const Adhesion law{100.0, 30.0, 0.5, 0.0, 0.0};
  for (const int steps : {100, 370}) {
    const double h = 1.0 / steps;
    NodeRun node("rccm", law.parameters(), h);
    node.h[0] = 1e-14;
    int weakened = 0;
    for (int k = 0; k < steps; ++k) {
      const double before = node.named("intensity"), q = law.square(mean_opening(node));
      ASSERT_EQ(node.step({0.2, 0.1, 0.0}), ILAW_OK);
      const double after = node.named("intensity"), end = law.square(mean_opening(node));
      if (after == before) continue;
      ++weakened;
      EXPECT_NEAR(0.25 * (before + after) * (q + end), law.energy, 1e-13);
      EXPECT_NEAR(after, law.energy / end, law.energy / q - law.energy / end) << k;
    }
    EXPECT_GT(weakened, steps / 4);
  }
}

// Unloaded, a bond comes back along the stiffness that it has, and is reloaded along it.
TEST(Rccm, KeepsItsAdhesionBelowTheLargestOpening) {
  const Adhesion law{100.0, 100.0, 0.5, 0.01, 0.0};
  NodeRun node("rccm", law.parameters(), 0.01);
  node.h[0] = 1e-14;
  for (int k = 0; k < 60; ++k) node.step({0.3, 0.0, 0.0});
  for (int k = 0; k < 10; ++k) node.step({-0.3, 0.0, 0.0});  // what viscosity has kept goes on
  const double beta = node.named("intensity");
  EXPECT_GT(beta, 0.05);
  EXPECT_LT(beta, 0.95);
  for (int k = 0; k < 60; ++k) {
    const Vector w = mean_opening(node);
    node.step({k < 40 ? -0.3 : 0.3, 0.0, 0.0});
    ASSERT_EQ(node.named("intensity"), beta);
    ASSERT_NEAR(node.r[0], -0.01 * beta * beta * 100.0 * 0.5 * (w[0] + node.named("mean_opening")), 1e-15);
  }
}

// Friction is that of what has been lost of the adhesion.
TEST(Rccm, RubsByWhatIsLostOfTheAdhesion) {
  Random random(2);
  const Adhesion law{50.0, 20.0, 1e9, 0.0, 0.6};
  NodeRun node("rccm", law.parameters(), 0.02);
  int slips = 0, sticks = 0;
  for (int k = 0; k < 2000; ++k) {
    const double beta = random.between(0.0, 1.0), slip = random.between(0.01, 0.1);
    node.state = {beta, 0.0, slip, 0.0, 0.0, slip, 0.0};
    node.v_previous = {};
    const Vector v = random.vector(1.0);
    ASSERT_EQ(node.step({-std::abs(v[0]), 0.3 * v[1], 0.3 * v[2]}), ILAW_OK);
    ASSERT_EQ(node.named("intensity"), beta);
    ASSERT_NEAR(node.r[0], std::abs(v[0]), 4 * ulp);
    const double pull = 0.02 * beta * beta * law.tangential * 0.5;
    const double f1 = node.r[1] + pull * (slip + node.named("mean_slip_1")),
                 f2 = node.r[2] + pull * node.named("mean_slip_2");
    const double limit = law.friction * (1.0 - beta) * node.r[0];
    ASSERT_LE(std::hypot(f1, f2), limit + 1e-14);
    if (std::hypot(node.v[1], node.v[2]) > 1e-12) {
      ASSERT_NEAR(std::hypot(f1, f2), limit, 1e-13);
      ++slips;
    } else {
      ++sticks;
    }
  }
  EXPECT_GT(slips, 300);
  EXPECT_GT(sticks, 300);
}

// A bond that is far stiffer than its step resolves, in one direction: the step has the one solution that a
// dense search finds.
TEST(Rccm, SolvesItsEquationWhereTheBondIsStiff) {
  Random random(4);
  int weakened = 0, broken = 0, held = 0;
  for (int k = 0; k < 3000; ++k) {
    const double f = random.between(0.0, 1.0), beta = random.between(0.3, 1.0), c = random.decades(-1.0, 2.0);
    const double b = k % 3 ? 0.0 : random.decades(-2.0, 0.0), w = random.decades(-2.0, 0.5);
    const double drive = f * 1.5 * (1.0 + c * beta * beta) + random.decades(-2.0, 1.0);
    const auto residual = [&](double x) {
      const double y = drive / (1.0 + 0.5 * c * (beta * beta + x * x)) - f, q = 0.5 * (f * f + y * y);
      return 0.5 * (beta + x) * q - w - b * (beta - x);
    };
    NodeRun node("rccm", Adhesion{1.0, 1.0, w, b, 0.0}.parameters(), 1.0);
    node.h[0] = 4.0 * c;
    node.state = {beta, f, 0.0, 0.0, f, 0.0, 0.0};
    ASSERT_EQ(node.step({2.0 * (drive - 2.0 * f), 0.0, 0.0}), ILAW_OK) << k << ": " << node.report.reason;
    const double found = node.named("intensity");
    if (residual(beta) <= 0.0) {
      ASSERT_EQ(found, beta) << k;
      ++held;
      continue;
    }
    int changes = 0;
    constexpr int samples = 1000;
    for (int i = 0; i < samples; ++i)
      changes += (residual(beta * i / samples) > 0.0) != (residual(beta * (i + 1) / samples) > 0.0);
    ASSERT_LE(changes, 1) << k;
    if (residual(0.0) < 0.0) {
      ASSERT_NEAR(residual(found), 0.0, 1e-12 * (drive * drive + w + b)) << k;
      ++weakened;
    } else {
      ASSERT_EQ(found, 0.0) << k;
      ++broken;
    }
  }
  EXPECT_GT(held, 100);
  EXPECT_GT(weakened, 100);
  EXPECT_GT(broken, 300);
}

}  // namespace
}  // namespace ilaw::testing
