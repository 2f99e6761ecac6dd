// The pages for hosts against what they quote: the code of docs/hosts stands in the example hosts, and
// docs/abi.md names the enumerators, structs and functions of the headers.
// SPDX-License-Identifier: BSD-3-Clause
#include "support/matchers.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {

using namespace ilaw::testing::matchers;
std::string read(const std::string& path) {
  std::ifstream file(path);
  EXPECT_TRUE(file) << path;
  return {std::istreambuf_iterator<char>(file), {}};
}

// Pages and sources indent differently; in Python that would be another program.
std::string without_indentation(const std::string& text, const std::string& language) {
  if (language == "python") return '\n' + text;
  return std::regex_replace(text, std::regex("(^|\n)[ ]+"), "$1");
}

struct code_block {
  std::string language, text;
};

std::vector<code_block> code_blocks(const std::string& page) {
  static const std::regex fence("```(\\w+)\n([^`]*)```");
  std::vector<code_block> blocks;
  for (std::sregex_iterator found(page.begin(), page.end(), fence), end; found != end; ++found)
    blocks.push_back({(*found)[1], (*found)[2]});
  return blocks;
}

// All pages of docs/hosts, and that of the minimal host, one after the other.
std::string pages_of_hosts() {
  std::string text = read(ILAW_MINIMAL "/README.md");
  for (const auto& page : std::filesystem::directory_iterator(ILAW_DOCS "/hosts")) text += read(page.path());
  return text;
}

TEST(HostsPage, QuotesCodeThatIsBuiltAndRun) {
  const std::map<std::string, std::string> sources{
      {"c", read(ILAW_MINIMAL "/blocks.c") + read(ILAW_MINIMAL "/grains.c") +
                read(ILAW_EXAMPLES "/../device/points.c")},
      {"cpp", read(ILAW_EXAMPLES "/blocks.cpp") + read(ILAW_EXAMPLES "/schemes_test.cpp") +
                  read(ILAW_MINIMAL "/minimal.cpp")},
      {"fortran", read(ILAW_EXAMPLES "/blocks.f90")},
      {"python", read(ILAW_EXAMPLES "/python/blocks.py")}};
  std::set<std::string> languages;
  for (const code_block& block : code_blocks(pages_of_hosts())) {
    ASSERT_TRUE(sources.contains(block.language)) << block.text;
    languages.insert(block.language);
    const std::string& source = sources.at(block.language);
    const auto stripped = [&block](const std::string& t) { return without_indentation(t, block.language); };
    EXPECT_THAT(stripped(source), HasSubstr(stripped(block.text)))
        << "not in the hosts in " << block.language << ":\n"
        << block.text;
  }
  EXPECT_EQ(languages.size(), sources.size());
}

// A reader who copies the excerpts of one language leaves out no call that every host must make.
TEST(HostsPage, QuotesEveryMandatoryCall) {
  const std::map<std::string, std::vector<std::string>> calls{
      {"c",
       {"ilaw_library_open(", "ilaw_interface_create(", "ilaw_interface_info(", "ilaw_interface_initialise(",
        "ilaw_interface_evaluate(", "ilaw_interface_destroy("}},
      {"cpp", {"ilaw::library(", "interface.info(", "interface.initialise(", "interface.evaluate("}},
      {"fortran",
       {"ilaw_open(", "ilaw_create(", "ilaw_interface_info(", "ilaw_interface_initialise(",
        "ilaw_interface_evaluate(", "ilaw_interface_destroy("}},
      {"python", {"ilaw.Interface(", "law.batch(", ".initialise(", ".evaluate("}}};
  std::map<std::string, std::string> quoted;
  for (const code_block& block : code_blocks(pages_of_hosts())) quoted[block.language] += block.text;
  for (const auto& [language, wanted] : calls)
    for (const std::string& call : wanted)
      EXPECT_THAT(quoted[language], HasSubstr(call))
          << "docs/hosts does not show " << call << ") in " << language;
}

std::set<std::string> names(const std::string& text, const char* pattern) {
  const std::regex name(pattern);
  std::set<std::string> found;
  for (std::sregex_iterator match(text.begin(), text.end(), name), end; match != end; ++match)
    found.insert((*match)[1]);
  return found;
}

void expect_named(const std::string& page, const std::set<std::string>& names, std::size_t at_least) {
  EXPECT_GE(names.size(), at_least);
  for (const std::string& name : names)
    EXPECT_NE(page.find('`' + name + '`'), std::string::npos) << "docs/abi.md does not name " << name;
}

// Members stand in the header, each with its comment.
TEST(AbiPage, NamesEveryEnumeratorStructAndFunction) {
  const std::string page = read(ILAW_DOCS "/abi.md");
  const std::string header = read(ILAW_INCLUDE "/ilaw/ilaw.h"), loader = read(ILAW_INCLUDE "/ilaw/loader.h");
  expect_named(page, names(header, "(ILAW_[A-Z0-9_]+) = [-(0-9]"), 54);
  expect_named(page, names(header, "typedef struct (ilaw_\\w+)"), 12);
  expect_named(page, names(loader, "\n[a-z][^\n(]*?(ilaw_\\w+)\\("), 12);
}

}  // namespace
