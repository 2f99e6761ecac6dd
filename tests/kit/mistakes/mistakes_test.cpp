// Mistakes of law authors, each a law of its own: the compiler names it, and says in one line what to write.
#include "support/program.hpp"

#include <cstdio>
#include <fstream>
#include <map>
#include <regex>
#include <string>
#include <vector>

namespace {

using Messages = std::map<std::string, std::string>;  // by law

struct Law {
  std::string name, message;
  int line;  // where it begins
};

// "// message" above "WRONG(law)" or above "struct law {".
std::vector<Law> laws_of(const std::string& file) {
  std::ifstream source(file);
  std::vector<Law> laws;
  const std::regex law("WRONG\\((\\w+)\\)|struct (\\w+) \\{");
  std::smatch found;
  std::string message;
  int number = 1;
  for (std::string line; std::getline(source, line); ++number) {
    if (line.starts_with("// ")) {
      message = line.substr(std::string("// ").size());
    } else if (std::regex_match(line, found, law) && !message.empty()) {
      laws.push_back({found[1].str() + found[2].str(), message, number});
      message.clear();
    } else if (line.empty()) {
      message.clear();
    }
  }
  return laws;
}

std::string file_of(const std::string& name) { return std::string(ILAW_MISTAKES) + "/" + name; }

std::vector<std::string> compiler_says(const std::string& file) {
  const std::string command =
      "LC_ALL=C " ILAW_CXX
      " -std=c++20 -Wall -Wextra -Wno-psabi -ftemplate-backtrace-limit=0 -I " ILAW_INCLUDE " " +
      std::string(file.ends_with("wrong_status.cpp") ? "-c -o /dev/null " : "-fsyntax-only ") + file;
  std::istringstream answer(ilaw::testing::programs::run_command(command).output);
  std::vector<std::string> lines;
  for (std::string line; std::getline(answer, line);) lines.push_back(line);
  return lines;
}

// The law in whose lines an error stands, or whose name is in the lines before it that say where it comes
// from.
std::string law_of(const std::vector<Law>& laws, int line, const std::string& origin) {
  std::string name;
  for (const Law& law : laws)
    if (line > 0 ? law.line <= line : std::regex_search(origin, std::regex("\\b" + law.name + "\\b")))
      name = law.name;
  return name;
}

// The first of each law, in quotes of ASCII.
Messages messages_of(const std::string& file, const std::vector<Law>& laws) {
  Messages messages;
  std::string origin, name = "no law";  // errors of one origin follow each other
  const std::regex error("^(.*):(\\d+):\\d+: error: (static assertion failed: )?(.*?)( \\[-Werror=.*)?$"),
      level("::(baseline|v3|v4)::");
  std::smatch found;
  for (const std::string& line : compiler_says(file)) {
    if (std::regex_match(line, found, error)) {
      const int number = found[1] == file ? std::stoi(found[2]) : 0;
      if (number > 0 || !origin.empty()) name = law_of(laws, number, origin);
      messages.try_emplace(name, std::regex_replace(found[4].str(), level, "::"));
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
  const std::vector<Law> laws = laws_of(file);
  EXPECT_FALSE(laws.empty());
  Messages found = messages_of(file, laws);
  EXPECT_EQ(found.size(), laws.size());
  EXPECT_EQ(found["no law"], "");
  for (const Law& law : laws) EXPECT_EQ(found[law.name], law.message) << law.name;
}

TEST(RightLaw, GoesWithHeadersOfTheStandard) {
  EXPECT_EQ(compiler_says(file_of("right_law.cpp")), std::vector<std::string>{});
}

INSTANTIATE_TEST_SUITE_P(Of, Mistakes,
                         ::testing::Values("wrong_laws.cpp", "wrong_steps.cpp", "wrong_status.cpp"),
                         [](const auto& file) {
                           const std::string name = file.param;
                           return name.substr(0, name.find('.'));
                         });

}  // namespace
