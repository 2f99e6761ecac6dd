// `ilaw list`: the laws of all libraries on the search path, from the JSON file beside each library; a
// library without one is opened in a process of its own. A broken library is listed with its refusal.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/commands.hpp"

#include "base/exit_code.hpp"
#include "cli/description.hpp"
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

int list_laws() {
  warn_of_search_path();
  std::printf("search path: %s\n", printable(ilaw::search_path()).c_str());
  std::vector<Row> rows;
  for (const std::string& file : ilaw::search()) {
    try {
      const json description = description_of(file);
      const auto text = [](const json& value) { return printable(value.get<std::string>()); };
      for (const json& law : description["laws"])
        rows.push_back({text(law["id"]), text(law["title"]),
                        text(description["name"]) + " " + text(description["version"]), printable(file)});
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

void add_list(CLI::App& app, int& code) {
  CLI::App* command = app.add_subcommand("list", "List the laws on the search path");
  command->footer("Example: ILAW_PATH=$HOME/my_laws ilaw list");
  command->callback([&code] { code = list_laws(); });
}

}  // namespace ilaw::host
