// A law that gives what its card does not announce: the kit refuses the node, and says which promise it was.
#include "support/law_runner.hpp"
#include "support/small_batch.hpp"

namespace ilaw::testing {
namespace {

struct Broken {
  const char* promise;
  std::int64_t node;  // of three: closed, open, open and out of reach; -1: none
  const char* reason;
};

constexpr Broken promises[] = {
    {"none", -1, nullptr},
    {"status", 0, "the law gave a status that ilaw.h does not have"},
    {"half_status", 0, "the law gave a status that ilaw.h does not have"},
    {"number", 0, "the law gave an impulse that is not a number"},
    {"pull", 0, "the law pulled, which needs ILAW_CAN_ADHERE in its card"},
    {"far", 2, "the law acted out of reach, which needs ILAW_CAN_ACT_AT_DISTANCE in its card"}};

ilaw::interface breaker_of(const char* promise) {
  const SetupBuilder setup({{}, {{"breaks", promise}}});
  return {ilaw::library(ILAW_PROMISE_BREAKER), "promise_breaker", setup.setup};
}

// With what leaves by the optional outputs and without: a node is refused in both or in neither.
TEST(Promises, ThatALawBreaksAreRefusedAtTheirNode) {
  const double gap[] = {-0.1, 1e-4, 1.0};
  for (const auto& [promise, node, reason] : promises)
    for (const bool outputs : {true, false}) {
      const ilaw::interface law = breaker_of(promise);
      SmallBatch nodes(3, {-1.0, 0.0, 0.0}, law.info().state_size);
      nodes.b.gap = {gap, 1, 1};
      std::uint8_t* const status = nodes.b.status;
      if (!outputs) nodes.b.status = nullptr;
      SCOPED_TRACE(::testing::Message() << promise << (outputs ? ", outputs" : ""));
      EXPECT_EQ(law.evaluate(nodes.b, &nodes.report), node < 0 ? ILAW_OK : ILAW_BAD_NODES);
      EXPECT_EQ(nodes.report.first_bad_node, node);
      EXPECT_STREQ(nodes.report.reason, reason);
      if (outputs && node >= 0) {
        EXPECT_EQ(status[node], ILAW_BAD_INPUT);
      }
      if (node >= 0) {
        EXPECT_EQ(nodes.r[static_cast<std::size_t>(node)][0], 0.0);
      }
    }
}

}  // namespace
}  // namespace ilaw::testing
