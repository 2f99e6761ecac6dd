// Where libraries are looked for, and where never. What names are refused: refusals.json.
// SPDX-License-Identifier: BSD-3-Clause
#include <ilaw/loader.hpp>

#include "support/program.hpp"

#include <dlfcn.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>

namespace {

using namespace ilaw::testing::matchers;
using namespace ilaw::testing::programs;
namespace fs = std::filesystem;

class Searched : public testing::Test {
 protected:
  Searched() {
    fs::create_directory(folder / "in");
    fs::copy_file(ILAW_TEST_PLUGINS "/good.so", folder / "in" / "here.so");
    setenv("ILAW_PATH", (folder / "in").c_str(), 1);
  }
  ~Searched() override { unsetenv("ILAW_PATH"); }

  static std::string refusal_of(const std::string& name) {
    try {
      const ilaw::library library = ilaw::library::named(name);
      return "";
    } catch (const ilaw::error& error) {
      EXPECT_EQ(error.code(), ILAW_NOT_FOUND) << error.what();
      return error.what();
    }
  }

  const TemporaryFolder made;
  const fs::path& folder = made.path;
};

// Laws of a package serve a host that links the loader of another installation.
TEST_F(Searched, FoldersOfTheSystemAreSearched) {
  const std::string path = ilaw::search_path() + ":";
  for (const char* wanted : {":/usr/local/lib/ilaw:", ":/usr/lib/ilaw:"})
    EXPECT_THAT(path, HasSubstr(wanted));
}

TEST_F(Searched, FolderThatEverybodyMayWriteToIsLeftOutAndNamed) {
  fs::permissions(folder / "in", fs::perms(0777));
  EXPECT_THAT(refusal_of("here"),
              HasSubstr("not searched, since every user may write there: " + (folder / "in").string()));
  EXPECT_THAT(ilaw::search_path(), Not(HasSubstr(folder.string())));
  for (const std::string& file : ilaw::search()) EXPECT_THAT(file, Not(HasSubstr(folder.string())));
  EXPECT_NO_THROW(
      ilaw::library((folder / "in" / "here.so").string()));  // an explicit path is the user's word
}

std::string output_of(const std::string& command) { return run_command(command).output; }

TEST_F(Searched, SetUidProgramReadsNoEnvironmentAndLooksNotBesideItself) {
  EXPECT_THAT(output_of(ILAW_HOSTS "/search_host"), HasSubstr(folder.string()));
  if (geteuid() != 0) GTEST_SKIP() << "only root can give a program away";
  if (prctl(PR_GET_NO_NEW_PRIVS, 0, 0, 0, 0) == 1) GTEST_SKIP() << "set-uid has no effect in this process";
  struct statvfs mount;
  ASSERT_EQ(statvfs(folder.c_str(), &mount), 0);
  if (mount.f_flag & ST_NOSUID) GTEST_SKIP() << "set-uid has no effect in " << folder;
  const fs::path program = folder / "bin" / "search_host";
  fs::create_directory(folder / "bin");
  fs::copy_file(ILAW_HOSTS "/search_host", program);
  constexpr uid_t somebody = 12345;
  ASSERT_EQ(chown(program.c_str(), somebody, somebody), 0);
  EXPECT_THAT(output_of(program.string()), HasSubstr((folder / "lib" / "ilaw").string()));
  ASSERT_EQ(chmod(program.c_str(), 04755), 0);
  EXPECT_THAT(output_of(program.string()), Not(HasSubstr(folder.string())));
}

TEST_F(Searched, SharedLoaderSearchesTheSame) {
  EXPECT_EQ(output_of(ILAW_HOSTS "/search_host_shared"), output_of(ILAW_HOSTS "/search_host"));
  EXPECT_EQ(output_of(ILAW_HOSTS "/search_host_shared here"), "0\n");
}

// An archive may be unpacked anywhere: its laws are found by a program that lies elsewhere, too.
TEST_F(Searched, SharedLoaderLooksBesideItself) {
  fs::create_directory(folder / "lib");
  fs::copy_file(ILAW_HOSTS "/../lib/libilaw_loader.so.1", folder / "lib" / "libilaw_loader.so.1");
  const std::string preload = "LD_PRELOAD=" + (folder / "lib" / "libilaw_loader.so.1").string();
  const std::string wanted = (folder / "lib" / "ilaw").string();
  EXPECT_THAT(output_of(preload + " " ILAW_HOSTS "/search_host_shared"), HasSubstr(wanted));
  EXPECT_THAT(output_of(ILAW_HOSTS "/search_host_shared"), Not(HasSubstr(wanted)));
}

// Loaded by a relative path, which means nothing once the program is in another folder. It stays loaded,
// since the loader in it keeps its list of libraries for the life of the process.
TEST_F(Searched, LooksBesideAPlugin) {
  fs::create_directory(folder / "plugins");
  fs::copy_file(ILAW_TEST_PLUGINS "/search_plugin.so", folder / "plugins" / "search_plugin.so");
  const fs::path before = fs::current_path();
  fs::current_path(folder);
  void* plugin = dlopen("plugins/search_plugin.so", RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  fs::current_path(before);
  ASSERT_NE(plugin, nullptr) << dlerror();
  std::size_t (*path)(char*, std::size_t) = nullptr;
  void* symbol = dlsym(plugin, "plugin_search_path");
  std::memcpy(&path, &symbol, sizeof path);
  ASSERT_NE(path, nullptr);
  std::string text(path(nullptr, 0), '\0');
  path(text.data(), text.size());
  const std::string at = folder.string();
  EXPECT_THAT(text, HasSubstr(":" + at + "/plugins/ilaw:" + at + "/lib/ilaw:"));
  EXPECT_THAT(ilaw::search_path(), Not(HasSubstr(at + "/plugins")));
  dlclose(plugin);
}

// Its interface outlives main, and with it whatever the loader has. Freed memory reads as rubbish.
TEST(LateHost, EndsWell) {
  EXPECT_EQ(output_of("MALLOC_PERTURB_=165 " ILAW_HOSTS "/late_host " ILAW_TEST_PLUGINS
                      "/good.so zero 2>&1; echo $?"),
            "ended\n0\n");
}

}  // namespace
