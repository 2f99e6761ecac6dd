// The motion of a bond that softens depends on the step by its order alone, in packs and one by one. A state
// of zeros is that of a new bond, and its impulse is the limit of that of small openings.
#include "bond.hpp"

#include "support/steps.hpp"

namespace ilaw::testing {
namespace {

TEST(CohesiveSteps, SofteningKeepsItsOrder) {
  for (const char* shape : {"bilinear", "exponential"})
    for (const double shear : {100.0, 130.0})
      expect_first_order(
          [&](double step, bool alone) {
            NodeRun node("cohesive",
                         {{{"strength", 100.0}, {"toughness", 1.0}, {"strength_2", shear}, {"friction", 0.3}},
                          {{"shape", shape}}},
                         step, ILAW_DELASSUS_FULL);
            // Tangents that are coupled, be it ever so little, are solved alone.
            node.h = {1.0, 1.0, 1.0, 0.0, 0.0, alone ? 1e-13 : 0.0};
            return node;
          },
          {1.0, 0.5, -0.2}, 1.4);
}

// A bond with zeros for its state is new. An older one has them only where it did not move in the step
// before; then new and old bonds have the same place, and an opening of 1e-20 the same impulse.
void expect_limit_at_rest(const std::string& law, const Parameters& parameters, double step, Draw& draw) {
  NodeRun node(law, parameters, step, ILAW_DELASSUS_FULL), shifted(law, parameters, step, ILAW_DELASSUS_FULL);
  node.h = {1.0, draw.between(0.5, 2.0), draw.between(0.5, 2.0), 0.0, 0.0, 0.0};
  if (draw.between(0.0, 1.0) < 0.5) node.h[3] = draw.between(-0.3, 0.3);
  shifted.h = node.h;
  for (std::size_t c = 1; c < shifted.state.size(); ++c) shifted.state[c] = 1e-20;
  const Vector v = draw.vector(draw.decades(-3.0, 3.0));
  const std::int32_t code = node.step(v);
  ASSERT_EQ(shifted.step(v), code);
  EXPECT_THAT(node.r, VectorNear(shifted.r, 1e-12 * std::sqrt(dot(v, v))));
}

TEST(BondAtZero, HasTheImpulseOfItsLimit) {
  Draw draw(1);
  for (int k = 0; k < 60; ++k)
    for (const double step : {1e-3, 7e-4, 1.3e-3}) {
      expect_limit_at_rest("cohesive", draw.bond(), step, draw);
      const Parameters adhesion{{{"normal_stiffness", draw.decades(0.0, 9.0)},
                                 {"tangential_stiffness", draw.decades(0.0, 9.0)},
                                 {"adhesion_energy", draw.between(0.0, 2.0)},
                                 {"friction", draw.between(0.0, 1.0)}},
                                {}};
      expect_limit_at_rest("rccm", adhesion, step, draw);
      if (::testing::Test::HasFailure()) FAIL() << "bond " << k << ", step " << step;
    }
}

// A bond whose secant turns its phase by 90 degrees a step is at zero in every second one, and in every
// fourth one its mean is. It goes on as a bond that was moved by 1e-20 there, and keeps its energy.
TEST(BondAtZero, IsPassedAsAnyOtherPlace) {
  for (const double step : {1e-3, 7e-4, 1.3e-3})
    for (const bool in_mean : {false, true}) {
      const double stiffness = 4.0 / (step * step);
      Bond bond({{{"strength", inf_value}, {"toughness", 1.0}, {"stiffness", stiffness}}, {}}, step, 1.0,
                1.0);
      Bond moved({{{"strength", inf_value}, {"toughness", 1.0}, {"stiffness", stiffness}}, {}}, step, 1.0,
                 1.0);
      // slip_1 and mean_slip_1, half a step apart
      const double speed = 0.5, way = 0.5 * step * speed;
      bond.state[2] = in_mean ? way : 0.0;
      bond.state[5] = in_mean ? 0.0 : -way;
      bond.v[1] = speed;
      moved.state = bond.state;
      moved.v = bond.v;
      int at_zero = 0;
      for (int k = 0; k < 40; ++k) {
        for (const std::size_t c : {2U, 5U}) {
          if (std::abs(bond.state[c]) > 1e-12 * way) continue;
          bond.state[c] = 0.0;
          moved.state[c] = 1e-20;
          ++at_zero;
        }
        bond.evolve(bond.v);
        moved.evolve(moved.v);
        ASSERT_NEAR(bond.v[1], moved.v[1], 1e-13 * speed) << "step " << k << " of " << step;
        const double mean = bond.named("mean_slip_1"),
                     energy = 0.5 * (bond.v[1] * bond.v[1] + stiffness * mean * mean);
        ASSERT_NEAR(energy, 0.5 * (speed * speed + (in_mean ? 0.0 : stiffness * way * way)), 1e-12 * speed);
      }
      EXPECT_GE(at_zero, 20) << step;
    }
}

}  // namespace
}  // namespace ilaw::testing
