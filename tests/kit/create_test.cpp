// Setups that create refuses, and in which words: the parameter, its value, what is allowed.
#include "support/law_runner.hpp"
#include "support/small_batch.hpp"

#include <ilaw/ext/draft/profile.h>

#include <cstdlib>
#include <set>

namespace ilaw::testing {
namespace {

TEST(Create, RefusesUnknownInstructionSets) {
  const SetupBuilder setup({});
  for (const char* level : {"", "V3", "avx2", "v5", "v3 "}) {
    setenv("ILAW_ISA", level, 1);
    EXPECT_EQ(refusal_of("contact", setup, ILAW_UNSUPPORTED),
              std::string("law 'contact': ILAW_ISA is '") + level + "', expected baseline, v3 or v4");
  }
  unsetenv("ILAW_ISA");
}

// A law whose named parameters are tables: time, value, time, value ...
Parameters tables_of(std::map<std::string, std::vector<double>> tables) {
  Parameters parameters;
  parameters.tables = std::move(tables);
  return parameters;
}

// Two nodes that close and slide at speed 5: the tangential impulse is minus their friction, up to -5.
struct TwoSliding : SmallBatch {
  TwoSliding() : SmallBatch(2, {-1.0, 5.0, 0.0}) {}
};

// A table's end beside an infinite value is what was written.
TEST(Create, TakesTablesThatReachInfinity) {
  const Parameters table = tables_of({{"friction", {0.0, 0.1, 0.1, 0.1, 0.2, inf_value, 0.3, 0.2}}});
  const ilaw::interface law = make_law("coulomb", SetupBuilder(table));
  TwoSliding nodes;
  for (const auto& [time, impulse] :
       {std::pair{0.0, -0.1}, {0.1, -0.1}, {0.15, -5.0}, {0.2, -5.0}, {0.25, -5.0}, {0.3, -0.2}}) {
    nodes.b.time = time;
    EXPECT_EQ(law.evaluate(nodes.b), ILAW_OK);
    EXPECT_NEAR(nodes.r[0][1], impulse, 1e-15) << time;
  }
}

// Parameters that go together at the start may not later: all times of all tables are looked at.
TEST(Create, JudgesConflictsAtAllTimesOfTables) {
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
  Parameters bond = tables_of({{"strength", {0.0, 1.0, 1.0, inf_value, 2.0, inf_value, 3.0, 1.0}},
                               {"strength_2", {0.0, 1.0, 3.0, 1.0}}});
  bond.numbers["toughness"] = 1.0;
  EXPECT_NE(refusal_of("cohesive", bond), "not refused");
  bond.tables.at("strength") = {0.0, 1.0, 1.0, 2.0, 3.0, 1.0};
  EXPECT_NO_THROW(make_law("cohesive", SetupBuilder(bond)));
}

// How many buckets a window has is settled when the law is created.
TEST(Create, RefusesAMemoryThatVaries) {
  Parameters per_node;
  per_node.per_node = {"memory"};
  for (const std::string law : {"postit", "tie"})
    for (const auto& [varying, words] : {std::pair{tables_of({{"memory", {0.0, 0.1, 1.0, 0.2}}}), "a table"},
                                         {per_node, "a value per node"}})
      EXPECT_EQ(refusal_of(law, varying), "law '" + law + "': parameter 'memory' was given as " + words +
                                              ": expected a number in [0, inf]")
          << "law " << law;
}

// Authors give their laws extensions by a member, beside those of the kit.
TEST(Extension, OfALawIsFoundByItsName) {
  const ilaw::library probe(ILAW_KIT_PROBE), coulomb(plugin_file("coulomb"));
  const auto extension = probe.law("kit_probe")->extension;
  ASSERT_NE(extension, nullptr);
  ASSERT_NE(extension("tests.answer/1"), nullptr);
  EXPECT_EQ(*static_cast<const int*>(extension("tests.answer/1")), 42);
  EXPECT_EQ(extension("tests.answer/2"), nullptr);
  EXPECT_EQ(coulomb.law("coulomb")->extension("tests.answer/1"), nullptr);
  for (const auto* law : {probe.law("kit_probe"), coulomb.law("coulomb")}) {
    const auto* profile = static_cast<const ilaw_profile*>(law->extension(ILAW_PROFILE));
    ASSERT_NE(profile, nullptr) << law->id;
    EXPECT_EQ(profile->struct_size, sizeof(ilaw_profile)) << law->id;
  }
}

// Packs of solver_probe leave such problems to the scalar fallback, and the count changes no bit.
TEST(Extension, OfTheProfileCountsWhatIsSolvedOneByOne) {
  const ilaw::library library(ILAW_KIT_PROBE);
  const SetupBuilder setup({});
  const ilaw::interface law(library, "solver_probe", setup.setup);
  const auto* profile = static_cast<const ilaw_profile*>(law.law().extension(ILAW_PROFILE));
  const std::set<std::string> known = {"baseline", "v3", "v4"};
  EXPECT_EQ(known.count(profile->instruction_set(law.instance())), 1U);
  constexpr std::size_t count = 70;  // more than a block
  SmallBatch nodes(count, {-30.0, 0.0, 0.0}, law.info().state_size);
  SmallBatch again(count, {-30.0, 0.0, 0.0}, law.info().state_size);
  ASSERT_EQ(law.evaluate(nodes.b), ILAW_OK);
  std::int64_t one_by_one = -1;
  ASSERT_EQ(profile->evaluate_counting(law.instance(), &again.b, nullptr, &one_by_one), ILAW_OK);
  EXPECT_EQ(one_by_one, static_cast<std::int64_t>(count));
  EXPECT_EQ(nodes.state, again.state);
  EXPECT_EQ(nodes.r, again.r);
}

}  // namespace
}  // namespace ilaw::testing
