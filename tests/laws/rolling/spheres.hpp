// spheres.hpp - the law rolling on nodes whose H has spins, through the ABI, in the host's axes.
#pragma once

#include "support/law_batch.hpp"

namespace ilaw::testing {

// h_N, h_T, k, j_N, j_T and nothing.
using SpinInertia = std::array<double, 6>;

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
struct Spheres : LawBatch {
  Spheres(const Parameters& parameters, std::size_t count, std::uint32_t frame = ILAW_FRAME_GLOBAL,
          const std::string& id = "rolling", bool has_tangent = false)
      : LawBatch(make_law(id, SetupBuilder(parameters, 3, ILAW_DELASSUS_TRANSVERSE_SPIN, frame, has_tangent)),
                 count),
        spin_free(count),
        spin_previous(count),
        m(count),
        w(count) {
    normal.assign(count, {0.0, 0.0, 1.0});
    tangent.assign(count, {1.0, 0.0, 0.0});
    h.assign(count, {});
  }

  ilaw_batch batch() {
    ilaw_batch b = LawBatch::batch();
    b.spin_free = ilaw::input(spin_free[0].data(), 3, 1);
    b.spin_previous = ilaw::input(spin_previous[0].data(), 3, 1);
    b.moment = ilaw::output(m[0].data(), 3, 1);
    b.spin = ilaw::output(w[0].data(), 3, 1);
    return b;
  }
  std::int32_t evaluate() { return LawBatch::evaluate(batch()); }
  using LawBatch::evaluate;

  // Any motion, H with k^2 at most `coupling` of h_T j_T, and any normal, all of order 1.
  void draw(unsigned seed, double coupling = 0.8) {
    Random random(seed);
    for (std::size_t i = 0; i < r.size(); ++i) {
      Vector n = random.vector(), t = random.vector();
      n = (1.0 / length(n)) * n;
      t = tangential(t, n);
      normal[i] = n;
      tangent[i] = (1.0 / length(t)) * t;
      v_free[i] = random.vector(), v_previous[i] = random.vector(), spin_free[i] = random.vector(),
      spin_previous[i] = random.vector();
      for (double& entry : h[i]) entry = std::exp(random());
      h[i][2] = random() * std::sqrt(coupling * h[i][1] * h[i][4]);
    }
  }

  std::vector<Vector> spin_free, spin_previous, m, w;  // m, w: moments and spins after
};
using VectorsOfSpheres = std::initializer_list<std::vector<Vector> Spheres::*>;

}  // namespace ilaw::testing
