// Arrays in layouts drawn at random (strides, lists, broadcasts, floats, any alignment) against a plain loop
// over doubles, bit for bit. No place between or beside the listed nodes may change.
#include "kit_probe.hpp"

#include <bit>
#include <numeric>

namespace ilaw::testing {
namespace {

constexpr double viscosity = 2.0, position_step = 0x1p-7;

// An array of the host: component c of node i stands at origin + i * node + c * component.
struct HostArray {
  std::vector<double> doubles;
  std::vector<float> floats;
  bool is_float = false;
  std::int64_t origin = 0, node = 0, component = 0;

  std::size_t place(std::int64_t i, std::int64_t c) const {
    return static_cast<std::size_t>(origin + i * node + c * component);
  }
  double get(std::int64_t i, std::int64_t c) const {
    return is_float ? double{floats[place(i, c)]} : doubles[place(i, c)];
  }
  void put(std::int64_t i, std::int64_t c, double x) {
    if (is_float)
      floats[place(i, c)] = static_cast<float>(x);
    else
      doubles[place(i, c)] = x;
  }
  ilaw_input in() const {
    return {is_float ? nullptr : doubles.data() + origin, is_float ? floats.data() + origin : nullptr, node,
            component};
  }
  ilaw_output out() {
    return {is_float ? nullptr : doubles.data() + origin, is_float ? floats.data() + origin : nullptr, node,
            component};
  }
};

std::string difference(const char* name, const HostArray& found, const HostArray& expected) {
  const auto bits_of = [](const HostArray& a, std::size_t k) {
    return a.is_float ? std::bit_cast<std::uint32_t>(a.floats[k])
                      : std::bit_cast<std::uint64_t>(a.doubles[k]);
  };
  for (std::size_t k = 0; k < std::max(found.doubles.size(), found.floats.size()); ++k)
    if (bits_of(found, k) != bits_of(expected, k))
      return std::string(name) + " differs at place " + std::to_string(k) + "; ";
  return "";
}

class Batch {
 public:
  explicit Batch(unsigned seed) : random_(seed) {
    d_ = static_cast<int>(whole(1, 3));
    total_ = whole(1, 70);
    is_float_ = whole(0, 1) == 1;
    is_transverse_ = d_ > 1 && whole(0, 1) == 1;
    draw_nodes();
    const bool may_repeat = true;
    v_free_ = filled(d_, may_repeat);
    delassus_ = filled(is_transverse_ ? 2 : 1, may_repeat, 0.5, 2.0);
    gap_ = filled(1, may_repeat);
    offset_ = filled(1, may_repeat);
    impulse_ = filled(d_);
    velocity_ = filled(d_);
    is_float_ = false;
    state_ = filled(state_size());
    for (std::int64_t i = 0; i < total_; ++i) state_.put(i, 0, 3.0);
    next_ = whole(0, 1) ? std::optional<HostArray>() : filled(state_size());
    is_float_ = v_free_.is_float;
    status_stride_ = whole(1, 3);
    status_.assign(static_cast<std::size_t>(total_ * status_stride_), 99);
    has_offset_ = whole(0, 1) == 1;
    has_velocity_ = whole(0, 1) == 1;
    has_status_ = whole(0, 1) == 1;
    if (whole(0, 2) == 0) v_free_.put(whole(0, total_ - 1), d_ - 1, inf_value);
    if (whole(0, 2) == 0) delassus_.put(whole(0, total_ - 1), 0, -1.0);
  }

  // Where evaluate and the plain loop differ.
  std::string run() {
    HostArray impulse = impulse_, velocity = velocity_, state = next_ ? *next_ : state_;
    std::vector<std::uint8_t> status = status_;
    for (const std::int64_t i : nodes_) step(i, impulse, velocity, state, status);
    SetupBuilder made(probe_parameters, static_cast<std::uint32_t>(d_),
                      is_transverse_ ? ILAW_DELASSUS_TRANSVERSE : ILAW_DELASSUS_SCALAR);
    made.setup.numbers = is_float_ ? ILAW_NUMBERS_FLOAT : ILAW_NUMBERS_DOUBLE;
    static const ilaw::library library(ILAW_KIT_PROBE);
    const ilaw::interface law(library, "kit_probe", made.setup);
    ilaw_report report{};
    report.struct_size = sizeof report;
    law.evaluate(batch(), &report);
    if (report.bad_count != bad_count_ || report.first_bad_node != first_bad_node_)
      return std::to_string(report.bad_count) + " bad nodes, the first " +
             std::to_string(report.first_bad_node) + "; ";
    return difference("impulse", impulse_, impulse) + difference("velocity", velocity_, velocity) +
           difference("state", next_ ? *next_ : state_, state) +
           (status == status_ ? "" : "status differs; ");
  }

 private:
  std::int64_t whole(std::int64_t least, std::int64_t most) {
    return std::uniform_int_distribution<std::int64_t>(least, most)(random_);
  }

  int state_size() const { return 1 + d_ + (d_ - 1) + 2; }

  void draw_nodes() {
    list_ = static_cast<int>(whole(0, 2));
    nodes_.resize(static_cast<std::size_t>(total_));
    std::iota(nodes_.begin(), nodes_.end(), 0);
    if (list_ == 0) return;
    if (whole(0, 1)) std::shuffle(nodes_.begin(), nodes_.end(), random_);
    nodes_.resize(static_cast<std::size_t>(whole(1, total_)));
    base_ = static_cast<std::int32_t>(whole(0, 1));
    for (const std::int64_t i : nodes_) {
      index_.push_back(static_cast<std::int32_t>(i + base_));
      index64_.push_back(i + base_);
    }
  }

  HostArray filled(std::int64_t components, bool may_repeat = false, double least = -1.0, double most = 1.0) {
    HostArray a;
    a.is_float = is_float_;
    const std::int64_t pad = whole(0, 3);
    switch (whole(0, may_repeat ? 6 : 5)) {
      case 0:  // rows
        a.node = components, a.component = 1;
        break;
      case 1:  // columns
        a.node = 1, a.component = total_ + pad;
        break;
      case 2:  // parts of rows
        a.node = components + pad, a.component = 1;
        break;
      case 3:  // parts of both
        a.component = 1 + pad, a.node = components * a.component + whole(0, 2);
        break;
      case 4:  // from the last node on
        a.node = -components - pad, a.component = 1;
        break;
      case 5:  // from the last component on
        a.node = components, a.component = -1;
        break;
      default:  // one for all
        a.node = 0, a.component = 1 + pad;
    }
    const std::int64_t along_nodes = (total_ - 1) * a.node, along = (components - 1) * a.component;
    a.origin = whole(0, 3) - std::min<std::int64_t>(along_nodes, 0) - std::min<std::int64_t>(along, 0);
    const std::int64_t size = a.origin + std::max<std::int64_t>(along_nodes, 0) +
                              std::max<std::int64_t>(along, 0) + 1 + whole(0, 3);
    std::uniform_real_distribution<double> uniform(least, most);
    std::vector<double> values(static_cast<std::size_t>(size));
    for (double& value : values) value = uniform(random_);
    if (a.is_float)
      a.floats.assign(values.begin(), values.end());
    else
      a.doubles = values;
    return a;
  }

  bool is_bad(std::int64_t i) const {
    bool is_finite = true;
    for (int k = 0; k < d_; ++k) is_finite = is_finite && std::isfinite(v_free_.get(i, k));
    return !is_finite || delassus_.get(i, 0) < 0.0;
  }
  void leave(std::int64_t i, HostArray& impulse, HostArray& velocity, HostArray& state,
             std::vector<std::uint8_t>& status) {
    if (bad_count_++ == 0) first_bad_node_ = i;
    for (int k = 0; k < d_; ++k) {
      impulse.put(i, k, 0.0);
      if (has_velocity_) velocity.put(i, k, v_free_.get(i, k));
    }
    for (int k = 0; k < state_size(); ++k) state.put(i, k, state_.get(i, k));
    if (has_status_) status[static_cast<std::size_t>(i * status_stride_)] = ILAW_BAD_INPUT;
  }

  // The plain loop: the equations of kit_probe at one node, in its order of operations.
  void step(std::int64_t i, HostArray& impulse, HostArray& velocity, HostArray& state,
            std::vector<std::uint8_t>& status) {
    if (is_bad(i)) return leave(i, impulse, velocity, state, status);
    const auto old = [&](int k) { return state_.get(i, k); };
    const int sum = 1, slip = 1 + d_, last = 2 * d_;
    const double gap = gap_.get(i, 0) - (has_offset_ ? offset_.get(i, 0) : 0.0);
    const bool closed = gap <= 0.0;
    const double c = closed ? viscosity : 0.0, h_n = delassus_.get(i, 0), factor = -c / (1.0 + c * h_n);
    state.put(i, 0, old(0) + 1.0);
    for (int k = 0; k < d_; ++k) {
      const double v = v_free_.get(i, k), h = delassus_.get(i, k > 0 && is_transverse_ ? 1 : 0);
      const double r = factor * v - 0.125 * (k == 0 ? old(last) : old(sum + k)) -
                       0.25 * (k == 0 ? 0.0 : old(slip + k - 1));
      impulse.put(i, k, r);
      if (has_velocity_) velocity.put(i, k, v + h * r);
      state.put(i, sum + k, old(sum + k) + r);
      if (k > 0) state.put(i, slip + k - 1, old(slip + k - 1) + (closed ? position_step * (v + h * r) : 0.0));
    }
    state.put(i, last, v_free_.get(i, 0));
    state.put(i, last + 1, old(last));
    if (has_status_) status[static_cast<std::size_t>(i * status_stride_)] = closed ? ILAW_CLOSED : ILAW_FREE;
  }

  ilaw_batch batch() {
    ilaw_batch b{};
    b.struct_size = sizeof b;
    b.node_count = static_cast<std::int64_t>(nodes_.size());
    b.index = list_ == 1 ? index_.data() : nullptr;
    b.index64 = list_ == 2 ? index64_.data() : nullptr;
    b.index_base = base_;
    b.velocity_step = b.position_step = position_step;
    b.v_free = v_free_.in();
    b.delassus = delassus_.in();
    b.gap = gap_.in();
    if (has_offset_) b.gap_offset = offset_.in();
    b.impulse = impulse_.out();
    if (has_velocity_) b.velocity = velocity_.out();
    b.state_in = state_.in();
    b.state_out = next_ ? next_->out() : state_.out();
    if (has_status_) b.status = status_.data();
    b.status_stride = status_stride_;
    return b;
  }

  std::mt19937_64 random_;
  int d_ = 3, list_ = 0;
  std::int32_t base_ = 0;
  std::int64_t total_ = 0, status_stride_ = 1, bad_count_ = 0, first_bad_node_ = -1;
  bool is_float_ = false, is_transverse_ = false, has_offset_ = false, has_velocity_ = false,
       has_status_ = false;
  std::vector<std::int64_t> nodes_, index64_;
  std::vector<std::int32_t> index_;
  HostArray v_free_, delassus_, gap_, offset_, impulse_, velocity_, state_;
  std::optional<HostArray> next_;
  std::vector<std::uint8_t> status_;
};

TEST(Layouts, GiveTheBitsOfAPlainLoop) {
  for (unsigned seed = 1; seed <= 1000; ++seed) {
    const std::string found = Batch(seed).run();
    ASSERT_EQ(found, "") << "seed " << seed;
  }
}

// g++ 12 lost such an assignment.
TEST(Layouts, KeepAPlainCopyOfAnInput) {
  const ilaw::interface law = make_tested_law("copy_probe", SetupBuilder({}));
  std::vector<double> v(3 * 21), r(v.size());
  std::iota(v.begin(), v.end(), 1.0);
  const double h = 1.0, gap = 0.0;
  ilaw_batch b{};
  b.struct_size = sizeof b;
  b.node_count = 21;
  b.velocity_step = b.position_step = position_step;
  b.v_free = ilaw::input(v.data(), 3, 1);
  b.delassus = ilaw::input(&h, 0, 0);
  b.gap = ilaw::input(&gap, 0, 0);
  b.impulse = ilaw::output(r.data(), 3, 1);
  ASSERT_EQ(law.evaluate(b), ILAW_OK);
  EXPECT_EQ(r, v);
}

}  // namespace
}  // namespace ilaw::testing
