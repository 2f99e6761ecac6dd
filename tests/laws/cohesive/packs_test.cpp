// Cohesive zones that are solved side by side: the equations of the page.
#include "any_inertia.hpp"
#include "support/profile.hpp"

namespace ilaw::testing {
namespace {

Inertia transverse(Draw& draw, double decades) {
  Inertia made(draw, 0.0);
  const double tangential = draw.decades(-decades, decades);
  made.h = {Vector{1.0, 0.0, 0.0}, {0.0, tangential, 0.0}, {0.0, 0.0, tangential}};
  made.condition = 3.0 * std::max(tangential, 1.0 / tangential);
  return made;
}

TEST(CohesivePacks, SolveTheEquationsOfThePage) {
  SolvedProblems solved;
  solved.solve(
      41, [](Draw& draw) { return draw.bond(); },
      [](Draw& draw, const Curve& curve) {
        Problem p(draw, curve, 0.0);
        p.inertia = transverse(draw, 2.0);
        return p;
      });
  solved.expect_variety();
}

ilaw::interface bond_of(const Parameters& parameters) {
  return make_law("cohesive", SetupBuilder(parameters, 3, ILAW_DELASSUS_FULL));
}

struct Nodes : LawBatch {
  using LawBatch::LawBatch;

  void set(std::size_t i, const Problem& p, double damage) {
    h[i] = p.inertia.entries();
    v_free[i] = p.v_free;
    v_previous[i] = p.v_previous;
    const double kept[] = {damage,       p.position[0], p.position[1], p.position[2],
                           p.opening[0], p.opening[1],  p.opening[2]};
    std::copy(std::begin(kept), std::end(kept), state.begin() + state_size() * i);
  }
};

// Also where two axes are nearly one.
TEST(CohesivePacks, TakeAnIllConditionedInertia) {
  Draw draw(44);
  const Parameters parameters{{{"strength", 1.0}, {"toughness", 1.0}, {"stiffness", 100.0}},
                              {{"shape", "bilinear"}}};
  const ilaw::interface law = bond_of(parameters);
  for (const bool is_fair : {true, false}) {
    Nodes nodes(law, 100);
    for (std::size_t i = 0; i < 100; ++i) {
      Problem p(draw, Curve(parameters), 0.0);
      if (i == 0) nodes.velocity_step = nodes.position_step = p.step;
      const double coupling = 1.0 - (is_fair ? 0x1p-10 : 0x1p-24);
      p.inertia.h = {Vector{1.0, coupling, 0.0}, {coupling, 1.0, 0.0}, {0.0, 0.0, 1.0}};
      nodes.set(i, p, p.damage);
    }
    EXPECT_EQ(one_by_one(nodes), 0);
  }
}

}  // namespace
}  // namespace ilaw::testing
