// Parameters as tables in time and as values per node: whatever a law's description allows, for every law.
#include "laws/random_nodes.hpp"
#include "support/law_cases.hpp"

namespace ilaw::testing {
namespace {

class OptionsOf : public ::testing::TestWithParam<LawCase> {
 protected:
  // Steps that both ways must give the same bits for.
  void expect_same(Runner& a, Runner& b) {
    a.initialise();
    b.initialise();
    for (int k = 0; k < 20; ++k) {
      nodes.draw();
      for (std::size_t i = 0; i < nodes.count; ++i) {
        nodes.v_previous[i] = nodes.v_free[nodes.count - 1 - i];
        nodes.gap[i] = nodes.uniform() * RandomNodes::step;
      }
      a.time = b.time += RandomNodes::step;
      ASSERT_EQ(a.evaluate(), ILAW_OK) << a.report.reason;
      ASSERT_EQ(b.evaluate(), ILAW_OK) << b.report.reason;
      ASSERT_EQ(a.r, b.r) << "k " << k;
      ASSERT_EQ(a.state, b.state) << "k " << k;
      ASSERT_EQ(a.status, b.status) << "k " << k;
    }
  }

  // Numbers that the law accepts per node or as a table over time.
  std::vector<const ilaw_parameter*> numbers(std::uint32_t kind) const {
    std::vector<const ilaw_parameter*> found;
    const ilaw_law& description = *library.law(law.law);
    for (std::uint32_t k = 0; k < description.parameter_count; ++k)
      if ((kind == ILAW_KIND_VALUE_TABLE
               ? description.parameters[k]->axis_count > 0
               : (description.parameters[k]->flags & ILAW_FLAG_ALLOWS_PER_NODE) != 0) &&
          law.parameters.numbers.contains(description.parameters[k]->name))
        found.push_back(description.parameters[k]);
    return found;
  }

  // A constant that is given in this way, as "give" writes it, changes no bit.
  template <class Give>
  void expect_no_change(std::uint32_t kind, Give give) {
    const auto varying = numbers(kind);
    EXPECT_GE(varying.size(), 1U);
    for (const ilaw_parameter* parameter : varying) {
      SCOPED_TRACE(parameter->name);
      Parameters parameters = law.parameters;
      const double value = parameters.numbers.extract(parameter->name).mapped();
      give(parameters, parameter->name, value);
      Runner constant(law.law, law.parameters, nodes), varied(law.law, parameters, nodes);
      const std::vector<double> values(nodes.count, value);
      varied.per_node = {ilaw::input(values.data(), 1, 1)};
      expect_same(constant, varied);
    }
  }

  const LawCase& law = GetParam();
  ilaw::library library{plugin_file(law.law)};
  RandomNodes nodes{500, 3, ILAW_DELASSUS_SCALAR, Inertia::any, 13};
};

TEST_P(OptionsOf, AConstantGivenPerNodeGivesTheSameBits) {
  expect_no_change(ILAW_KIND_VALUE_PER_NODE,
                   [](Parameters& parameters, const char* name, double) { parameters.per_node = {name}; });
}

TEST_P(OptionsOf, AConstantTableGivesTheSameBits) {
  expect_no_change(ILAW_KIND_VALUE_TABLE, [](Parameters& parameters, const char* name, double value) {
    parameters.tables[name] = {0.0, value, 3.5 * RandomNodes::step, value, 1.0, value};
  });
}

// Each node has the value of its own array entry, whatever the others have: as in a batch where it is the
// constant.
TEST_P(OptionsOf, EachNodeHasItsOwnValue) {
  for (const ilaw_parameter* parameter : numbers(ILAW_KIND_VALUE_PER_NODE)) {
    Parameters parameters = law.parameters;
    const double value = parameters.numbers.at(parameter->name),
                 other = std::min(1.1 * value, parameter->maximum);
    Parameters changed = law.parameters;
    changed.numbers[parameter->name] = other;
    parameters.numbers.erase(parameter->name);
    parameters.per_node = {parameter->name};
    Runner a(law.law, law.parameters, nodes), b(law.law, changed, nodes), mixed(law.law, parameters, nodes);
    std::vector<double> values(nodes.count);
    for (std::size_t i = 0; i < nodes.count; ++i) values[i] = i % 2 ? value : other;
    mixed.per_node = {ilaw::input(values.data(), 1, 1)};
    for (Runner* runner : {&a, &b, &mixed}) runner->initialise();
    nodes.draw();
    std::fill(nodes.gap.begin(), nodes.gap.end(), -1e-4);
    nodes.v_previous = nodes.v_free;
    for (Runner* runner : {&a, &b, &mixed}) ASSERT_EQ(runner->evaluate(), ILAW_OK) << runner->report.reason;
    for (std::size_t i = 0; i < nodes.count; ++i)
      ASSERT_EQ(mixed.r[i], (i % 2 ? a : b).r[i]) << parameter->name;
  }
}

// A value that may not be, at one node in three, is bad input there and nowhere else.
TEST_P(OptionsOf, BadValuesAreBadInputAtTheirNodesOnly) {
  for (const ilaw_parameter* parameter : numbers(ILAW_KIND_VALUE_PER_NODE))
    for (const double bad :
         {std::nan(""), parameter->minimum - 1.0, -std::numeric_limits<double>::infinity()}) {
      Parameters parameters = law.parameters;
      const double value = parameters.numbers.extract(parameter->name).mapped();
      parameters.per_node = {parameter->name};
      Runner constant(law.law, law.parameters, nodes), per_node(law.law, parameters, nodes);
      std::vector<double> values(nodes.count, value);
      per_node.per_node = {ilaw::input(values.data(), 1, 1)};
      for (Runner* runner : {&constant, &per_node}) runner->initialise();
      for (std::size_t i = 0; i < nodes.count; i += 3) values[i] = bad;
      nodes.draw();
      nodes.v_previous = nodes.v_free;
      std::fill(nodes.gap.begin(), nodes.gap.end(), -1e-4);
      ASSERT_EQ(constant.evaluate(), ILAW_OK);
      ASSERT_EQ(per_node.evaluate(), ILAW_BAD_NODES);
      EXPECT_EQ(per_node.report.bad_count, static_cast<std::int64_t>((nodes.count + 2) / 3));
      EXPECT_EQ(per_node.report.first_bad_node, 0);
      EXPECT_STREQ(per_node.report.reason, "a per-node parameter is out of range");
      for (std::size_t i = 0; i < nodes.count; ++i) {
        ASSERT_EQ(per_node.r[i], i % 3 ? constant.r[i] : Vector{}) << parameter->name << " " << bad;
        ASSERT_EQ(per_node.status[i], i % 3 ? int{constant.status[i]} : int{ILAW_BAD_INPUT}) << "i " << i;
      }
    }
}

// Parameters that do not go together are refused by create, or at their nodes where one of them is given per
// node.
TEST(Options, ValuesThatDoNotGoTogetherAreRefusedAtTheirNodes) {
  RandomNodes nodes(4, 3, ILAW_DELASSUS_SCALAR, Inertia::any, 14);
  Parameters parameters{{{"strength", 10.0}, {"toughness", 1.0}, {"delay_time", 1.0}}, {}};
  parameters.per_node = {"stiffness"};
  Runner run("cohesive", parameters, nodes);
  const double stiffness[] = {1e3, std::numeric_limits<double>::infinity(), 1e3, 1.0};
  run.per_node = {ilaw::input(stiffness, 1, 1)};
  nodes.draw();
  EXPECT_EQ(run.evaluate(), ILAW_BAD_NODES);
  EXPECT_EQ(run.report.bad_count, 2);
  EXPECT_EQ(run.report.first_bad_node, 1);
  EXPECT_EQ(std::string(run.report.reason).rfind("parameter 'delay_time' > 0 needs a finite 'stiffness'", 0),
            0U)
      << run.report.reason;
  EXPECT_EQ(run.status[3], ILAW_BAD_INPUT);  // toughness below strength^2/(2 stiffness) = 50
  EXPECT_NE(run.status[0], ILAW_BAD_INPUT);
}

// Half way between two instants of a table the value is half way, and outside its ends it is theirs.
TEST_P(OptionsOf, TablesArePiecewiseLinearInTime) {
  for (const ilaw_parameter* parameter : numbers(ILAW_KIND_VALUE_TABLE)) {
    const double value = law.parameters.numbers.at(parameter->name);
    const double from = std::min(0.75 * value, parameter->maximum), to = 1.25 * value - 0.25 * from;
    Parameters parameters = law.parameters, midway = law.parameters;
    parameters.numbers.erase(parameter->name);
    parameters.tables[parameter->name] = {1.0, from, 3.0, to};
    nodes.draw();
    nodes.v_previous = nodes.v_free;
    std::fill(nodes.gap.begin(), nodes.gap.end(), -1e-4);
    Runner table(law.law, parameters, nodes);
    for (const auto& [time, expected] : {std::pair{0.0, from}, {2.0, 0.5 * from + 0.5 * to}, {9.0, to}}) {
      midway.numbers[parameter->name] = expected;
      Runner constant(law.law, midway, nodes);
      constant.time = table.time = time;
      constant.initialise();
      table.initialise();
      ASSERT_EQ(constant.evaluate(), ILAW_OK);
      ASSERT_EQ(table.evaluate(), ILAW_OK);
      ASSERT_EQ(constant.r, table.r) << parameter->name << " at " << time;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Laws, OptionsOf, ::testing::ValuesIn(law_cases("options")),
                         [](const auto& drawn) { return drawn.param.name; });

}  // namespace
}  // namespace ilaw::testing
