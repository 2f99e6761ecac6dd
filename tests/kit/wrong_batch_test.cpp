// Flags that a law does not know, and the first state. Other wrong batches: `ilaw check` (call-refused), and
// plain_c/evaluate_test.cpp for their reasons.
#include "kit_probe.hpp"

#include "support/small_batch.hpp"

namespace ilaw::testing {
namespace {

// A flat array of all degrees of freedom gives its first numbers to every component. One normal for all nodes
// (a node stride of 0) is no such array.
TEST(WrongBatch, FlatVectorsAreRefused) {
  const char* const tail = " has one component per node (component stride 0), expected a (d,n) array";
  const struct {
    const char* name;
    ilaw_input ilaw_batch::*vector;
  } vectors[] = {{"v_free", &ilaw_batch::v_free},
                 {"v_previous", &ilaw_batch::v_previous},
                 {"normal", &ilaw_batch::normal}};
  for (const std::uint32_t d : {1U, 2U, 3U}) {
    const ilaw::interface law = make_law(
        "coulomb", SetupBuilder({{{"friction", 0.5}}, {}}, d, ILAW_DELASSUS_SCALAR, ILAW_FRAME_GLOBAL));
    const double normal[] = {1.0, 0.0, 0.0};
    SmallBatch nodes(2, {-1.0, 0.0, 0.0});
    nodes.b.normal = ilaw::input(normal, 0, 1);
    EXPECT_EQ(law.evaluate(nodes.b), ILAW_OK);
    for (const auto& [name, vector] : vectors) {
      ilaw_batch b = nodes.b;
      (b.*vector).component_stride = 0;
      EXPECT_EQ(law.evaluate(b, &nodes.report), d == 1 ? ILAW_OK : ILAW_INVALID_ARGUMENT) << name << d;
      if (d > 1) {
        ASSERT_STREQ(nodes.report.reason, (name + std::string(tail)).c_str());
      }
    }
  }
}

// A flag asks for something that a library which does not know it would not give.
TEST(WrongBatch, FlagsThatAreNotKnownAreRefused) {
  const ilaw::interface law = make_probe();
  SmallBatch node(1, {}, law.info().state_size);
  for (const int bit : {2, 31, 63}) {
    node.b.flags = std::uint64_t{1} << bit;
    for (const auto call : {law.law().evaluate, law.law().initialise}) {
      EXPECT_EQ(call(law.instance(), &node.b, &node.report), ILAW_UNSUPPORTED) << bit;
      EXPECT_STREQ(node.report.reason, "flags of the batch are not known") << "bit " << bit;
    }
  }
  node.b.flags = ILAW_BATCH_HOLD_BONDS;
  EXPECT_EQ(law.law().evaluate(law.instance(), &node.b, &node.report), ILAW_UNSUPPORTED);
  EXPECT_STREQ(node.report.reason, "the batch tells bonds to hold or break, of a law that cannot hold bonds");
}

}  // namespace
}  // namespace ilaw::testing
