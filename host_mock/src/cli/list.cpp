// `ilaw list`: the laws of all libraries on the search path; a broken library is listed with its
// refusal.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/commands.hpp"

#include "base/exit_code.hpp"
#include "cli/child.hpp"
#include "cli/terminal.hpp"

#include <ilaw/loader.hpp>

#include <nlohmann/json.hpp>

#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

namespace ilaw::host {
namespace {

using nlohmann::json;

// A row per law.
json laws_of(const std::string& file) {
  const ilaw::library library(file);
  const ilaw_plugin& plugin = library.plugin();
  json rows = json::array();
  for (std::uint32_t i = 0; i < plugin.law_count; ++i)
    rows.push_back({plugin.laws[i]->id, plugin.laws[i]->title,
                    std::string(plugin.name) + " " + plugin.version, printable(file)});
  return rows;
}

int list_laws() {
  warn_of_search_path();
  std::printf("search path: %s\n", printable(ilaw::search_path()).c_str());
  std::vector<Row> rows;
  for (const std::string& file : ilaw::search()) {
    try {
      const std::string laws =
          in_child([&file] { return laws_of(file).dump(-1, ' ', false, json::error_handler_t::replace); });
      for (const json& law : json::parse(laws)) rows.push_back(law.get<Row>());
    } catch (const ilaw::error& error) {
      rows.push_back({"-", "refused: " + printable(error.what())});
    } catch (const std::runtime_error& error) {
      rows.push_back({"-", "refused: " + printable(file) + ": " + error.what()});
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
