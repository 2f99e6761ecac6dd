// mixed_nodes.hpp - nodes of every kind that the kit solves in a way of its own, beside each other.
#pragma once

#include "support/law_batch.hpp"

namespace ilaw::testing {

// What a host asks for, and in which order it lists its nodes.
struct Asked {
  std::vector<std::int32_t> order{};  // empty: no list
  bool outputs = true, energy = true;
};

// Blocks of 128 nodes in turn: with forces; usual ones, some of which turned round within the step; in
// flight, but for one that closes within the step and one with bad input.
class MixedNodes : public LawBatch {
 public:
  MixedNodes(ilaw::interface&& of, std::size_t count, std::uint32_t dimension = 3, bool is_full = false)
      : LawBatch(std::move(of), count) {
    Random random(1);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t kind = i / 128 % 3;
      const Vector other = random.vector();
      normal[i] = random.vector();
      for (std::size_t c = dimension; c < 3; ++c) normal[i][c] = 0.0;
      normal[i] = (1.0 / length(normal[i])) * normal[i];
      v_free[i] = random.vector();
      v_previous[i] = kind == 0 ? other : i % 40 == 5 ? 2.0 * other - v_free[i] : v_free[i];
      gap[i] = i % 4 == 3 ? 0.5 : -1e-3 * std::abs(random());
      area[i] = std::abs(random());
      h[i] = {1.5 + random(), 2.0, 2.0, 0.0, 0.0, 0.0};
      for (std::size_t c = dimension == 2 ? 2 : 3; is_full && i % 3 == 0 && c < 6; ++c)
        h[i][c] = 0.2 * random();
      if (is_full && dimension == 2 && i % 3 > 0) h[i][2] = 0.0;
      if (kind < 2) continue;
      gap[i] = 0.5;
      if (i % 128 == 5) close_within_step(i);
      if (i % 128 == 7) v_previous[i][0] = nan_value;
    }
  }

  // After some steps, in each of which v_free is half of that before.
  MixedNodes stepped(const Asked& asked = {}, int steps = 3) const {
    MixedNodes after = *this;
    ilaw_batch b = after.batch();
    b.index = asked.order.empty() ? nullptr : asked.order.data();
    if (!asked.energy || !asked.outputs) b.energy = {};
    if (!asked.outputs) b.velocity = {}, b.status = nullptr;
    after.law->initialise(b);
    for (int step = 1; step <= steps; ++step) {
      b.time = step * b.velocity_step;
      after.evaluate(b);
      for (Vector& velocity : after.v_free) velocity = 0.5 * velocity;
    }
    return after;
  }

 private:
  void close_within_step(std::size_t i) {
    gap[i] = 1e-6;
    v_free[i] = v_previous[i] =
        (law->info().inputs & ILAW_INPUT_NORMAL) ? -normal[i] : Vector{-1.0, 0.0, 0.0};
  }
};

}  // namespace ilaw::testing
