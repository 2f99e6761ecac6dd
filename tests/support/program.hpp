// program.hpp - programs that tests run, what they say, and folders to run them in.
#pragma once

#include "support/matchers.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

namespace ilaw::testing::programs {

struct Outcome {
  int code;
  std::string output;  // stdout and stderr

  friend void PrintTo(const Outcome& shown, std::ostream* out) {
    *out << "exit code " << shown.code << ": " << shown.output;
  }
};

// A program that ends with an exit code and an output.
MATCHER_P2(Exits, code, output,
           "exits with " + std::to_string(code) + " and its output " +
               ::testing::DescribeMatcher<std::string>(output)) {
  return arg.code == code && ::testing::ExplainMatchResult(output, arg.output, result_listener);
}

inline Outcome run_command(const std::string& command) {
  FILE* pipe = popen(("exec 2>&1 </dev/null; " + command).c_str(), "r");
  std::string output;
  std::array<char, 4096> buffer{};
  for (std::size_t got; (got = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
    output.append(buffer.data(), got);
  const int status = pclose(pipe);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, output};
}

inline std::string text_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

struct TemporaryFolder {
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "ilaw_test_XXXXXX").string();
    if (!mkdtemp(name.data())) throw std::runtime_error("no folder");
    path = std::filesystem::canonical(name);
    permissions(path, std::filesystem::perms(0755));
  }
  ~TemporaryFolder() { remove_all(path); }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::filesystem::path path;
};

}  // namespace ilaw::testing::programs
