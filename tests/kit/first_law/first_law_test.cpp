// docs/first_law.md: what the page shows builds and works, from its own text.
#include <ilaw/loader.hpp>

#include <gtest/gtest.h>

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace {

namespace fs = std::filesystem;

// The first code block of the page in a language.
std::string block(const std::string& language) {
  std::ostringstream page;
  page << std::ifstream(ILAW_PAGE).rdbuf();
  const std::string text = page.str(), fence = "```" + language + "\n";
  const std::size_t start = text.find(fence) + fence.size();
  return text.substr(start, text.find("```", start) - start);
}

// Builds the page's project against an ilaw; returns the library. Release makes all instruction sets.
std::string build(const fs::path& folder, const std::string& ilaw_dir, const std::string& type) {
  fs::create_directories(folder);
  std::ofstream(folder / "viscous.cpp") << block("cpp");
  std::ofstream(folder / "CMakeLists.txt") << block("cmake");
  const std::string command = std::string(ILAW_CMAKE) + " -S " + folder.string() + " -B " +
                              (folder / "build").string() + " -DCMAKE_BUILD_TYPE=" + type +
                              " -DCMAKE_CXX_COMPILER=" ILAW_CXX " -Dilaw_DIR=" + ilaw_dir + " >" +
                              (folder / "log").string() + " 2>&1 && " + ILAW_CMAKE + " --build " +
                              (folder / "build").string() + " >>" + (folder / "log").string() + " 2>&1";
  EXPECT_EQ(std::system(command.c_str()), 0) << std::ifstream(folder / "log").rdbuf();
  return (folder / "build" / "lib" / "ilaw" / "viscous.so").string();
}

// r = -h c A/(1 + h c A H) v_free where the gap is closed.
void expect_works(const std::string& file) {
  const ilaw::library library(file);
  ilaw_argument viscosity{};
  viscosity.struct_size = sizeof viscosity;
  viscosity.name = "viscosity";
  viscosity.number = 40.0;
  const ilaw_argument* arguments[] = {&viscosity};
  ilaw_setup setup{};
  setup.struct_size = sizeof setup;
  setup.dimension = 3;
  setup.delassus_form = ILAW_DELASSUS_SCALAR;
  setup.arguments = arguments;
  setup.argument_count = 1;
  const ilaw::interface law(library, "viscous", setup);
  const double v[] = {-1.0, 2.0, -3.0, -1.0, 2.0, -3.0}, h = 0.5, gap[] = {-0.1, 0.1}, area = 2.0;
  double r[6];
  ilaw_batch batch{};
  batch.struct_size = sizeof batch;
  batch.node_count = 2;
  batch.velocity_step = batch.position_step = 0.01;
  batch.v_free = {v, 3, 1};
  batch.delassus = {&h, 0, 1};
  batch.gap = {gap, 1, 1};
  batch.area = {&area, 0, 1};
  batch.impulse = {r, 3, 1};
  ASSERT_EQ(law.evaluate(batch), ILAW_OK);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(r[c], -0.8 / 1.4 * v[c], 1e-15);
    EXPECT_EQ(r[3 + c], 0.0);
  }
}

TEST(FirstLaw, BuildsAgainstTheBuildTree) {
  const fs::path folder = fs::temp_directory_path() / ("ilaw_first_law_" + std::to_string(getpid()));
  expect_works(build(folder / "law", ILAW_BUILD, "Debug"));
  fs::remove_all(folder);
}

TEST(FirstLaw, BuildsAgainstAnInstalledTree) {
  const fs::path folder = fs::temp_directory_path() / ("ilaw_installed_" + std::to_string(getpid()));
  const std::string install = std::string(ILAW_CMAKE) + " --install " ILAW_BUILD " --prefix " +
                              (folder / "ilaw").string() + " >/dev/null";
  ASSERT_EQ(std::system(install.c_str()), 0);
  for (const char* file :
       {"bin/ilaw", "lib/ilaw/contact.so", "include/ilaw/ilaw.h", "share/ilaw/fortran/ilaw.f90"})
    EXPECT_TRUE(fs::exists(folder / "ilaw" / file)) << file;
  expect_works(build(folder / "law", (folder / "ilaw" / "lib" / "cmake" / "ilaw").string(), "Release"));
  fs::remove_all(folder);
}

}  // namespace
