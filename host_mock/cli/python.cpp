// SPDX-License-Identifier: BSD-3-Clause
#include "cli/python.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <stdexcept>

namespace ilaw::host {

void run_python(const std::string& module, const std::vector<std::string>& arguments,
                const std::string& imports, const std::string& debian_packages) {
  const std::filesystem::path package =
      std::filesystem::read_symlink("/proc/self/exe").parent_path().parent_path() / "share/ilaw/python";
  if (!std::filesystem::is_directory(package / "ilaw"))
    throw std::runtime_error(package.string() +
                             ": found no such folder, expected the Python package of ilaw");
  // The package of this program comes before others of the same name.
  const char* const others = std::getenv("PYTHONPATH");
  setenv("PYTHONPATH", (package.string() + (others ? ":" + std::string(others) : "")).c_str(), 1);
  std::fflush(nullptr);
  for (const std::string python : {"python3", "/usr/bin/python3"}) {
    if (std::system((python + " -B -c 'import " + imports + "' 2> /dev/null").c_str()) != 0) continue;
    std::vector<std::string> words = {python, "-B", "-m", module};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> pointers;
    std::transform(words.begin(), words.end(), std::back_inserter(pointers),
                   [](std::string& word) { return word.data(); });
    pointers.push_back(nullptr);
    execvp(pointers[0], pointers.data());
  }
  throw std::runtime_error("found no Python 3 with " + imports + "; install it with `apt-get install " +
                           debian_packages + "`");
}

}  // namespace ilaw::host
