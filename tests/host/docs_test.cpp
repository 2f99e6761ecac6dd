// Every scene of the host derives its result in its text; the page of a law names its scenes.
#include "support/matchers.hpp"
#include "support/scene_files.hpp"

#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>

namespace {

using namespace ilaw::testing::matchers;
const std::filesystem::path root = ILAW_SOURCE;

std::string text_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

TEST(SceneFiles, DeriveTheirResultByHand) {
  static const std::regex doc("\"doc\": \"([^\"]{60,})\"");
  int scenes = 0;
  for (const std::filesystem::path& file : scene_files::of_host()) {
    ++scenes;
    EXPECT_TRUE(std::regex_search(text_of(file), doc))
        << file << " has no `doc` that says what must come out";
  }
  EXPECT_GT(scenes, 10);
}

TEST(LawPages, NameTheScenesOfTheirFolders) {
  int scenes = 0;
  for (const std::filesystem::path& file : scene_files::of_laws()) {
    ++scenes;
    const std::filesystem::path folder = file.parent_path();
    const std::string text = text_of(folder / (folder.filename().string() + ".md"));
    EXPECT_THAT(text, HasSubstr(file.filename().string())) << file;
  }
  EXPECT_GT(scenes, 5);
}

}  // namespace
