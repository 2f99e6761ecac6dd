// bond.hpp - a cohesive node that is driven, or that a mass hangs on.
#pragma once

#include "support/law_runner.hpp"

#include <limits>
#include <random>

namespace ilaw::testing {

inline constexpr double inf_value = std::numeric_limits<double>::infinity();
inline constexpr double ulp = std::numeric_limits<double>::epsilon();

struct Bond : NodeRun {
  Bond(const Parameters& parameters, double step, double bond_area, double delassus)
      : NodeRun("cohesive", parameters, step) {
    area = bond_area;
    h[0] = delassus;
    initialise();
  }

  // A step with this free velocity; keeps the sums of what the ABI gives.
  void evolve(const Vector& free) {
    const Vector old = v;
    v_previous = old;
    ASSERT_EQ(step(free), ILAW_OK);
    for (std::size_t c = 0; c < 3; ++c) work -= 0.5 * r[c] * (old[c] + v[c]);
    for (std::size_t k = 0; k < 3; ++k) parts[k] += energy[k];
  }
  // Traction of the bond, in the direction that opens.
  double traction(std::size_t component) const { return -r[component] / (dt * area); }

  double work = 0.0;              // taken from the node
  std::array<double, 3> parts{};  // dissipated by friction, impact, rupture
};

// Its node moves as it is told: a mass too large for the bond to slow it.
struct Driven : Bond {
  Driven(const Parameters& parameters, double step, double bond_area = 1.0)
      : Bond(parameters, step, bond_area, 1e-12) {}
  void pull(const Vector& velocity) {
    for (double& each : v_free) each = 0.0;
    gap += dt * v[0];
    evolve(velocity);
  }
};

// A mass on its bond, with a spring to its place of rest behind it, in central differences.
struct Hung : Bond {
  Hung(const Parameters& parameters, double step, double mass = 1.0, double stiffness = 0.0)
      : Bond(parameters, step, 1.0, 1.0 / mass), spring(stiffness) {}
  void push(const Vector& force) {
    Vector free{};
    for (std::size_t c = 0; c < 3; ++c) {
      position[c] += dt * v[c];
      free[c] = v[c] + dt * h[0] * (force[c] - spring * position[c]);
    }
    gap = position[0];
    evolve(free);
  }
  double spring;
  Vector position{};
};

}  // namespace ilaw::testing
