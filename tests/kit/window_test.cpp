// The window of impulses against the sum over all impulses with age < tau.
#include <ilaw/kit/window.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <random>
#include <vector>

namespace {

using ilaw::kit::vector;
using ilaw::kit::window;

// A window in memory of its own, and the same with everything remembered.
class Windows {
 public:
  Windows(double duration, double buckets, double smallest_step)
      : duration_(duration),
        slots_(window::slot_count(duration, buckets, smallest_step)),
        memory_(static_cast<std::size_t>(window::doubles(slots_)) + 1) {}

  // A step: the sum before it, then its impulse. Returns the sum with it.
  vector step(double h, vector impulse) {
    time_ += h;
    const window w(duration_, slots_);
    const vector sum = w.sum(ilaw::kit::history{memory_.data(), 1}, time_, h) + impulse;
    w.add({memory_.data(), 1}, time_, h, impulse);
    all_.push_front({time_, impulse});
    while (all_.back().time <= time_ - 2.0 * duration_ - 1.0) all_.pop_back();
    step_ = h;
    return sum;
  }

  // Impulses of age < tau, ages equal to tau but for rounding left out.
  vector exact() const {
    vector sum;
    for (const Entry& e : all_)
      if (&e == &all_.front() || time_ - e.time < duration_ - 1e-6 * step_) sum = sum + e.impulse;
    return sum;
  }
  // Sum of |r_N| over the ages [tau - width, tau + width].
  double near_the_edge(double width) const {
    double sum = 0.0;
    for (const Entry& e : all_)
      if (std::abs(time_ - e.time - duration_) <= width) sum += std::abs(e.impulse.n);
    return sum;
  }

 private:
  struct Entry {
    double time;
    vector impulse;
  };
  double duration_;
  std::int64_t slots_;
  std::vector<double> memory_;
  std::deque<Entry> all_;
  double time_ = -3.0, step_ = 0.0;  // time may start anywhere
};

TEST(Window, IsExactWithABucketPerStep) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (const int steps : {1, 2, 7, 80}) {
    Windows windows(steps * 1e-3, steps, 1e-3);
    for (int k = 0; k < 2000; ++k) {
      const vector sum = windows.step(1e-3, {uniform(random), uniform(random), uniform(random)});
      const vector exact = windows.exact();
      ASSERT_NEAR(sum.n, exact.n, 1e-13) << steps << " steps, step " << k;  // 80 terms below 1
      ASSERT_NEAR(sum.t2, exact.t2, 1e-13);
    }
  }
}

TEST(Window, OfNoDurationIsTheOwnImpulse) {
  Windows windows(0.0, 16, 1e-3);
  for (int k = 0; k < 10; ++k) EXPECT_EQ(windows.step(1e-3, {1.0 + k, 0, 0}).n, 1.0 + k);
}

TEST(Window, OfInfiniteDurationIsTheSumOfAll) {
  Windows windows(ilaw::kit::infinity, 16, 1e-3);
  double all = 0.0;
  for (int k = 0; k < 1000; ++k) EXPECT_EQ(windows.step(1e-3, {0.5 + k, 0, 0}).n, all += 0.5 + k);
}

// The bound of window.hpp: one slot, of duration tau/B and at most a step more, on either side of the edge.
TEST(Window, WithSixteenBucketsErrsByAtMostOneSlot) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  constexpr double tau = 0.1, h = 1e-4;
  Windows windows(tau, 16, h);
  double largest = 0.0;
  for (int k = 0; k < 20000; ++k) {
    const double r = k % 37 == 0 ? 20.0 * uniform(random) : uniform(random);
    const vector sum = windows.step(h, {r, 0, 0});
    const double error = std::abs(sum.n - windows.exact().n);
    ASSERT_LE(error, windows.near_the_edge(tau / 16 + 2 * h) + 1e-12) << k;
    largest = std::max(largest, error);
  }
  EXPECT_GT(largest, 1e-3);  // it is an approximation, and the test sees it
}

TEST(Window, OfAConstantForceIsForceTimesDurationWithAnyNumberOfBuckets) {
  for (const double buckets : {1.0, 2.0, 3.0, 16.0, 999.0, 1000.0}) {
    Windows windows(0.1, buckets, 1e-4);
    for (int k = 0; k < 5000; ++k) {
      const double sum = windows.step(1e-4, {3e-4, 0, 0}).n;
      if (k >= 1000) {
        ASSERT_NEAR(sum, 0.3, 3.0e-4) << buckets << " buckets, step " << k;  // one impulse
      }
    }
  }
}

TEST(Window, DoesNotDriftInTenMillionSteps) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const std::int64_t slots = window::slot_count(8e-3, 8, 1e-3);
  std::vector<double> memory(static_cast<std::size_t>(window::doubles(slots)));
  const window w(8e-3, slots);
  std::vector<double> last(8, 0.0);
  for (std::int64_t k = 0; k < 10000000; ++k) {
    const double time = static_cast<double>(k + 1) * 1e-3, r = 1e6 * uniform(random);
    last[static_cast<std::size_t>(k % 8)] = r;
    if (k > 9999900) {
      double exact = 0.0;
      for (double value : last) exact += value;
      const double sum = w.sum(ilaw::kit::history{memory.data(), 1}, time, 1e-3).n + r;
      ASSERT_NEAR(sum, exact, 8e6 * 1e-15 * 8);  // a fresh sum of 8 terms below 1e6
    }
    w.add({memory.data(), 1}, time, 1e-3, {r, 0, 0});
  }
}

// Halving the step in mid-run (also with fewer buckets than steps) leaves only the error of the
// discretisation.
TEST(Window, TakesAnyChangeOfStep) {
  const auto force = [](double t) { return std::sin(9.0 * t); };
  for (const double buckets : {8.0, 40.0, 400.0}) {
    Windows windows(0.2, buckets, 5e-4);
    double time = -3.0;
    for (int k = 0; k < 3000; ++k) {
      const double h = k < 700 ? 1e-3 : (k < 1500 ? 5e-4 : (k % 3 == 0 ? 2e-3 : 7e-4));
      time += h;
      const double sum = windows.step(h, {h * force(time), 0, 0}).n;
      if (k < 250) continue;
      const double integral = (std::cos(9.0 * (time - 0.2)) - std::cos(9.0 * time)) / 9.0;
      // A slot of tau/B and a step, half of which the linear part can err by, and a step at either end.
      ASSERT_NEAR(sum, integral, 0.5 * 0.2 / buckets + 2.0 * 2e-3) << buckets << " buckets, step " << k;
    }
  }
}

}  // namespace
