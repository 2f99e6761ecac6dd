// SPDX-License-Identifier: BSD-3-Clause
#include "cli/python.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <stdexcept>
#include <vector>

namespace ilaw::host {
namespace {

// "--levels=3", or "--y=a,b" if commas stand between the values of an option; after them the arguments.
std::vector<std::string> given_to(const CLI::App& command) {
  std::vector<std::string> words, arguments = {"--"};
  for (const CLI::Option* option : command.get_options()) {
    if (option->count() == 0) continue;
    if (option->get_positional()) {
      arguments.insert(arguments.end(), option->results().begin(), option->results().end());
    } else if (option->get_items_expected_max() == 0) {
      words.push_back(option->get_name());
    } else {
      std::string joined;
      for (const std::string& value : option->results()) {
        if (option->get_delimiter() == '\0' || joined.empty())
          words.push_back(joined = option->get_name() + "=" + value);
        else
          words.back() += option->get_delimiter() + value;
      }
    }
  }
  words.insert(words.end(), arguments.begin(), arguments.end());
  return words;
}

}  // namespace

void become_python(const CLI::App& command, const PythonModule& module) {
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe");
  const std::filesystem::path package = program.parent_path().parent_path() / "share/ilaw/python";
  if (!std::filesystem::is_directory(package / "ilaw"))
    throw std::runtime_error(package.string() +
                             ": found no such folder, expected the Python package of ilaw");
  // The package of this program comes before others of the same name.
  const char* const others = std::getenv("PYTHONPATH");
  setenv("PYTHONPATH", (package.string() + (others ? ":" + std::string(others) : "")).c_str(), 1);
  setenv("ILAW_PROGRAM", program.c_str(), 1);  // which a command in Python starts
  std::fflush(nullptr);
  for (const std::string python : {"python3", "/usr/bin/python3"}) {
    // Found, not imported, which would take as long as the command itself.
    const std::string look = " -B -c 'from importlib.util import find_spec as f; exit(not all(map(f, \"" +
                             module.packages + "\".split(\", \"))))' 2> /dev/null";
    const int code = std::system((python + look).c_str());
    if (WIFSIGNALED(code) || WEXITSTATUS(code) > 128) throw std::runtime_error("interrupted");
    if (code != 0) continue;
    // Until the module is there to say so, an interrupt just ends it.
    const std::string start =
        "import runpy, signal as s; s.getsignal(2) == s.SIG_IGN or s.signal(2, s.SIG_DFL); runpy.run_module('" +
        module.name + "', run_name='__main__', alter_sys=True)";
    std::vector<std::string> words = {python, "-B", "-c", start};
    const std::vector<std::string> arguments = given_to(command);
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> pointers;
    std::transform(words.begin(), words.end(), std::back_inserter(pointers),
                   [](std::string& word) { return word.data(); });
    pointers.push_back(nullptr);
    execvp(pointers[0], pointers.data());
  }
  throw std::runtime_error("found no Python 3 with " + module.packages +
                           "; install it with `apt-get install " + module.debian_packages + "`");
}

void run_in_python(CLI::App& command, const PythonModule& module) {
  command.callback([&command, module] { become_python(command, module); });
}

}  // namespace ilaw::host
