// `ilaw list`: the laws of all libraries on the search path; a broken library is listed with its
// refusal.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/commands.hpp"

#include "base/exit_code.hpp"
#include "cli/terminal.hpp"

#include <ilaw/loader.hpp>

#include <cstdio>
#include <string>
#include <vector>

namespace ilaw::host {
namespace {

int list_laws() {
  std::printf("search path: %s\n", ilaw::search_path().c_str());
  std::vector<Row> rows;
  for (const std::string& file : ilaw::search()) {
    try {
      const ilaw::library library(file);
      const ilaw_plugin& plugin = library.plugin();
      for (std::uint32_t i = 0; i < plugin.law_count; ++i)
        rows.push_back({plugin.laws[i]->id, plugin.laws[i]->title,
                        std::string(plugin.name) + " " + plugin.version, file});
    } catch (const ilaw::error& error) {
      rows.push_back({"-", "refused: " + std::string(error.what())});
    }
  }
  print_rows(rows, "");
  return exit_done;
}

}  // namespace

void add_list(CLI::App& app, Action& chosen) {
  CLI::App* command = app.add_subcommand("list", "List the laws on the search path");
  command->footer("Example: ILAW_PATH=$HOME/my_laws ilaw list");
  command->callback([&chosen] { chosen = list_laws; });
}

}  // namespace ilaw::host
