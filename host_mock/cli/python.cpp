// SPDX-License-Identifier: BSD-3-Clause
#include "cli/python.hpp"

#include "base/exit_code.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <utility>

extern char** environ;

namespace ilaw::host {
namespace {

// Ends with a null, as posix_spawn reads it.
std::vector<char*> pointers(std::vector<std::string>& texts) {
  std::vector<char*> found(texts.size() + 1, nullptr);
  std::transform(texts.begin(), texts.end(), found.begin(), [](std::string& text) { return text.data(); });
  return found;
}

// Exit code of a program, or -1 if it cannot be started.
int run_program(std::vector<std::string> words, std::vector<std::string>& environment, bool is_quiet) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  if (is_quiet) posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const int started = posix_spawnp(&child, words.front().c_str(), &actions, nullptr, pointers(words).data(),
                                   pointers(environment).data());
  posix_spawn_file_actions_destroy(&actions);
  int status = 0;
  if (started != 0 || waitpid(child, &status, 0) != child) return -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : exit_failed;
}

// The environment, with the package of this program before others of the same name.
std::vector<std::string> environment_with(const std::filesystem::path& package) {
  const std::string key = "PYTHONPATH=";
  std::string path = key + package.string();
  std::vector<std::string> found;
  for (char** entry = environ; *entry != nullptr; ++entry)
    if (const std::string text = *entry; text.starts_with(key))
      path += ":" + text.substr(key.size());
    else
      found.push_back(text);
  found.push_back(path);
  return found;
}

}  // namespace

int run_python(const std::string& module, const std::vector<std::string>& arguments,
               const std::string& imports, const std::string& debian_packages) {
  const std::filesystem::path package =
      std::filesystem::read_symlink("/proc/self/exe").parent_path().parent_path() / "share/ilaw/python";
  if (!std::filesystem::is_directory(package / "ilaw"))
    throw std::runtime_error(package.string() +
                             ": found no such folder, expected the Python package of ilaw");
  std::vector<std::string> environment = environment_with(package);
  std::fflush(nullptr);
  for (const std::string python : {"python3", "/usr/bin/python3"}) {
    if (run_program({python, "-B", "-c", "import " + imports}, environment, true) != exit_done) continue;
    std::vector<std::string> words = {python, "-B", "-m", module};
    words.insert(words.end(), arguments.begin(), arguments.end());
    return run_program(std::move(words), environment, false);
  }
  throw std::runtime_error("found no Python 3 with " + imports + "; install it with `apt-get install " +
                           debian_packages + "`");
}

}  // namespace ilaw::host
