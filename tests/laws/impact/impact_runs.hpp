// impact_runs.hpp - what the tests of impacts with friction share.
#pragma once

#include "support/law_runner.hpp"

namespace ilaw::testing {

inline Parameters rough(double friction, double restitution) {
  return {{{"friction", friction}, {"restitution", restitution}}, {}};
}

inline void expect_in_cone(const Vector& r, double friction) {
  if (r[0] == 0.0)
    EXPECT_EQ(r, Vector{});
  else
    EXPECT_LE(tangential_length(r), friction * r[0] * (1.0 + 8 * ulp));
}

struct Body {
  double friction = 0.3, restitution = 0.5, coupling = 1.0;
};

}  // namespace ilaw::testing
