// law_cases.hpp - the laws of the tree and the parameters that the tests of all laws give them, found by
// looking: each tests/laws/<law>/cases.json brings its own, in sections named for the tests that read them.
//
//   contract     instruction sets, threads, large batches (kit_test)
//   bad_input    what a node is refused for (kit_test)
//   frame        for laws that remember vectors (turning_test)
//   properties   conditions, energy, units, axes (laws_test; its head explains the further keys)
//   limits       parameters with which the law is another, bit for bit (laws_test)
//   benchmarks   what ilaw bench --cases times (docs/benchmarks.md explains the keys)
//
// A case has "parameters" (numbers, "inf", choices; {} if left out) and, where a law has several, a "name".
// "forms" names those of H that the law serves, where it does not serve all.
#pragma once

#include "law_runner.hpp"

#include <nlohmann/json.hpp>

#include <fstream>

namespace ilaw::testing {

using json = nlohmann::json;

// The tree whose laws are tested: this one, unless a test looks at a copy of it.
inline std::filesystem::path tree_of_laws() {
  const char* other = std::getenv("ILAW_TEST_TREE");
  return other ? other : ILAW_SOURCE;
}

inline Parameters parameters_of(const json& given) {
  Parameters parameters;
  for (const auto& [name, value] : given.items())
    if (value.is_number())
      parameters.numbers[name] = value.get<double>();
    else if (value == "inf")
      parameters.numbers[name] = std::numeric_limits<double>::infinity();
    else
      parameters.texts[name] = value.get<std::string>();
  return parameters;
}

struct LawCase {
  std::string law, name;  // name: letters, digits and underscores, as test names have
  Parameters parameters;
  json more;  // the whole entry

  friend std::ostream& operator<<(std::ostream& out, const LawCase& shown) { return out << shown.name; }
};

inline std::string name_of_case(const ::testing::TestParamInfo<LawCase>& drawn) { return drawn.param.name; }

inline LawCase law_case(const std::string& law, const json& entry) {
  const std::string suffix = entry.value("name", "");
  return {law, suffix.empty() ? law : law + "_" + suffix,
          parameters_of(entry.value("parameters", json::object())), entry};
}

// Names of the folders of plugins/ that hold a law.
inline std::vector<std::string> laws_of_tree() {
  std::vector<std::string> laws;
  for (const auto& entry : std::filesystem::directory_iterator(tree_of_laws() / "plugins")) {
    const std::string law = entry.path().filename().string();
    if (std::filesystem::exists(entry.path() / (law + ".cpp"))) laws.push_back(law);
  }
  std::sort(laws.begin(), laws.end());
  return laws;
}

// A law's cases for a section; empty where it has none.
inline json section_of(const std::string& law, const std::string& section) {
  std::ifstream file(tree_of_laws() / "tests/laws" / law / "cases.json");
  return file ? json::parse(file).value(section, json::array()) : json::array();
}

// The cases that all laws bring for a section.
inline std::vector<LawCase> law_cases(const std::string& section) {
  std::vector<LawCase> cases;
  for (const std::string& law : laws_of_tree())
    for (const json& entry : section_of(law, section)) cases.push_back(law_case(law, entry));
  return cases;
}

inline const char* name_of_form(std::uint32_t form) {
  if (form == ILAW_DELASSUS_TRANSVERSE) return "transverse";
  return form == ILAW_DELASSUS_SCALAR ? "scalar" : form == ILAW_DELASSUS_DIAGONAL ? "diagonal" : "full";
}

// Whether the "forms" of H of a case, all if left out, have this one.
inline bool serves(const LawCase& given, std::uint32_t form) {
  const json forms = given.more.is_object() ? given.more.value("forms", json()) : json();
  return forms.is_null() || std::find(forms.begin(), forms.end(), name_of_form(form)) != forms.end();
}

}  // namespace ilaw::testing
