// progress.hpp - a bar with the remaining time, on a terminal only.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace ilaw::host {

class Progress {
 public:
  // A run that starts at a step and ends after steps.
  Progress(std::int64_t first, std::int64_t steps);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // Draws at most ten times a second.
  void show(std::int64_t done);

 private:
  std::int64_t first_, steps_;
  bool terminal_, drawn_ = false;
  double start_, last_;  // seconds
};

}  // namespace ilaw::host
