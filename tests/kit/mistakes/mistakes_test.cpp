// Mistakes of law authors, each a law of its own: the compiler names it, and says in one line what to write.
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <map>
#include <regex>
#include <string>
#include <vector>

namespace {

using Messages = std::map<std::string, std::string>;  // by law

// "// message" above "struct law {", which may have been wrapped.
Messages expected_of(const std::string& file) {
  std::ifstream source(file);
  Messages expected;
  const std::regex law("struct (\\w+) \\{");
  std::smatch found;
  for (std::string above, line; std::getline(source, line);) {
    if (std::regex_match(line, found, law) && !above.empty()) expected[found[1]] = above;
    if (line.starts_with("// "))
      above += (above.empty() ? "" : " ") + line.substr(std::string("// ").size());
    else
      above.clear();
  }
  return expected;
}

std::string file_of(const std::string& name) { return std::string(ILAW_MISTAKES) + "/" + name; }

std::vector<std::string> compiler_says(const std::string& file) {
  const std::string command =
      "LC_ALL=C " ILAW_CXX
      " -std=c++20 -fsyntax-only -Wall -Wextra -fopenmp-simd -ftemplate-backtrace-limit=0 -I " ILAW_INCLUDE
      " " +
      file + " 2>&1";
  std::vector<std::string> lines;
  std::FILE* answer = popen(command.c_str(), "r");
  std::string line;
  for (int c = std::fgetc(answer); c != EOF; c = std::fgetc(answer)) {
    if (c != '\n') {
      line += static_cast<char>(c);
      continue;
    }
    lines.push_back(line);
    line.clear();
  }
  pclose(answer);
  return lines;
}

// The law whose name stands among the lines before an error that tell where it comes from.
std::string law_of(const std::string& origin, const Messages& expected) {
  for (const auto& [law, ignored] : expected)
    if (std::regex_search(origin, std::regex("\\b" + law + "\\b"))) return law;
  return "no law";
}

// The first of each law.
Messages messages_of(const std::string& file, const Messages& expected) {
  Messages messages;
  std::string origin;
  const std::regex error("^.*: error: (static assertion failed: )?(.*)$"), level("::(baseline|v3|v4)::");
  std::smatch found;
  for (const std::string& line : compiler_says(file)) {
    if (std::regex_match(line, found, error)) {
      messages.try_emplace(law_of(origin, expected), std::regex_replace(found[2].str(), level, "::"));
      origin.clear();
    } else if (line.find("required") != std::string::npos || line.find("In ") != std::string::npos) {
      origin += line + "\n";
    }
  }
  return messages;
}

class Mistakes : public ::testing::TestWithParam<const char*> {};

TEST_P(Mistakes, AreNamedByTheCompilerInOneLine) {
  const std::string file = file_of(GetParam());
  const Messages expected = expected_of(file), found = messages_of(file, expected);
  EXPECT_FALSE(expected.empty());
  EXPECT_EQ(found, expected);
}

TEST(RightLaw, GoesWithHeadersOfTheStandard) {
  EXPECT_EQ(compiler_says(file_of("right_law.cpp")), std::vector<std::string>{});
}

INSTANTIATE_TEST_SUITE_P(Of, Mistakes, ::testing::Values("wrong_laws.cpp", "wrong_steps.cpp"),
                         [](const auto& file) {
                           const std::string name = file.param;
                           return name.substr(0, name.find('.'));
                         });

}  // namespace
