// draw.hpp - random local problems of any scale, condition and friction; the same for every run.
#pragma once

#include "support/random.hpp"

#include <ilaw/kit/local_coulomb.hpp>

#include <algorithm>

namespace ilaw::testing {

struct Draw : Random {
  using Random::Random;

  double normal() { return normal_(engine); }

  // A A^T + floor I with A of normal entries: full, positive definite.
  void fill_coupled(kit::local_coulomb& p, double floor) {
    double a[3][3];
    for (auto& row : a)
      for (double& entry : row) entry = normal();
    const auto product = [&a](int i, int j) {
      return a[i][0] * a[j][0] + a[i][1] * a[j][1] + a[i][2] * a[j][2];
    };
    const double h[] = {product(0, 0) + floor, product(1, 1) + floor, product(2, 2) + floor,
                        product(0, 1),         product(0, 2),         product(1, 2)};
    std::copy(h, h + 6, p.h);
  }

  // L L^T with pivots over twelve decades: conditions up to 1e12 and beyond.
  void fill_ill_conditioned(kit::local_coulomb& p) {
    const double d[] = {decades(-3, 3), decades(-3, 3), decades(-3, 3)};
    const double l10 = normal() * d[1], l20 = normal() * d[2], l21 = normal() * d[2];
    const double h[] = {d[0] * d[0], l10 * l10 + d[1] * d[1], l20 * l20 + l21 * l21 + d[2] * d[2], d[0] * l10,
                        d[0] * l20,  l10 * l20 + d[1] * l21};
    std::copy(h, h + 6, p.h);
  }

  void fill_pressed_velocity(kit::local_coulomb& p, double scale) {
    p.q[0] = -scale * std::abs(normal());
    p.q[1] = scale * normal();
    p.q[2] = scale * normal();
  }

  // Both, without friction yet.
  kit::local_coulomb pressed_coupled(double floor) {
    kit::local_coulomb p{};
    fill_coupled(p, floor);
    fill_pressed_velocity(p, 1.0);
    return p;
  }

 private:
  std::normal_distribution<double> normal_;
};

}  // namespace ilaw::testing
