// The window of impulses against the exact integral of the force over the last tau.
#include "window_in_test.hpp"

#include "support/matchers.hpp"
#include "support/random.hpp"

#include <algorithm>
#include <cstring>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace {

using ilaw::kit::infinity;
using ilaw::kit::refusal;
using ilaw::kit::step_interval;
using ilaw::kit::window;
using ilaw::testing::Random;

constexpr double ratios[] = {1.5, 8.5, 33.7, 100.5, 1000.3};  // tau/h
constexpr double bucket_counts[] = {4, 8, 16, 64};

using window_in_test::Reading;
using window_in_test::Steps;
using window_in_test::vector;
using window_in_test::Window;

// A force by its integral, from which every step gets the exact impulse: what is off is the window.
using Integral = std::function<double(double)>;

// Largest |S - integral over the last tau| over 5 tau, once the window is full of a force that acts from
// -inf.
double largest_error(const Integral& integral, double tau, double h, double buckets, bool varies) {
  Window w(tau, buckets, -3.0 * tau);
  Steps steps(h, varies);
  double largest = 0.0;
  while (w.end < 4.0 * tau) {
    const double step = steps.next();
    const double sum = w.step(step, {integral(w.end + step) - integral(w.end), 0, 0}).n;
    if (w.end > -tau) largest = std::max(largest, std::abs(sum - (integral(w.end) - integral(w.end - tau))));
  }
  return largest;
}

TEST(Window, NeedsAStateThatDependsOnItsParametersAlone) {
  EXPECT_EQ(window::doubles({0.0, 16}), 0);
  EXPECT_EQ(window::doubles({infinity, 16}), 3);
  EXPECT_EQ(window::doubles({1e-9, 16}), 58);
  EXPECT_EQ(window::doubles({1e9, 16}), 58);
  EXPECT_EQ(window::doubles({1.0, 1}), 13);
}

// Values read in every step come first, the ring after them. Hosts have stored states in this order: a change
// of it must raise the state_version of postit and tie.
TEST(Window, StandsInAStateInTheOrderOfVersion2) {
  const auto impulse_in = [](double bucket) -> std::vector<double> {
    return {bucket, 2.0 * bucket, -bucket * bucket};
  };
  Window w(4.0, 4, 0.0);
  for (double k = 1.0; k <= 7.0; k += 1.0) {
    const std::vector<double> given = impulse_in(k);
    w.step_to(k + 0.75, 0.5, {given[0], given[1], given[2]});
  }
  std::vector<double> expected = {8.0};  // the newest bucket is the eighth from time 0 on
  for (const std::vector<double>& three : {impulse_in(7.0),
                                           {15.0, 30.0, -77.0},
                                           impulse_in(3.0),
                                           {1.0, 2.0, -7.0},
                                           impulse_in(6.0),
                                           impulse_in(4.0),
                                           impulse_in(5.0)})
    expected.insert(expected.end(), three.begin(), three.end());
  EXPECT_EQ(w.history, expected);
}

TEST(Window, ShorterThanAStepIsTheOwnImpulse) {
  Window w(0.9e-3, 16, 0.0);
  for (int k = 0; k < 100; ++k) EXPECT_EQ(w.step(1e-3, {1.0 + k, 0, 0}).n, 1.0 + k);
}

TEST(Window, OfInfiniteDurationIsTheSumOfAll) {
  Window w(infinity, 16, 0.0);
  double all = 0.0;
  for (int k = 0; k < 1000; ++k) EXPECT_EQ(w.step(1e-3, {0.5 + k, 0, 0}).n, all += 0.5 + k);
}

// A force F from long before: S = F tau at any ratio, with any number of buckets and any steps.
TEST(Window, OfAConstantForceIsForceTimesDuration) {
  for (const double ratio : ratios)
    for (const double buckets : {1.0, 2.0, 3.0, 4.0, 16.0, 64.0, 999.0})
      for (const bool varies : {false, true})
        EXPECT_LE(largest_error([](double t) { return 3.0 * t; }, 1.0, 1.0 / ratio, buckets, varies), 1e-12)
            << "tau/h " << ratio << ", " << buckets << " buckets, varies " << varies;
}

// A constant force since the window began, whose first step is longer than tau and a bucket: what counts of
// it later is what lies within tau, no more.
TEST(Window, KeepsOfALongFirstStepWhatLiesWithinItsDuration) {
  constexpr double force = 3.0;
  for (const double beyond : {0.02, 0.37, 4.3})
    for (const double buckets : {1.0, 2.0, 3.0, 8.0, 16.0, 64.0})
      for (const double h : {0.0137, 0.11, 0.23}) {
        const double longest = 1.0 + 1.0 / buckets + beyond;
        Window w(1.0, buckets, -2.6);
        ASSERT_EQ(w.step(longest, {force * longest, 0, 0}).n, force * longest);
        for (int k = 0; k * h < 3.0; ++k)
          ASSERT_NEAR(w.step(h, {force * h, 0, 0}).n, force, 1e-12)
              << "first step " << longest << ", " << buckets << " buckets, h " << h << ", step " << k;
      }
}

// A step is spread evenly although the force in it is not, which matters where an edge cuts it: at most
// h^2 F'/8 at each of three edges, those of the oldest bucket and that of tau.
double cut_steps(double longest) { return 3.0 * longest * longest / 8.0; }

// Whether the slope in the oldest bucket is known in every step.
bool knows_slope(double longest, double w) { return longest <= 1.0 - 2.0 * w; }

TEST(Window, OfALinearForceIsExactButForTheStepsThatAnEdgeCuts) {
  for (const double ratio : ratios)
    for (const double buckets : {1.0, 2.0, 4.0, 16.0, 64.0})
      for (const bool varies : {false, true}) {
        const double h = 1.0 / ratio, longest = varies ? 1.5 * h : h, w = 1.0 / buckets;
        EXPECT_LE(largest_error([](double t) { return 0.5 * t * t + 10.0 * t; }, 1.0, h, buckets, varies),
                  (knows_slope(longest, w) ? 0.0 : w * w / 8.0) + cut_steps(longest) + 1e-12)
            << "tau/h " << ratio << ", " << buckets << " buckets, varies " << varies;
      }
}

// F = 2 + sin(t) keeps its sign, so that no slope is limited: w^3 |F''|/(9 sqrt 3), and the steps.
TEST(Window, OfASmoothForceKeepsItsBound) {
  for (const double ratio : ratios)
    for (const double buckets : {2.0, 4.0, 8.0, 16.0, 64.0})
      for (const bool varies : {false, true}) {
        const double h = 1.0 / ratio, longest = varies ? 1.5 * h : h, w = 1.0 / buckets;
        const double error =
            largest_error([](double t) { return 2.0 * t - std::cos(t); }, 1.0, h, buckets, varies);
        EXPECT_LE(error, (knows_slope(longest, w) ? w * w * w / (9.0 * std::sqrt(3.0)) : w * w / 8.0) +
                             cut_steps(longest))
            << "tau/h " << ratio << ", " << buckets << " buckets, varies " << varies;
      }
}

// Where it changes its sign the slope is limited: w^2 |F'|/8.
TEST(Window, OfAForceThatChangesItsSignIsOfSecondOrder) {
  for (const double ratio : {100.5, 1000.3})
    for (const double buckets : {1.0, 2.0, 4.0, 8.0, 16.0, 64.0}) {
      const double error =
          largest_error([](double t) { return -std::cos(3.0 * t) / 3.0; }, 1.0, 1.0 / ratio, buckets, true);
      EXPECT_LE(error, 3.0 / (8.0 * buckets * buckets) + 3.0 * cut_steps(1.5 / ratio))
          << ratio << " " << buckets;
    }
}

TEST(Window, IsOfThirdOrderInTheBucket) {
  const auto error = [](double buckets) {
    return largest_error([](double t) { return 2.0 * t - std::cos(3.0 * t) / 3.0; }, 1.0, 1e-5, buckets,
                         false);
  };
  for (const double coarse : {4.0, 8.0}) EXPECT_GT(std::log2(error(coarse) / error(2.0 * coarse)), 2.85);
}

// With one bucket the integral is interpolated linearly: w^2 |F'|/8.
TEST(Window, OfOneBucketIsOfSecondOrder) {
  for (const double tau : {0.5, 0.1}) {
    const double error =
        largest_error([](double t) { return 2.0 * t - std::cos(t); }, tau, tau / 500.3, 1, false);
    EXPECT_LE(error, tau * tau / 8.0 * 1.01) << tau;
    EXPECT_GE(error, tau * tau / 8.0 * 0.8) << tau;
  }
}

// A force that is switched on: never more than the exact sum, so that what holds for ever holds; and off by
// at most w J/4 while the jump's bucket leaves.
TEST(Window, OfAForceSwitchedOnNeverExceedsForceTimesDuration) {
  for (const double ratio : ratios)
    for (const double buckets : bucket_counts) {
      Window w(1.0, buckets, 5.123);
      const double begin = w.end, h = 1.0 / ratio;
      while (w.end < begin + 3.0) {
        const double sum = w.step(h, {h, 0, 0}).n, exact = std::min(w.end - begin, 1.0);
        ASSERT_LE(sum, exact + h * (w.end - begin < 1.0 + h ? 1.0 : 0.0) + 1e-12) << ratio << " " << buckets;
        ASSERT_GE(sum, exact - 0.25 / buckets - 1e-12) << ratio << " " << buckets << " at " << w.end - begin;
      }
    }
}

// A shock counts whole until tau - w after its step, and is gone tau + w after it.
TEST(Window, KeepsAShockWholeAndLosesItWhole) {
  Random random(3);
  for (const double ratio : {8.5, 33.7, 100.5, 1000.3})
    for (const double buckets : bucket_counts)
      for (int draw = 0; draw < 20; ++draw) {
        Window w(1.0, buckets, 100.0 * random(0.0, 1.0) - 50.0);
        const double h = 1.0 / ratio, begin = w.end;
        w.step(h, {0.6, 0, -0.3});
        while (w.end < begin + 3.0) {
          const vector sum = w.step(h, {});
          const double age = w.end - begin - h;
          if (age <= 1.0 - 1.0 / buckets - h) {
            ASSERT_NEAR(sum.n, 0.6, 1e-15) << ratio << " " << buckets << " age " << age;
            ASSERT_NEAR(sum.t2, -0.3, 1e-15);
          }
          if (age >= 1.0 + 1.0 / buckets) {
            ASSERT_EQ(sum.n, 0.0) << ratio << " " << buckets << " age " << age;
          }
          ASSERT_GE(sum.n, 0.0);
          ASSERT_LE(sum.n, 0.6 + 1e-15);
        }
      }
}

// Both clocks that hosts keep: the number of the step times h, and a sum of steps, which rounds at each.
TEST(Window, DoesNotDriftInTenMillionSteps) {
  constexpr double tau = 1.0, h = tau / 1000.3;
  for (const bool adds_up : {false, true}) {
    Window w(tau, 16, 0.0);
    double largest = 0.0;
    for (std::int64_t k = 1; k <= 10000000; ++k) {
      const double end = adds_up ? w.end + h : static_cast<double>(k) * h;
      const double sum = w.step_to(end, h, {h, 0, 0}).n;
      if (end > 2.0 * tau) largest = std::max(largest, std::abs(sum - tau));
    }
    EXPECT_LE(largest, adds_up ? ilaw::kit::window_slack : 1e-11) << adds_up;
  }
}

// After millions of random impulses it is, bit for bit, a window that saw the last ones alone.
TEST(Window, ForgetsWhatIsOlderThanItsDuration) {
  Random random(4);
  Window old(8.3e-3, 8, 0.0), young(8.3e-3, 8, 0.0);
  constexpr int count = 1000000;
  for (int k = 1; k <= count; ++k) {
    const vector impulse{random(-1e6, 1e6), random(-1e6, 1e6), random(-1e6, 1e6)};
    const vector sum = old.step_to(k * 1e-3, 1e-3, impulse);
    if (k <= count - 50) continue;
    const vector fresh = young.step_to(k * 1e-3, 1e-3, impulse);
    if (k > count - 35) {
      ASSERT_EQ(sum.n, fresh.n) << k;
      ASSERT_EQ(sum.t1, fresh.t1) << k;
    }
  }
}

// Steps without impulse may be left out: the state stays as it was, and later sums have the same bits.
TEST(Window, NeedNotBeToldOfStepsWithoutImpulse) {
  Random random(5);
  for (const double ratio : ratios) {
    Window told(1.0, 8, -2.0), skipped(1.0, 8, -2.0);
    const double h = 1.0 / ratio;
    bool acts = true;
    for (int k = 0; k < 5000; ++k) {
      if (random.below(20) == 0) acts = !acts;
      const vector impulse = acts ? vector{random(), random(), 0} : vector{};
      const std::vector<double> before = told.history;
      const vector sum = told.step(h, impulse);
      if (!acts) {
        ASSERT_EQ(told.history, before) << ratio << " " << k;
        continue;
      }
      ASSERT_EQ(sum.n, skipped.step_to(told.end, h, impulse).n) << ratio << " " << k;
      ASSERT_EQ(told.history, skipped.history) << ratio << " " << k;
    }
  }
}

TEST(Window, SeesAClockThatIsSetBack) {
  Window w(1.0, 16, 100.0);
  for (int k = 0; k < 500; ++k) w.step(0.01, {0.01, 0, 0});
  const double now = w.end;
  for (const double back : {0.2, 1.0, 100.0, 1e6}) {
    w.end = now - back;
    EXPECT_EQ(w.before(0.01).refused, refusal::time_before_history) << back;
  }
  w.end = now - 0.05;  // less than a bucket: a host whose steps shrink may fall back by part of one
  EXPECT_EQ(w.before(0.01).refused, refusal::none);
  w.step(0.01, {0.01, 0, 0});
}

// An abrupt change of the step in a host that knows one step alone: ends may fall back by part of a step.
TEST(Window, TakesAnyChangeOfStep) {
  Window w(1.0, 16, 0.0);
  double time = 0.0;
  for (int k = 0; k < 4000; ++k) {
    const double h = (k / 50) % 2 == 0 ? 0.04 : 1e-3;
    time += h;
    const double sum = w.step_to(time + 0.5 * h, h, {h, 0, 0}).n;
    if (time > 3.0) {
      ASSERT_NEAR(sum, 1.0, 0.08) << k;  // two steps
    }
  }
}

// Whatever a history holds, nothing but it is touched, and a reading is finite or refused.
TEST(Window, TouchesNothingButItsHistory) {
  std::mt19937_64 random(8);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> odd = {nan,  infinity, -infinity,  1e300, -1e300, 9e15, -9e15, 0.5, -1.0,
                                   -0.0, 5e-324,   4611686e12, 1e19,  -1e19,  2e9,  17.0,  16.0};
  constexpr std::size_t guard = 64, numbers = 58;
  constexpr ilaw::kit::window_size size{1.0, 16.0};
  for (int draw = 0; draw < 200000; ++draw) {
    std::array<double, guard + numbers + guard> memory{};
    for (double& x : memory) x = odd[random() % odd.size()];
    if (draw % 3 == 0) memory[guard] = static_cast<double>(random() % 2000);
    const auto before = memory;
    const window_in_test::History own{memory.data() + guard, 1};
    const double times[] = {0.0, 30.0, -1e5, 1e20, 0.99 + static_cast<double>(draw % 1999) / 16.0};
    const step_interval step{times[random() % 5], draw % 2 == 0 ? 0.01 : 0.3};
    const Reading reading = window_in_test::read(size, step, own);
    if (reading.refused == refusal::none) {
      ASSERT_TRUE(std::isfinite(reading.sum.n) && std::isfinite(reading.sum.t1)) << "draw " << draw;
      window_in_test::write(size, step, own, {1.0, 0.5, 0.0});
    }
    ASSERT_EQ(std::memcmp(memory.data(), before.data(), guard * sizeof(double)), 0) << "draw " << draw;
    ASSERT_EQ(
        std::memcmp(memory.data() + guard + numbers, before.data() + guard + numbers, guard * sizeof(double)),
        0)
        << "draw " << draw;
  }
}

// A clock so far on that a step is below its resolution: impulses still count, whole.
TEST(Window, CountsStepsThatItsClockCannotResolve) {
  Window w(1.0, 16, 0x1p46);
  for (int k = 1; k <= 100; ++k) EXPECT_EQ(w.step_to(0x1p46, 1e-4, {1.0, 0, 0}).n, k);
  Window beyond(1e-9, 16, 1e9);
  for (int k = 1; k <= 100; ++k) EXPECT_EQ(beyond.step_to(1e9, 1e-10, {1.0, 0, 0}).n, 1.0);
}

TEST(Window, RefusesANumberOfABucketThatItCannotHaveWritten) {
  for (const double stamp :
       {0.5, -2.25, 1e16, -1e300, infinity, -infinity, std::numeric_limits<double>::quiet_NaN()}) {
    Window w(1.0, 16, 3.0);
    w.history[0] = stamp;
    EXPECT_EQ(w.before(0.01).refused, refusal::impossible_state) << stamp;
  }
  Window future(1.0, 16, 3.0);
  future.history[0] = 1000.0;
  EXPECT_EQ(future.before(0.01).refused, refusal::time_before_history);
}

// A number of the history that is not finite is found as soon as it counts, at the latest when the next
// bucket opens.
TEST(Window, RefusesASumThatIsNotFinite) {
  for (const double bad : {infinity, std::numeric_limits<double>::quiet_NaN()})
    for (std::size_t entry = 1; entry < 58; ++entry) {
      Window w(1.0, 16, 0.0);
      for (int k = 0; k < 305; ++k) w.step(0.01, {0.01, 0.02, 0.03});
      w.history[entry] = bad;
      bool refused = false;
      for (int k = 0; k < 8 && !refused; ++k) {  // 0.08 is more than a bucket
        w.end += 0.01;
        const Reading reading = w.before(0.01);
        refused = reading.refused == refusal::impossible_state;
        if (!refused) w.add(0.01, {0.01, 0.02, 0.03});
      }
      EXPECT_TRUE(refused) << "entry " << entry;
    }
}

// The tangential part turns with the impulses: no axis is preferred.
TEST(Window, IsIsotropicInTheTangentPlane) {
  Random random(6);
  const double c = std::cos(0.7), s = std::sin(0.7);
  Window plain(1.0, 4, 0.0), turned(1.0, 4, 0.0);
  for (int k = 0; k < 20000; ++k) {
    const vector r{random(), random(), random()};
    const vector a = plain.step(0.0137, r);
    const vector b = turned.step(0.0137, {r.n, c * r.t1 - s * r.t2, s * r.t1 + c * r.t2});
    ASSERT_EQ(a.n, b.n) << k;
    ASSERT_NEAR(c * a.t1 - s * a.t2, b.t1, 1e-13) << k;
    ASSERT_NEAR(s * a.t1 + c * a.t2, b.t2, 1e-13) << k;
  }
}

}  // namespace
