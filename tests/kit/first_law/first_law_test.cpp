// docs/first_law.md: what the page shows builds and works, from its own text.
#include "support/law_runner.hpp"
#include "support/small_batch.hpp"

#include <unistd.h>

#include <fstream>
#include <sstream>

namespace ilaw::testing {
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
  const std::string check = "ctest --test-dir " + (folder / "build").string() +
                            " --no-tests=error --output-on-failure >" + (folder / "log").string() + " 2>&1";
  EXPECT_EQ(std::system(check.c_str()), 0) << std::ifstream(folder / "log").rdbuf();
  return (folder / "build" / "lib" / "ilaw" / "viscous.so").string();
}

// r = -h c A/(1 + h c A H) v_free where the gap is closed.
void expect_works(const std::string& file) {
  const SetupBuilder setup({{{"viscosity", 40.0}}, {}});
  const ilaw::interface law(ilaw::library(file), "viscous", setup.setup);
  const double gap[] = {-0.1, 0.1};
  SmallBatch nodes(2, {-1.0, 2.0, -3.0});
  nodes.h[0] = 0.5;
  nodes.area = 2.0;
  nodes.b.gap = {gap, 1, 1};
  nodes.b.velocity_step = nodes.b.position_step = 0.01;
  ASSERT_EQ(law.evaluate(nodes.b), ILAW_OK);
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(nodes.r[0][c], -0.8 / 1.4 * nodes.v[c], 1e-15);
    EXPECT_EQ(nodes.r[1][c], 0.0);
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
  expect_works(build(folder / "law", (folder / "ilaw" / "lib" / "cmake" / "ilaw").string(), "Debug"));
  fs::remove_all(folder);
}

TEST(FirstLaw, InPlainCGivesTheSame) {
  expect_works(ILAW_VISCOUS_C);
  const auto refusal = [](const SetupBuilder& setup) {
    try {
      const ilaw::interface law(ilaw::library(ILAW_VISCOUS_C), "viscous", setup.setup);
    } catch (const ilaw::error& error) {
      return std::string(error.what());
    }
    return std::string("not refused");
  };
  EXPECT_NE(refusal(SetupBuilder({})).find("viscosity must be given"), std::string::npos);
  EXPECT_NE(refusal(SetupBuilder({{{"viscosity", -1.0}}, {}})).find("in [0, 1e300]"), std::string::npos);
  EXPECT_NE(refusal(SetupBuilder({{{"viscosity", 1.0}}, {}}, 3, ILAW_DELASSUS_FULL)).find("scalar H"),
            std::string::npos);
}

}  // namespace
}  // namespace ilaw::testing
