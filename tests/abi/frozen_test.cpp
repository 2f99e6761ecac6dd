// Minor versions only append: every line of a struct in a frozen header is there today, in the same order,
// before any new one.
#include <ilaw/ilaw.h>

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

// Members of each struct, and values of each enumerator, comments and spaces left out.
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
    ASSERT_GE(frozen.size(), 60U) << "structs and enumerators of " << folder.path();
    for (const auto& [name, members] : frozen) {
      ASSERT_TRUE(today.count(name)) << name << " is gone";
      const Members& now = today.at(name);
      ASSERT_GE(now.size(), members.size()) << name;
      for (std::size_t k = 0; k < members.size(); ++k) EXPECT_EQ(now[k], members[k]) << name;
    }
  }
  EXPECT_GE(versions, 1);
}

// No padding hides between members: a member put there would change nothing that a size check sees.
TEST(Abi, StructsHaveNoPadding) {
  EXPECT_EQ(sizeof(ilaw_parameter), 2 * 4 + 4 * 8 + 3 * 8 + 4 * 4 + 8 + 2 * 4);
  EXPECT_EQ(sizeof(ilaw_state_variable), 2 * 4 + 3 * 8 + 8 + 2 * 4);
  EXPECT_EQ(sizeof(ilaw_argument), 2 * 4 + 5 * 8);
  EXPECT_EQ(sizeof(ilaw_setup), 4 * 4 + 8 + 8 + 2 * 4);
  EXPECT_EQ(sizeof(ilaw_instance_info), 4 * 4 + 8 + 2 * 8 + 4 * 4);
  EXPECT_EQ(sizeof(ilaw_batch), 2 * 4 + 4 * 8 + 3 * 8 + 8 * 24 + 8 + 5 * 24 + 2 * 8);
  EXPECT_EQ(sizeof(ilaw_report), 2 * 4 + 4 * 8);
  EXPECT_EQ(sizeof(ilaw_law), 6 * 4 + 6 * 8 + 4 * 4 + 6 * 8);
  EXPECT_EQ(sizeof(ilaw_plugin), 4 + 2 * 2 + 5 * 8 + 2 * 4 + 8);
}

}  // namespace
