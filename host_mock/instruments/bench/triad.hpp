// triad.hpp - the kernel a = b + s c, which moves what the memory can (J. McCalpin, 1995, STREAM): the
// measure beside which laws are timed.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

namespace ilaw::host {

class Triad {
 public:
  explicit Triad(std::size_t size) : a_(size), b_(size, 1.0), c_(size, 2.0) {}
  void run();
  // Counted as STREAM does; a line that is written is read first, which makes 32 in truth.
  double bytes() const { return 24.0 * static_cast<double>(a_.size()); }
  const std::vector<double>& result() const { return a_; }

 private:
  std::vector<double> a_, b_, c_;
};

}  // namespace ilaw::host
