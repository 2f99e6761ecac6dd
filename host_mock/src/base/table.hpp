// table.hpp - a piecewise-linear function of time, constant outside its ends.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/vector.hpp"

#include <algorithm>
#include <vector>

namespace ilaw::host {

class Table {
 public:
  // times strictly increasing, one value each; all values of the same size.
  Table(std::vector<double> times, std::vector<Vector> values)
      : times_(std::move(times)), values_(std::move(values)) {}

  Vector at(double time) const {
    if (time <= times_.front()) return values_.front();
    if (time >= times_.back()) return values_.back();
    const auto k =
        static_cast<std::size_t>(std::upper_bound(times_.begin(), times_.end(), time) - times_.begin());
    const double fraction = (time - times_[k - 1]) / (times_[k] - times_[k - 1]);
    return (1.0 - fraction) * values_[k - 1] + fraction * values_[k];
  }

 private:
  std::vector<double> times_;
  std::vector<Vector> values_;
};

}  // namespace ilaw::host
