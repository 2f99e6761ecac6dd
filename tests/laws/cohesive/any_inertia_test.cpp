// Cohesive zones with any H: the equations at the returned impulse, by quadrature and in another order than
// the law's, energies and invariances.
#include "any_inertia.hpp"

namespace ilaw::testing {
namespace {

// A bond that was pulled open and is now sheared, in which it is weaker, has more than the curve of shear
// allows also where it is unloaded.
TEST(CohesiveAnyInertia, SolvesThemWhereItTurnsToShear) {
  Draw draw(31);
  int softened = 0;
  for (int k = 0; k < 300; ++k) {
    const double strength = draw.between(0.5, 2.0), toughness = draw.between(0.5, 2.0);
    const Parameters parameters{{{"strength", strength},
                                 {"strength_2", strength * draw.decades(-3.0, -0.5)},
                                 {"toughness", toughness},
                                 {"mixing_exponent", draw.decades(-0.5, 0.5)}},
                                {{"shape", k % 2 ? "bilinear" : "exponential"}}};
    const Curve curve(parameters);
    Problem p(draw, curve, 0.0);
    const double opened = draw.between(0.3, 0.9) * curve.meets(p.damage), toward = 2.0 / p.step * opened;
    p.opening = {opened, 0.0, 0.0};
    p.position = {draw.between(0.0, 1.0) * opened, 0.0, 0.0};
    p.v_previous = {2.0 * (p.position[0] - opened) / p.step, 0.0, 0.0};
    p.v_free = {-0.5 * toward, draw.between(0.2, 0.9) * toward, 0.0};
    const double c = 0.25 * p.step * p.velocity_step * p.inertia.h[0][0];
    const double times = draw.decades(-3.0, -1.0) / (c * curve.secant(p.damage));
    for (Vector& row : p.inertia.h)
      for (double& entry : row) entry *= times;
    NodeRun node("cohesive", parameters, 1.0, ILAW_DELASSUS_FULL);
    ASSERT_EQ(p.solve(node), ILAW_OK) << k << ": " << node.report.reason;
    bool pressed = false;
    const std::optional<std::string> wrong = judge(p, node, pressed);
    ASSERT_FALSE(wrong) << "seed 31, step " << k << ", strengths " << curve.s1 << " and " << curve.s2
                        << ", exponent " << curve.eta << ": " << *wrong;
    softened += node.named("damage") > p.damage;
  }
  EXPECT_GT(softened, 30);
}

// A bond that has been sheared, on a node with any H or with one that does not tell the tangents apart, which
// is solved in packs.
Problem sheared_problem(Draw& draw, const Curve& curve, bool in_packs) {
  Problem p(draw, curve, in_packs ? 0.0 : draw.between(0.0, 6.0));
  const double sheared = draw.between(0.3, 0.99) * curve.meets(p.damage), toward = 2.0 / p.step * sheared;
  p.opening = {draw.between(0.0, 0.5) * sheared, sheared, 0.0};
  p.position = {0.0, draw.between(0.5, 1.5) * sheared, 0.0};
  p.v_free = draw.vector(toward);
  if (in_packs) {
    const double across = draw.decades(-3.0, 3.0);
    p.inertia.h = {Vector{1.0, 0.0, 0.0}, {0.0, across, 0.0}, {0.0, 0.0, across}};
  }
  const double c = 0.25 * p.step * p.velocity_step * p.inertia.h[0][0];
  const double times = draw.decades(-3.0, 1.0) / (c * curve.secant(p.damage));
  for (Vector& row : p.inertia.h)
    for (double& entry : row) entry *= times;
  return p;
}

// As it is unloaded the mix of modes changes, and may end on a curve that asks for less damage than the bond
// has: what is broken stays broken.
TEST(CohesiveAnyInertia, NeverHealsWhereTheModeChanges) {
  Draw draw(33);
  int softened = 0;
  for (int bond = 0; bond < 20; ++bond) {
    const double strength = draw.between(0.5, 2.0), toughness = draw.between(0.5, 2.0);
    const Parameters parameters{{{"strength", strength},
                                 {"strength_2", strength * draw.decades(-2.0, 0.0)},
                                 {"toughness", toughness},
                                 {"toughness_2", toughness * draw.decades(-0.7, 0.7)},
                                 {"mixing_exponent", draw.decades(-0.5, 0.5)}},
                                {{"shape", bond % 2 ? "bilinear" : "exponential"}}};
    const Curve curve(parameters);
    NodeRun node("cohesive", parameters, 1.0, ILAW_DELASSUS_FULL);
    for (int k = 0; k < 600; ++k) {
      const Problem p = sheared_problem(draw, curve, k % 6 > 0);
      if (p.solve(node) != ILAW_OK) continue;  // several solutions
      ASSERT_GE(node.named("damage"), p.damage)
          << "seed 33, bond " << bond << ", problem " << k << ", strengths " << curve.s1 << " and "
          << curve.s2 << ", toughnesses " << curve.g1 << " and " << curve.g2 << ", exponent " << curve.eta;
      softened += node.named("damage") > p.damage;
    }
  }
  EXPECT_GT(softened, 1000);
}

// All shapes and delay, H of a condition of up to a million, turned and scaled: the traction is that of the
// page's curve to rounding, the node stays outside, and what is left is contact and friction.
TEST(CohesiveAnyInertia, SolvesTheEquationsOfThePage) {
  SolvedProblems solved;
  solved.solve(
      21, [](Draw& draw) { return draw.bond(); },
      [](Draw& draw, const Curve& curve) { return Problem(draw, curve, draw.between(0.0, 6.0)); });
  solved.expect_variety();
}

}  // namespace
}  // namespace ilaw::testing
