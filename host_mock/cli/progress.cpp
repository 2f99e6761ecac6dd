// SPDX-License-Identifier: BSD-3-Clause
#include "cli/progress.hpp"

#include "base/clock.hpp"

#include <unistd.h>

#include <cstdio>
#include <string>

namespace ilaw::host {

Progress::Progress(std::int64_t first, std::int64_t steps)
    : first_(first),
      steps_(steps),
      terminal_(isatty(STDERR_FILENO) == 1),
      start_(clock_seconds(CLOCK_MONOTONIC)),
      last_(start_) {}

Progress::~Progress() {
  if (drawn_) std::fputs("\r\033[K", stderr);
}

void Progress::show(std::int64_t done) {
  if (!terminal_ || done == first_) return;
  const double now = clock_seconds(CLOCK_MONOTONIC);
  if (now - last_ < 0.1) return;
  last_ = now;
  drawn_ = true;
  constexpr int width = 30;
  const double part = static_cast<double>(done) / static_cast<double>(steps_);
  const int filled = static_cast<int>(part * width);
  std::fprintf(stderr, "\r[%s%s] %3.0f %%  %.0f s left ",
               std::string(static_cast<std::size_t>(filled), '#').c_str(),
               std::string(static_cast<std::size_t>(width - filled), '.').c_str(), 100.0 * part,
               (now - start_) * static_cast<double>(steps_ - done) / static_cast<double>(done - first_));
}

}  // namespace ilaw::host
