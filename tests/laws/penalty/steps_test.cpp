// The motion on an implicit spring depends on the step by its order alone, in packs and one by one.
#include "support/steps.hpp"

namespace ilaw::testing {
namespace {

// An exponent that is not quite that of packs is solved alone.
Parameters spring(double stiffness, double exponent, double friction, bool alone) {
  return {{{"stiffness", stiffness},
           {"exponent", exponent + (alone ? 1e-13 : 0.0)},
           {"friction", friction},
           {"tangential_stiffness", 3000.0}},
          {{"integration", "implicit"}}};
}

TEST(PenaltySteps, HertzKeepsItsOrder) {
  expect_first_order(
      [](double step, bool alone) { return NodeRun("penalty", spring(2e4, 1.5, 0.0, alone), step); },
      {-1.0, 0.6, -0.3}, 1.03);
}

TEST(PenaltySteps, FrictionCoupledByHKeepsItsOrder) {
  for (const double exponent : {1.0, 1.5})
    expect_first_order(
        [&](double step, bool alone) {
          NodeRun node("penalty", spring(exponent == 1.0 ? 4e3 : 2e4, exponent, 0.3, alone), step,
                       ILAW_DELASSUS_FULL);
          node.h = {1.0, 1.3, 0.8, 0.2, -0.1, 0.15};
          return node;
        },
        {-1.0, 0.6, -0.3}, 1.03);
}

}  // namespace
}  // namespace ilaw::testing
