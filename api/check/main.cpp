// ilaw-check LIBRARY - `ilaw check` for authors of laws who build no host: the same options, output and exit
// codes.
// SPDX-License-Identifier: BSD-3-Clause
#include "check/check.hpp"
#include "check/command.hpp"

#include <cstdio>
#include <exception>

namespace {

enum ExitCode { exit_done = 0, exit_failed = 1, exit_bad_input = 2 };

int complain(const char* what, int code) {
  std::fprintf(stderr, "ilaw-check: %s\n", what);
  return code;
}

int run_command(int argc, char** argv) {
  CLI::App app{"ilaw-check - checks a library of laws against the contract, rule by rule", "ilaw-check"};
  app.set_version_flag("--version", "ilaw-check " ILAW_VERSION);
  app.footer(
      "Exit codes: 0 no rule is broken; 1 some are; 2 bad usage.\n"
      "Example: ilaw-check ./build/lib/ilaw/my_law.so --junit check.xml");
  const auto check = ilaw::check::add_options(app);
  try {
    app.parse(argc, argv);
    return check();
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? exit_done : exit_bad_input;
  } catch (const ilaw::check::UsageError& error) {
    return complain(error.what(), exit_bad_input);
  } catch (const std::exception& error) {
    return complain(error.what(), exit_failed);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int code = run_command(argc, argv);
  const bool had_failed = std::ferror(stdout) != 0;
  if (std::fflush(stdout) == 0 && !had_failed) return code;
  return complain("standard output: cannot be written", exit_failed);
}
