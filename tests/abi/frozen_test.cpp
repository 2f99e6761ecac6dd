// Minor versions only append: every line of a struct in a frozen header is there today, in the same order,
// before any new one.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

namespace {

using Members = std::vector<std::string>;

// Members of each struct, values of each enumerator and typedefs, comments and spaces left out.
std::map<std::string, Members> declarations_of(const std::filesystem::path& header) {
  std::ostringstream text;
  text << std::ifstream(header).rdbuf();
  const std::string code = std::regex_replace(text.str(), std::regex(R"(/\*[^*]*\*+([^/*][^*]*\*+)*/)"), "");
  std::map<std::string, Members> structs;
  const std::regex structure(R"(typedef struct (\w+) \{([^}]*)\})"), member(R"(\s*([^;]+);)"),
      spaces(R"(\s+)");
  for (std::sregex_iterator s(code.begin(), code.end(), structure), end; s != end; ++s) {
    const std::string body = (*s)[2];
    for (std::sregex_iterator m(body.begin(), body.end(), member); m != end; ++m)
      structs[(*s)[1]].push_back(std::regex_replace((*m)[1].str(), spaces, " "));
  }
  // Types, of functions too.
  const std::regex type(R"(typedef ([^;{]+);)");
  for (std::sregex_iterator t(code.begin(), code.end(), type); t != std::sregex_iterator(); ++t)
    structs[std::regex_replace((*t)[1].str(), spaces, " ")].emplace_back("typedef");
  const std::regex enumerator(R"((ILAW_\w+) = ([^,}]+)[,}])");
  for (std::sregex_iterator e(code.begin(), code.end(), enumerator), end; e != end; ++e)
    structs[(*e)[1]].push_back(std::regex_replace((*e)[2].str(), spaces, " "));
  return structs;
}

TEST(Abi, FrozenHeadersAreTheBeginningsOfTodays) {
  const auto today = declarations_of(ILAW_HEADER);
  int versions = 0;
  for (const auto& folder : std::filesystem::directory_iterator(ILAW_FROZEN)) {
    ++versions;
    const auto frozen = declarations_of(folder.path() / "ilaw" / "ilaw.h");
    ASSERT_GE(frozen.size(), 95U) << "structs and enumerators of " << folder.path();
    for (const auto& [name, members] : frozen) {
      if (name == "ILAW_ABI_MINOR") continue;
      ASSERT_TRUE(today.count(name)) << name << " is gone";
      const Members& now = today.at(name);
      ASSERT_GE(now.size(), members.size()) << name;
      for (std::size_t k = 0; k < members.size(); ++k) EXPECT_EQ(now[k], members[k]) << name;
    }
  }
  EXPECT_GE(versions, 1);
}

}  // namespace
