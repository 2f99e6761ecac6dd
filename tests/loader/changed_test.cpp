// Files that changed since a library was opened, by what the user reads of them; where laws may not lie.
// SPDX-License-Identifier: BSD-3-Clause
#include <ilaw/loader.hpp>

#include "replaced_files.hpp"

#include <dlfcn.h>
#include <fcntl.h>

#include <string>

namespace {

using namespace ilaw::testing::matchers;
using namespace ilaw::testing::replaced_files;

class Changed : public testing::Test {
 protected:
  static std::string answer(const fs::path& file) {
    try {
      return ilaw::library(file.string()).law("zero")->title;
    } catch (const ilaw::error& error) {
      EXPECT_EQ(error.code(), ILAW_BAD_LIBRARY);
      return error.what();
    }
  }

  TemporaryFolder folder;
  const fs::path file = folder.path / "law.so";
  const std::string changed = file.string() + ": changed since it was opened: ";
};

// dlclose leaves it loaded, and dlopen would give it again by its path.
TEST_F(Changed, RefusesWhenTheOldOneStaysLoaded) {
  fs::copy_file(ILAW_TEST_PLUGINS "/kept.so", file);
  EXPECT_EQ(answer(file), "Nothing");
  EXPECT_EQ(answer(file), "Nothing");
  install(file, 2);
  EXPECT_THAT(answer(file), StartsWith(changed));
  EXPECT_THAT(answer(file), HasSubstr("as long as this process keeps it loaded"));
}

// A host that does its own dlopen, or another loader: each has its own list.
TEST_F(Changed, RefusesWhenOthersLoadedTheOldOne) {
  install(file, 1);
  void* foreign = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  ASSERT_NE(foreign, nullptr);
  install(file, 2);
  EXPECT_EQ(answer(file), file.string() + ": changed since another part of this process loaded it: found " +
                              file.string() + " (deleted), expected the file that has the path now");
  dlclose(foreign);
  foreign = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  EXPECT_EQ(answer(file), "Number 2");
  install(file, 1);
  EXPECT_THAT(answer(file), HasSubstr("as long as this process keeps it loaded"));
  dlclose(foreign);
  EXPECT_EQ(answer(file), "Number 1");
}

// By the path of a descriptor, /proc/self/fd/3, it would not find the other one.
TEST_F(Changed, LoadsLibrariesWithOrigin) {
  for (const char* name : {"origin.so", "libneeded.so"})
    fs::copy_file(std::string(ILAW_TEST_PLUGINS "/") + name, folder.path / name);
  EXPECT_EQ(answer(folder.path / "origin.so"), "Nothing");
}

TEST_F(Changed, RefusesFilesThatAllMayWrite) {
  install(file, 1);
  fs::permissions(file, fs::perms(0666));
  const std::string said =
      file.string() + ": every user may write to the file, expected no such permission (chmod o-w)";
  EXPECT_EQ(answer(file), said);
  EXPECT_THROW(ilaw::read_description(file.string()), ilaw::error);
  fs::permissions(file, fs::perms(0664));  // the owner chose the group
  EXPECT_EQ(answer(file), "Number 1");
}

// Where every user may rename a folder, he may put his own in its place.
TEST_F(Changed, SearchesNoFolderBelowAWritableOne) {
  const fs::path top = folder.path, in = top / "deep" / "in", link = top / "link";
  fs::create_directories(in);
  fs::create_directory_symlink(in, link);
  install(in / "law.so", 1);
  const auto found = [](const fs::path& searched) -> std::string {
    setenv("ILAW_PATH", searched.c_str(), 1);
    try {
      return ilaw::library::named("law").path();
    } catch (const ilaw::error& error) {
      return error.what();
    }
  };
  const std::string weak = "not searched, since every user may write there: ", by = " (by " + top.string();
  EXPECT_EQ(found(in), (in / "law.so").string());
  fs::permissions(top / "deep", fs::perms(0777));
  EXPECT_THAT(found(in), HasSubstr(weak + in.string() + by + "/deep)"));
  EXPECT_THAT(found(link), HasSubstr(weak + link.string() + by + "/deep)"));
  fs::permissions(top / "deep", fs::perms(01777));  // the sticky bit forbids to rename what others have
  EXPECT_EQ(found(in), (in / "law.so").string());
  EXPECT_EQ(found(link), (in / "law.so").string());
  fs::permissions(in, fs::perms(01777));  // but not to add a library
  EXPECT_THAT(found(in), HasSubstr(weak + in.string()));
  unsetenv("ILAW_PATH");
}

}  // namespace
