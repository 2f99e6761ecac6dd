// Arrays of float: parameters per node, overflow and what is no number. That results are the doubles rounded
// once is for `ilaw check` (floats-rounded), at each level in check_test.
#include "support/law_runner.hpp"

namespace ilaw::testing {
namespace {

// One closed node of coulomb, friction per node.
struct FloatNode {
  FloatNode() : law(with_floats()) {
    b.struct_size = sizeof b;
    b.node_count = 1;
    b.velocity_step = b.position_step = 1e-3;
    b.v_free = b.v_previous = ilaw::input(v.data(), 3, 1);
    b.delassus = ilaw::input(&h, 1, 1);
    b.gap = ilaw::input(&gap, 1, 1);
    b.per_node_parameters = &parameter;
    b.impulse = ilaw::output(r.data(), 3, 1);
    b.velocity = ilaw::output(after.data(), 3, 1);
    b.status = &status;
    b.status_stride = 1;
    report.struct_size = sizeof report;
  }
  static ilaw::interface with_floats() {
    SetupBuilder builder({{}, {}, {}, {"friction"}});
    builder.setup.numbers = ILAW_NUMBERS_FLOAT;
    return make_law("coulomb", builder);
  }
  std::int32_t evaluate() { return law.evaluate(b, &report); }

  ilaw::interface law;
  std::array<float, 3> v{-1.0F, 0.25F, 0.0F}, r{}, after{};
  float h = 0.5F, gap = 0.0F, friction = 0.5F;
  ilaw_input parameter = ilaw::input(&friction, 1, 1);
  std::uint8_t status = 99;
  ilaw_batch b{};
  ilaw_report report{};
};

TEST(FloatArrays, HaveParametersPerNode) {
  FloatNode node;
  ASSERT_EQ(node.evaluate(), ILAW_OK);
  EXPECT_EQ(node.r, (std::array{2.0F, -0.5F, 0.0F}));
  node.friction = 0.125F;
  ASSERT_EQ(node.evaluate(), ILAW_OK);
  EXPECT_EQ(node.r, (std::array{2.0F, -0.25F, 0.0F}));
  node.friction = -1.0F;
  ASSERT_EQ(node.evaluate(), ILAW_BAD_NODES);
  EXPECT_STREQ(node.report.reason, "a per-node parameter is out of range");
}

// Twice an impulse that is accepted is a number, along any axis.
TEST(FloatArrays, RefuseImpulsesThatOverflowAFloat) {
  FloatNode node;
  node.h = 0x1p-125F;
  ASSERT_EQ(node.evaluate(), ILAW_OK);
  EXPECT_EQ(node.r[0], 0x1p125F);
  node.h = 0x1p-126F;
  ASSERT_EQ(node.evaluate(), ILAW_BAD_NODES);
  EXPECT_EQ(node.r, (std::array<float, 3>{}));
  EXPECT_EQ(node.after, node.v);
  EXPECT_EQ(node.status, ILAW_BAD_INPUT);
  EXPECT_EQ(node.report.first_bad_node, 0);
  EXPECT_STREQ(node.report.reason, "the impulse or the state overflows");
}

TEST(FloatArrays, RefuseWhatIsNoNumber) {
  for (float FloatNode::*member : {&FloatNode::h, &FloatNode::gap, &FloatNode::friction})
    for (const double bad : {nan_value, inf_value, -inf_value}) {
      FloatNode node;
      if (member == &FloatNode::friction && bad > 0.0) continue;  // infinite friction is some
      node.*member = static_cast<float>(bad);
      EXPECT_EQ(node.evaluate(), ILAW_BAD_NODES) << bad;
    }
}

// An array of doubles in a batch of floats is none of this law's.
TEST(FloatArrays, RefuseArraysOfDoubles) {
  FloatNode node;
  const double gap = 0.0;
  for (const bool both : {false, true}) {
    node.b.gap = ilaw::input(&gap, 1, 1);
    if (both) node.b.gap.floats = &node.gap;
    EXPECT_EQ(node.evaluate(), ILAW_INVALID_ARGUMENT);
    EXPECT_STREQ(
        node.report.reason,
        both ? "an array is of other numbers than the setup's, or has both pointers" : "gap is null");
  }
}

}  // namespace
}  // namespace ilaw::testing
