// The motion of a bond that softens depends on the step by its order alone, in packs and one by one.
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

}  // namespace
}  // namespace ilaw::testing
