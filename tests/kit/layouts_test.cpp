// Arrays laid out at random, against a plain loop over doubles: rows and columns with room between them, one
// value for all nodes, lists of nodes, floats, any alignment. The law is contact by Moreau's activation
// (contact.md) along axes, so that each operation is rounded once.
#include "support/law_runner.hpp"

#include <numeric>

namespace ilaw::testing {
namespace {

constexpr double restitution = 0.4;

// An array of nodes, in double or single precision, somewhere in a buffer whose other numbers stay as they
// are.
template <class Number>
class Laid {
 public:
  Laid(Random& random, int nodes, int components, bool may_be_shared)
      : first_(random.below(9)), nodes_(nodes), components_(components) {
    const int room = random.below(4), apart = 1 + random.below(4);
    if (may_be_shared && random.below(4) == 0)
      node_stride_ = 0, component_stride_ = apart;
    else if (random.below(2) == 0)
      node_stride_ = components * apart + room, component_stride_ = apart;
    else
      node_stride_ = apart, component_stride_ = nodes * apart + room;
    numbers_.assign(place(nodes - 1, components - 1) + 9, Number(-77));
  }

  Number& at(int node, int component) { return numbers_[place(node, component)]; }
  Number at(int node, int component) const { return numbers_[place(node, component)]; }
  void draw(Random& random, double low, double high) {
    for (int i = 0; i < nodes_; ++i)
      for (int c = 0; c < components_; ++c) at(i, c) = static_cast<Number>(random.between(low, high));
  }
  const std::vector<Number>& numbers() const { return numbers_; }

  ilaw_input input() const { return filled<ilaw_input>(numbers_.data() + first_); }
  ilaw_output output() { return filled<ilaw_output>(numbers_.data() + first_); }

 private:
  std::size_t place(int node, int component) const {
    return static_cast<std::size_t>(first_ + node * node_stride_ + component * component_stride_);
  }
  template <class Array, class Pointer>
  Array filled(Pointer pointer) const {
    Array array{};
    if constexpr (std::is_same_v<Number, float>)
      array.floats = pointer;
    else
      array.values = pointer;
    array.node_stride = node_stride_;
    array.component_stride = component_stride_;
    return array;
  }

  int first_, nodes_, components_, node_stride_ = 0, component_stride_ = 0;
  std::vector<Number> numbers_;
};

std::array<double, 3> plain(const std::array<double, 3>& normal, const std::array<double, 3>& v,
                            const std::array<double, 3>& before, double h, double gap) {
  const auto along = [&](const std::array<double, 3>& a) {
    return (normal[0] * a[0] + normal[1] * a[1]) + normal[2] * a[2];
  };
  const double excess = along(v) + std::max(restitution * along(before), along(before));
  const double r = gap <= 0.0 ? std::max(0.0, -excess / h) : 0.0;
  return {normal[0] * r, normal[1] * r, normal[2] * r};
}

template <class Number>
void compare(Random& random, std::uint32_t frame) {
  const bool is_full = frame == ILAW_FRAME_LOCAL && random.below(2) == 0;
  SetupBuilder builder({{{"restitution", restitution}}, {{"activation", "moreau"}}}, 3,
                       is_full ? ILAW_DELASSUS_FULL : ILAW_DELASSUS_SCALAR, frame);
  builder.setup.numbers = std::is_same_v<Number, float> ? ILAW_NUMBERS_FLOAT : ILAW_NUMBERS_DOUBLE;
  const ilaw::interface law = make_law("contact", builder);
  const int nodes = 1 + random.below(random.below(2) ? 12 : 300);
  Laid<Number> v(random, nodes, 3, true), before(random, nodes, 3, true),
      h(random, nodes, is_full ? 6 : 1, true), gap(random, nodes, 1, true), normal(random, nodes, 3, true),
      r(random, nodes, 3, false);
  v.draw(random, -1.0, 1.0);
  before.draw(random, -1.0, 1.0);
  h.draw(random, 0.5, 2.0);
  for (int i = 0; is_full && i < nodes; ++i)
    for (const int c : {3, 4, 5}) h.at(i, c) = static_cast<Number>(random.between(-0.1, 0.1));
  gap.draw(random, -1.0, 1.0);
  for (int i = 0; i < nodes; ++i) {
    const int axis = random.below(3);
    for (int c = 0; c < 3; ++c) normal.at(i, c) = Number(c == axis ? -1 : 0);
  }

  std::vector<int> list(static_cast<std::size_t>(nodes));
  std::iota(list.begin(), list.end(), 0);
  const int kind = random.below(3), base = kind > 0 ? random.below(2) : 0;
  if (kind > 0) {
    std::shuffle(list.begin(), list.end(), random.engine);
    list.resize(static_cast<std::size_t>(1 + random.below(nodes)));
  }
  std::vector<std::int32_t> narrow;
  std::vector<std::int64_t> wide;
  for (const int node : list) narrow.push_back(node + base), wide.push_back(node + base);

  ilaw_batch batch{};
  batch.struct_size = sizeof batch;
  batch.node_count = static_cast<std::int64_t>(list.size());
  batch.index_base = base;
  if (kind == 1) batch.index = narrow.data();
  if (kind == 2) batch.index64 = wide.data();
  batch.velocity_step = batch.position_step = 1e-3;
  batch.v_free = v.input();
  batch.v_previous = before.input();
  batch.delassus = h.input();
  batch.gap = gap.input();
  if (frame == ILAW_FRAME_GLOBAL) batch.normal = normal.input();

  Laid<Number> expected = r;
  for (const int node : list) {
    const auto of = [&](const Laid<Number>& array) {
      return std::array<double, 3>{array.at(node, 0), array.at(node, 1), array.at(node, 2)};
    };
    const std::array<double, 3> n =
        frame == ILAW_FRAME_GLOBAL ? of(normal) : std::array<double, 3>{1.0, 0.0, 0.0};
    const std::array<double, 3> impulse = plain(n, of(v), of(before), h.at(node, 0), gap.at(node, 0));
    for (int c = 0; c < 3; ++c)
      expected.at(node, c) = static_cast<Number>(impulse[static_cast<std::size_t>(c)]);
  }
  batch.impulse = r.output();
  ASSERT_EQ(law.evaluate(batch), ILAW_OK);
  EXPECT_EQ(r.numbers(), expected.numbers()) << nodes << " nodes, list " << kind << ", frame " << frame;
}

TEST(Layouts, GiveWhatAPlainLoopGives) {
  Random random(52);
  for (int draw = 0; draw < 2000 && !HasFailure(); ++draw)
    for (const std::uint32_t frame : {ILAW_FRAME_LOCAL, ILAW_FRAME_GLOBAL}) {
      compare<double>(random, frame);
      compare<float>(random, frame);
    }
}

}  // namespace
}  // namespace ilaw::testing
