// law_batch.hpp - many nodes of a law, each with inputs and outputs of its own, node by node.
#pragma once

#include "support/law_runner.hpp"

#include <memory>

namespace ilaw::testing {

// At rest with H = 1, gap 0, area 1 and steps of 1 ms, in axes along those of the host, until a test sets
// more.
struct LawBatch {
  using Law = std::shared_ptr<const ilaw::interface>;

  explicit LawBatch(ilaw::interface&& of, std::size_t count = 1)
      : LawBatch(std::make_shared<ilaw::interface>(std::move(of)), count) {}
  // The law outlives the batch.
  explicit LawBatch(const ilaw::interface& of, std::size_t count = 1) : LawBatch(Law(Law(), &of), count) {}
  explicit LawBatch(Law of, std::size_t count = 1)
      : law(std::move(of)),
        v_free(count),
        v_previous(count),
        normal(count, {1.0, 0.0, 0.0}),
        tangent(count, {0.0, 1.0, 0.0}),
        r(count),
        v(count),
        h(count, {1.0, 1.0, 1.0, 0.0, 0.0, 0.0}),
        gap(count),
        area(count, 1.0),
        energy(count),
        state(count * law->info().state_size),
        status(count) {
    report.struct_size = sizeof report;
  }

  std::size_t count() const { return r.size(); }
  std::size_t state_size() const { return state.size() / count(); }

  ilaw_batch batch() {
    const auto size = static_cast<std::int64_t>(state_size());
    ilaw_batch b{};
    b.struct_size = sizeof b;
    b.node_count = static_cast<std::int64_t>(count());
    b.time = time;
    b.velocity_step = velocity_step;
    b.position_step = position_step;
    b.v_free = ilaw::input(v_free[0].data(), 3, 1);
    b.v_previous = ilaw::input(v_previous[0].data(), 3, 1);
    b.delassus = ilaw::input(h[0].data(), 6, 1);
    b.gap = ilaw::input(gap.data(), 1, 1);
    b.area = ilaw::input(area.data(), 1, 1);
    b.normal = ilaw::input(normal[0].data(), 3, 1);
    b.tangent = ilaw::input(tangent[0].data(), 3, 1);
    b.per_node_parameters = per_node.data();
    b.state_in = ilaw::input(state.data(), size, 1);
    b.state_out = ilaw::output(state.data(), size, 1);
    b.impulse = ilaw::output(r[0].data(), 3, 1);
    b.velocity = ilaw::output(v[0].data(), 3, 1);
    b.energy = ilaw::output(energy[0].data(), 4, 1);
    b.status = status.data();
    b.status_stride = 1;
    return b;
  }
  std::int32_t initialise() { return law->initialise(batch()); }
  std::int32_t evaluate() { return evaluate(batch()); }
  std::int32_t evaluate(const ilaw_batch& b) { return law->evaluate(b, &report); }

  // Whether both give the same bits.
  bool operator==(const LawBatch& other) const {
    return same_bits(r, other.r) && same_bits(v, other.v) && same_bits(energy, other.energy) &&
           same_bits(state, other.state) && status == other.status;
  }

  Law law;
  double time = 0.0, velocity_step = 1e-3, position_step = 1e-3;
  std::vector<Vector> v_free, v_previous, normal, tangent, r, v;
  std::vector<std::array<double, 6>> h;
  std::vector<double> gap, area;
  std::vector<std::array<double, 4>> energy;
  std::vector<double> state;
  std::vector<std::uint8_t> status;
  std::vector<ilaw_input> per_node;  // parameters, in the order of the instance
  ilaw_report report{};
};

}  // namespace ilaw::testing
