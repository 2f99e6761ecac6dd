// The `ilaw` program.
// SPDX-License-Identifier: BSD-3-Clause
#include "base/exit_code.hpp"
#include "base/scene_error.hpp"
#include "base/words.hpp"
#include "check/check.hpp"
#include "cli/commands.hpp"
#include "cli/terminal.hpp"

#include <ilaw/loader.hpp>

#include <CLI/CLI.hpp>

#include <exception>
#include <filesystem>
#include <string>
#include <vector>

namespace {

// Names what nobody knows first: CLI11 would only tell what is missing for it.
std::string usage_message(const CLI::App* app, const CLI::Error& error) {
  const CLI::App* command = app->get_subcommands().empty() ? app : app->get_subcommands().front();
  const std::string name = app->get_name() + (command == app ? "" : " " + command->get_name());
  const std::vector<std::string> unknown = app->remaining(true);
  std::string text = std::string("ilaw: ") + error.what();
  if (!unknown.empty()) {
    std::vector<std::string> known;
    for (const CLI::App* one : command->get_subcommands({})) known.push_back(one->get_name());
    for (const CLI::Option* one : command->get_options())
      if (!one->get_positional()) known.push_back(one->get_name());
    text = "ilaw: found '" + unknown.front() + "', expected " + (known.empty() ? "" : "one of ") +
           ilaw::host::joined(known);
  }
  return text + "\nRun `" + name + " --help` for more.\n";
}

int complain_of(const std::exception& error, ilaw::host::ExitCode code) {
  ilaw::host::complain(ilaw::host::message_of(error));
  return code;
}

int run_command(int argc, char** argv) {
  using namespace ilaw::host;
  CLI::App app{"ilaw - interface laws in explicit dynamics: runs and draws scenes, measures and checks laws"};
  app.set_version_flag("--version", "ilaw " ILAW_VERSION);
  app.name("ilaw");
  app.require_subcommand(1);
  app.failure_message(usage_message);
  app.footer(
      "Exit codes: 0 done; 1 the run failed (diverged, plugin error, interrupted); 2 bad usage or bad input, "
      "before\n"
      "anything ran; 3 a value that the scene expects was missed.\nExample: ilaw run scene.json --out results && ilaw plot results && ilaw view results");

  int code = exit_done;
  for (const auto add : {add_run, add_plot, add_view, add_table, add_converge, add_study, add_stress,
                         add_list, add_describe, add_check, add_bench})
    add(app, code);
  try {
    app.parse(argc, argv);
    return code;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? exit_done : exit_bad_input;
  } catch (const InputError& error) {
    return complain_of(error, exit_bad_input);
  } catch (const ilaw::error& error) {
    return complain_of(error, exit_bad_input);
  } catch (const ilaw::check::UsageError& error) {
    return complain_of(error, exit_bad_input);
  } catch (const std::filesystem::filesystem_error& error) {
    return complain_of(error, error.path1().empty() ? exit_bad_input : exit_failed);
  } catch (const std::exception& error) {
    return complain_of(error, exit_failed);
  }
}

}  // namespace

int main(int argc, char** argv) {
  ilaw::host::open_standard_streams();
  if (!ilaw::host::knows_instruction_set()) return ilaw::host::exit_bad_input;
  return ilaw::host::after_output(run_command(argc, argv));
}
