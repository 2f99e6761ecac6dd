// window_in_test.hpp - a window with a history of its own, and steps of equal or varying size.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/window.hpp>

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace window_in_test {

using ilaw::kit::refusal;
using vector = ilaw::kit::vector<double>;

// The sum of a window before a step, and why there is none.
struct Reading {
  vector sum;
  refusal refused;
};
using History = ilaw::kit::detail::window_columns<double>;
inline Reading read(ilaw::kit::window_size size, ilaw::kit::step_interval step, History own) {
  Reading found;
  found.refused = static_cast<refusal>(static_cast<int>(ilaw::kit::window(size, step).read(own, found.sum)));
  return found;
}
inline void write(ilaw::kit::window_size size, ilaw::kit::step_interval step, History own, vector impulse) {
  ilaw::kit::window(size, step).write(own, false, true, impulse);
}

// A window with a history of its own, which is told impulses by the interval over which they act.
class Window {
 public:
  Window(double duration, double buckets, double begin)
      : end(begin),
        size_{duration, buckets},
        history(static_cast<std::size_t>(ilaw::kit::window::doubles(size_))) {}

  // The sum with the impulse of a step of length h.
  vector step(double h, vector impulse) {
    end += h;
    return step_to(end, h, impulse);
  }
  vector step_to(double time, double h, vector impulse) {
    end = time;
    const Reading earlier = before(h);
    EXPECT_EQ(earlier.refused, refusal::none) << "end " << end;
    add(h, impulse);
    return earlier.sum + impulse;
  }
  Reading before(double h) { return read(size_, {end, h}, own()); }
  void add(double h, vector impulse) { write(size_, {end, h}, own(), impulse); }
  History own() { return {history.data(), 1}; }

  double end;

 private:
  ilaw::kit::window_size size_;

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
