// The checker: the sample law keeps every rule, and breaks each that it is told to; so do crashes and the
// like. The laws of the tree keep all.
#include "check_sample.hpp"

#include "check/rule.hpp"

#include <gtest/gtest.h>
#include <tinyxml2.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>

namespace ilaw::check {
namespace {

constexpr double seconds = 0.2;  // for a rule: thousandths are enough, but for those that hang

Names with_id_of_rules() {
  Names ids;
  for (const Rule& rule : rules()) ids.insert(rule.id);
  return ids;
}

TEST(Rules, HaveAnIdASentenceAndASource) {
  EXPECT_EQ(with_id_of_rules().size(), rules().size());
  EXPECT_GE(rules().size(), 120U);
  for (const Rule& rule : rules()) {
    EXPECT_EQ(std::string(rule.required).back(), '.') << rule.id;
    EXPECT_NE(std::string(rule.source).find(", "), std::string::npos) << rule.id;
  }
}

// The page names each rule, or its family with '*', in the first column of the table under "The rules".
TEST(Rules, StandOnTheirPage) {
  std::stringstream page;
  page << std::ifstream(ILAW_SOURCE "/docs/check.md").rdbuf();
  const std::string text = page.str();
  EXPECT_NE(text.find(" the " + std::to_string(rules().size()) + " rules, "), std::string::npos)
      << "docs/check.md has another number of rules than " << rules().size();
  static const std::regex row("\n\\| (`[^|]*)\\|"), name("`([^`]*)`");
  Names named, families;
  const auto start = text.find("\n## The rules\n");
  ASSERT_NE(start, std::string::npos);
  const std::string table = text.substr(start);
  for (std::sregex_iterator at(table.begin(), table.end(), row), end; at != end; ++at) {
    const std::string cell = (*at)[1];
    for (std::sregex_iterator found(cell.begin(), cell.end(), name); found != end; ++found)
      ((*found)[1].str().back() == '*' ? families : named).insert((*found)[1]);
  }
  const auto begins_with = [](const std::string& id, const std::string& family) {
    return id.rfind(family.substr(0, family.size() - 1), 0) == 0;
  };
  const Names ids = with_id_of_rules();
  for (const std::string& id : ids)
    EXPECT_TRUE(named.contains(id) ||
                std::any_of(families.begin(), families.end(),
                            [&](const std::string& family) { return begins_with(id, family); }))
        << "docs/check.md does not name " << id;
  for (const std::string& id : named)
    EXPECT_TRUE(ids.contains(id)) << "docs/check.md: no rule is called " << id;
  for (const std::string& family : families)
    EXPECT_TRUE(
        std::any_of(ids.begin(), ids.end(), [&](const std::string& id) { return begins_with(id, family); }))
        << "docs/check.md: no rule begins as " << family;
}

TEST(Rules, MakeATableOfThreeColumns) {
  std::stringstream table(table_of_rules());
  for (std::string line; std::getline(table, line);)
    EXPECT_EQ(std::count(line.begin(), line.end(), '|'), 4) << line;
}

TEST(Sample, KeepsEveryRule) {
  const Checked checked = check_sample("", only({}));
  EXPECT_TRUE(checked.all_passed()) << text_of(checked);
  EXPECT_EQ(checked.outcomes.size(), rules().size());
  for (const Outcome& outcome : checked.outcomes)
    EXPECT_TRUE(outcome.verdict == Verdict::passed || outcome.rule == "stable-step" ||
                outcome.rule == "stable-step-bound" || outcome.rule == "held-bonds" ||
                outcome.rule == "frame-turned")
        << outcome.rule << ": " << outcome.why;
}

class Broken : public ::testing::TestWithParam<std::string> {};

// Its own rule is seen broken; those around it are not. Where others must break too, they are named.
TEST_P(Broken, IsSeen) {
  const std::string& id = GetParam();
  const auto at =
      std::find_if(rules().begin(), rules().end(), [&](const Rule& rule) { return id == rule.id; });
  std::vector<std::string> ids{id};
  const bool all = std::getenv("ILAW_TEST_ALL_RULES");
  for (const Rule& rule : rules())
    if (all || std::abs(&rule - &*at) == 1) ids.emplace_back(rule.id);
  Options options = only(ids);
  options.seeds = {1};  // others may show a break to the rules around, too
  const Checked checked = check_sample(id, options);
  EXPECT_EQ(broken(checked), Names{id}) << text_of(checked);
}

std::string name_of(const ::testing::TestParamInfo<std::string>& drawn) {
  std::string name = drawn.param;
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c == '-' || c == ' '; }, '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Rules, Broken, ::testing::ValuesIn(with_id_of_rules()), name_of);

// A law that never changes its state is broken nowhere, and not judged there.
TEST(Reach, NamesStatesThatNoStepChanged) {
  const Checked checked = check_sample("closures stay", only({"purity-twice", "mirror"}));
  EXPECT_TRUE(checked.all_passed()) << text_of(checked);
  EXPECT_NE(text_of(checked).find("  not judged there, sample: state closures: purity-twice, mirror\n"),
            std::string::npos)
      << text_of(checked);
}

TEST(Reach, IsInTheJson) {
  const nlohmann::json reached =
      nlohmann::json::parse(json_of(check_sample("", only({"purity-twice"}))))[0].at("reached");
  EXPECT_GT(reached.at("node_steps"), 1000);
  for (const char* status : {"free", "closed", "slip"}) EXPECT_GT(reached.at("statuses").at(status), 0);
  EXPECT_EQ(reached.at("states").at("closures").at("least"), 0.0);
  EXPECT_GT(reached.at("states").at("closures").at("largest"), 2.0);
  EXPECT_EQ(reached.at("states").at("closures").at("changed"), true);
  EXPECT_TRUE(reached.at("not_judged_there").empty());
}

TEST(Reach, LacksWhatOthersReached) {
  Reach all, one;
  all.statuses = {5, 0, 3, 0, 0, 0, 0, 2};
  one.statuses = {5, 0, 0, 0, 0, 0, 0, 0};
  all.states["damage"] = {0.0, 1.0, true};
  all.states["age"] = {0.0, 0.0, false};
  one.states["damage"] = {0.5, 0.5, false};
  EXPECT_EQ(missing_in(one, all), (std::vector<std::string>{"status stick", "state age", "state damage"}));
  EXPECT_EQ(missing_in(all, all), std::vector<std::string>{"state age"});
}

// Rules that can be broken in several ways: each is told apart from the others.
TEST(OtherWays, OfBreakingARuleAreSeenToo) {
  const std::pair<const char*, const char*> ways[] = {
      {"description-constant: text", "the description was sample|"},
      {"description-constant: law", "the entry describes no law 'sample' any more"},
      {"extension-unknown: library", "extension of the library gave something"},
      {"info-within: inputs", "the instance reads inputs 64"},
      {"info-within: before", "the instance reads inputs "},
      {"info-within: permissions", "the instance lacks permissions 1"},
      {"description-units: amount", "amount 'heat' has the unit \"calorie\""},
      {"info-frame: local", "ILAW_INPUT_NORMAL in the local frame"},
      {"info-frame: tangent", "ILAW_INPUT_TANGENT without tangents"},
      {"functions-return: info", "info returned -"},
      {"setups-served: nothing", "create returned ILAW_OK and no instance"},
      {"setup-unserved: code", "create refused dimension 0 with code -"},
      {"refusal-message: instance", "a refusal left *instance set"},
      {"refusal-message: beyond", "create wrote beyond the 512 bytes of the message"},
      {"refusal-message: endless", "the message has no zero at its end"},
      {"sizes-long: info", "info wrote beyond the known struct"},
      {"sizes-long: report", "or wrote beyond the known report"},
      {"functions-return: code", "evaluate returned -"},
      {"call-refused: writes", ", wrote results"},
      {"call-refused: silent", ", gave no reason"},
      {"call-refused: state stride", "given state_out with node_stride 0, returned 0"},
      {"array-numbers: amount", "an amount with both pointers"},
      {"balance-inputs: amounts", "with amounts, evaluate returned 0"},
      {"table-linear: order", "over time {0.25, 0.75, 1}, temperature {0.25, 0.75} at (0.25, 0.75)"},
      {"initialise-reads: step", "wrote state 1, else 0"},
      {"stable-step: last", "stable_velocity_step "},
      {"bad-input-report: not a number", "v_free NaN: code 0"},
      {"array-numbers: state", "given state_in with both pointers, returned 0"},
      {"frame-indifference: backward", "in axes of the host"},
      {"table-linear: beyond", "over time {0.25, 0.75, 1} at (1.125)"},
      {"layout-strides: negative", "with negative strides, step "},
      {"layout-strides: state", "with strides of state_out alone, step "},
      {"energy-balance: position step", "a rest of "},
      {"report-null: refused", "without a report evaluate returned -"},
      {"report-clean: step", "stable_velocity_step nan"},
      {"report-clean: step beside bad", "stable_velocity_step nan"},
      {"report-clean: negative step", "stable_velocity_step -0.5"},
      {"report-clean: step per node", "stable_velocity_step nan"},
      {"batch-order: pack", "in reverse order, step "},
      {"batch-parts: pack", "alone, step "},
      {"batch-large: pack", "alone, step "},
      {"per-node-constant: pack", "with its values as constants, step "},
      {"bad-input-report: count", "bad_count 2"},
      {"bad-input-node: impulse", "impulse 1"},
      {"bad-input-node: state", "state_out "},
      {"bad-input-node: status", "status 0"},
      {"bad-input-node: energy", ", energy 1"},
      {"bad-input-node: amount", "amounts 1"},
      {"impulse-finite: floats", "impulse "},
      {"foreign-state: impulse", "bad input with an impulse"},
      {"foreign-state: state", "bad input with another state"},
      {"foreign-state: others", "node 3 changed"},
      {"skip-fresh: impulse", "out of reach, impulse "},
      {"skip-fresh: status", "out of reach, status 1"},
      {"skip-fresh: energy", "out of reach, energy 0.001"},
      {"skip-fresh: amount", "out of reach, amounts 1"},
      {"amounts-zero: no number", "wear of nan"},
      {"heat-dissipated: negative", "heat of -"},
      {"status-meaning: number", "status 8"},
      {"status-meaning: closed", "ILAW_CLOSED with the impulse "},
      {"energy-parts: stored", "stored energy 1"},
      {"energy-parts: no number", "dissipated part 1 of nan"},
      {"outputs-written: impulse", "the array impulse was not written"},
      {"outputs-written: state", "the array state_out was not written"},
      {"outputs-written: energy", "the array energy was not written"},
      {"outputs-written: amounts", "the array amounts was not written"},
      {"outputs-written: status", "the array status was not written"},
      {"step-limits: impulse", "impulse inf"},
      {"functions-return: v_smooth", "evaluate returned -1"},
      {"good-input-served: rest", "the slip has no direction"},
      {"array-numbers: v_smooth", "given v_smooth with both pointers, returned 0"},
      {"memory-unneeded: v_smooth", "reading not asked for: the array v_smooth"},
      {"layout-components: v_smooth", "component by component, step "},
      {"layout-strides: v_smooth", "with strides of 2 and more, step "},
      {"index-32: v_smooth", "by a list of 32 bits, step "},
      {"index-64: v_smooth", "by a list of 64 bits, step "},
      {"bad-input-report: v_smooth", "v_smooth NaN: code 0"},
      {"skip-fresh: v_smooth", "out of reach, impulse "},
      {"skip-free: v_smooth", "out of reach, impulse "},
      {"energy-made: v_smooth", ": energy was made"},
      {"energy-balance: v_smooth", "a rest of "},
      {"frame-indifference: v_smooth", "in axes of the host"},
      {"frame-turned: v_smooth", "with the whole model turned"},
      {"isotropy: v_smooth", "turned about the normal"},
      {"mirror: v_smooth", "in a mirror"},
      {"units: v_smooth", "in other units"},
      {"setup-unserved: spins", "create accepted dimension "},
      {"call-refused: spins", "given spin_free null, returned 0"},
      {"array-numbers: spins", "given spin "},
      {"balance-inputs: spins", "without spin_previous, "},
      {"floats-rounded: moment", "in floats moment["},
      {"outputs-written: moment", "the array moment was not written"},
      {"outputs-written: spin", "the array spin was not written"},
      {"bad-input-node: moment", ", moment 1"},
      {"bad-input-node: spin", ": spin 0"},
      {"bad-input-definite: spins", "code 0"},
      {"impulse-finite: moment", "moment "},
      {"skip-fresh: moment", "out of reach, moment "},
      {"friction-pressure: moment", "moment ("},
      {"status-meaning: moment", "ILAW_FREE with the moment "},
      {"velocity-output: moment", "velocity["},
      {"velocity-output: spin", "spin["},
      {"step-limits: moment", "moment inf"},
      {"energy-made: moment", ": energy was made"},
      {"energy-balance: moment", "a rest of "},
      {"frame-indifference: moment", "in axes of the host"},
      {"frame-turned: moment", "with the whole model turned"},
      {"isotropy: moment", "turned about the normal"},
      {"mirror: moment", "in a mirror"},
      {"units: moment", "in other units"}};
  for (const auto& [breaks, words] : ways) {
    const std::string rule = std::string(breaks).substr(0, std::string(breaks).find(':'));
    const Checked checked = check_sample(breaks, only({rule}));
    EXPECT_EQ(broken(checked), Names{rule}) << breaks;
    const std::string& seen = checked.outcomes.at(0).finding.seen;
    EXPECT_NE(seen.find(words), std::string::npos) << breaks << ": " << seen;
  }
}

// Whatever ends a process: the words, and nothing but this one rule.
TEST(Ending, OfTheProcessIsAFinding) {
  const std::map<std::string, std::string> words = {
      {"functions-return", "evaluate was ended by SIGSEGV, writing where nothing of the batch is"},
      {"hang", "evaluate did not return within 0.2 s"},
      {"pause", "evaluate did not return within 0.2 s"},
      {"poll", "evaluate did not return within 0.2 s"},
      {"exit", "evaluate ended the process with exit code 3"},
      {"quiet exit", "evaluate ended the process with exit code 0"},
      {"abort", "evaluate was ended by SIGABRT"},
      {"kill", "evaluate was ended by signal 9"},
      {"throw", "evaluate threw an exception"},
      {"memory bomb", "evaluate was ended by SIGSEGV"},
  };
  for (const auto& [breaks, expected] : words) {
    Options options = only({"functions-return", "purity-twice"});
    options.limits.seconds = breaks == "hang" || breaks == "pause" || breaks == "poll" ? seconds : 30.0;
    options.limits.megabytes = 64;
    const Checked checked = check_sample(breaks, options);
    EXPECT_EQ(broken(checked), Names{"functions-return"}) << breaks;
    ASSERT_EQ(checked.outcomes.size(), 2U) << breaks;
    EXPECT_EQ(checked.outcomes[0].finding.seen.substr(0, expected.size()), expected) << breaks;
    EXPECT_FALSE(checked.outcomes[0].finding.setting.empty()) << breaks;
    EXPECT_EQ(checked.outcomes[1].why, "needs functions-return") << breaks;
    EXPECT_NE(text_of(checked).find("not judged, sample: needs functions-return: "), std::string::npos);
  }
}

// A library can write over what its process leaves for the checker, whose stack must not depend on it.
TEST(Ending, WithAnUnreadableResultIsAFinding) {
  constexpr std::size_t most = 1U << 18;
  std::string objects;  // {"": {"": ...
  while (objects.size() < most) objects += "\xa1\x60";
  std::string other_types, whole;
  nlohmann::json::to_cbor({{"finding", 3}, {"why", 4}}, other_types);
  nlohmann::json::to_cbor({{"finding", nullptr}, {"reach", {1, 2}}}, whole);
  for (const std::string& result :
       {std::string(most, '\x81'), objects, std::string(), std::string(most, '\0'), other_types,
        whole.substr(0, whole.size() - 1), std::string("\x5b\xff\xff\xff\xff\xff\xff\xff\xff")}) {
    Ending ending;
    ending.returned = true;
    ending.result = result;
    const Outcome outcome = outcome_of("sample", "purity-twice", ending);
    EXPECT_EQ(outcome.verdict, Verdict::broken);
    EXPECT_EQ(outcome.finding.seen, "the library wrote over the result of the check");
  }
}

// A machine that is busy lets a law wait, as naps do: that breaks no rule.
TEST(Limit, IsOfTheProcessorAndNotOfTheClock) {
  Options options = only({"purity-twice"});
  options.limits.seconds = 0.5;
  options.seeds = {1};
  const Outcome outcome = check_sample("naps", options).outcomes.at(0);
  EXPECT_EQ(outcome.verdict, Verdict::passed) << outcome.finding.seen << outcome.why;
  EXPECT_GT(outcome.seconds, 2.0 * options.limits.seconds);
}

TEST(Limit, LeavesASlowLawUnjudged) {
  Options options = only({"purity-twice"});
  options.limits.seconds = 0.3;
  options.seeds = {1};
  const Checked checked = check_sample("slow", options);
  EXPECT_EQ(checked.outcomes.at(0).verdict, Verdict::not_judged) << text_of(checked);
  EXPECT_NE(text_of(checked).find("sample: took longer than the limit of time: purity-twice"),
            std::string::npos)
      << text_of(checked);
}

TEST(Finding, IsTheSameAgain) {
  Options options = only({"mirror"});
  const std::string first = text_of(check_sample("mirror", options));
  EXPECT_EQ(text_of(check_sample("mirror", options)), first);
  options.seeds = {2};
  EXPECT_NE(text_of(check_sample("mirror", options)), first);
  for (const char* part : {"seen:    in a mirror", "allowed: ", "with:    dimension 2", "v_free = ",
                           "repeat:  ilaw check " ILAW_SAMPLE " --law sample --only mirror --seed 1"})
    EXPECT_NE(first.find(part), std::string::npos) << part << " is not in\n" << first;
}

TEST(Finding, NamesValuesPerNode) {
  const Checked checked = check_sample("batch-order: pack", only({"batch-order"}));
  const std::string& setting = checked.outcomes.at(0).finding.setting;
  EXPECT_NE(setting.find("damping per node"), std::string::npos) << setting;
}

// A dashpot has no answer to the gap: the eigenvalues are 1 and their product.
TEST(Finding, HasSumAndProductOfEigenvalues) {
  const Checked checked = check_sample("stable-step-bound", only({"stable-step-bound"}));
  const std::string& seen = checked.outcomes.at(0).finding.seen;
  double sum = 0.0, product = 0.0;
  const char* begin = std::strstr(seen.c_str(), "eigenvalues of sum ");
  ASSERT_TRUE(begin && std::sscanf(begin, "eigenvalues of sum %lf and product %lf", &sum, &product) == 2)
      << seen;
  EXPECT_LT(product, -1.0);
  EXPECT_NEAR(sum, 1.0 + product, 1e-6);
}

// Rules that move nodes are judged with each seed, others with the first.
TEST(Seeds, AreTriedByRulesOfMotion) {
  Options options = only({"mirror", "purity-twice"});
  const auto steps_of = [&](const std::vector<std::uint64_t>& seeds) {
    options.seeds = seeds;
    std::map<std::string, std::size_t> steps;
    for (const Outcome& outcome : check_sample("", options).outcomes)
      steps[outcome.rule] = outcome.reach.steps;
    return steps;
  };
  const auto one = steps_of({1}), two = steps_of({2}), both = steps_of({1, 2});
  EXPECT_EQ(both.at("mirror"), one.at("mirror") + two.at("mirror"));
  EXPECT_EQ(both.at("purity-twice"), one.at("purity-twice") + two.at("purity-twice"));
}

// No float is a tenth.
TEST(Parameters, MayHaveADefaultThatNoFloatIs) {
  const Checked checked = check_sample("a default of .1", only({"per-node-constant", "parameter-default"}));
  EXPECT_TRUE(checked.all_passed()) << text_of(checked);
}

// Depends on what was called before, at one node in 10^5.
TEST(Fuzz, FindsAndShrinksARareFault) {
  Options options = only({"purity-twice", "batch-order", "frame-turned"});
  EXPECT_TRUE(check_sample("rare memory", options).all_passed());
  options.only = {"purity-twice"};
  options.fuzz_minutes = 1.0;
  const Checked found = check_sample("rare memory", options);
  ASSERT_EQ(broken(found), Names{"purity-twice"});
  const Outcome& outcome = found.outcomes.at(0);
  EXPECT_GT(outcome.seed, 3U);
  EXPECT_EQ(outcome.part.nodes.size(), 1U);
  EXPECT_EQ(outcome.part.steps.size(), 1U);
  EXPECT_EQ(outcome.finding.arrays.back().name, "state_in");
  options.fuzz_minutes = 0.0;
  options.seeds = {outcome.seed};
  options.part = outcome.part;
  const Checked again = check_sample("rare memory", options);
  EXPECT_EQ(again.outcomes.at(0).finding.seen, outcome.finding.seen);
  EXPECT_NE(text_of(again).find(" --nodes " + std::to_string(outcome.part.nodes[0])), std::string::npos);
}

TEST(Parameters, ReplaceTheDrawnOnes) {
  Options options = only({"mirror"});
  options.parameters = Values{{"damping", ILAW_KIND_VALUE_NUMBER, 0.75}};
  const Checked checked = check_sample("mirror", options);
  ASSERT_EQ(broken(checked), Names{"mirror"});
  EXPECT_NE(checked.outcomes[0].finding.setting.find("; damping = 0.75"), std::string::npos)
      << checked.outcomes[0].finding.setting;
  options.parameters = Values{{"damping", ILAW_KIND_VALUE_NUMBER, -1.0}};
  EXPECT_THROW(check_sample("", options), UsageError);
}

TEST(Report, IsJson) {
  const Checked checked = check_sample("bad-input-node", only({"bad-input-node", "mirror"}));
  const nlohmann::json all = nlohmann::json::parse(json_of(checked));
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].at("rule"), "bad-input-node");
  EXPECT_EQ(all[0].at("result"), "broken");
  EXPECT_EQ(all[0].at("arrays").at("v_free").at(0), "nan");
  EXPECT_EQ(all[1].at("result"), "passed");
}

TEST(Report, IsJUnit) {
  const Checked checked = check_sample("mirror", only({"mirror", "units", "stable-step"}));
  tinyxml2::XMLDocument document;
  ASSERT_EQ(document.Parse(junit_of(checked).c_str()), tinyxml2::XML_SUCCESS);
  const tinyxml2::XMLElement* suite = document.RootElement();
  EXPECT_EQ(suite->IntAttribute("tests"), 3);
  EXPECT_EQ(suite->IntAttribute("failures"), 1);
  EXPECT_NE(suite->FirstChildElement("testcase"), nullptr);
}

TEST(Usage, ThatIsWrongIsSaid) {
  const auto refusal = [](const std::string& file, const Options& options) -> std::string {
    try {
      check(file, options);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(refusal("/nowhere/law.so", {}).find("no such file"), std::string::npos);
  EXPECT_EQ(refusal(ILAW_SAMPLE, only({"nonsense"})),
            "found rule 'nonsense', expected one that `ilaw check --rules` lists");
  Options other;
  other.law = "other";
  EXPECT_NE(refusal(ILAW_SAMPLE, other).find("found law 'other'"), std::string::npos);
}

// Laws of the tree with one mistake each that people make (wrong_laws.cmake), and a rule that finds it with
// the default seeds.
class WrongLaw : public ::testing::TestWithParam<std::pair<const char*, const char*>> {};

TEST_P(WrongLaw, IsFound) {
  const auto& [name, rule] = GetParam();
  const std::string file = std::string(ILAW_WRONG_LAWS) + "/" + name + ".so";
  const Options options = only({rule});
  EXPECT_EQ(broken({file, options.seeds, check(file, options)}), Names{rule});
}

INSTANTIATE_TEST_SUITE_P(
    Laws, WrongLaw,
    ::testing::Values(std::pair{"cohesive_transverse", "form-agreement"},
                      std::pair{"cohesive_asks", "batch-order"}, std::pair{"rccm_step", "units"},
                      std::pair{"rolling_turned", "isotropy"}, std::pair{"rolling_work", "energy-balance"},
                      std::pair{"rolling_velocity", "velocity-output"},
                      std::pair{"postit_unturned", "frame-turned"}, std::pair{"rccm_force", "energy-made"},
                      std::pair{"table_friction_turned", "energy-made"}, std::pair{"tie_area", "units"},
                      std::pair{"tie_unit", "units"}),
    [](const auto& drawn) { return std::string(drawn.param.first); });

std::vector<std::string> laws() {
  std::vector<std::string> names;
  std::stringstream list(ILAW_LAW_NAMES);
  for (std::string name; list >> name;) names.push_back(name);
  return names;
}

class Shipped : public ::testing::TestWithParam<std::string> {};

// By one level of instructions, the next law by the next one. .ci/night has all levels, with drawn motions.
TEST_P(Shipped, KeepsEveryRule) {
  static const char* const levels[] = {"v4", "v3", "baseline"};
  const std::vector<std::string> all = laws();
  const std::size_t own = std::find(all.begin(), all.end(), GetParam()) - all.begin();
  const std::string file = std::string(ILAW_PLUGIN_FOLDER) + "/" + GetParam() + ".so";
  Options options = only({});
  options.seeds = {own % 3 + 1};
  setenv("ILAW_ISA", levels[own % 3], 1);
  const Checked checked{file, options.seeds, check(file, options)};
  unsetenv("ILAW_ISA");
  EXPECT_EQ(broken(checked), Names()) << levels[own % 3] << ": " << text_of(checked);
}

INSTANTIATE_TEST_SUITE_P(Laws, Shipped, ::testing::ValuesIn(laws()), name_of);

}  // namespace
}  // namespace ilaw::check
