// Every page of the tree can be read and followed: lines of prose are short, and links lead somewhere.
// SPDX-License-Identifier: BSD-3-Clause
#include "support/matchers.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {

using namespace ilaw::testing::matchers;
using std::filesystem::path;

const path root = ILAW_SOURCE;
constexpr int longest_line = 100;

// All of the tree but what is built or hidden.
std::vector<path> pages() {
  std::vector<path> found{root / "README.md"};
  for (const char* folder : {"api", "docs", "host_mock", "plugins", "tests"})
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root / folder))
      if (entry.path().extension() == ".md") found.push_back(entry.path());
  std::sort(found.begin(), found.end());
  return found;
}

struct Line {
  int number;
  std::string text;
};

bool begins(const std::string& text, const char* with) { return text.rfind(with, 0) == 0; }

// The lines of a page that people read: without code and without formulas that stand alone.
std::vector<Line> prose(const path& page) {
  std::vector<Line> lines;
  std::ifstream file(page);
  EXPECT_TRUE(file) << page;
  bool in_code = false, in_formula = false;
  int number = 0;
  for (std::string text; std::getline(file, text);) {
    ++number;
    const std::string start = text.substr(std::min(text.find_first_not_of(' '), text.size()));
    if (begins(start, "```")) {
      in_code = !in_code;
      continue;
    }
    if (in_code || begins(text, "    ")) continue;
    if (begins(start, "$$")) {
      const bool ends = start.size() > 2 && start.find("$$", 2) != std::string::npos;
      in_formula = !in_formula && !ends;
      continue;
    }
    if (in_formula) {
      in_formula = text.size() < 2 || text.substr(text.size() - 2) != "$$";
      continue;
    }
    lines.push_back({number, text});
  }
  return lines;
}

// Characters, not bytes: continuation bytes of UTF-8 do not count.
int characters(const std::string& text) {
  return static_cast<int>(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

// Formulas and code within a line cannot be broken: each counts as one word.
std::string with_units_joined(const std::string& text) {
  static const std::regex unit("\\$[^$]*\\$|`[^`]*`");
  std::string joined;
  auto rest = text.cbegin();
  for (std::sregex_iterator found(text.begin(), text.end(), unit), end; found != end; ++found) {
    joined.append(rest, (*found)[0].first);
    joined.append(static_cast<std::size_t>(found->length()), 'x');
    rest = (*found)[0].second;
  }
  return joined.append(rest, text.cend());
}

// A line that is one word, a long link or formula, cannot be shorter. Rows of tables are lines by nature.
bool is_too_long(const std::string& text) {
  if (characters(text) <= longest_line || begins(text, "|")) return false;
  static const std::regex mark("^ *([-*] |[0-9]+\\. |#+ |> )?");
  return std::regex_replace(with_units_joined(text), mark, "").find(' ') != std::string::npos;
}

TEST(Pages, LinesOfProseAreShort) {
  ASSERT_GT(pages().size(), 10U);
  for (const path& page : pages()) {
    std::string first;
    int count = 0;
    for (const Line& line : prose(page))
      if (is_too_long(line.text) && count++ == 0)
        first = "line " + std::to_string(line.number) + ": " + line.text;
    EXPECT_EQ(count, 0) << page.lexically_relative(root) << ": lines of more than " << longest_line
                        << " characters, the first is " << first;
  }
}

// The name of a heading in links: lower case, spaces as hyphens, nothing else but letters, digits, _ and -.
std::string anchor(const std::string& heading) {
  std::string name;
  for (const char c : heading.substr(heading.find_first_not_of("# ")))
    if (c == ' ')
      name += '-';
    else if (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-')
      name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return name;
}

bool has_anchor(const path& page, const std::string& name) {
  const std::vector<Line> lines = prose(page);
  return std::any_of(lines.begin(), lines.end(),
                     [&](const Line& line) { return begins(line.text, "#") && anchor(line.text) == name; });
}

// Whether a link of a page leads to a file or folder of the tree, and to a heading where it names one. Other
// places are not visited.
bool leads_somewhere(const path& page, const std::string& target) {
  if (target.find("://") != std::string::npos || begins(target, "mailto:")) return true;
  const auto hash = target.find('#');
  const std::string file = target.substr(0, hash);
  const path to = file.empty() ? page : page.parent_path() / file;
  if (!std::filesystem::exists(to)) return false;
  return hash == std::string::npos || to.extension() != ".md" || has_anchor(to, target.substr(hash + 1));
}

TEST(Pages, LinksLeadSomewhere) {
  static const std::regex link("\\]\\(([^)]*)\\)"), code("`[^`]*`|\\$[^$]*\\$");
  int links = 0;
  for (const path& page : pages())
    for (const Line& line : prose(page)) {
      const std::string text = std::regex_replace(line.text, code, "code");
      for (std::sregex_iterator found(text.begin(), text.end(), link), end; found != end; ++found, ++links)
        EXPECT_TRUE(leads_somewhere(page, (*found)[1]))
            << page.lexically_relative(root) << ", line " << line.number << ": " << (*found)[1]
            << " does not exist";
    }
  EXPECT_GT(links, 50);
}

// Sources by their paths, with '/' before them.
std::vector<std::string> sources() {
  std::vector<std::string> found;
  for (const char* folder : {"api", "docs", "host_mock", "plugins", "tests"})
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root / folder))
      if (entry.is_regular_file())
        found.push_back('/' + entry.path().lexically_relative(root).generic_string());
  return found;
}

// The pages that lead through the tree name files by the end of their paths, or by all of it.
TEST(Pages, FilesThatTheMapNamesExist) {
  static const std::regex file("`([A-Za-z0-9_/]+\\.(cpp|hpp|h|f90|sh|md))`");
  const std::vector<std::string> all = sources();
  int named = 0;
  for (const char* page : {"docs/architecture.md", "docs/contributing.md"})
    for (const Line& line : prose(root / page))
      for (std::sregex_iterator found(line.text.begin(), line.text.end(), file), end; found != end;
           ++found, ++named) {
        const std::string name = '/' + (*found)[1].str();
        EXPECT_TRUE(std::any_of(all.begin(), all.end(),
                                [&](const std::string& source) {
                                  return source.size() >= name.size() &&
                                         source.compare(source.size() - name.size(), name.size(), name) == 0;
                                }))
            << page << ", line " << line.number << ": no file is called " << name.substr(1);
      }
  EXPECT_GT(named, 30);
}

TEST(Pages, ContributingNamesEveryBuildMode) {
  const auto text_of = [](const path& file) {
    std::ostringstream text;
    text << std::ifstream(root / file).rdbuf();
    return text.str();
  };
  const std::string page = text_of("docs/contributing.md"), presets = text_of("CMakePresets.json");
  static const std::regex preset("\"name\": \"(\\w+)\"");
  int modes = 0;
  for (std::sregex_iterator found(presets.begin(), presets.end(), preset), end; found != end;
       ++found, ++modes)
    EXPECT_THAT(page, HasSubstr("| `" + (*found)[1].str() + "` |"))
        << "the build modes of docs/contributing.md leave out " << (*found)[1];
  EXPECT_GT(modes, 4);
}

// All tests: of GoogleTest by suite and name, of ctest by their names up to a variable.
std::set<std::string> names_of_tests() {
  static const std::regex in_source("TEST(?:_P|_F)?\\((\\w+),\\s*(\\w+)\\)"),
      in_build_file("add_test\\(NAME ([\\w.]*\\w)");
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root / "tests")) {
    const bool is_source = entry.path().extension() == ".cpp";
    if (!is_source && entry.path().filename() != "CMakeLists.txt") continue;
    std::ostringstream stream;
    stream << std::ifstream(entry.path()).rdbuf();
    const std::string text = stream.str();
    for (std::sregex_iterator found(text.begin(), text.end(), is_source ? in_source : in_build_file), end;
         found != end; ++found)
      names.insert(is_source ? (*found)[1].str() + '.' + (*found)[2].str() : (*found)[1].str());
  }
  return names;
}

// promises.txt has a promise of the ABI in each line, and the tests that hold it after the last ": "; words
// in brackets are remarks.
TEST(Pages, TestsThatHoldThePromisesExist) {
  const std::set<std::string> tests = names_of_tests();
  std::ifstream promises(root / "tests/abi/promises.txt");
  static const std::regex remark("\\([^)]*\\)");
  int named = 0;
  for (std::string line; std::getline(promises, line);) {
    if (begins(line, "#")) continue;
    std::istringstream names(std::regex_replace(line.substr(line.rfind(": ") + 2), remark, ""));
    for (std::string name; names >> name; ++named) EXPECT_TRUE(tests.count(name)) << "no test " << name;
  }
  EXPECT_GT(named, 60);
}

// The two tests at the top rest on is_too_long.
TEST(Pages, WhatIsTooLong) {
  const std::string word(101, 'a'), words = std::string(60, 'a') + ' ' + std::string(60, 'b');
  EXPECT_TRUE(is_too_long(words));
  EXPECT_TRUE(is_too_long("- " + words));
  EXPECT_FALSE(is_too_long(word));
  EXPECT_FALSE(is_too_long("- " + word));
  EXPECT_FALSE(is_too_long("| " + words + " |"));
  EXPECT_FALSE(is_too_long("$" + words + "$"));
  EXPECT_FALSE(is_too_long(std::string(99, 'a') + "é"));
  EXPECT_EQ(anchor("## Which velocity, which step"), "which-velocity-which-step");
}

}  // namespace
