// batch_runner.hpp - the same nodes through any layout of a batch, to compare results bit for bit.
#pragma once

#include "support/law_runner.hpp"

#include <cstring>

namespace ilaw::testing {

// Inputs of n nodes in canonical (AoS) order, drawn at random; every fourth node is open, every third has a
// coupled H where its form can tell.
struct Nodes {
  explicit Nodes(std::int64_t n, int dimension = 3, int form_components = 1, unsigned seed = 1)
      : count(n), d(dimension), hc(form_components) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    const auto fill = [&](std::vector<double>& values, std::int64_t size) {
      values.resize(static_cast<std::size_t>(size));
      for (double& value : values) value = uniform(random);
    };
    fill(v_free, n * d);
    fill(v_previous, n * d);
    fill(gap, n);
    fill(area, n);
    fill(normal, n * d);
    delassus.resize(static_cast<std::size_t>(n * hc));
    for (std::int64_t i = 0; i < n; ++i) {
      for (int c = 0; c < hc; ++c) {
        const bool on_diagonal = c < d;
        delassus[static_cast<std::size_t>(i * hc + c)] = on_diagonal ? 2.0
                                                         : i % 3     ? 0.0
                                                                     : 0.2 * uniform(random);
      }
      delassus[static_cast<std::size_t>(i * hc)] = 1.5 + uniform(random);
      const auto k = static_cast<std::size_t>(i);
      gap[k] = i % 4 == 3 ? 0.5 : -std::abs(gap[k]) * 1e-3;
      area[k] = std::abs(area[k]);
      double length = 0.0;
      for (int c = 0; c < d; ++c) length += normal[k * d + c] * normal[k * d + c];
      for (int c = 0; c < d; ++c) normal[k * d + c] /= std::sqrt(length);
    }
  }
  std::int64_t count;
  int d, hc;
  bool sound = true;  // nothing that initialise may refuse
  std::vector<double> v_free, v_previous, gap, area, normal, delassus;
};

struct Results {
  std::vector<double> impulse, velocity, energy, state;
  std::vector<std::uint8_t> status;
  std::int32_t code = 0;
  ilaw_report report{};

  bool operator==(const Results& other) const {
    const auto same = [](const auto& a, const auto& b) {
      return a.size() == b.size() &&
             (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0);
    };
    return same(impulse, other.impulse) && same(velocity, other.velocity) && same(energy, other.energy) &&
           same(state, other.state) && same(status, other.status);
  }
};

// How the arrays of a batch are laid out.
struct Layout {
  std::int64_t node_stride = 0, component_stride = 0;  // 0: AoS
  bool soa = false;
  bool separate_state = false, outputs = true, energy = true;  // energy: among the outputs
  bool velocity = true;                                        // among them, too
  bool previous_in_columns = false;                            // v_previous, whatever the others are in
  std::vector<std::int32_t> order{};                           // index list; empty: none
  std::int32_t index_base = 0;
  bool wide_index = false;  // of 64 bits
};

// An array of n nodes with c components in some layout, with guard values between and around.
class Laid {
 public:
  static constexpr double guard = 123456.75;
  Laid(std::int64_t n, std::int64_t c, const Layout& layout) : n_(n), c_(c) {
    node_ = layout.soa ? 1 : (layout.node_stride ? layout.node_stride * std::max<std::int64_t>(c, 1) : c);
    component_ = layout.soa ? n + 3 : (layout.component_stride ? layout.component_stride : 1);
    values_.assign(static_cast<std::size_t>(n * node_ + (c + 1) * component_ + 16), guard);
  }
  void put(const std::vector<double>& canonical) {
    for (std::int64_t i = 0; i < n_; ++i)
      for (std::int64_t k = 0; k < c_; ++k) at(i, k) = canonical[static_cast<std::size_t>(i * c_ + k)];
  }
  std::vector<double> get() const {
    std::vector<double> canonical;
    for (std::int64_t i = 0; i < n_; ++i)
      for (std::int64_t k = 0; k < c_; ++k) canonical.push_back(values_[index(i, k)]);
    return canonical;
  }
  // Whether everything outside the n c values still is the guard.
  bool guarded() const {
    std::vector<bool> used(values_.size());
    for (std::int64_t i = 0; i < n_; ++i)
      for (std::int64_t k = 0; k < c_; ++k) used[index(i, k)] = true;
    for (std::size_t k = 0; k < values_.size(); ++k)
      if (!used[k] && values_[k] != guard) return false;
    return true;
  }
  std::int64_t count() const { return n_; }
  ilaw_input in() const { return ilaw::input(values_.data(), node_, component_); }
  ilaw_output out() { return ilaw::output(values_.data(), node_, component_); }

 private:
  std::size_t index(std::int64_t i, std::int64_t k) const {
    return static_cast<std::size_t>(i * node_ + k * component_);
  }
  double& at(std::int64_t i, std::int64_t k) { return values_[index(i, k)]; }
  std::int64_t n_, c_, node_, component_;
  std::vector<double> values_;
};

// The arrays of a batch over some nodes in a layout.
class Arrays {
 public:
  Arrays(const Nodes& nodes, std::int64_t state_size, const Layout& layout, bool global)
      : layout_(layout),
        global_(global),
        wide_(layout.order.begin(), layout.order.end()),
        v_free_(nodes.count, nodes.d, layout),
        v_previous_(nodes.count, nodes.d, layout.previous_in_columns ? Layout{.soa = true} : layout),
        h_(nodes.count, nodes.hc, layout),
        gap_(nodes.count, 1, layout),
        area_(nodes.count, 1, layout),
        normal_(nodes.count, nodes.d, layout),
        state(nodes.count, state_size, layout),
        next(nodes.count, state_size, layout),
        r(nodes.count, nodes.d, layout),
        v(nodes.count, nodes.d, layout),
        energy(nodes.count, 4, layout),
        status(static_cast<std::size_t>(nodes.count), 99) {
    v_previous_.put(nodes.v_previous);
    h_.put(nodes.delassus);
    gap_.put(nodes.gap);
    area_.put(nodes.area);
    normal_.put(nodes.normal);
  }

  // The batch that initialise reads and writes.
  ilaw_batch first_batch() {
    ilaw_batch b{};
    b.struct_size = sizeof b;
    b.node_count = v_free_.count();
    if (!layout_.order.empty()) {
      b.node_count = static_cast<std::int64_t>(layout_.order.size());
      b.index = layout_.wide_index ? nullptr : layout_.order.data();
      b.index64 = layout_.wide_index ? wide_.data() : nullptr;
    }
    b.index_base = layout_.index_base;
    b.velocity_step = b.position_step = 1e-3;
    b.delassus = h_.in();
    b.gap = gap_.in();
    b.area = area_.in();
    b.v_previous = v_previous_.in();
    if (global_) b.normal = normal_.in();
    b.state_out = state.out();
    return b;
  }

  ilaw_batch batch(const std::vector<double>& v_free, double time) {
    v_free_.put(v_free);
    ilaw_batch b = first_batch();
    b.v_free = v_free_.in();
    b.time = time;
    b.state_in = state.in();
    b.state_out = layout_.separate_state ? next.out() : state.out();
    b.impulse = r.out();
    if (layout_.outputs) {
      if (layout_.velocity) b.velocity = v.out();
      if (layout_.energy) b.energy = energy.out();
      b.status = status.data();
      b.status_stride = 1;
    }
    return b;
  }

 private:
  const Layout& layout_;
  bool global_;
  std::vector<std::int64_t> wide_;
  Laid v_free_, v_previous_, h_, gap_, area_, normal_;

 public:
  Laid state, next, r, v, energy;
  std::vector<std::uint8_t> status;
};

// Initialises and runs some steps of a law over the nodes in a layout; v_free is halved at each step.
inline Results run(const ilaw::interface& law, const Nodes& nodes, const Layout& layout, bool global = false,
                   int steps = 3) {
  Arrays arrays(nodes, static_cast<std::int64_t>(law.info().state_size), layout, global);
  const std::int32_t initialised = law.initialise(arrays.first_batch());
  EXPECT_TRUE(initialised == ILAW_OK || (!nodes.sound && initialised == ILAW_BAD_NODES));
  Results results;
  results.report.struct_size = sizeof results.report;
  std::vector<double> v_free = nodes.v_free;
  for (int step = 1; step <= steps; ++step) {
    results.code = law.evaluate(arrays.batch(v_free, step * 1e-3), &results.report);
    if (layout.separate_state) std::swap(arrays.state, arrays.next);
    for (double& value : v_free) value *= 0.5;
  }
  EXPECT_TRUE(arrays.r.guarded() && arrays.state.guarded() && arrays.v.guarded() && arrays.energy.guarded());
  results.impulse = arrays.r.get();
  results.state = arrays.state.get();
  if (layout.outputs) {
    results.velocity = arrays.v.get();
    results.energy = arrays.energy.get();
    results.status = arrays.status;
  }
  return results;
}

}  // namespace ilaw::testing
