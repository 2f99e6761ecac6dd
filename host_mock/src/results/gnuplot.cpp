// SPDX-License-Identifier: BSD-3-Clause
#include "results/gnuplot.hpp"

#include "base/files.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cctype>
#include <cstdio>
#include <string>
#include <utility>

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

bool run(const std::filesystem::path& script) {
  const int status = exit_status_of_gnuplot(script.string());
  if (status == 0) return true;
  if (status < 0 || status == 127)
    std::fprintf(stderr, "ilaw: gnuplot cannot be started; it is in the package gnuplot-nox\n");
  else
    std::fprintf(stderr, "ilaw: gnuplot failed; run it on %s to see why\n", script.c_str());
  return false;
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

bool draw_by_gnuplot(const std::filesystem::path& script, const std::function<void(std::ostream&)>& write) {
  AtomicFile file(script);
  write(file.stream());
  file.commit();
  return run(script);
}

bool draw_log_sheet(const std::filesystem::path& folder, const std::string& name, const LogSheet& sheet,
                    const std::function<void(std::ostream&)>& panels) {
  return draw_by_gnuplot(folder / (name + ".gnuplot"), [&](std::ostream& script) {
    for (const auto& [terminal, kind] : {std::pair{"pngcairo", ".png"}, std::pair{"svg", ".svg"}}) {
      script << "reset\nset datafile separator comma\nset datafile missing ''\nset terminal " << terminal
             << " size " << sheet.size << " font 'sans,11' background rgb 'white'\nset output "
             << in_quotes((folder / (name + kind)).string())
             << "\nset logscale xy\nset format xy '10^{%T}'\nset grid\nset border 3\nset tics nomirror\n"
                "set ylabel 'relative error'\nset multiplot "
             << sheet.layout << " title " << in_quotes(sheet.title) << ' ' << sheet.title_font
             << " noenhanced\n";
      panels(script);
      script << "unset multiplot\nunset output\n";
    }
  });
}

}  // namespace ilaw::host
