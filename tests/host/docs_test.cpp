// docs/scenes.md is complete: it names every key and every choice of the schema, and every scene of the host.
// A law's scene is named by the law's page.
#include "support/scene_files.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace {

using nlohmann::json;

const std::filesystem::path root = ILAW_SOURCE;

std::string text_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

std::string page() { return text_of(root / "docs/scenes.md"); }

// The paragraphs and tables of the page: what stands between empty lines.
std::vector<std::string> blocks() {
  std::vector<std::string> found{""};
  std::istringstream lines(page());
  for (std::string line; std::getline(lines, line);)
    if (line.empty())
      found.emplace_back();
    else
      found.back() += line + '\n';
  return found;
}

bool has(const std::string& text, const std::string& word) {
  return text.find('`' + word + '`') != std::string::npos;
}

// Keys of the object that the block leaves out.
std::string missing(const std::string& block, const json& properties) {
  std::string keys;
  for (const auto& [key, ignored] : properties.items())
    if (!has(block, key)) keys += ' ' + key;
  return keys;
}

// Visits what the schema says of every value, with its JSON pointer.
template <class Visit>
void for_each_part(const json& part, const std::string& pointer, Visit visit) {
  if (part.is_object()) visit(part, pointer);
  if (part.is_structured())
    for (const auto& [key, inside] : part.items()) for_each_part(inside, pointer + '/' + key, visit);
}

json schema() { return json::parse(std::ifstream(root / "host_mock/schema/scene.schema.json")); }

// One block of the page names all keys of an object, not several blocks together.
TEST(ScenesPage, NamesEveryKeyOfTheSchema) {
  const std::vector<std::string> all = blocks();
  int objects = 0;
  for_each_part(schema(), "", [&](const json& part, const std::string& pointer) {
    if (!part.contains("properties") || part.value("type", json()) != "object") return;
    ++objects;
    std::string least = missing("", part["properties"]);
    for (const std::string& block : all) {
      const std::string left_out = missing(block, part["properties"]);
      if (left_out.size() < least.size()) least = left_out;
    }
    EXPECT_EQ(least, "") << "no block of docs/scenes.md names these keys of " << pointer;
  });
  EXPECT_GT(objects, 20);
}

TEST(ScenesPage, NamesEveryChoiceOfTheSchema) {
  const std::string text = page();
  int choices = 0;
  for_each_part(schema(), "", [&](const json& part, const std::string& pointer) {
    if (!part.contains("enum")) return;
    for (const json& choice : part["enum"]) {
      ++choices;
      EXPECT_TRUE(has(text, choice.get<std::string>())) << pointer << ": " << choice;
    }
  });
  EXPECT_GT(choices, 15);
}

TEST(ScenesPage, DerivesEverySceneOfTheHost) {
  const std::string text = page();
  int scenes = 0;
  for (const std::filesystem::path& file : scene_files::of_host()) {
    ++scenes;
    EXPECT_NE(text.find("**" + file.stem().string() + "**"), std::string::npos) << file;
  }
  EXPECT_GT(scenes, 10);
}

TEST(LawPages, NameTheScenesOfTheirFolders) {
  int scenes = 0;
  for (const std::filesystem::path& file : scene_files::of_laws()) {
    ++scenes;
    const std::filesystem::path folder = file.parent_path();
    const std::string text = text_of(folder / (folder.filename().string() + ".md"));
    EXPECT_NE(text.find(file.filename().string()), std::string::npos) << file;
  }
  EXPECT_GT(scenes, 5);
}

}  // namespace
