// `ilaw bench` as a user sees it: what it prints for every law, what it counts, what it refuses. How fast
// anything is depends on the machine, and is not asserted.
#include "host_runner.hpp"
#include "support/law_cases.hpp"

namespace ilaw::host::testing {
namespace {

json measured(const std::string& arguments, const std::string& before = "") {
  const Outcome outcome = run_program("bench " + arguments + " --json --repetitions 1", before);
  EXPECT_EQ(outcome.code, 0) << arguments << ": " << outcome.output;
  return outcome.code == 0 ? json::parse(outcome.output) : json::array();
}

// Empty where a result is one.
std::string complaint_about(const json& result) {
  for (const char* key : {"law", "case", "nodes", "ns_per_node", "bytes_per_node", "triad_gb_per_s", "ratio",
                          "isa", "scalar_share"})
    if (!result.contains(key)) return std::string("no ") + key;
  for (const char* key : {"ns_per_node", "bytes_per_node", "triad_gb_per_s", "ratio"})
    if (!result[key].is_number() || !(result[key] > 0.0)) return std::string(key) + " is not above zero";
  const double expected = result["ns_per_node"].get<double>() * result["triad_gb_per_s"].get<double>() /
                          result["bytes_per_node"].get<double>();
  if (std::abs(result["ratio"].get<double>() - expected) > 1e-9 * expected)
    return "one repetition has a ratio of " + result["ratio"].dump() + ", not " + std::to_string(expected);
  if (result["isa"] != "baseline" && result["isa"] != "v3" && result["isa"] != "v4") return "isa";
  const json& share = result["scalar_share"];
  if (!share.is_number() || share < 0.0 || share > 1.0) return "scalar_share";
  return "";
}

TEST(Bench, MeasuresEveryLawInItsCases) {
  std::string files;
  for (const std::string& law : ilaw::testing::laws_of_tree())
    files += " " ILAW_SOURCE "/tests/laws/" + law + "/cases.json";
  const json results = measured("--cases" + files + " --nodes 100");
  EXPECT_GT(results.size(), ilaw::testing::laws_of_tree().size());
  std::set<std::string> laws;
  for (const json& result : results) {
    EXPECT_EQ(complaint_about(result), "") << result;
    EXPECT_EQ(result["nodes"], 100);
    laws.insert(result["law"]);
  }
  EXPECT_EQ(laws.size(), ilaw::testing::laws_of_tree().size());
}

// Without any option: a law is measured with a plain value of what it requires, and says which.
TEST(Bench, TakesPlainValuesOfParametersThatAreMissing) {
  for (const std::string& law : ilaw::testing::laws_of_tree()) {
    const json results = measured(law + " --nodes 50");
    ASSERT_EQ(results.size(), 1U) << "law " << law;
    EXPECT_EQ(complaint_about(results[0]), "") << results[0];
  }
  const json coulomb = measured("coulomb --nodes 50");
  EXPECT_EQ(coulomb[0]["parameters"], (json{{"friction", 0.3}}));
  EXPECT_EQ(coulomb[0]["case"], "friction=0.3; scalar H local aos");
}

struct Count {
  const char* options;
  double bytes;
};

// By hand, 3D: v_free 24, v_previous 24, gap 8, r 24 and H.
TEST(Bench, CountsTheBytesThatALawMoves) {
  const double rest = 24 + 24 + 8 + 24;
  const Count counts[] = {{"", rest + 8},
                          {"--delassus diagonal", rest + 24},
                          {"--delassus full", rest + 48},
                          {"--layout soa", rest + 8},
                          {"--frame global", rest + 8 + 24},
                          {"--outputs motion", rest + 8 + 24 + 1},
                          {"--outputs all --frame global", rest + 8 + 24 + 24 + 1 + 32},
                          {"--delassus transverse", rest + 16},
                          {"--float", 0.5 * (rest + 8)},
                          {"--float --outputs all --frame global", 0.5 * (rest + 8 + 24 + 24 + 32) + 1}};
  for (const char* law : {"contact", "coulomb"})
    for (const Count& count : counts) {
      const json results = measured(std::string(law) + " --nodes 20 " + count.options);
      ASSERT_EQ(results.size(), 1U);
      EXPECT_EQ(results[0]["bytes_per_node"], count.bytes) << law << " " << count.options;
    }
  // tie reads no gap unless it breaks, and remembers one number, which counts in and out. A parameter per
  // node counts once.
  EXPECT_EQ(measured("tie --nodes 20")[0]["bytes_per_node"], rest - 8 + 8 + 16);
  EXPECT_EQ(measured("tie --nodes 20 --float")[0]["bytes_per_node"], 0.5 * (rest - 8 + 8) + 16);
  const json per_node = measured(R"(coulomb --nodes 20 --parameters '{"friction": {"per_node": 0.3}}')");
  EXPECT_EQ(per_node[0]["bytes_per_node"], rest + 8 + 8);
}

// Packs solve what random contacts ask; a history is written node by node; nothing is told of a law of
// somebody else.
TEST(Bench, TellsHowManyNodesAreSolvedOneByOne) {
  EXPECT_EQ(measured("contact --nodes 200")[0]["scalar_share"], 0.0);
  EXPECT_LT(measured("coulomb --nodes 200 --delassus full")[0]["scalar_share"], 0.05);
  EXPECT_EQ(measured("contact --nodes 200", "ILAW_ISA=baseline ")[0]["isa"], "baseline");
  const json foreign = measured(ILAW_VISCOUS_C " --nodes 200");
  ASSERT_EQ(foreign.size(), 1U);
  EXPECT_EQ(foreign[0]["law"], "viscous");
  EXPECT_TRUE(foreign[0]["isa"].is_null());
  EXPECT_TRUE(foreign[0]["scalar_share"].is_null());
}

TEST(Bench, LeavesATable) {
  const auto folder = fresh_folder();
  const Outcome outcome =
      run_program("bench contact coulomb --nodes 20 30 --repetitions 1 --out " + folder.string());
  EXPECT_EQ(outcome.code, 0) << outcome.output;
  EXPECT_THAT(outcome.output, HasSubstr("coulomb friction=0.3; scalar H local aos"));
  const std::string csv = text_of(folder / "bench.csv");
  EXPECT_EQ(csv.substr(0, csv.find('\n')),
            "law,case,nodes,ns_per_node,bytes_per_node,triad_gb_per_s,ratio,isa,scalar_share");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 5);
}

std::string file_of_cases(const fs::path& folder, const json& entries) {
  std::ofstream(folder / "cases.json") << json{{"benchmarks", entries}};
  return "--cases " + (folder / "cases.json").string();
}

// As on the command line: all laws of the library.
TEST(Bench, TakesThePathOfALibraryInAFileOfCases) {
  const auto folder = fresh_folder();
  for (const json& entry : {json{{"law", ILAW_VISCOUS_C}}, json{{"library", ILAW_VISCOUS_C}},
                            json{{"library", ILAW_VISCOUS_C}, {"law", "viscous"}}}) {
    const json results = measured(file_of_cases(folder, json::array({entry})) + " --nodes 20");
    ASSERT_EQ(results.size(), 1U) << entry;
    EXPECT_EQ(results[0]["law"], "viscous");
    EXPECT_EQ(results[0]["library"], ILAW_VISCOUS_C);
  }
}

// A law would take another one without a word.
TEST(Environment, AnInstructionSetThatNoLawKnowsIsRefused) {
  for (const char* value : {"", "V3", "avx2", "v2", "v5", "v3 "}) {
    EXPECT_THAT(run_program("list", std::string("ILAW_ISA='") + value + "' "),
                Exits(2, std::string("ilaw: ILAW_ISA: found '") + value +
                             "', expected one of baseline, v3, v4, or no such variable\n"))
        << value;
  }
  for (const char* value : {"baseline", "v3", "v4"})
    EXPECT_EQ(run_program("list", std::string("ILAW_ISA=") + value + " ").code, 0) << value;
}

}  // namespace
}  // namespace ilaw::host::testing
