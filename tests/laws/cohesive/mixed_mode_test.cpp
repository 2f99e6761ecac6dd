// Strength and toughness where both modes act, for any exponent and ratio of strengths: Benzeggagh and
// Kenane's curve in long double, in packs and one by one.
#include "bond.hpp"

namespace ilaw::testing {
namespace {

// The mean traction of a rigid bilinear bond on its way from where it was made to an opening.
long double mean_traction(const Parameters& p, const Vector& opening) {
  const auto number = [&p](const char* name) { return static_cast<long double>(p.numbers.at(name)); };
  const long double n = opening[0], t1 = opening[1], t2 = opening[2];
  const long double size = std::sqrt(n * n + t1 * t1 + t2 * t2), normal = n * n / (size * size);
  const long double logarithm = number("mixing_exponent") * std::log1p(-normal);
  const long double shear = std::exp(logarithm), rest = -std::expm1(logarithm);
  const auto mean = [&](long double a, long double b) { return rest * a + shear * b; };
  const long double s1 = number("strength"), s2 = number("strength_2");
  const long double strength = std::sqrt(mean(s1 * s1, s2 * s2)),
                    toughness = mean(number("toughness"), number("toughness_2"));
  const long double end = 2.0L * toughness / strength;
  return size < end ? strength * (1.0L - 0.5L * size / end) : toughness / size;
}

// A bond that is pulled in one step, of a random length, in a random direction, near pure shear as often as
// not.
struct Pulled {
  explicit Pulled(Draw& draw) {
    const double exponents[] = {1.0, 1.5, 2.0, draw.decades(-1.0, 5.0), draw.decades(-1.0, 5.0)};
    parameters.numbers = {{"strength", draw.decades(-4.0, 4.0)},
                          {"strength_2", draw.decades(-4.0, 4.0)},
                          {"toughness", draw.decades(-4.0, 4.0)},
                          {"toughness_2", draw.decades(-4.0, 4.0)},
                          {"mixing_exponent", exponents[static_cast<int>(draw.between(0.0, 5.0))]}};
    const double turn = draw.between(0.0, 6.28), normal = draw.decades(-8.0, 0.0),
                 across = std::sqrt(1.0 - normal * normal), size = draw.decades(-4.0, 4.0);
    velocity = {size * normal, size * across * std::cos(turn), size * across * std::sin(turn)};
  }

  // How far the law's mean traction is from that of the page, relatively.
  double error(double coupling) const {
    NodeRun node("cohesive", parameters, 1.0, ILAW_DELASSUS_FULL);
    constexpr double heavy = 1e-30;  // a mass too large for the bond to slow it
    node.h = {heavy, heavy, heavy, 0.0, 0.0, coupling * heavy};
    EXPECT_EQ(node.step(velocity), ILAW_OK) << node.report.reason;
    const Vector opening{node.named("mean_opening"), node.named("mean_slip_1"), node.named("mean_slip_2")};
    const long double expected = mean_traction(parameters, opening);
    return static_cast<double>(std::abs(std::hypot(node.r[0], node.r[1], node.r[2]) / expected - 1.0L));
  }

  Parameters parameters;
  Vector velocity;
};

// Tangents that are coupled, be it ever so little, are solved alone.
TEST(CohesiveMixedMode, KeepsItsDigitsForAnyExponentAndStrengths) {
  for (const double coupling : {0.0, 1e-13}) {
    Draw draw(17);
    for (int k = 0; k < 600; ++k) {
      const Pulled pulled(draw);
      ASSERT_LE(pulled.error(coupling), 64 * ulp)
          << "draw " << k << ", coupling " << coupling << ", exponent "
          << pulled.parameters.numbers.at("mixing_exponent");
    }
  }
}

// Damage is one number for all modes: however far apart their strengths and toughnesses are, each mode
// softens to its end step by step, in packs and one by one, and takes its toughness.
TEST(CohesiveMixedMode, TakesTheToughnessOfAModeHoweverFarTheOtherIs) {
  for (const double ratio : {1e-18, 1e-9, 1e-5, 1e-2, 1e2, 1e5, 1e9, 1e18})
    for (const bool is_tough : {false, true})
      for (const double stiffness : {inf_value, 1e3})
        for (const double coupling : {0.0, 1e-13})
          for (const Vector& direction : {Vector{1, 0, 0}, Vector{0, 0.6, -0.8}}) {
            const double strength_2 = is_tough ? 1.0 : ratio, toughness_2 = is_tough ? ratio : 1.0;
            const double strength = direction[0] > 0.0 ? 1.0 : strength_2,
                         toughness = direction[0] > 0.0 ? 1.0 : toughness_2;
            const double rigid = 1e3 * (1.0 + strength_2 * strength_2 / toughness_2);
            NodeRun node("cohesive",
                         {{{"strength", 1.0},
                           {"strength_2", strength_2},
                           {"toughness", 1.0},
                           {"toughness_2", toughness_2},
                           {"stiffness", stiffness * rigid}},
                          {{"shape", "bilinear"}}},
                         1.0, ILAW_DELASSUS_FULL);
            const double light = 1e-30 * toughness / (strength * strength);
            node.h = {light, light, light, 0.0, 0.0, coupling * light};
            const double end = 2.0 * toughness / strength, speed = end / 300.0;
            Vector v = direction;
            for (double& each : v) each *= speed;
            double work = 0.0, rupture = 0.0;
            for (int k = 0; k < 320; ++k) {
              const Vector before = node.v;
              ASSERT_EQ(node.step(v), ILAW_OK) << node.report.reason;
              for (std::size_t c = 0; c < 3; ++c) work -= 0.5 * node.r[c] * (before[c] + node.v[c]);
              rupture += node.energy[ILAW_ENERGY_RUPTURE];
            }
            EXPECT_EQ(node.named("damage"), 1.0)
                << ratio << is_tough << stiffness << coupling << direction[0];
            EXPECT_NEAR(rupture, toughness, 1e-11 * toughness)
                << "ratio " << ratio << (is_tough ? " of toughness" : " of strength") << ", stiffness "
                << stiffness << ", coupling " << coupling << ", opening " << direction[0];
            EXPECT_NEAR(work, rupture, 1e-11 * toughness);
          }
}

}  // namespace
}  // namespace ilaw::testing
