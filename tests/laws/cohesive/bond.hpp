// bond.hpp - a cohesive node that is driven, or that a mass hangs on.
#pragma once

#include "support/law_runner.hpp"

namespace ilaw::testing {

inline constexpr const char* several_solutions =
    "the law's equations have several solutions for this H and step: a smaller step is needed";

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
    const bool solved = step(free) == ILAW_OK;
    several = !solved && std::string(report.reason) == several_solutions;
    ASSERT_TRUE(solved || several) << report.reason;
    for (std::size_t c = 0; c < 3; ++c) work -= 0.5 * r[c] * (old[c] + v[c]);
    for (std::size_t k = 0; k < 3; ++k) parts[k] += energy[k];
  }
  // Traction of the bond, in the direction that opens.
  double traction(std::size_t component) const { return -r[component] / (dt * area); }

  bool several = false;           // the step had several solutions, and was refused
  double work = 0.0;              // taken from the node
  std::array<double, 3> parts{};  // dissipated by friction, impact, rupture
};

// Bonds at random.
struct Draw : Random {
  using Random::Random;

  // Any bond: of any shape, rigid or not, with its mixed mode, friction and delay.
  Parameters bond() {
    const bool is_delayed = between(0.0, 1.0) < 0.2;
    const char* shapes[] = {"bilinear", "exponential", "camacho_ortiz"};
    const std::string shape = shapes[static_cast<int>(between(0.0, is_delayed ? 2.0 : 3.0))];
    const double strength = between(0.5, 2.0), strength_2 = between(0.5, 4.0), toughness = between(0.5, 2.0);
    Parameters p{{{"strength", strength}, {"strength_2", strength_2}, {"toughness", toughness}},
                 {{"shape", shape}}};
    p.numbers["friction"] = between(0.0, 1.0) < 0.3 ? 0.0 : between(0.0, 1.5);
    if (shape != "camacho_ortiz") {
      p.numbers["toughness_2"] = between(0.5, 4.0);
      p.numbers["mixing_exponent"] = between(0.3, 3.0);
      if (is_delayed || between(0.0, 1.0) < 0.7) p.numbers["stiffness"] = decades(1.5, 9.0);
    }
    if (is_delayed)
      p.numbers.insert({{"delay_time", decades(-2.0, 1.0)}, {"delay_exponent", decades(-1.0, 2.0)}});
    return p;
  }
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
