// The description of a library in the JSON file beside it: written by ilaw-describe, read without running the
// library's code, compared with what the library says.
// SPDX-License-Identifier: BSD-3-Clause
#include <ilaw/loader.hpp>

#include "support/program.hpp"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

namespace {

using namespace ilaw::testing::matchers;
using namespace ilaw::testing::programs;
namespace fs = std::filesystem;
using nlohmann::json;

// A folder with a library of tests/loader/plugins, and "law.json" beside it where a test writes one.
class DescriptionFile : public testing::Test {
 protected:
  DescriptionFile() { take("good"); }

  void take(const std::string& variant) {
    fs::copy_file(ILAW_TEST_PLUGINS "/" + variant + ".so", library(), fs::copy_options::overwrite_existing);
  }
  std::string library() const { return (folder / "law.so").string(); }
  std::string file() const { return (folder / "law.json").string(); }
  void write(const std::string& text) const { std::ofstream(file(), std::ios::binary) << text; }
  Outcome describe() const { return run_command(ILAW_HOSTS "/ilaw-describe " + library()); }
  json written() {
    EXPECT_THAT(describe(), Exits(0, ""));
    return json::parse(text_of(file()));
  }

  // Messages of reading the description and of opening the library; empty where they do not refuse it.
  template <class Work>
  static std::string refusal_of(const Work& work) {
    try {
      work();
      return "";
    } catch (const ilaw::error& error) {
      EXPECT_EQ(error.code(), ILAW_BAD_LIBRARY);
      return error.what();
    }
  }
  std::string reading() const {
    return refusal_of([&] { ilaw::read_description(library()); });
  }
  std::string opening() const {
    return refusal_of([&] { const ilaw::library opened(library()); });
  }

  const TemporaryFolder made;
  const fs::path& folder = made.path;
};

TEST_F(DescriptionFile, HoldsAllThatTheLibrarySays) {
  const json expected = json::parse(R"({
    "format": "ilaw-description/1", "name": "variant", "version": "0.1", "vendor": "tests",
    "licence": "BSD-3-Clause", "abi": [1, 0],
    "laws": [{"id": "zero", "title": "Nothing", "doc": "Gives no impulse.", "references": [],
      "dimensions": ["1"], "delassus_forms": ["scalar"], "frames": ["local"], "numbers": ["double"],
      "inputs": ["gap"], "outputs": [], "capabilities": [], "permissions": ["skip_fresh"],
      "parameters": [{"name": "strength", "symbol": "s", "unit": "1", "doc": "Nothing.", "kind": "number",
        "minimum": 0.0, "maximum": "inf", "default": 0.5, "flags": ["allows_infinity", "allows_per_node"],
        "choices": [], "axes": ["time", "slip_speed"]}],
      "state_variables": [],
      "amounts": [{"name": "heat", "unit": "J", "doc": "Of friction."}]}]})");
  EXPECT_EQ(written(), expected);
  EXPECT_EQ(opening(), "");
  json with_path = expected;
  with_path["file"] = library();
  EXPECT_EQ(json::parse(ilaw::read_description(library())), with_path);
  EXPECT_EQ(json::parse(ilaw::library(library()).describe()), with_path);
}

// Its constructor ends the process.
TEST_F(DescriptionFile, IsReadWithoutRunningTheLibrary) {
  written();
  take("aborts");
  EXPECT_EXIT(opening(), testing::KilledBySignal(SIGABRT), "");
  EXPECT_EQ(json::parse(ilaw::read_description(library()))["laws"][0]["id"], "zero");
}

TEST_F(DescriptionFile, MayBeMissing) {
  EXPECT_EQ(ilaw::read_description(library()), "");
  EXPECT_EQ(opening(), "");
  const fs::path other = folder / "law.so.1";
  fs::copy_file(library(), other);
  EXPECT_EQ(ilaw::read_description(other.string()), "");
}

TEST_F(DescriptionFile, MayBeAScene) {
  for (const char* scene : {R"({"interfaces": []})", R"({"format": 7})", "[1, 2]", "7"}) {
    write(scene);
    EXPECT_EQ(ilaw::read_description(library()), "") << scene;
    EXPECT_EQ(opening(), "") << scene;
    EXPECT_THAT(describe(), Exits(1, "ilaw-describe: " + file() +
                                         ": the file is there and is no description of a library\n"))
        << scene;
    EXPECT_EQ(text_of(file()), scene);
  }
}

TEST_F(DescriptionFile, MustSayWhatTheLibrarySays) {
  const json good = written();
  const std::string hint = ": remove the file, or write it anew by ilaw-describe " + library();
  const auto opening_with = [&](const char* pointer, const json& value) {
    json changed = good;
    changed[json::json_pointer(pointer)] = value;
    write(changed.dump());
    EXPECT_EQ(reading(), "");
    const std::string text = opening();
    EXPECT_TRUE(text.starts_with(file() + ": ") && text.ends_with(hint)) << text;
    return text.substr(file().size() + 2, text.size() - file().size() - 2 - hint.size());
  };
  EXPECT_EQ(opening_with("/version", "0.2"), "/version is \"0.2\", the library says \"0.1\"");
  EXPECT_EQ(opening_with("/abi/1", 3), "/abi/1 is 3, the library says 0");
  EXPECT_EQ(opening_with("/laws/0/parameters/0/maximum", 2.0),
            "/laws/0/parameters/0/maximum is 2, the library says \"inf\"");
  EXPECT_EQ(opening_with("/laws/0/parameters/0/default", 0.5 + std::numeric_limits<double>::epsilon()),
            "/laws/0/parameters/0/default is 0.5000000000000002, the library says 0.5");
  EXPECT_EQ(opening_with("/laws/0/frames/0", "global"),
            "/laws/0/frames/0 is \"global\", the library says \"local\"");
  EXPECT_EQ(opening_with("/laws/0/permissions", json::array()),
            "/laws/0/permissions is a list of 0, the library says a list of 1");
  EXPECT_EQ(opening_with("/laws/0/title", std::string(100, 'a')),
            "/laws/0/title is \"" + std::string(59, 'a') + "..., the library says \"Nothing\"");
  EXPECT_EQ(opening_with("/laws/0/spins", true), "/laws/0/spins is true, the library says nothing");
}

TEST_F(DescriptionFile, MayTellMoreOfANewerLibrary) {
  take("newer_minor");
  EXPECT_THAT(describe(), Exits(1, HasSubstr("ABI 1.5, expected at most 1.0: use a newer ilaw-describe")));
  json newer = json::parse(ilaw::library(library()).describe());
  newer["laws"][0]["spins"] = true;
  newer["laws"][0]["dimensions"].push_back("4");
  write(newer.dump());
  EXPECT_EQ(opening(), "");
  EXPECT_EQ(reading(), "");
  newer["laws"][0]["dimensions"][0] = "2";
  write(newer.dump());
  EXPECT_THAT(opening(), HasSubstr("/laws/0/dimensions is"));
}

TEST_F(DescriptionFile, IsRefusedWhenDamaged) {
  const std::string whole = written().dump();
  const auto expect_refused = [&](const std::string& text, const std::string& expected) {
    write(text);
    EXPECT_EQ(reading(), file() + ": " + expected);
    EXPECT_EQ(opening(), file() + ": " + expected);
  };
  expect_refused("", "no JSON at byte 1");
  expect_refused("{\"format\": nonsense", "no JSON at byte 13");
  expect_refused(whole.substr(0, whole.size() - 1), "no JSON at byte " + std::to_string(whole.size()));
  expect_refused("{\"name\": \"caf\xe9\"}", "no JSON at byte 15");
  expect_refused("[1e999]", "a number beyond the range of double, expected infinity as \"inf\"");
  expect_refused(std::string(1000000, '['), "nested deeper than 16 levels, expected a description");
  expect_refused(std::string((1 << 20) + 1, ' '), "larger than 1 MiB, expected a description of a library");
  json tricky = json::parse(whole);
  tricky["laws"][0]["title"] = "No\033[2Jthing";
  expect_refused(tricky.dump(), "a text has control characters");
  tricky = json::parse(whole);
  tricky["\033[2J"] = 1;
  expect_refused(tricky.dump(), "a name has control characters");
  fs::remove(file());
  fs::create_directory(file());
  EXPECT_EQ(reading(), file() + ": not a regular file, expected a description of a library");
}

// `ilaw list` reads files whose library nobody has opened.
TEST_F(DescriptionFile, IsRefusedWhenMembersAreMissingOrOfOtherTypes) {
  const json good = written();
  const auto reading_with = [&](const char* pointer, const json& value) {
    json changed = good;
    changed[json::json_pointer(pointer)] = value;
    write(changed.dump());
    return reading().substr(file().size() + 2);
  };
  json without = good;
  without["laws"][0].erase("title");
  write(without.dump());
  EXPECT_EQ(reading(), file() + ": /laws/0/title is missing");
  EXPECT_EQ(reading_with("/laws", 7), "/laws is 7, expected list");
  EXPECT_EQ(reading_with("/laws/0", json()), "/laws/0 is null, expected object");
  EXPECT_EQ(reading_with("/abi", {1}), "/abi has not two numbers");
  EXPECT_EQ(reading_with("/abi", {1, 0, 0}), "/abi has not two numbers");
  EXPECT_EQ(reading_with("/laws/0/frames", {7}), "/laws/0/frames/0 is 7, expected text");
  EXPECT_EQ(reading_with("/laws/0/parameters/0/maximum", "none"),
            "/laws/0/parameters/0/maximum is \"none\", expected number");
  EXPECT_EQ(reading_with("/laws/0/parameters/0/default", true),
            "/laws/0/parameters/0/default is true, expected text or number");
}

TEST_F(DescriptionFile, IsWrittenAnewAfterAChange) {
  json old = written();
  old["version"] = "0.0";
  write(old.dump());
  EXPECT_NE(opening(), "");
  EXPECT_EQ(written()["version"], "0.1");
  EXPECT_EQ(opening(), "");
}

TEST_F(DescriptionFile, IsNotWrittenForABrokenLibrary) {
  written();
  take("null_title");
  EXPECT_THAT(describe(),
              Exits(1, "ilaw-describe: " + library() + ": law 'zero': title is null, expected a text\n"));
  EXPECT_FALSE(fs::exists(file()));
}

TEST_F(DescriptionFile, OfALibraryThatIsNoneIsNotRead) {
  written();
  std::ofstream(library()) << "no library";
  EXPECT_THAT(reading(), HasSubstr("not an ELF file"));
}

TEST_F(DescriptionFile, IsCutAtTheBuffersSize) {
  written();
  char text[8];
  std::size_t length = 0;
  ASSERT_EQ(ilaw_library_read_description(library().c_str(), text, sizeof text, &length, nullptr, 0),
            ILAW_OK);
  EXPECT_EQ(length, ilaw::read_description(library()).size() + 1);
  EXPECT_EQ(std::string(text).size(), 7U);
  EXPECT_EQ(ilaw_library_read_description(library().c_str(), text, sizeof text, nullptr, nullptr, 0),
            ILAW_INVALID_ARGUMENT);
  EXPECT_EQ(ilaw_library_read_description("", text, sizeof text, &length, nullptr, 0), ILAW_INVALID_ARGUMENT);
  EXPECT_EQ(ilaw_library_describe(nullptr, text, sizeof text), 0U);
  EXPECT_STREQ(text, "");
}

}  // namespace
