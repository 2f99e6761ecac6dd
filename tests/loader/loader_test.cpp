// Libraries that the loader finds, refuses and keeps loaded.
#include <ilaw/loader.hpp>

#include "support/program.hpp"

#include <dlfcn.h>
#include <sys/stat.h>

#include <algorithm>
#include <cfenv>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <utility>

namespace {

using namespace ilaw::testing::matchers;
using ilaw::testing::programs::TemporaryFolder;
namespace fs = std::filesystem;

std::string variant(const std::string& name) { return std::string(ILAW_TEST_PLUGINS) + "/" + name + ".so"; }

std::pair<std::int32_t, std::string> refusal_of(const std::string& file) {
  try {
    const ilaw::library library(file);
  } catch (const ilaw::error& error) {
    return {error.code(), error.what()};
  }
  return {ILAW_OK, "not refused"};
}

ilaw_setup setup_1d() {
  ilaw_setup setup{};
  setup.struct_size = sizeof setup;
  setup.dimension = 1;
  setup.delassus_form = ILAW_DELASSUS_SCALAR;
  setup.frame = ILAW_FRAME_LOCAL;
  setup.numbers = ILAW_NUMBERS_DOUBLE;
  return setup;
}

// Other files that are refused: refusals.json.
TEST(Loader, RefusesFilesThatAreNoLibraries) {
  const TemporaryFolder made;
  const fs::path& folder = made.path;
  const std::string pipe = (folder / "pipe.so").string(), huge = (folder / "huge.so").string();
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_THAT(refusal_of(pipe).second, HasSubstr(": not a regular file, expected"));
  std::ofstream(huge) << "\x7f"
                         "ELF";
  fs::resize_file(huge, (std::uintmax_t{1} << 30) + 1);  // without room on the disk
  EXPECT_THAT(refusal_of(huge).second, HasSubstr(": larger than 1 GiB, expected"));
}

TEST(Loader, LoadsALibraryOfANewerMinorVersion) {
  const ilaw::library library(variant("newer_minor"));
  EXPECT_EQ(library.plugin().abi_minor, 5);
  const ilaw::interface law(library, "", setup_1d());
  double r = 7.0;
  ilaw_batch batch{};
  batch.struct_size = sizeof batch;
  batch.node_count = 1;
  batch.impulse = {&r, nullptr, 1, 1};
  EXPECT_EQ(law.evaluate(batch), ILAW_OK);
  EXPECT_EQ(r, 0.0);
}

struct RefusedInfo {
  const char* name;
  std::int32_t code;
  const char* found_and_expected;

  friend void PrintTo(const RefusedInfo& refused, std::ostream* out) { *out << refused.name; }
};

class RefusedInstance : public ::testing::TestWithParam<RefusedInfo> {};

// Also: it does not stay behind. Other mistakes: description_test.cpp.
TEST_P(RefusedInstance, IsNamedAndEnded) {
  const ilaw::library library(variant(GetParam().name));
  const auto* alive = static_cast<const int*>(library.law("zero")->extension("tests.instances/1"));
  ASSERT_NE(alive, nullptr);
  try {
    const ilaw::interface law(library, "zero", setup_1d());
    FAIL() << "not refused";
  } catch (const ilaw::error& error) {
    EXPECT_EQ(error.code(), GetParam().code);
    EXPECT_THAT(std::string(error.what()), HasSubstr(GetParam().found_and_expected)) << error.what();
  }
  EXPECT_EQ(*alive, 0);
}

const RefusedInfo refused_instances[] = {
    {"wrong_state_size", ILAW_BAD_LIBRARY, "state_size is 3, expected the sum of the counts, 0"},
    {"unknown_input", ILAW_UNSUPPORTED, "reads inputs 1048576, expected only the bits of 63"},
    {"refused_info", ILAW_BAD_LIBRARY, "info refuses its own instance"},
    {"rounds_in_create", ILAW_BAD_LIBRARY, "create changed how the processor rounds"},
    {"odd_code", ILAW_BAD_LIBRARY, "create gave no instance, code 57"},
    {"throws_number", ILAW_BAD_LIBRARY, "an exception of a library"},
    {"throws_error", ILAW_BAD_LIBRARY, "a table is missing"},
    {"odd_message", ILAW_INVALID_PARAMETER, "wrong ?[2J?"}};
INSTANTIATE_TEST_SUITE_P(Loader, RefusedInstance, ::testing::ValuesIn(refused_instances),
                         [](const auto& drawn) { return drawn.param.name; });

TEST(Loader, RefusesALibraryThatRoundsOtherwise) {
  const auto [code, text] = refusal_of(variant("rounds_at_load"));
  EXPECT_EQ(code, ILAW_BAD_LIBRARY);
  EXPECT_THAT(text, HasSubstr("loading it changed how the processor rounds"));
  EXPECT_EQ(std::fegetround(), FE_TONEAREST);
}

TEST(Loader, RefusesToChooseAmongSeveralLaws) {
  const ilaw_setup setup = setup_1d();
  ilaw_interface* law = nullptr;
  char message[200] = "";
  const ilaw::library alone(variant("good")), several(variant("two_laws"));
  ASSERT_EQ(ilaw_interface_create(alone.get(), nullptr, &setup, &law, nullptr, 0), ILAW_OK);
  ilaw_interface_destroy(law);
  EXPECT_EQ(ilaw_interface_create(several.get(), nullptr, &setup, &law, message, sizeof message),
            ILAW_NOT_FOUND);
  EXPECT_THAT(std::string(message), HasSubstr("expected one of: zero, one")) << message;
}

// A host of another minor version than the loader: its structs are longer, or as short as 1.0 had them.
TEST(Loader, FillsStructsOfLongerHosts) {
  struct Longer {
    ilaw_instance_info info;
    double appended[2];
  } longer;
  std::memset(&longer, 0xAB, sizeof longer);
  longer.info.struct_size = sizeof longer;
  const ilaw::library library(variant("good"));
  const ilaw_setup setup = setup_1d();
  ilaw_interface* law = nullptr;
  ASSERT_EQ(ilaw_interface_create(library.get(), "zero", &setup, &law, nullptr, 0), ILAW_OK);
  EXPECT_EQ(ilaw_interface_info(law, &longer.info), ILAW_OK);
  EXPECT_EQ(longer.info.struct_size, sizeof longer);
  EXPECT_EQ(longer.info.state_version, 0U);
  EXPECT_EQ(longer.appended[0], 0.0);
  EXPECT_EQ(longer.appended[1], 0.0);
  longer.info.struct_size = 8;
  EXPECT_EQ(ilaw_interface_info(law, &longer.info), ILAW_INVALID_ARGUMENT);
  ilaw_interface_destroy(law);
}

TEST(Loader, RefusesStructsThatNoHostCanHaveFilled) {
  const ilaw::library library(variant("good"));
  ilaw_setup setup = setup_1d();
  ilaw_interface* law = nullptr;
  char message[256];
  setup.struct_size = 12;
  EXPECT_EQ(ilaw_interface_create(library.get(), "zero", &setup, &law, message, sizeof message),
            ILAW_INVALID_ARGUMENT);
  EXPECT_STREQ(message, "setup has struct_size 12, expected at least 48");
  setup = setup_1d();
  ASSERT_EQ(ilaw_interface_create(library.get(), "zero", &setup, &law, nullptr, 0), ILAW_OK);
  ilaw_batch batch{};
  batch.struct_size = sizeof batch;
  ilaw_report report{};
  EXPECT_EQ(ilaw_interface_evaluate(law, &batch, &report), ILAW_INVALID_ARGUMENT);
  EXPECT_EQ(ilaw_interface_initialise(law, &batch, &report), ILAW_INVALID_ARGUMENT);
  EXPECT_EQ(ilaw_interface_evaluate(nullptr, &batch, nullptr), ILAW_INVALID_ARGUMENT);
  ilaw_interface_destroy(law);
}

// Hosts print it.
TEST(Loader, GivesReasonsThatMayBePrinted) {
  const std::string unreadable = "(the library gave a reason that is no readable text)";
  const std::pair<const char*, std::string> cases[] = {
      {"odd_node", "a node that is none"}, {"wild_reason", unreadable}, {"control_reason", unreadable}};
  for (const auto& [name, reason] : cases) {
    const ilaw::library library(variant(name));
    const ilaw_setup setup = setup_1d();
    ilaw_interface* law = nullptr;
    ASSERT_EQ(ilaw_interface_create(library.get(), "zero", &setup, &law, nullptr, 0), ILAW_OK) << name;
    ilaw_batch batch{};
    batch.struct_size = sizeof batch;
    ilaw_report report{};
    report.struct_size = sizeof report;
    EXPECT_EQ(ilaw_interface_evaluate(law, &batch, &report), ILAW_BAD_NODES) << name;
    EXPECT_EQ(report.reason, reason) << name;
    EXPECT_EQ(ilaw_interface_initialise(law, &batch, nullptr), ILAW_BAD_NODES) << name;
    ilaw_interface_destroy(law);
  }
}

TEST(Loader, AnswersNullArgumentsWithACode) {
  const ilaw::library library(variant("good"));
  const ilaw_setup setup = setup_1d();
  ilaw_library* opened = library.get();
  ilaw_interface* law = nullptr;
  char message[256] = "before";
  EXPECT_EQ(ilaw_library_open(nullptr, &opened, message, sizeof message), ILAW_INVALID_ARGUMENT);
  EXPECT_EQ(opened, nullptr);
  EXPECT_STREQ(message, "the name of the library, or where to put it, is null or empty");
  EXPECT_EQ(ilaw_library_open("", &opened, nullptr, sizeof message), ILAW_INVALID_ARGUMENT);
  EXPECT_EQ(ilaw_library_open_named("good", nullptr, message, 0), ILAW_INVALID_ARGUMENT);
  EXPECT_EQ(ilaw_interface_create(nullptr, "zero", &setup, &law, message, sizeof message),
            ILAW_INVALID_ARGUMENT);
  EXPECT_STREQ(message, "library, setup or interface is null");
  EXPECT_EQ(ilaw_interface_create(library.get(), "zero", nullptr, &law, nullptr, 0), ILAW_INVALID_ARGUMENT);
  EXPECT_EQ(ilaw_interface_create(library.get(), "zero", &setup, nullptr, nullptr, 0), ILAW_INVALID_ARGUMENT);
  EXPECT_EQ(ilaw_library_plugin(nullptr), nullptr);
  EXPECT_EQ(ilaw_library_path(nullptr), nullptr);
  EXPECT_EQ(ilaw_library_law(nullptr, "zero"), nullptr);
  EXPECT_EQ(ilaw_library_law(library.get(), nullptr), nullptr);
  EXPECT_EQ(ilaw_interface_law(nullptr), nullptr);
  EXPECT_EQ(ilaw_interface_instance(nullptr), nullptr);
  ilaw_instance_info info{};
  info.struct_size = sizeof info;
  EXPECT_EQ(ilaw_interface_info(nullptr, &info), ILAW_INVALID_ARGUMENT);
  EXPECT_EQ(ilaw_interface_initialise(nullptr, nullptr, nullptr), ILAW_INVALID_ARGUMENT);
  ilaw_interface_destroy(nullptr);
  ilaw_library_close(nullptr);
  // The only law of a library needs no name.
  ASSERT_EQ(ilaw_interface_create(library.get(), nullptr, &setup, &law, nullptr, 0), ILAW_OK);
  EXPECT_STREQ(ilaw_interface_law(law)->id, "zero");
  EXPECT_EQ(ilaw_interface_info(law, nullptr), ILAW_INVALID_ARGUMENT);
  ilaw_interface_destroy(law);
}

TEST(Loader, NamesTheLawsOfALibrary) {
  const ilaw::library library(variant("good"));
  EXPECT_NE(library.law("zero"), nullptr);
  EXPECT_EQ(library.law("one"), nullptr);
  try {
    const ilaw::interface law(library, "one", setup_1d());
    FAIL() << "not refused";
  } catch (const ilaw::error& error) {
    EXPECT_EQ(error.code(), ILAW_NOT_FOUND);
    EXPECT_THAT(std::string(error.what()), HasSubstr("no law 'one', expected one of: zero"));
  }
}

// A folder with a copy of the good plugin under a name.
struct FolderWith : TemporaryFolder {
  explicit FolderWith(const std::string& name) { fs::copy_file(variant("good"), path / (name + ".so")); }
};

TEST(Search, FindsNamesInThePathInItsOrder) {
  const FolderWith one("here"), other("here");
  const fs::path &first = one.path, &second = other.path;
  setenv("ILAW_PATH", (first.string() + ":" + second.string()).c_str(), 1);
  EXPECT_EQ(ilaw::library("here").path(), (first / "here.so").string());
  setenv("ILAW_PATH", (second.string() + ":" + first.string()).c_str(), 1);
  EXPECT_EQ(ilaw::library("here").path(), (second / "here.so").string());
  const std::vector<std::string> files = ilaw::search();
  EXPECT_EQ(std::count(files.begin(), files.end(), (second / "here.so").string()), 1);
  EXPECT_EQ(std::count(files.begin(), files.end(), (first / "here.so").string()), 0);
  EXPECT_EQ(ilaw::search_path().substr(0, second.string().size()), second.string());
}

TEST(Search, GoesOnUntilTheVisitorHasSeenEnough) {
  const FolderWith made("here");
  const fs::path& folder = made.path;
  fs::copy_file(variant("good"), folder / "there.so");
  std::ofstream(folder / "so") << "no library by its name";
  setenv("ILAW_PATH", (folder / ".." / "." / folder.filename()).c_str(), 1);
  std::vector<std::string> seen;
  const ilaw_visit_function visit = [](const char* path, void* context) -> std::int32_t {
    static_cast<std::vector<std::string>*>(context)->push_back(path);
    return 7;
  };
  EXPECT_EQ(ilaw_search(visit, &seen), 7);
  EXPECT_EQ(seen, std::vector<std::string>{(folder / "here.so").string()});
  const ilaw_visit_function failing = [](const char*, void* calls) -> std::int32_t {
    ++*static_cast<int*>(calls);
    return -7;
  };
  int calls = 0;
  EXPECT_EQ(ilaw_search(failing, &calls), -7);
  EXPECT_EQ(calls, 1);
  EXPECT_EQ(ilaw_search(nullptr, nullptr), ILAW_INVALID_ARGUMENT);
  EXPECT_EQ(ilaw::search()[1], (folder / "there.so").string());
  char text[8];
  EXPECT_EQ(ilaw_search_path(nullptr, 0), ilaw::search_path().size() + 1);
  EXPECT_EQ(ilaw_search_path(text, sizeof text), ilaw::search_path().size() + 1);
  EXPECT_EQ(text, ilaw::search_path().substr(0, 7));
}

bool loaded(const std::string& file) {
  void* handle = dlopen(file.c_str(), RTLD_NOLOAD | RTLD_LAZY);
  if (handle) dlclose(handle);
  return handle != nullptr;
}

TEST(Lifetime, LibraryStaysLoadedWhileAnInterfaceLives) {
  const FolderWith folder("alive");
  const std::string file = (folder.path / "alive.so").string();
  {
    auto library = std::make_unique<ilaw::library>(file);
    const ilaw::library again(file);
    EXPECT_EQ(again.get(), library->get());
    const ilaw::interface law(*library, "zero", setup_1d());
    library.reset();
    EXPECT_TRUE(loaded(file));
    EXPECT_STREQ(law.law().id, "zero");
  }
  EXPECT_FALSE(loaded(file));
}

}  // namespace
