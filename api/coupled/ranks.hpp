// ranks.hpp - what ranks exchange: sums of vectors per body, and sums and maxima of a few numbers. Without an
// exchange all of it is local.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "bodies.hpp"

#include <ilaw/coupled.h>

#include <cstddef>
#include <vector>

namespace ilaw::coupled {

class Ranks {
 public:
  void use(const ilaw_exchange* exchange) { exchange_ = exchange; }
  bool any() const { return exchange_ != nullptr; }

  void largest(double* values, std::size_t count) const {
    if (exchange_) exchange_->largest(exchange_->context, values, static_cast<std::int64_t>(count));
  }
  void sum(double* values, std::size_t count) const {
    if (exchange_) exchange_->sum(exchange_->context, values, static_cast<std::int64_t>(count));
  }
  bool any_rank(bool here) const {
    double any = here ? 1.0 : 0.0;
    largest(&any, 1);
    return any > 0.0;
  }
  // One number per body.
  void sum_bodies(std::vector<double>& values) const {
    if (exchange_) exchange_->sum_bodies(exchange_->context, values.data(), 1);
  }
  // Velocities and, where bodies rotate, spins: 3 or 6 numbers per body.
  void sum_bodies(std::vector<Motion>& motions, bool rotate);

 private:
  const ilaw_exchange* exchange_ = nullptr;
  std::vector<double> packed_;
};

inline void Ranks::sum_bodies(std::vector<Motion>& motions, bool rotate) {
  if (!exchange_) return;
  const std::size_t width = rotate ? 6 : 3;
  packed_.resize(width * motions.size());
  for (std::size_t b = 0; b < motions.size(); ++b)
    for (std::size_t c = 0; c < width; ++c)
      packed_[width * b + c] = c < 3 ? motions[b].velocity[c] : motions[b].spin[c - 3];
  exchange_->sum_bodies(exchange_->context, packed_.data(), static_cast<std::int64_t>(width));
  for (std::size_t b = 0; b < motions.size(); ++b)
    for (std::size_t c = 0; c < width; ++c)
      (c < 3 ? motions[b].velocity[c] : motions[b].spin[c - 3]) = packed_[width * b + c];
}

}  // namespace ilaw::coupled
