// docs/from_question_to_picture.md: its commands run, and draw the pictures that it shows.
#include "program_runner.hpp"

#include <gtest/gtest.h>

#include <set>

namespace ilaw::host::testing {
namespace {

const std::filesystem::path root = ILAW_SOURCE;

std::set<std::string> pictures_of(const std::string& page) {
  std::set<std::string> names;
  for (std::size_t at = page.find("](img/"); at != std::string::npos; at = page.find("](img/", at + 1))
    names.insert(page.substr(at + 6, page.find(')', at) - at - 6));
  return names;
}

TEST(QuestionPage, DrawsWhatItShows) {
  const auto folder = std::filesystem::temp_directory_path() / ("ilaw_pictures_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  const std::string command = "bash " + (root / "docs/make_pictures.sh").string() + " " + ILAW_PROGRAM + " " +
                              folder.string() + " >" + (folder / "said").string() + " 2>&1 </dev/null";
  ASSERT_EQ(std::system(command.c_str()), 0) << text_of(folder / "said");
  const std::set<std::string> pictures = pictures_of(text_of(root / "docs/from_question_to_picture.md"));
  EXPECT_EQ(pictures.size(), 4U);
  for (const std::string& name : pictures) {
    EXPECT_EQ(text_of(folder / name).substr(1, 3), "PNG") << name;
    // The one that stands beside the page.
    EXPECT_EQ(text_of(root / "docs/img" / name).substr(1, 3), "PNG") << name;
    EXPECT_LT(std::filesystem::file_size(root / "docs/img" / name), 61440U) << name;
  }
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace ilaw::host::testing
