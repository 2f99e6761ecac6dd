// ball.hpp - a ball on a plane under gravity, in central differences, whose contact is a law with spins.
#pragma once

#include "laws/rolling/spheres.hpp"

namespace ilaw::testing {

// A solid ball, I = 2/5 M R^2. Its contact point has the velocity v + w x (-R n).
class Ball {
 public:
  static constexpr double mass = 0.3, radius = 0.05, gravity = 9.81, inertia = 0.4 * mass * radius * radius;

  // slope: angle of the plane, downwards along x.
  Ball(const Parameters& parameters, double h, double slope = 0.0, const std::string& law = "rolling")
      : contact_(parameters, 1, ILAW_FRAME_GLOBAL, law),
        sinks_(law != "rolling"),
        pull_{gravity * std::sin(slope), 0.0, -gravity * std::cos(slope)} {
    contact_.velocity_step = contact_.position_step = h;
    contact_.h[0] = {1.0 / mass, 1.0 / mass + radius * radius / inertia, radius / inertia, 1.0 / inertia,
                     1.0 / inertia};
  }

  void step() {
    const Vector n = contact_.normal[0], arm = -radius * n;
    contact_.v_previous[0] = v + cross(w, arm);
    contact_.spin_previous[0] = w;
    v = v + contact_.velocity_step * pull_;
    contact_.v_free[0] = v + cross(w, arm);
    contact_.spin_free[0] = w;
    ASSERT_EQ(contact_.evaluate(), ILAW_OK) << contact_.report.reason;
    v = v + (1.0 / mass) * contact_.r[0];
    w = w + (1.0 / inertia) * (cross(arm, contact_.r[0]) + contact_.m[0]);
    // Masses and arms say what the five numbers of H say.
    ASSERT_LE(length(v + cross(w, arm) - contact_.v[0]), 1e-12);
    ASSERT_LE(length(w - contact_.w[0]), 1e-10);
    x = x + contact_.velocity_step * v;
    if (sinks_) contact_.gap[0] += contact_.velocity_step * v[2];
    dissipated += contact_.energy[0][ILAW_ENERGY_FRICTION] + contact_.energy[0][ILAW_ENERGY_IMPACT];
  }
  void run(double time) {
    for (int k = 0; k < std::lround(time / contact_.velocity_step); ++k) step();
  }
  double kinetic_energy() const { return 0.5 * (mass * dot(v, v) + inertia * dot(w, w)); }
  double stored_energy() const { return contact_.energy[0][ILAW_ENERGY_STORED]; }
  std::uint8_t status() const { return contact_.status[0]; }

  Vector x{}, v{}, w{};
  double dissipated = 0.0;

 private:
  Spheres contact_;
  bool sinks_;  // into a contact that is a spring
  Vector pull_;
};

}  // namespace ilaw::testing
