// Every scene of the host is derived in docs/theory/shipped_scenes.md; the page of a law names its scene.
#include "support/matchers.hpp"
#include "support/scene_files.hpp"

#include <filesystem>
#include <fstream>
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

TEST(ScenesPage, DerivesEverySceneOfTheHost) {
  const std::string text = text_of(root / "docs/theory/shipped_scenes.md");
  int scenes = 0;
  for (const std::filesystem::path& file : scene_files::of_host()) {
    ++scenes;
    EXPECT_THAT(text, HasSubstr("**" + file.stem().string() + "**")) << file;
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
