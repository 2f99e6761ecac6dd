// The layers of docs/architecture.md: no include runs up from one floor of the host to another, and hosts and
// laws meet in the ABI alone.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <regex>
#include <string>
#include <string_view>
#include <vector>

namespace {

using std::filesystem::path;

const path root = ILAW_SOURCE;

// From the ground up.
constexpr std::array<std::string_view, 8> floors{"base",  "model",   "contact", "step",
                                                 "scene", "results", "study",   "cli"};

struct Include {
  path file;
  std::string header;
};

std::vector<Include> includes_below(const path& folder) {
  static const std::regex include("^#include [<\"]([^>\"]*)[>\"]");
  std::vector<Include> found;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root / folder)) {
    if (!entry.is_regular_file()) continue;
    std::ifstream file(entry.path());
    std::smatch match;
    for (std::string line; std::getline(file, line);)
      if (std::regex_search(line, match, include))
        found.push_back({entry.path().lexically_relative(root), match[1]});
  }
  EXPECT_FALSE(found.empty()) << folder;
  return found;
}

// The floor of a folder's name; as many as there are floors where it is none.
std::size_t floor_of(const std::string& folder) {
  return static_cast<std::size_t>(std::find(floors.begin(), floors.end(), folder) - floors.begin());
}

TEST(Layers, EveryFolderOfTheHostIsAFloor) {
  std::size_t folders = 0;
  for (const auto& entry : std::filesystem::directory_iterator(root / "host_mock/src"))
    if (entry.is_directory()) {
      ++folders;
      EXPECT_LT(floor_of(entry.path().filename()), floors.size()) << entry.path() << " is no floor";
    } else {
      ADD_FAILURE() << entry.path() << " stands outside the floors";
    }
  EXPECT_EQ(folders, floors.size());
}

TEST(Layers, NoIncludeOfTheHostRunsUp) {
  int checked = 0;
  for (const std::string_view name : floors)
    for (const Include& include : includes_below(path("host_mock/src") / name)) {
      const std::size_t to = floor_of(include.header.substr(0, include.header.find('/')));
      if (to == floors.size()) continue;  // from elsewhere
      ++checked;
      EXPECT_LE(to, floor_of(std::string(name))) << include.file << " includes " << include.header;
    }
  EXPECT_GT(checked, 50);
}

void expect_no_include(const path& folder, const char* forbidden) {
  const std::regex pattern(forbidden);
  for (const Include& include : includes_below(folder))
    EXPECT_FALSE(std::regex_search(include.header, pattern))
        << include.file << " includes " << include.header;
}

TEST(Layers, HostsAndLawsMeetInTheAbiAlone) {
  expect_no_include("host_mock/src", "^ilaw/kit");
  expect_no_include("api/loader", "^ilaw/kit");
  expect_no_include("api/include/ilaw/kit", "^ilaw/loader");
  expect_no_include("plugins", "^ilaw/loader");
}

TEST(Layers, NoLawNamesTheMachineryOfTheKit) { expect_no_include("plugins", "^ilaw/kit/detail"); }

}  // namespace
