// What create refuses, and in which words: the parameter, its value, what is allowed.
#include "support/law_runner.hpp"

#include <limits>
#include <span>

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
  setup.setup.flags = std::uint64_t{1} << 40;
  EXPECT_EQ(refusal(), "law 'contact': flags 0x10000000000 are not known: expected 0");
}

// A setup with one parameter, that varies.
struct Varying {
  Varying(std::uint32_t kind, const char* name, std::span<const double> values, std::uint64_t count) {
    argument.struct_size = sizeof argument;
    argument.kind = kind;
    argument.name = name;
    argument.values = values.data();
    argument.count = count;
    setup.setup.arguments = arguments;
    setup.setup.argument_count = 1;
  }
  Varying(const Varying&) = delete;
  Varying& operator=(const Varying&) = delete;

  ilaw_argument argument{};
  const ilaw_argument* arguments[1] = {&argument};
  SetupBuilder setup{{}};
};

// Two nodes that close and slide at speed 5: the tangential impulse is minus their friction, up to -5.
struct TwoSliding {
  TwoSliding() {
    b.struct_size = sizeof b;
    b.node_count = 2;
    b.velocity_step = b.position_step = 1e-3;
    b.v_free = b.v_previous = {v, 3, 1};
    b.delassus = {&h, 0, 1};
    b.gap = {&gap, 0, 1};
    b.impulse = {r, 3, 1};
  }
  TwoSliding(const TwoSliding&) = delete;
  TwoSliding& operator=(const TwoSliding&) = delete;

  const double v[6] = {-1.0, 5.0, 0.0, -1.0, 5.0, 0.0}, h = 1.0, gap = 0.0;
  double r[6] = {};
  ilaw_batch b{};
};

// A table in time is read at the time of the batch.
TEST(Create, TakesTables) {
  const double pairs[] = {0.0, 0.0, 1.0, 0.8};
  const Varying table(ILAW_VALUE_TABLE, "friction", pairs, 2);
  const ilaw::interface law = make_law("coulomb", table.setup);
  TwoSliding nodes;
  for (const auto& [time, friction] : {std::pair{-1.0, 0.0}, {0.25, 0.2}, {0.5, 0.4}, {7.0, 0.8}}) {
    nodes.b.time = time;
    EXPECT_EQ(law.evaluate(nodes.b), ILAW_OK);
    EXPECT_NEAR(nodes.r[1], -friction, 1e-15);
  }
}

// A table's end beside an infinite value is what was written.
TEST(Create, TakesTablesThatReachInfinity) {
  const double pairs[] = {0.0, 0.1, 0.1, 0.1, 0.2, std::numeric_limits<double>::infinity(), 0.3, 0.2};
  const Varying table(ILAW_VALUE_TABLE, "friction", pairs, 4);
  const ilaw::interface law = make_law("coulomb", table.setup);
  TwoSliding nodes;
  for (const auto& [time, impulse] :
       {std::pair{0.0, -0.1}, {0.1, -0.1}, {0.15, -5.0}, {0.2, -5.0}, {0.25, -5.0}, {0.3, -0.2}}) {
    nodes.b.time = time;
    EXPECT_EQ(law.evaluate(nodes.b), ILAW_OK);
    EXPECT_NEAR(nodes.r[1], impulse, 1e-15) << time;
  }
}

// Parameters that go together at the start may not later: all times of all tables are looked at.
TEST(Create, JudgesConflictsAtAllTimesOfTables) {
  const auto tables_of = [](std::map<std::string, std::vector<double>> tables) {
    Parameters parameters;
    parameters.tables = std::move(tables);
    return parameters;
  };
  EXPECT_EQ(
      refusal_of("postit", tables_of({{"initial_adhesion", {0.0, 1.0}},
                                      {"adhesion_limit", {0.0, 2.0, 1.0, 0.5, 3.0, 2.0}}})),
      "law 'postit': parameter 'initial_adhesion' is larger than 'adhesion_limit', expected at most that; "
      "found adhesion_limit = 0.5, initial_adhesion = 1 at time 1");
  // In between the points of the one, at a point of the other.
  EXPECT_EQ(
      refusal_of("postit", tables_of({{"initial_adhesion", {0.0, 0.0, 0.5, 1.75, 1.0, 0.0}},
                                      {"adhesion_limit", {0.0, 2.0, 1.0, 1.0}}})),
      "law 'postit': parameter 'initial_adhesion' is larger than 'adhesion_limit', expected at most that; "
      "found adhesion_limit = 1.5, initial_adhesion = 1.75 at time 0.5");
  const double inf = std::numeric_limits<double>::infinity();
  Parameters bond = tables_of(
      {{"strength", {0.0, 1.0, 1.0, inf, 2.0, inf, 3.0, 1.0}}, {"strength_2", {0.0, 1.0, 3.0, 1.0}}});
  bond.numbers["toughness"] = 1.0;
  EXPECT_NE(refusal_of("cohesive", bond), "not refused");
  bond.tables.at("strength") = {0.0, 1.0, 1.0, 2.0, 3.0, 1.0};
  EXPECT_NO_THROW(make_law("cohesive", SetupBuilder(bond)));
}

// The slots of a memory are laid out when the law is made.
TEST(Create, RefusesAMemoryThatVaries) {
  const double pairs[] = {0.0, 0.1, 1.0, 0.2};
  for (const char* law : {"postit", "tie"})
    for (const auto& [kind, words] :
         {std::pair{ILAW_VALUE_TABLE, "a table in time"}, {ILAW_VALUE_PER_NODE, "a value per node"}}) {
      const Varying memory(static_cast<std::uint32_t>(kind), "memory", pairs, 2);
      try {
        make_law(law, memory.setup);
        ADD_FAILURE() << law;
      } catch (const ilaw::error& error) {
        EXPECT_EQ(error.what(), "law '" + std::string(law) + "': parameter 'memory' was given as " + words +
                                    ": expected a number in [0, inf]");
      }
    }
}

// A value per node comes with the batch and is checked there.
TEST(Create, TakesValuesPerNode) {
  const Varying per_node(ILAW_VALUE_PER_NODE, "friction", {}, 0);
  const ilaw::interface law = make_law("coulomb", per_node.setup);
  ASSERT_EQ(law.info().per_node_parameter_count, 1U);
  EXPECT_STREQ(law.info().per_node_parameters[0], "friction");
  double friction[] = {0.1, 0.3};
  const ilaw_input given{friction, 1, 1};
  TwoSliding nodes;
  nodes.b.per_node_parameters = &given;
  EXPECT_EQ(law.evaluate(nodes.b), ILAW_OK);
  EXPECT_NEAR(nodes.r[1], -0.1, 1e-16);
  EXPECT_NEAR(nodes.r[4], -0.3, 1e-16);
  friction[1] = -0.3;
  ilaw_report report{};
  report.struct_size = sizeof report;
  EXPECT_EQ(law.evaluate(nodes.b, &report), ILAW_BAD_NODES);
  EXPECT_EQ(report.first_bad_node, 1);
  EXPECT_STREQ(report.reason, "a per-node parameter is out of range");
  EXPECT_NEAR(nodes.r[1], -0.1, 1e-16);
  EXPECT_EQ(nodes.r[4], 0.0);
}

// Authors give their laws extensions by a member; a law without has none, which null says.
TEST(Extension, OfALawIsFoundByItsName) {
  const ilaw::library probe(ILAW_KIT_PROBE), coulomb(plugin_file("coulomb"));
  const auto extension = probe.law("kit_probe")->extension;
  ASSERT_NE(extension, nullptr);
  ASSERT_NE(extension("tests.answer/1"), nullptr);
  EXPECT_EQ(*static_cast<const int*>(extension("tests.answer/1")), 42);
  EXPECT_EQ(extension("tests.answer/2"), nullptr);
  EXPECT_EQ(coulomb.law("coulomb")->extension, nullptr);
}

}  // namespace
}  // namespace ilaw::testing
