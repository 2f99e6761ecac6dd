// Messages and descriptions have decimal dots in a host whose locale has commas.
#include "twins.hpp"

#include <unistd.h>

#include <clocale>
#include <fstream>

namespace ilaw::testing {
namespace {

namespace fs = std::filesystem;

// A locale of its own, so that none need be installed.
class CommaLocale : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_);
    std::ofstream(folder_ / "source")
        << "LC_NUMERIC\ndecimal_point \",\"\nthousands_sep \".\"\ngrouping 3;3\nEND LC_NUMERIC\n";
    const std::string command = "localedef -c -i " + (folder_ / "source").string() + " " +
                                (folder_ / "xx_XX").string() + " >/dev/null 2>&1";
    [[maybe_unused]] const int warnings = std::system(command.c_str());
    setenv("LOCPATH", folder_.c_str(), 1);
    if (!std::setlocale(LC_ALL, "xx_XX"))
      GTEST_SKIP() << "no locale with decimal commas: localedef is missing";
    char text[8];
    std::snprintf(text, sizeof text, "%g", 1.5);
    ASSERT_STREQ(text, "1,5");
  }
  void TearDown() override {
    std::setlocale(LC_ALL, "C");
    unsetenv("LOCPATH");
    fs::remove_all(folder_);
  }

 private:
  const fs::path folder_ = fs::temp_directory_path() / ("ilaw_locale_" + std::to_string(getpid()));
};

TEST_F(CommaLocale, IsNotInRefusals) {
  for (const std::string made_with : {"c", "kit"}) {
    const SetupBuilder setup({{{"friction", 0.5}, {"exponent", 0.125}}, {}});
    EXPECT_EQ(create(made_with, &setup.setup).message,
              "law 'twin': parameter 'exponent' = 0.125 is not allowed: expected a number in (0.5, 2.5]")
        << made_with;
    const SetupBuilder all_digits({{{"friction", 0.5}, {"exponent", 2.5000000000000004}}, {}});
    EXPECT_THAT(create(made_with, &all_digits.setup).message, HasSubstr(" = 2.5000000000000004 is not"))
        << made_with;
  }
}

TEST_F(CommaLocale, IsNotInDescriptions) {
  for (const std::string made_with : {"c", "kit"}) {
    const std::string text = twin(made_with).describe();
    EXPECT_THAT(text, HasSubstr("0.5")) << made_with;
    EXPECT_THAT(text, HasSubstr("2.5")) << made_with;
    std::setlocale(LC_ALL, "C");
    EXPECT_EQ(twin(made_with).describe(), text) << made_with;
    std::setlocale(LC_ALL, "xx_XX");
  }
}

}  // namespace
}  // namespace ilaw::testing
