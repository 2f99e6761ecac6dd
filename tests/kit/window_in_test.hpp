// window_in_test.hpp - a window with a history of its own, and steps of equal or varying size.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/window.hpp>

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace window_in_test {

using ilaw::kit::not_refused;
using ilaw::kit::vector;
using ilaw::kit::window;

// A window with a history of its own, which is told impulses by the interval over which they act.
class Window {
 public:
  Window(double duration, double buckets, double begin)
      : end(begin),
        window_(duration, buckets),
        history(static_cast<std::size_t>(window::doubles(duration, buckets))) {}

  // The sum with the impulse of a step of length h.
  vector step(double h, vector impulse) {
    end += h;
    return step_to(end, h, impulse);
  }
  vector step_to(double time, double h, vector impulse) {
    end = time;
    const window::reading earlier = before(h);
    EXPECT_EQ(earlier.refused, not_refused) << "end " << end;
    window_.add(own(), {end, h}, impulse);
    return earlier.sum + impulse;
  }
  window::reading before(double h) { return window_.before(own(), {end, h}); }
  ilaw::kit::history own() { return {history.data(), 1}; }

  double end;

 private:
  window window_;

 public:
  std::vector<double> history;
};

// Steps of size h, or of size h +- 50 % at random.
class Steps {
 public:
  Steps(double h, bool varies) : h_(h), varies_(varies) {}
  double next() { return varies_ ? h_ * (0.5 + static_cast<double>(random_() >> 11) * 0x1p-53) : h_; }

 private:
  double h_;
  bool varies_;
  std::mt19937_64 random_{7};
};

}  // namespace window_in_test
