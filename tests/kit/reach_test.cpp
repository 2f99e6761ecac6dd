// Nodes out of reach, which a host may skip by the expression of ilaw.h, to the last bit.
#include "support/law_cases.hpp"
#include "support/small_batch.hpp"

#include <cstring>

namespace ilaw::testing {
namespace {

// One node in the host's axes, without tangents: the frame goes along in the state.
class Node : public SmallBatch {
 public:
  Node(const LawCase& served, std::uint32_t frame)
      : Node(make_law(served.law, SetupBuilder(served.parameters, 3, ILAW_DELASSUS_SCALAR, frame))) {}

  void set_step(double step) { b.velocity_step = b.position_step = step; }
  bool is_out_of_reach(bool global) const {
    const double g = gap - gap_offset;
    const double v_n = global ? (normal[0] * v[0] + normal[1] * v[1]) + normal[2] * v[2] : v[0];
    return g > 0.0 && g + b.position_step * v_n > 0.0;
  }
  // Steps, and says whether that left r = 0 and the state, bit for bit.
  bool rests() {
    const std::vector<double> before = state;
    EXPECT_EQ(law.evaluate(b), ILAW_OK);
    return r[0] == Vector{} && status[0] == ILAW_FREE &&
           (state.empty() || std::memcmp(before.data(), state.data(), state.size() * sizeof(double)) == 0);
  }

  ilaw::interface law;
  Vector v_previous{}, normal{1.0, 0.0, 0.0};
  double gap_offset = 0.0;

 private:
  explicit Node(ilaw::interface made) : SmallBatch(1, {}, made.info().state_size), law(std::move(made)) {
    b.v_previous = ilaw::input(v_previous.data(), 0, 1);
    b.gap_offset = ilaw::input(&gap_offset, 0, 1);
    b.normal = ilaw::input(normal.data(), 0, 1);
  }
};

// A velocity that would close the gap exactly but for rounding, or an ulp beside it.
double borderline(double gap, double step, std::uint64_t draw) {
  const double v = -gap / step;
  return draw % 3 == 0 ? v : std::nextafter(v, draw % 3 == 1 ? -1e9 : 1e9);
}

void turn(Node& node, std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Vector n{uniform(random), uniform(random), uniform(random)};
  const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  for (std::size_t c = 0; c < 3; ++c) node.normal[c] = n[c] / length;
}

// Draws a decimal gap and step, and a velocity that only just closes it. The tangential part must not
// matter.
void draw_borderline(Node& node, bool global, std::mt19937_64& random) {
  const double step = 1e-4 * static_cast<double>(1 + random() % 99);
  node.gap_offset = random() % 2 ? 0.0 : 0.003;
  node.gap = node.gap_offset + 1e-3 * static_cast<double>(1 + random() % 99);
  node.set_step(step);
  const double normal = borderline(node.gap - node.gap_offset, step, random());
  if (global) turn(node, random);
  for (std::size_t c = 0; c < 3; ++c) node.v[c] = global ? normal * node.normal[c] : (c == 0 ? normal : 0.25);
  for (std::size_t c = 0; c < 3; ++c)
    node.v_previous[c] = (global ? node.normal[c] : (c == 0 ? 1.0 : 0.0)) * -3.0;
}

TEST(OutOfReach, FreshNodesAreLeftAloneToTheLastBit) {
  for (const std::uint32_t frame : {ILAW_FRAME_LOCAL, ILAW_FRAME_GLOBAL})
    for (const LawCase& served : law_cases("reach")) {
      Node node(served, frame);
      if (!(node.law.info().permissions & ILAW_MAY_SKIP_FRESH)) continue;
      const bool global = frame == ILAW_FRAME_GLOBAL;
      std::mt19937_64 random(3);
      int outside = 0, broken = 0;
      for (int k = 0; k < 3000; ++k) {
        draw_borderline(node, global, random);
        ASSERT_EQ(node.law.initialise(node.b), ILAW_OK) << "k " << k;
        if (global) turn(node, random);  // by any angle since
        if (!node.is_out_of_reach(global)) continue;
        ++outside;
        broken += !node.rests();
      }
      EXPECT_GT(outside, 300) << served.law;
      EXPECT_EQ(broken, 0) << served.law << " of " << outside << ", frame " << frame;
    }
}

// After any history: what was free last stays so, with its state, for as long as it is out of reach.
TEST(OutOfReach, NodesThatWereFreeRest) {
  for (const std::uint32_t frame : {ILAW_FRAME_LOCAL, ILAW_FRAME_GLOBAL})
    for (const LawCase& served : law_cases("reach")) {
      Node node(served, frame);
      if (!(node.law.info().permissions & ILAW_MAY_SKIP_FREE)) continue;
      const bool global = frame == ILAW_FRAME_GLOBAL;
      std::mt19937_64 random(5);
      std::uniform_real_distribution<double> uniform(-1.0, 1.0);
      node.set_step(1e-3);
      ASSERT_EQ(node.law.initialise(node.b), ILAW_OK);
      int rested = 0, broken = 0;
      for (int k = 0; k < 6000; ++k) {
        node.b.time += 0.1;
        node.gap_offset = 0.0;
        node.gap = 1e-3 * uniform(random);
        node.set_step(1e-3);
        for (std::size_t c = 0; c < 3; ++c)
          node.v[c] = node.v_previous[c] = uniform(random) + 0.5 * node.normal[c];
        node.rests();
        if (node.status[0] != ILAW_FREE) continue;
        node.b.time += 0.1;
        draw_borderline(node, global, random);
        if (!node.is_out_of_reach(global)) continue;
        ++rested;
        broken += !node.rests();
      }
      EXPECT_GT(rested, 300) << served.law;
      EXPECT_EQ(broken, 0) << served.law << " of " << rested << ", frame " << frame;
    }
}

}  // namespace
}  // namespace ilaw::testing
