// rupture_instants.hpp - when a bond breaks whose limit is on the sum of impulses over the last tau, against
// the instant at which the exact integral of the force passes the limit. tau = 1; a load acts from time 0 on.
#pragma once

#include "support/law_runner.hpp"
#include "support/sizes.hpp"

#include <cstdio>
#include <functional>

namespace ilaw::testing {

struct BondLoad {
  const char* name;
  std::function<double(double)> force, integral;  // of the time since the load began, > 0
  double first, last;                             // instants of rupture to draw
  double onset_error;                             // of the steps' impulses at the start, over h
  double bucket_error;                            // of the window at these instants, over w^3: see window.hpp

  double sum_at(double t) const { return integral(t) - (t > 1.0 ? integral(t - 1.0) : 0.0); }
};

inline std::vector<BondLoad> bond_loads() {
  const double omega = 2.0 * 3.141592653589793 / 3.0;
  return {
      {"ramp", [](double t) { return t; }, [](double t) { return 0.5 * t * t; }, 1.6, 6.0, 0.0, 0.0},
      {"constant", [](double) { return 1.0; }, [](double t) { return t; }, 0.05, 0.7, 0.5, 0.0},
      // |F''| = omega^2, limited slopes at the start; the sum grows by at least 1.3 where the window is full
      {"sine", [omega](double t) { return 1.0 - std::cos(omega * t); },
       [omega](double t) { return t - std::sin(omega * t) / omega; }, 0.3, 1.4, 0.0,
       omega * omega / 8.0 / 1.3}};
}

// A law with a bond of this limit, and the impulse that loads it by r.
struct BondLaw {
  const char* name;
  std::function<Parameters(double limit, double buckets)> parameters;
  Vector direction;
};

// The steps of a host whose time step varies by +- 50 %: a velocity step is the mean of two position steps.
class BondRun {
 public:
  BondRun(const BondLaw& law, double limit, double buckets, double h, bool varies, unsigned seed)
      : law_(law), node_(law.name, law.parameters(limit, buckets), h), h_(h), varies_(varies), random_(seed) {
    node_.time = 20.0 * uniform() - 10.0;
    before_ = next();
    after_ = next();
  }

  // The first step at which it breaks, since the load began; NAN if it holds until end.
  double rupture_instant(const std::function<double(double)>& force, double end) {
    const double begin = node_.time + (2.0 + uniform()) * h_;
    while (node_.time - begin < end) {
      const double t = node_.time + before_ - begin;
      if (step(t > 0.0 ? force(t) * 0.5 * (before_ + after_) : 0.0)) return t;
    }
    return NAN;
  }

  // One step with this impulse; whether the bond breaks.
  bool step(double impulse) {
    node_.time += before_;
    node_.dt = 0.5 * (before_ + after_);
    node_.position_dt = after_;
    before_ = after_;
    after_ = next();
    const Vector& d = law_.direction;
    EXPECT_EQ(node_.step({impulse * d[0], impulse * d[1], impulse * d[2]}), ILAW_OK) << node_.report.reason;
    return node_.status == ILAW_BROKEN;
  }

  double uniform() { return static_cast<double>(random_() >> 11) * 0x1p-53; }

 private:
  double next() { return varies_ ? h_ * (0.5 + uniform()) : h_; }

  const BondLaw& law_;
  NodeRun node_;
  double h_;
  bool varies_;
  std::mt19937_64 random_;
  double before_ = 0.0, after_ = 0.0;  // position steps
};

// Half a step cannot be avoided, half the longest one (1.5 h) where steps vary; below tau/h of 2 the midpoint
// rule of the impulses themselves is off by some tenths of h.
inline double allowed_error(const BondLoad& load, double ratio, double buckets, bool varies) {
  const double steps = (varies ? 0.8 : 0.52) + (varies ? 1.5 : 1.0) * load.onset_error;
  return steps + (ratio < 2.0 ? 0.3 : 0.0) + load.bucket_error * ratio / (buckets * buckets * buckets);
}

// Over phases, limits and absolute times; prints the table of the law's page.
inline void expect_rupture_instants(const BondLaw& law) {
  for (const bool varies : {false, true})
    for (const BondLoad& load : bond_loads()) {
      std::printf("%s, %s, %s h: largest error of the rupture instant over h\n", law.name, load.name,
                  varies ? "varying" : "constant");
      for (const double buckets : {4.0, 8.0, 16.0, 64.0}) {
        std::printf("  B = %2.0f:", buckets);
        for (const double ratio : {1.5, 8.5, 33.7, 100.5, 1000.3}) {
          double largest = 0.0;
          const auto draws = static_cast<unsigned>(part_of(ratio > 500.0 ? 16 : 40));
          for (unsigned draw = 0; draw < draws; ++draw) {
            const double exact = load.first + (load.last - load.first) * (draw + 0.37) / draws;
            BondRun run(law, load.sum_at(exact), buckets, 1.0 / ratio, varies, draw + 1);
            const double found = run.rupture_instant(load.force, load.last + 3.0);
            largest = std::max(largest, std::isnan(found) ? 1e9 : std::abs(found - exact) * ratio);
          }
          std::printf(" %.2f", largest);
          EXPECT_LE(largest, allowed_error(load, ratio, buckets, varies))
              << law.name << " " << load.name << " tau/h " << ratio << " B " << buckets << " varies "
              << varies;
        }
        std::printf("\n");
      }
    }
}

// Two shocks of 0.6 of the limit break together when less than tau apart: the window sees the first whole
// until tau - w, and not at all from tau + w on.
inline void expect_double_shocks(const BondLaw& law) {
  for (const double buckets : {4.0, 16.0, 64.0})
    for (const double ratio : {8.5, 33.7, 100.5, 1000.3}) {
      double shortest_that_holds = 1e9, longest_that_breaks = 0.0;
      for (unsigned draw = 0; draw < static_cast<unsigned>(part_of(ratio > 500.0 ? 20 : 200)); ++draw) {
        BondRun run(law, 1.0, buckets, 1.0 / ratio, false, draw + 1);
        const auto steps = static_cast<int>(ratio * (1.0 + (1.8 * run.uniform() - 1.2) / buckets));
        run.step(0.6);
        for (int k = 1; k < steps; ++k) run.step(0.0);
        const double distance = steps / ratio;
        if (run.step(0.6))
          longest_that_breaks = std::max(longest_that_breaks, distance);
        else
          shortest_that_holds = std::min(shortest_that_holds, distance);
      }
      std::printf("%s, double shock, B = %2.0f, tau/h = %6.1f: holds from %.4f tau, breaks up to %.4f tau\n",
                  law.name, buckets, ratio, shortest_that_holds, longest_that_breaks);
      EXPECT_GE(shortest_that_holds, 1.0 - 1.0 / buckets - 1.0 / ratio) << buckets << " " << ratio;
      EXPECT_LE(longest_that_breaks, 1.0 + 1.0 / buckets) << buckets << " " << ratio;
    }
}

}  // namespace ilaw::testing
