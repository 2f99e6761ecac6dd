// docs/first_law.md and memory_law.md: what the pages show builds and works, from their own text.
#include "support/law_runner.hpp"
#include "support/small_batch.hpp"

#include <unistd.h>

#include <fstream>
#include <regex>
#include <sstream>

namespace ilaw::testing {
namespace {

namespace fs = std::filesystem;

// The first code block of a page in a language.
std::string block(const std::string& language, const char* page = ILAW_PAGE) {
  std::ostringstream all;
  all << std::ifstream(page).rdbuf();
  const std::string text = all.str(), fence = "```" + language + "\n";
  const std::size_t start = text.find(fence) + fence.size();
  return text.substr(start, text.find("```", start) - start);
}

void run(const std::string& command, const fs::path& log) {
  EXPECT_EQ(std::system((command + " >" + log.string() + " 2>&1").c_str()), 0) << command << "\n"
                                                                               << std::ifstream(log).rdbuf();
}

// The page's project, to be built against an ilaw. Release would make all instruction sets.
void configure(const fs::path& folder, const std::string& ilaw_dir) {
  fs::create_directories(folder);
  std::ofstream(folder / "viscous.cpp") << block("cpp");
  std::ofstream(folder / "CMakeLists.txt") << block("cmake");
  run(std::string(ILAW_CMAKE) + " -S " + folder.string() + " -B " + (folder / "build").string() +
          " -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG=-O0 -DCMAKE_CXX_COMPILER=" ILAW_CXX
          " -DCMAKE_EXPORT_COMPILE_COMMANDS=ON -Dilaw_DIR=" +
          ilaw_dir,
      folder / "log");
}

std::string text_of(const fs::path& file, const std::string& from, const std::string& to) {
  std::ostringstream all;
  all << std::ifstream(file).rdbuf();
  std::string text = all.str();
  EXPECT_FALSE(text.empty()) << file;
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

class FirstLaw : public ::testing::Test {
 protected:
  FirstLaw() {
    fs::create_directories(folder);
    run(ILAW_CMAKE " --install " ILAW_BUILD " --prefix " + (folder / "ilaw").string(), folder / "log");
    configure(folder / "law", (folder / "ilaw" / "lib" / "cmake" / "ilaw").string());
  }
  ~FirstLaw() override { fs::remove_all(folder); }

  const fs::path folder = fs::temp_directory_path() / ("ilaw_first_law_" + std::to_string(getpid()));
};

// r = -h c A/(1 + h c A H) v_free where the gap is closed; of a node that came with -0.9 v_free the tenth of
// -v_free/H, with which it leaves as fast.
void expect_works(const std::string& file) {
  const SetupBuilder setup({{{"viscosity", 40.0}}, {}});
  const ilaw::interface law(ilaw::library(file), "viscous", setup.setup);
  const double gap[] = {-0.1, 0.1, -0.1}, before[] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.9, -1.8, 2.7};
  SmallBatch nodes(3, {-1.0, 2.0, -3.0});
  nodes.h[0] = 0.5;
  nodes.area = 2.0;
  nodes.b.gap = {gap, nullptr, 1, 1};
  nodes.b.v_previous = {before, nullptr, 3, 1};
  nodes.b.velocity_step = nodes.b.position_step = 0.01;
  ASSERT_EQ(law.evaluate(nodes.b), ILAW_OK);
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(nodes.r[0][c], -0.8 / 1.4 * nodes.v[c], 1e-15) << "c " << c;
    EXPECT_EQ(nodes.r[1][c], 0.0) << "c " << c;
    EXPECT_NEAR(nodes.r[2][c], -0.2 * nodes.v[c], 1e-15) << "c " << c;
  }
}

// Random scenes, of which none may gain energy (docs/stability.md).
void expect_adds_no_energy(const std::string& folder) {
  const fs::path log = fs::temp_directory_path() / ("ilaw_scenes_" + std::to_string(getpid()) + ".log");
  run("ILAW_PATH=" + folder + " " ILAW_BUILD "/bin/ilaw stress --scenes 60 --steps 2000 --law viscous", log);
  fs::remove(log);
}

TEST_F(FirstLaw, BuildsAgainstAnInstalledTree) {
  for (const char* file :
       {"bin/ilaw", "lib/ilaw/contact.so", "include/ilaw/ilaw.h", "share/ilaw/fortran/ilaw.f90"})
    EXPECT_TRUE(fs::exists(folder / "ilaw" / file)) << file;
  const std::string build = (folder / "law" / "build").string();
  run(ILAW_CMAKE " --build " + build, folder / "log");
  run("ctest --test-dir " + build + " --no-tests=error --output-on-failure", folder / "log");
  expect_works(build + "/lib/ilaw/viscous.so");
  expect_adds_no_energy(build + "/lib/ilaw");
}

// The same commands on the same headers: it need not be compiled once more.
TEST_F(FirstLaw, IsTheSameAgainstTheBuildTree) {
  configure(folder / "own", ILAW_BUILD);
  const fs::path build = folder / "own" / "build", other = folder / "law" / "build";
  for (const char* file : {"compile_commands.json", "CMakeFiles/viscous.dir/link.txt"})
    EXPECT_EQ(text_of(build / file, (folder / "own").string(), (folder / "law").string()),
              text_of(other / file, (folder / "ilaw" / "include").string(), ILAW_SOURCE "/api/include"))
        << file;
  run("diff -r " ILAW_SOURCE "/api/include " + (folder / "ilaw" / "include").string(), folder / "log");
  EXPECT_THAT(text_of(build / "CTestTestfile.cmake", ILAW_BUILD, "BUILD"), HasSubstr("BUILD/bin/ilaw"));
}

// Every name that law_checks.hpp knows, on the page and at the top of law.hpp.
TEST(FirstLawPage, ListsAllNames) {
  const auto text = [](const char* file) {
    std::ostringstream all;
    all << std::ifstream(file).rdbuf();
    return all.str();
  };
  const std::string checks = text(ILAW_SOURCE "/api/include/ilaw/kit/detail/law_checks.hpp");
  const std::string law = text(ILAW_SOURCE "/api/include/ilaw/kit/law.hpp"), page = text(ILAW_PAGE);
  const std::regex name("ILAW_KIT_NAME\\((?!wrong)(\\w+)\\);");
  int names = 0;
  for (std::sregex_iterator it(checks.begin(), checks.end(), name), end; it != end; ++it, ++names) {
    EXPECT_THAT(page, HasSubstr("`" + (*it)[1].str() + "`")) << (*it)[1];
    EXPECT_TRUE(std::regex_search(law.substr(0, law.find("#pragma once")),
                                  std::regex("\\b" + (*it)[1].str() + "\\b")))
        << (*it)[1];
  }
  EXPECT_GT(names, 20);
  EXPECT_LE(std::count(page.begin(), page.end(), '\n'), 150);
}

TEST(ViscousLaw, InPlainCGivesTheSame) {
  expect_works(ILAW_VISCOUS_C);
  const auto refusal = [](const SetupBuilder& setup) {
    try {
      const ilaw::interface law(ilaw::library(ILAW_VISCOUS_C), "viscous", setup.setup);
    } catch (const ilaw::error& error) {
      return std::string(error.what());
    }
    return std::string("not refused");
  };
  EXPECT_THAT(refusal(SetupBuilder({})), HasSubstr("parameter 'viscosity' is missing"));
  EXPECT_THAT(refusal(SetupBuilder({{{"viscosity", -1.0}}, {}})),
              HasSubstr("'viscosity' = -1 is not allowed: expected a number in [0, 1e+300]"));
  EXPECT_THAT(refusal(SetupBuilder({{{"viscosity", 1.0}}, {}}, 3, ILAW_DELASSUS_FULL)),
              HasSubstr("form 4 of H"));
}

TEST(ViscousLaw, InPlainCKeepsEveryRule) {
  const fs::path log = fs::temp_directory_path() / ("ilaw_viscous_" + std::to_string(getpid()) + ".log");
  run(ILAW_BUILD "/bin/ilaw check " ILAW_VISCOUS_C, log);
  fs::remove(log);
}

// The command of the page, with this compiler; the check judges the balance of what is stored.
TEST(MemoryLawPage, BuildsInOneCallAndKeepsEveryRule) {
  const fs::path folder = fs::temp_directory_path() / ("ilaw_memory_law_" + std::to_string(getpid()));
  fs::create_directories(folder);
  const char* const page = ILAW_SOURCE "/docs/memory_law.md";
  std::ofstream(folder / "glue.cpp") << block("cpp", page);
  std::string commands =
      std::regex_replace(block("sh", page), std::regex("PREFIX/include"), ILAW_SOURCE "/api/include");
  commands = std::regex_replace(commands, std::regex("g\\+\\+"), ILAW_CXX);
  std::ofstream(folder / "commands.sh") << commands;
  run("cd " + folder.string() + " && PATH=" ILAW_BUILD "/bin:$PATH sh -e commands.sh", folder / "log");
  fs::remove_all(folder);
}

}  // namespace
}  // namespace ilaw::testing
