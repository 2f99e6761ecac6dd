// program_runner.hpp - the `ilaw` program in a process of its own.
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace ilaw::host::testing {

struct Outcome {
  int code;
  std::string output;  // stdout and stderr
};

// before: for the shell, as "ulimit -f 100; ".
inline Outcome run_command(const std::string& command) {
  FILE* pipe = popen((command + " 2>&1 </dev/null").c_str(), "r");
  std::string output;
  std::array<char, 4096> buffer{};
  for (std::size_t got; (got = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
    output.append(buffer.data(), got);
  const int status = pclose(pipe);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, output};
}

inline Outcome run_program(const std::string& arguments, const std::string& before = "") {
  return run_command(before + ILAW_PROGRAM + " " + arguments);
}

// Starts the program, its messages in a file; waitpid tells how it ended.
inline pid_t start_program(std::vector<std::string> arguments, const std::filesystem::path& messages) {
  const pid_t child = fork();
  if (child != 0) return child;
  arguments.insert(arguments.begin(), ILAW_PROGRAM);
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  if (!freopen(messages.c_str(), "w", stderr) || !freopen("/dev/null", "w", stdout)) _exit(127);
  execv(ILAW_PROGRAM, pointers.data());
  _exit(127);
}

inline std::string text_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

}  // namespace ilaw::host::testing
