// SPDX-License-Identifier: BSD-3-Clause
#include "search.hpp"

#include "refusal.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <sstream>
#include <system_error>

namespace ilaw::loading {
namespace {

namespace fs = std::filesystem;

void add_once(std::vector<std::string>& folders, const fs::path& folder) {
  const std::string text = folder.lexically_normal().string();
  if (std::find(folders.begin(), folders.end(), text) == folders.end()) folders.push_back(text);
}

std::string joined(const std::vector<std::string>& folders) {
  std::string text;
  for (const std::string& folder : folders) text += (text.empty() ? "" : ":") + folder;
  return text;
}

}  // namespace

std::vector<std::string> search_folders() {
  std::vector<std::string> folders;
  if (const char* path = std::getenv("ILAW_PATH")) {
    std::istringstream entries(path);
    // An empty or relative entry would mean the current folder, which is never searched.
    for (std::string entry; std::getline(entries, entry, ':');)
      if (fs::path(entry).is_absolute()) add_once(folders, entry);
  }
  std::error_code error;
  if (const fs::path program = fs::read_symlink("/proc/self/exe", error); !error)
    add_once(folders, program.parent_path().parent_path() / "lib" / "ilaw");
  add_once(folders, ILAW_INSTALLED_FOLDER);
  return folders;
}

std::string find_library(const std::string& name_or_path) {
  std::error_code error;
  if (name_or_path.find('/') != std::string::npos) {
    if (!fs::exists(name_or_path, error))
      throw refusal(ILAW_NOT_FOUND, name_or_path + ": no such file, expected a law library");
    return fs::canonical(name_or_path).string();
  }
  const std::string file = fs::path(name_or_path).extension() == ".so" ? name_or_path : name_or_path + ".so";
  const std::vector<std::string> folders = search_folders();
  for (const std::string& folder : folders)
    if (fs::exists(fs::path(folder) / file, error)) return fs::canonical(fs::path(folder) / file).string();
  throw refusal(ILAW_NOT_FOUND,
                "'" + name_or_path + "': no " + file + " found, expected it in one of: " + joined(folders));
}

std::vector<std::string> library_files() {
  std::vector<std::string> files;
  std::set<std::string> seen;
  for (const std::string& folder : search_folders()) {
    std::vector<fs::path> here;
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, error))
      if (entry.path().extension() == ".so") here.push_back(entry.path());
    std::sort(here.begin(), here.end());
    for (const fs::path& path : here)
      if (seen.insert(path.filename().string()).second) files.push_back(path.string());
  }
  return files;
}

}  // namespace ilaw::loading
