// contact_circle.hpp - one step of the normal force of two spheres. With z^2 the radius of the circle of
// contact over R, overlap, energy and force in units of R, E R^3 and E R^2 are (Johnson, Kendall, Roberts
// 1971)
//     D = z^4 - s z,  U = 8/15 z^10 - 4/3 s z^7 + s^2/2 z^4 - d z^4,  F = dU/dD = 4/3 z^6 - 2 s z^3 - d,
// s^2 = 2 pi w/(E R), d = 0 for JKR; s = 0, d = 2 pi w/(E R) for DMT; both are 0 for Hertz.
#pragma once

#include <ilaw/kit/roots.hpp>

namespace grain_law {

using namespace ilaw::kit;

template <class V>
struct adhesion_scale {
  V s, d;
  V touch, least;  // z where the surfaces meet, D = 0, and where the neck breaks, dD/dz = 0
  V lost, pull;    // what breaks takes, and the largest pull

  static adhesion_scale jkr(V square) {
    constexpr double third = 1.0 / 3.0, root_of_quarter = 0.62996052494743658;
    const V s = square_root(square), touch = power(s, third), third_power = s * touch;
    return {s,
            0.0,
            touch,
            root_of_quarter * touch,
            (0.3 + 0.05 * root_of_quarter) * (third_power * s * s),
            0.75 * square};
  }
  static adhesion_scale dmt(V square) { return {0.0, square, 0.0, 0.0, 0.0, square}; }

  // (U(a) - U(b))/(a - b) and the same of D: nothing cancels where a is close to b.
  struct differences {
    V energy, overlap;
  };
  differences between(V a, V b) const {
    const V a2 = a * a, b2 = b * b, p3 = a2 + a * b + b2, p4 = (a + b) * (a2 + b2);
    const V p5 = a * p4 + b2 * b2, p7 = a * a2 * p4 + b2 * b2 * p3,
            p10 = p5 * (a * (a2 * a2) + b * (b2 * b2));
    return {8.0 / 15.0 * p10 - 4.0 / 3.0 * s * p7 + (0.5 * s * s - d) * p4, p4 - s};
  }
  // U from where the surfaces meet on, grown being z less that.
  V energy(V grown) const { return grown * between(touch + grown, touch).energy; }
  V force(V z) const {
    const V cube = z * z * z;
    return cube * (4.0 / 3.0 * cube - 2.0 * s) - d;
  }
};

// D + apart moves by -h vbar/R, under the mean force S = (U(z') - U(z))/(D(z') - D(z) + apart), which gives U
// back whatever the step (Simo and Tarnow 1992): the root z' of
//     f = D(z') - D(z) + apart + travel + give S.
template <class V>
struct circle_step {
  adhesion_scale<V> scale;
  V grown;      // z less that at which the surfaces meet
  V apart;      // the gap before, over R
  V travel;     // h (v_free + v^-)/(2 R)
  V give;       // h^2 H E R/2
  V viscosity;  // 2 A/h

  struct motion {
    V moved;         // D(z') - D(z) + apart
    V force, slope;  // S with the viscous force, and its derivative by z'
    V viscosity;     // 0 where it does not count
  };
  V before() const { return scale.touch + grown; }
  // To z + growth.
  motion by(V growth) const {
    const V b = before(), z = b + growth, steep = 4.0 * (z * z * z) - scale.s;
    const auto mean = scale.between(z, b);
    const V closed = growth * mean.overlap, moved = closed + apart;
    const V elastic = select(apart > 0.0, growth * mean.energy / moved,
                             zero_unless(mean.overlap > 0.0, mean.energy / mean.overlap));
    const V stiff = (scale.force(z) - elastic) * steep / moved;
    // Viscosity never pulls more than the elastic force does.
    const V viscous = elastic + viscosity * (z * z) * closed, least = smaller(elastic, 0.0);
    const V damped = stiff + viscosity * (z * (2.0 * closed + z * steep));
    const mask_of<V> counts = viscous > least;
    return {moved, larger(viscous, least), select(counts, damped, zero_unless(elastic < 0.0, stiff)),
            zero_unless(counts, viscosity)};
  }
  V residual(const motion& m) const { return m.moved + travel + give * m.force; }
  // By the motion where that rounds less: the terms of S, of the pull's size, cancel in a stiff step.
  V force_of(const motion& m) const {
    return select(give * scale.pull > absolute(travel), -(m.moved + travel) / give, m.force);
  }
  V most_that_opens() const { return before() - scale.least; }

  // The neck breaks where even that much force does not hold it.
  mask_of<V> breaks() const { return (residual(by(0.0)) > 0.0) & (residual(by(-most_that_opens())) > 0.0); }
  // Then y = D(z) - D' of y^2 - travel y + give (lost - U) = 0.
  V force_of_break() const {
    const V rest = scale.lost - scale.energy(grown);
    const V root = square_root(positive_part(travel * travel - 4.0 * give * rest));
    const V y = select(travel > 0.0, 0.5 * (travel + root), -2.0 * give * rest / (root - travel));
    return zero_unless(y > 0.0, -rest / y);
  }

  // z' - z.
  V solve() const {
    const V there = residual(by(0.0)), sign = select(there > 0.0, V(-1.0), V(1.0)), b = before();
    // D of the farthest that the largest pull may bring about, and a z beyond it.
    const V deep = b * (b * b * b - scale.s) - apart - travel + give * scale.pull;
    const V farthest = square_root(square_root(positive_part(deep))) + scale.touch;
    const V most = select(there > 0.0, most_that_opens(), positive_part(farthest - b));
    // By the stiffness of Hertz's contact before the step, where there was one.
    const V cube = b * b * b, first = absolute(there) / (4.0 * cube * (1.0 + give * (b * b)));
    const V start = select((grown != 0.0) & (first < most), first, most);
    return sign * root_between(V(0.0), most, start, there != 0.0, [&](V size_of) ILAW_KIT_LAMBDA {
             const V z = b + sign * size_of, square = z * z, steep = 4.0 * (z * square) + scale.s;
             const motion m = by(sign * size_of);
             const V rise = steep - 2.0 * scale.s + give * m.slope;
             const V fourth = square * square, part = fourth / (fourth + apart);  // of the way, in contact
             const V size = steep * (1.0 + give * (square * (2.0 * part + m.viscosity)));
             const mask_of<V> is_exact = (size_of > 1e-4 * z) & (rise > 0.125 * size);
             return root_trial<V>{sign * residual(m), size, select(is_exact, rise, size), 1.0, is_exact};
           });
  }
};

}  // namespace grain_law
