// What create refuses, and in which words: the parameter, its value, what is allowed.
#include "law_runner.hpp"

#include <limits>

namespace ilaw::testing {
namespace {

std::string refusal_of(const std::string& law, const Parameters& parameters) {
  try {
    make_law(law, SetupBuilder(parameters));
  } catch (const ilaw::error& error) {
    EXPECT_EQ(error.code(), ILAW_INVALID_PARAMETER);
    return error.what();
  }
  return "not refused";
}

TEST(Create, NamesTheParameterItsValueAndWhatIsAllowed) {
  EXPECT_EQ(refusal_of("contact", {{{"restitution", 1.5}}, {}}),
            "law 'contact': parameter 'restitution' = 1.5 is not allowed: expected a number in [0, 1]");
  EXPECT_EQ(refusal_of("contact", {{{"restitution", std::nan("")}}, {}}),
            "law 'contact': parameter 'restitution' = nan is not allowed: expected a number in [0, 1]");
  EXPECT_EQ(refusal_of("contact", {{{"restitution", std::numeric_limits<double>::infinity()}}, {}}),
            "law 'contact': parameter 'restitution' = inf is not allowed: expected a number in [0, 1]");
  EXPECT_EQ(refusal_of("contact", {{{"restituton", 0.5}}, {}}),
            "law 'contact': unknown parameter 'restituton': expected one of restitution, activation");
  EXPECT_EQ(refusal_of("contact", {{}, {{"activation", "early"}}}),
            "law 'contact': parameter 'activation' = \"early\" is not allowed: expected one of \"moreau\", "
            "\"predictive\"");
  EXPECT_EQ(
      refusal_of("contact", {{}, {{"restitution", "high"}}}),
      "law 'contact': parameter 'restitution' was given as a text (\"high\"): expected a number in [0, 1]");
  EXPECT_EQ(refusal_of("coulomb", {}),
            "law 'coulomb': parameter 'friction' is missing: expected a number in [0, inf]");
  EXPECT_EQ(refusal_of("coulomb", {{{"friction", -0.1}}, {}}),
            "law 'coulomb': parameter 'friction' = -0.1 is not allowed: expected a number in "
            "[0, inf]");
  EXPECT_EQ(refusal_of("postit", {{{"buckets", 2.5}}, {}}),
            "law 'postit': parameter 'buckets' = 2.5 is not allowed: expected a whole number in [1, 4096]");
  EXPECT_EQ(refusal_of("postit", {{{"tangent_influence", 0.0}}, {}}),
            "law 'postit': parameter 'tangent_influence' = 0 is not allowed: expected a number in (0, inf]");
  EXPECT_EQ(
      refusal_of("postit", {{{"initial_adhesion", 2.0}, {"adhesion_limit", 1.0}}, {}}),
      "law 'postit': parameter 'initial_adhesion' is larger than 'adhesion_limit', expected at most that; "
      "found adhesion_limit = 1, initial_adhesion = 2");
}

TEST(Create, RefusesSetupsThatTheLawDoesNotServe) {
  const ilaw::library library(plugin_file("contact"));
  SetupBuilder setup({});
  const auto refusal = [&] {
    try {
      const ilaw::interface law(library, "contact", setup.setup);
    } catch (const ilaw::error& error) {
      return std::string(error.what());
    }
    return std::string("not refused");
  };
  setup.setup.dimension = 4;
  EXPECT_EQ(refusal(), "law 'contact': dimension 4 is not served: expected 1 2 3");
  setup.setup.dimension = 3;
  setup.setup.delassus_form = 8;
  EXPECT_EQ(refusal(),
            "law 'contact': form 8 of H is not served: expected one of 1 (scalar) 2 (diagonal) 4 (full)");
  setup.setup.delassus_form = ILAW_DELASSUS_SCALAR;
  setup.setup.velocity_step = 0.0;
  EXPECT_EQ(refusal(), "law 'contact': velocity_step 0 is not allowed: expected a finite number > 0");
}

// A table's end beside an infinite value is what was written.
TEST(Create, TablesMayReachInfinity) {
  const double inf = std::numeric_limits<double>::infinity();
  const double pairs[] = {0.0, 0.1, 0.1, 0.1, 0.2, inf, 0.3, 0.2};
  ilaw_argument table{};
  table.struct_size = sizeof table;
  table.kind = ILAW_VALUE_TABLE;
  table.name = "friction";
  table.values = pairs;
  table.count = 4;
  const ilaw_argument* arguments[] = {&table};
  SetupBuilder setup({});
  setup.setup.arguments = arguments;
  setup.setup.argument_count = 1;
  const ilaw::interface law = make_law("coulomb", setup);
  const double v[] = {-1.0, 5.0, 0.0}, h = 1.0, gap = 0.0;
  double r[3];
  ilaw_batch b{};
  b.struct_size = sizeof b;
  b.node_count = 1;
  b.velocity_step = b.position_step = 1e-3;
  b.v_free = b.v_previous = {v, 3, 1};
  b.delassus = {&h, 0, 1};
  b.gap = {&gap, 0, 1};
  b.impulse = {r, 3, 1};
  for (const auto& [time, impulse] :
       {std::pair{0.0, -0.1}, {0.1, -0.1}, {0.15, -5.0}, {0.2, -5.0}, {0.25, -5.0}, {0.3, -0.2}}) {
    b.time = time;
    EXPECT_EQ(law.evaluate(b), ILAW_OK);
    EXPECT_NEAR(r[1], impulse, 1e-15) << time;
  }
}

// The slots of a memory are laid out when the law is made.
TEST(Create, RefusesAMemoryThatVaries) {
  const double pairs[] = {0.0, 0.1, 1.0, 0.2};
  for (const char* law : {"postit", "tie"})
    for (const auto& [kind, words] :
         {std::pair{ILAW_VALUE_TABLE, "a table in time"}, {ILAW_VALUE_PER_NODE, "a value per node"}}) {
      ilaw_argument memory{};
      memory.struct_size = sizeof memory;
      memory.kind = static_cast<std::uint32_t>(kind);
      memory.name = "memory";
      memory.values = pairs;
      memory.count = 2;
      const ilaw_argument* arguments[] = {&memory};
      SetupBuilder setup({});
      setup.setup.arguments = arguments;
      setup.setup.argument_count = 1;
      try {
        make_law(law, setup);
        ADD_FAILURE() << law;
      } catch (const ilaw::error& error) {
        EXPECT_EQ(error.what(), "law '" + std::string(law) + "': parameter 'memory' was given as " + words +
                                    ": expected a number in [0, inf]");
      }
    }
}

// A table in time is read at the time of the batch; a value per node comes with the batch and is checked
// there.
TEST(Create, TakesTablesAndValuesPerNode) {
  const double pairs[] = {0.0, 0.0, 1.0, 0.8};
  ilaw_argument table{};
  table.struct_size = sizeof table;
  table.kind = ILAW_VALUE_TABLE;
  table.name = "friction";
  table.values = pairs;
  table.count = 2;
  const ilaw_argument* arguments[] = {&table};
  SetupBuilder setup({});
  setup.setup.arguments = arguments;
  setup.setup.argument_count = 1;
  const double v[] = {-1.0, 5.0, 0.0, -1.0, 5.0, 0.0}, h = 1.0, gap = 0.0;
  double r[6];
  ilaw_batch b{};
  b.struct_size = sizeof b;
  b.node_count = 2;
  b.velocity_step = b.position_step = 1e-3;
  b.v_free = {v, 3, 1};
  b.v_previous = {v, 3, 1};
  b.delassus = {&h, 0, 1};
  b.gap = {&gap, 0, 1};
  b.impulse = {r, 3, 1};
  const ilaw::interface in_time = make_law("coulomb", setup);
  for (const auto& [time, friction] : {std::pair{-1.0, 0.0}, {0.25, 0.2}, {0.5, 0.4}, {7.0, 0.8}}) {
    b.time = time;
    EXPECT_EQ(in_time.evaluate(b), ILAW_OK);
    EXPECT_NEAR(r[1], -friction, 1e-15);
  }

  table.kind = ILAW_VALUE_PER_NODE;
  const ilaw::interface per_node = make_law("coulomb", setup);
  ASSERT_EQ(per_node.info().per_node_parameter_count, 1U);
  EXPECT_STREQ(per_node.info().per_node_parameters[0], "friction");
  double friction[] = {0.1, 0.3};
  const ilaw_input given{friction, 1, 1};
  b.per_node_parameters = &given;
  EXPECT_EQ(per_node.evaluate(b), ILAW_OK);
  EXPECT_NEAR(r[1], -0.1, 1e-16);
  EXPECT_NEAR(r[4], -0.3, 1e-16);
  friction[1] = -0.3;
  ilaw_report report{};
  report.struct_size = sizeof report;
  EXPECT_EQ(per_node.evaluate(b, &report), ILAW_BAD_NODES);
  EXPECT_EQ(report.first_bad_node, 1);
  EXPECT_STREQ(report.reason, "a per-node parameter is out of range");
  EXPECT_NEAR(r[1], -0.1, 1e-16);
  EXPECT_EQ(r[4], 0.0);
}

}  // namespace
}  // namespace ilaw::testing
