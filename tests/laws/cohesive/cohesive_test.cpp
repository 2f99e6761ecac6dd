// Cohesive zones through the ABI: tractions and energies against closed forms.
#include "bond.hpp"

namespace ilaw::testing {
namespace {

const std::array<std::string, 3> shapes{"bilinear", "exponential", "camacho_ortiz"};

Parameters bond_of(const std::string& shape, double strength, double toughness,
                   double stiffness = inf_value) {
  return {{{"strength", strength}, {"toughness", toughness}, {"stiffness", stiffness}}, {{"shape", shape}}};
}

// Pulled from rest at any constant speed, in 15 steps or 3000, rigid or not: the work of the impulses is
// toughness times area, all of it dissipated by rupture, since an impulse is the mean traction over the two
// steps that its work spans.
TEST(Cohesive, PullingApartTakesTheToughness) {
  for (const std::string& shape : shapes)
    for (const double stiffness : {5.0, 1e3, 1e9, inf_value}) {
      if (shape == "camacho_ortiz" && stiffness < inf_value) continue;
      for (const double h : {0.2, 0.037, 0.001})
        for (const Vector& direction : {Vector{1, 0, 0}, Vector{0, 0.6, -0.8}, Vector{0.48, 0.64, 0.6}}) {
          Driven node(bond_of(shape, 2.0, 3.0, stiffness), h, 0.25);
          double peak = 0.0;
          while (node.named("damage") < 1.0) {
            node.pull(direction);
            peak = std::max(peak, std::hypot(node.traction(0), node.traction(1), node.traction(2)));
          }
          EXPECT_NEAR(node.work, 0.75, 1e-9) << shape << ", stiffness " << stiffness << ", h " << h;
          EXPECT_NEAR(node.parts[ILAW_ENERGY_RUPTURE], 0.75, 1e-9);
          EXPECT_NEAR(node.parts[ILAW_ENERGY_FRICTION] + node.parts[ILAW_ENERGY_IMPACT], 0.0, 1e-9);
          EXPECT_EQ(node.energy[ILAW_ENERGY_STORED], 0.0);
          EXPECT_LE(peak, 2.0 * (1.0 + 1e-12));
          if (h == 0.001) {
            EXPECT_GE(peak, 2.0 * (1.0 - (shape == "exponential" ? 2e-3 : 1e-3)));
          }
        }
    }
}

// Within the linear softening the mean traction over two steps is that of the middle one, to rounding:
// sigma (1 - opening/(2 G/sigma)), which ends at 2 G/sigma; elastic up to the onset sigma/K.
TEST(Cohesive, BilinearTractionIsExactAtTheTimeOfTheImpulse) {
  const double h = 0.01, strength = 2.0, toughness = 3.0, end = 2.0 * toughness / strength;
  for (const double stiffness : {4.0, inf_value}) {
    const double onset = strength / stiffness;
    Driven node(bond_of("bilinear", strength, toughness, stiffness), h);
    for (int k = 0; k < 400; ++k) {
      node.pull({1.0, 0, 0});
      const double opening = k * h;  // at the time of the impulse
      if (k > 0 && opening + h < onset) {
        EXPECT_NEAR(node.traction(0), stiffness * opening, 1e-10);
      }
      if (opening - h > onset && opening + h < end) {
        EXPECT_NEAR(node.traction(0), strength * (end - opening) / (end - onset), 1e-10);
        EXPECT_NEAR(node.named("damage"), (opening + 0.5 * h - onset) / (end - onset), 1e-10)
            << "at the half step";
        EXPECT_EQ(node.status, ILAW_BONDED);
      }
      if (opening - h > end) {
        EXPECT_NEAR(node.r[0], 0.0, 1e-25);
      }
    }
  }
}

TEST(Cohesive, SaysBrokenOnceAndThatWhenTheOpeningReachesItsEnd) {
  for (const std::string& shape : shapes) {
    Driven node(bond_of(shape, 2.0, 3.0), 0.01);
    // G = sigma width ((1/8) - e^-8/(1 - e^-8)) for the exponential that is cut at e^-8.
    const double end = shape == "exponential" ? 1.5 / (0.125 - std::exp(-8.0) / (1.0 - std::exp(-8.0))) : 3.0;
    int broken = 0;
    for (int k = 1; k < 1400; ++k) {
      node.pull({1.0, 0, 0});
      if (node.status != ILAW_BROKEN) continue;
      ++broken;
      EXPECT_NEAR(k * 0.01, end, 0.0101) << shape;
    }
    EXPECT_EQ(broken, 1);
    EXPECT_EQ(node.status, ILAW_FREE);
  }
}

// Mixed mode at a fixed direction, shear share B = sin^2: toughness and squared strength are interpolated by
// B^eta (Benzeggagh and Kenane 1996; Turon et al. 2006); opening at the end is 2 G/sigma.
TEST(Cohesive, MixedModeFollowsBenzeggaghAndKenane) {
  for (const double exponent : {0.5, 1.0, 2.284})
    for (double angle = 0.0; angle <= 90.0; angle += 7.5) {
      const double n = std::cos(angle * M_PI / 180.0), t = std::sin(angle * M_PI / 180.0);
      const double part = std::pow(t * t, exponent);
      const double toughness = 3.0 + part * (12.0 - 3.0), strength = std::sqrt(4.0 + part * (36.0 - 4.0));
      Parameters parameters = bond_of("bilinear", 2.0, 3.0);
      parameters.numbers.insert({{"strength_2", 6.0}, {"toughness_2", 12.0}, {"mixing_exponent", exponent}});
      Driven node(parameters, 1e-3);
      double peak = 0.0;
      while (node.named("damage") < 1.0) {
        node.pull({n, 0.6 * t, 0.8 * t});
        peak = std::max(peak, std::hypot(node.traction(0), node.traction(1), node.traction(2)));
      }
      EXPECT_NEAR(node.parts[ILAW_ENERGY_RUPTURE], toughness, 1e-9 * toughness) << angle;
      EXPECT_NEAR(peak, strength, 1e-3 * strength);
      EXPECT_NEAR(std::hypot(node.named("opening"), node.named("slip_1"), node.named("slip_2")),
                  2.0 * toughness / strength, 2.1e-3);
    }
}

// Camacho and Ortiz: traction (delta_N, beta^2 delta_T) sigma(delta)/delta with delta^2 = delta_N^2 + beta^2
// delta_T^2, beta the ratio of the strengths: it first moves where (t_N/s_1)^2 + (t_T/s_2)^2 = 1, and takes
// the toughness in any direction.
TEST(Cohesive, CamachoOrtizStartsOnItsEllipse) {
  for (double angle = 0.0; angle <= 90.0; angle += 7.5) {
    const double n = std::cos(angle * M_PI / 180.0), t = std::sin(angle * M_PI / 180.0);
    Parameters parameters = bond_of("camacho_ortiz", 2.0, 3.0);
    parameters.numbers["strength_2"] = 5.0;
    Driven node(parameters, 1e-4);
    node.pull({n, 0.6 * t, 0.8 * t});
    const double shear = std::hypot(node.traction(1), node.traction(2));
    EXPECT_NEAR(std::hypot(node.traction(0) / 2.0, shear / 5.0), 1.0, 1e-3) << angle;
    EXPECT_NEAR(shear * n, 6.25 * node.traction(0) * t, 1e-10) << "along (n, beta^2 t)";
    while (node.named("damage") < 1.0) node.pull({n, 0.6 * t, 0.8 * t});
    EXPECT_NEAR(node.parts[ILAW_ENERGY_RUPTURE], 3.0, 1e-9);
  }
}

// Back to the origin along the secant, to the other side, and up again without a loss; then on where the
// softening was left. The turn is half a step early and late for the mean of two positions.
TEST(Cohesive, UnloadsToTheOrigin) {
  for (const std::string& shape : shapes) {
    const double h = 0.01;
    Driven node(bond_of(shape, 2.0, 3.0), h);
    for (int k = 0; k < 80; ++k) node.pull({0, 1.0, 0});
    const double damage = node.named("damage"), loss = node.parts[ILAW_ENERGY_RUPTURE];
    const double stored = node.energy[ILAW_ENERGY_STORED], largest = node.named("mean_slip_1");
    const double secant = 2.0 * stored / (largest * largest);
    double slip = 80 * h;
    for (int k = 0; k < 160; ++k, slip -= h) {
      node.pull({0, -1.0, 0});
      EXPECT_NEAR(node.named("damage"), damage, 1e-13);
      EXPECT_NEAR(node.traction(1), secant * (k == 0 ? largest : slip), 1e-10) << shape << ", step " << k;
    }
    for (int k = 0; k < 159; ++k) node.pull({0, 1.0, 0});
    EXPECT_NEAR(node.parts[ILAW_ENERGY_RUPTURE], loss, 1e-12);
    while (node.named("damage") < 1.0) node.pull({0, 1.0, 0});
    EXPECT_NEAR(node.work, 3.0, 1e-9);
    EXPECT_NEAR(node.parts[ILAW_ENERGY_RUPTURE], 3.0, 1e-9);
  }
}

// A mass torn off by a growing force, free or with a spring behind it next to the stability limit of that
// spring (h w = 1.9): the dissipated energy is the toughness for any initial stiffness, up to 1e9 times m/h^2
// and rigid.
TEST(Cohesive, TakesTheToughnessFromAMassAtTheLargestStep) {
  constexpr double rate = 20.0, spring_stiffness = 100.0;
  for (const double spring : {0.0, spring_stiffness})
    for (const std::string shape : {"bilinear", "exponential"})
      for (const double stiffness : {5.0, 1e3, 1e11, inf_value})
        for (const double h : {0.19, 0.095, 0.0475, 0.01}) {
          Hung node(bond_of(shape, 2.0, 3.0, stiffness), h, 1.0, spring);
          for (int k = 0; k < 10000 && node.named("damage") < 1.0; ++k) node.push({rate * k * h, 0, 0});
          EXPECT_EQ(node.named("damage"), 1.0);
          EXPECT_NEAR(node.work, 3.0, 1e-11) << shape << ", stiffness " << stiffness << ", h " << h;
          EXPECT_NEAR(node.parts[ILAW_ENERGY_RUPTURE], 3.0, 1e-11);
        }
}

// Rigid: it does not move at all until the pull passes the strength.
TEST(Cohesive, RigidBondStandsStillUpToItsStrength) {
  Hung node(bond_of("camacho_ortiz", 2.0, 3.0), 0.1);
  for (int k = 0; k < 100; ++k) {
    node.push({1.99 * std::sin(0.1 * k), 1.99 * std::cos(0.1 * k), 0});
    EXPECT_EQ(node.v, (Vector{}));
    EXPECT_EQ(node.named("damage"), 0.0);
  }
  node.push({-1e6, 0, 0});
  EXPECT_EQ(node.v, (Vector{}));
  EXPECT_EQ(node.status, ILAW_BONDED);
  node.push({2.01, 0, 0});
  EXPECT_GT(node.named("damage"), 0.0);
}

// A rigid bond on which a constant force F > sigma acts, m = 1: x'' = F - sigma + sigma x/end, so that
// x = (F/sigma - 1) end (cosh(w t) - 1), w^2 = sigma/end: it breaks at arcosh(1 + sigma/(F - sigma))/w, found
// at second order.
TEST(Cohesive, RuptureInstantUnderAConstantForceConverges) {
  const double strength = 2.0, toughness = 3.0, end = 3.0, force = 2.5, rate = std::sqrt(strength / end);
  const double exact = std::acosh(1.0 + strength / (force - strength)) / rate;
  double last = 0.0;
  for (const double h : {0.02, 0.01, 0.005}) {
    Hung node(bond_of("camacho_ortiz", strength, toughness), h);
    double t = 0.0, before = 0.0;
    // The force starts at time 0, so its first impulse is that of half a step.
    node.push({0.5 * force + 0.5 * strength, 0, 0});
    while (node.named("opening") < end) {
      before = node.named("opening");
      node.push({force, 0, 0});
      t += h;
    }
    const double found = t + h * (end - before) / (node.named("opening") - before);
    const double error = std::abs(found - exact);
    EXPECT_LE(error, 0.3 * h * h) << h;
    if (last > 0.0) {
      EXPECT_NEAR(last / error, 4.0, 1.0);
    }
    last = error;
  }
}

// f constant: d(t) = f - ln(1 + (e^(a f) - 1) e^(-a t/tau))/a (Allix and Deu 1997).
TEST(Cohesive, DelayedDamageFollowsItsClosedForm) {
  for (const double a : {0.5, 1.0, 10.0, 500.0})
    for (const double opening : {0.6, 1.4, 2.9}) {
      const double tau = 0.3, h = 0.01, onset = 0.5, end = 3.0, target = (opening - onset) / (end - onset);
      Parameters parameters = bond_of("bilinear", 2.0, 3.0, 4.0);
      parameters.numbers.insert({{"delay_time", tau}, {"delay_exponent", a}});
      Driven node(parameters, h);
      // Between 0 and twice the opening and back: the mean of two positions stays.
      node.pull({0, 2.0 * opening / h, 0});
      for (int k = 1; k < 100; ++k) {
        const double exact = target - std::log1p(std::expm1(a * target) * std::exp(-a * k * h / tau)) / a;
        ASSERT_NEAR(node.named("damage"), exact, 1e-12)
            << "a " << a << ", opening " << opening << ", step " << k;
        node.pull({0, (k % 2 ? -2.0 : 2.0) * opening / h, 0});
      }
    }
}

TEST(Cohesive, DelayBoundsTheRateAndBreaksInFiniteTime) {
  Parameters parameters = bond_of("exponential", 2.0, 3.0, 4.0);
  parameters.numbers.insert({{"delay_time", 0.25}, {"delay_exponent", 20.0}});
  Driven node(parameters, 0.01);
  double last = 0.0;
  int steps = 0;
  for (; node.named("damage") < 1.0 && steps < 1000; ++steps) {
    node.pull({1e3, 0, 0});
    ASSERT_LE(node.named("damage") - last, 0.01 / 0.25 * (1.0 + 1e-12));
    last = node.named("damage");
  }
  EXPECT_GE(steps, 25);
  EXPECT_LE(steps, 27);
  EXPECT_NEAR(node.work, node.parts[ILAW_ENERGY_RUPTURE] + node.energy[ILAW_ENERGY_STORED], 1e-6 * node.work);
}

}  // namespace
}  // namespace ilaw::testing
