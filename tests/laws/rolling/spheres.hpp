// spheres.hpp - laws on nodes whose H has spins, through the ABI, in the host's axes.
#pragma once

#include "support/law_runner.hpp"

#include <ilaw/arrays.hpp>

#include <random>

namespace ilaw::testing {

inline Vector operator+(const Vector& a, const Vector& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Vector operator-(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Vector operator*(double s, const Vector& a) { return {s * a[0], s * a[1], s * a[2]}; }
inline Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline Vector tangential(const Vector& a, const Vector& n) { return a - dot(a, n) * n; }
inline double length(const Vector& a) { return std::sqrt(dot(a, a)); }

// h_N, h_T, k, j_N, j_T.
using SpinInertia = std::array<double, 5>;

// v - v_free and w - w_free as ilaw.h has them.
struct Gain {
  Vector velocity, spin;
};
inline Gain gain_of(const SpinInertia& h, const Vector& n, const Vector& r, const Vector& m) {
  return {(h[0] * dot(r, n)) * n + h[1] * tangential(r, n) + h[2] * cross(n, m),
          (h[3] * dot(m, n)) * n + h[4] * tangential(m, n) - h[2] * cross(n, r)};
}

inline Parameters resistance(double friction, double rolling, double twisting, double restitution = 0.0) {
  return {{{"friction", friction},
           {"rolling_friction", rolling},
           {"twisting_friction", twisting},
           {"restitution", restitution}},
          {}};
}

// Nodes in touch, each with its own H and normal.
class Spheres {
 public:
  Spheres(const Parameters& parameters, std::size_t count, std::uint32_t frame = ILAW_FRAME_GLOBAL,
          const std::string& law = "rolling", bool has_tangent = false)
      : interface_(
            make_law(law, SetupBuilder(parameters, 3, ILAW_DELASSUS_TRANSVERSE_SPIN, frame, has_tangent))),
        v_free(count),
        v_previous(count),
        spin_free(count),
        spin_previous(count),
        normal(count, {0.0, 0.0, 1.0}),
        tangent(count, {1.0, 0.0, 0.0}),
        r(count),
        m(count),
        v(count),
        w(count),
        h(count),
        gap(count),
        energy(count),
        state(count * interface_.info().state_size),
        status(count) {
    if (!state.empty()) interface_.initialise(batch());
  }

  ilaw_batch batch() {
    ilaw_batch b{};
    b.struct_size = sizeof b;
    b.node_count = static_cast<std::int64_t>(r.size());
    b.velocity_step = b.position_step = step;
    b.v_free = ilaw::input(v_free[0].data(), 3, 1);
    b.v_previous = ilaw::input(v_previous[0].data(), 3, 1);
    b.delassus = ilaw::input(h[0].data(), 5, 1);
    b.gap = ilaw::input(gap.data(), 1, 1);
    b.normal = ilaw::input(normal[0].data(), 3, 1);
    b.tangent = ilaw::input(tangent[0].data(), 3, 1);
    b.impulse = ilaw::output(r[0].data(), 3, 1);
    b.velocity = ilaw::output(v[0].data(), 3, 1);
    b.energy = ilaw::output(energy[0].data(), ILAW_ENERGY_COUNT, 1);
    b.status = status.data();
    b.status_stride = 1;
    const auto size = static_cast<std::int64_t>(interface_.info().state_size);
    b.state_in = ilaw::input(state.data(), size, 1);
    b.state_out = ilaw::output(state.data(), size, 1);
    b.spin_free = ilaw::input(spin_free[0].data(), 3, 1);
    b.spin_previous = ilaw::input(spin_previous[0].data(), 3, 1);
    b.moment = ilaw::output(m[0].data(), 3, 1);
    b.spin = ilaw::output(w[0].data(), 3, 1);
    report.struct_size = sizeof report;
    return b;
  }
  std::int32_t evaluate() { return evaluate(batch()); }
  std::int32_t evaluate(const ilaw_batch& b) { return interface_.evaluate(b, &report); }

  // Any motion, H with k^2 at most `coupling` of h_T j_T, and any normal, all of order 1.
  void draw(unsigned seed, double coupling = 0.8) {
    std::mt19937 bits(seed);
    const auto within = [&](double low, double high) {
      return std::uniform_real_distribution<double>(low, high)(bits);
    };
    const auto any = [&] { return Vector{within(-1.0, 1.0), within(-1.0, 1.0), within(-1.0, 1.0)}; };
    for (std::size_t i = 0; i < r.size(); ++i) {
      Vector n = any(), t = any();
      n = (1.0 / length(n)) * n;
      t = tangential(t, n);
      normal[i] = n;
      tangent[i] = (1.0 / length(t)) * t;
      v_free[i] = any(), v_previous[i] = any(), spin_free[i] = any(), spin_previous[i] = any();
      for (double& entry : h[i]) entry = std::exp(within(-1.0, 1.0));
      h[i][2] = within(-1.0, 1.0) * std::sqrt(coupling * h[i][1] * h[i][4]);
    }
  }

 private:
  ilaw::interface interface_;

 public:
  double step = 1e-3;
  std::vector<Vector> v_free, v_previous, spin_free, spin_previous, normal, tangent, r, m, v, w;
  std::vector<SpinInertia> h;
  std::vector<double> gap;
  std::vector<std::array<double, ILAW_ENERGY_COUNT>> energy;
  std::vector<double> state;
  std::vector<std::uint8_t> status;
  ilaw_report report{};
};

}  // namespace ilaw::testing
