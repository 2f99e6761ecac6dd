// table.hpp - a function of time: rows with straight or smooth steps between them, constant outside, or a
// sine.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/vector.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

namespace ilaw::host {

// mean + amplitude sin(2 pi frequency time + phase)
struct Sine {
  Vector mean, amplitude;
  double frequency, phase;
};

class Table {
 public:
  // times strictly increasing, one value each; all values of the same size.
  Table(std::vector<double> times, std::vector<Vector> values, bool is_smooth = false)
      : times_(std::move(times)), values_(std::move(values)), is_smooth_(is_smooth) {}
  explicit Table(Sine sine) : sine_(std::move(sine)) {}

  Vector at(double time) const {
    if (sine_)
      return sine_->mean +
             std::sin(2.0 * std::numbers::pi * sine_->frequency * time + sine_->phase) * sine_->amplitude;
    if (time <= times_.front()) return values_.front();
    if (time >= times_.back()) return values_.back();
    const auto k =
        static_cast<std::size_t>(std::upper_bound(times_.begin(), times_.end(), time) - times_.begin());
    double fraction = (time - times_[k - 1]) / (times_[k] - times_[k - 1]);
    if (is_smooth_) fraction = smooth_step(fraction);
    return (1.0 - fraction) * values_[k - 1] + fraction * values_[k];
  }
  // Whether it never changes.
  bool is_constant() const { return !sine_ && values_.size() == 1; }

 private:
  // From 0 to 1 without slope and curvature at the ends: *AMPLITUDE, DEFINITION=SMOOTH STEP of Abaqus.
  static double smooth_step(double x) { return x * x * x * (10.0 + x * (6.0 * x - 15.0)); }

  std::vector<double> times_;
  std::vector<Vector> values_;
  bool is_smooth_ = false;
  std::optional<Sine> sine_;
};

}  // namespace ilaw::host
