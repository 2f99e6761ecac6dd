// SPDX-License-Identifier: BSD-3-Clause
#include "results/gnuplot.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cctype>
#include <cstdio>
#include <string>

extern char** environ;

namespace ilaw::host {
namespace {

// -1 when it cannot be started.
int exit_status_of_gnuplot(std::string file) {
  std::string program = "gnuplot";
  char* arguments[] = {program.data(), file.data(), nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const int started = posix_spawnp(&child, "gnuplot", &actions, nullptr, arguments, environ);
  posix_spawn_file_actions_destroy(&actions);
  int status = 0;
  if (started != 0 || waitpid(child, &status, 0) != child) return -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace

std::string in_quotes(std::string_view text) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'') out += '\'';
    out += std::iscntrl(static_cast<unsigned char>(c)) ? ' ' : c;
  }
  return out + "'";
}

bool run_gnuplot(const std::filesystem::path& script) {
  const int status = exit_status_of_gnuplot(script.string());
  if (status == 0) return true;
  if (status < 0 || status == 127)
    std::fprintf(stderr, "ilaw: gnuplot cannot be started; it is in the package gnuplot-nox\n");
  else
    std::fprintf(stderr, "ilaw: gnuplot failed; run it on %s to see why\n", script.c_str());
  return false;
}

}  // namespace ilaw::host
