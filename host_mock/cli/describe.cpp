// `ilaw list`: the laws of all libraries on the search path; a broken library is listed with its refusal.
// `ilaw describe`: all laws of a library, found by law name or file, as text or JSON.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/commands.hpp"

#include "base/child_process.hpp"
#include "base/exit_code.hpp"
#include "base/words.hpp"
#include "cli/terminal.hpp"

#include <ilaw/loader.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

namespace ilaw::host {
namespace {

using nlohmann::json;

// Whatever code of the library does, the program goes on.
std::string describe_in_process(const std::string& name_or_path) {
  constexpr unsigned max_seconds = 20;
  try {
    return result_in_process([&] { return ilaw::library(name_or_path).describe(); }, max_seconds);
  } catch (const ProcessEnded& ended) {
    throw std::runtime_error(std::string("its code ") + ended.what());
  } catch (const std::runtime_error& error) {
    throw ilaw::error(ILAW_BAD_LIBRARY, error.what());
  }
}

// The JSON beside the library, without running any of its code; a library without such a file is opened in a
// process of its own.
json description_of(const std::string& name_or_path) {
  const std::string text = ilaw::read_description(name_or_path);
  return json::parse(text.empty() ? describe_in_process(name_or_path) : text);
}

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

std::string unquoted(const json& value) {
  return value.is_string() ? value.get<std::string>() : value.dump();
}

std::string listed(const json& values) {
  std::vector<std::string> words;
  for (const json& value : values) words.push_back(unquoted(value));
  return joined(words);
}

bool has(const json& names, const char* name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string range_of(const json& p) {
  if (p["kind"] == "choice") return "one of " + listed(p["choices"]);
  const bool infinite = has(p["flags"], "allows_infinity");
  const bool closed = infinite || p["maximum"] != "inf";
  return std::string(has(p["flags"], "excludes_minimum") ? "(" : "[") + unquoted(p["minimum"]) + ", " +
         unquoted(infinite ? json("inf") : p["maximum"]) + (closed ? "]" : ")");
}

// How else than as a constant the value may be given.
std::string varying(const json& p) {
  std::vector<std::string> ways;
  if (has(p["flags"], "field")) ways.push_back("field");
  if (has(p["flags"], "allows_per_node")) ways.push_back("per_node");
  if (!p["axes"].empty()) ways.push_back("table over " + listed(p["axes"]));
  const char* condition = has(p["flags"], "needs_spins") ? "; needs spins" : "";
  return (ways.empty() ? "constant" : "or " + joined(ways)) + condition;
}

Row row_of_parameter(const json& p) {
  const bool required = has(p["flags"], "required");
  return {unquoted(p["name"]), unquoted(p["unit"]),
          range_of(p),         required ? "required" : "default " + unquoted(p["default"]),
          varying(p),          unquoted(p["doc"])};
}

void print_law(const json& law) {
  std::printf("\n%s - %s\n  %s\n", unquoted(law["id"]).c_str(), unquoted(law["title"]).c_str(),
              unquoted(law["doc"]).c_str());
  std::printf("  dimensions: %s; H: %s; frames: %s; numbers: %s; may read: %s\n",
              listed(law["dimensions"]).c_str(), listed(law["delassus_forms"]).c_str(),
              listed(law["frames"]).c_str(), listed(law["numbers"]).c_str(), listed(law["inputs"]).c_str());
  if (!law["capabilities"].empty()) std::printf("  can: %s\n", listed(law["capabilities"]).c_str());
  if (!law["permissions"].empty()) std::printf("  the host may: %s\n", listed(law["permissions"]).c_str());
  std::printf("  parameters:\n");
  std::vector<Row> rows;
  for (const json& p : law["parameters"]) rows.push_back(row_of_parameter(p));
  print_rows(rows, "    ");
  rows.clear();
  for (const json& v : law["state_variables"])
    rows.push_back({unquoted(v["name"]), unquoted(v["unit"]),
                    unquoted(v["kind"]) + (has(v["flags"], "internal") ? ", internal" : ""),
                    unquoted(v["doc"])});
  if (!rows.empty()) std::printf("  state:\n");
  print_rows(rows, "    ");
  rows.clear();
  for (const json& a : law["amounts"])
    rows.push_back({unquoted(a["name"]), unquoted(a["unit"]), unquoted(a["doc"])});
  if (!rows.empty()) std::printf("  amounts:\n");
  print_rows(rows, "    ");
  std::printf("  references:\n");
  for (const json& reference : law["references"]) std::printf("    %s\n", unquoted(reference).c_str());
}

int describe(const std::string& law_or_file, bool as_json) {
  try {
    warn_of_search_path();
    const json description = description_of(law_or_file);
    if (as_json) {
      std::printf("%s\n", description.dump(2).c_str());
      return exit_done;
    }
    const auto text = [&](const char* key) { return unquoted(description[key]); };
    std::printf("%s %s (%s, %s), ABI %s.%s\n%s\n", text("name").c_str(), text("version").c_str(),
                text("vendor").c_str(), text("licence").c_str(), description["abi"][0].dump().c_str(),
                description["abi"][1].dump().c_str(), printable(text("file")).c_str());
    for (const json& law : description["laws"]) print_law(law);
    return exit_done;
  } catch (const ilaw::error&) {
    throw;
  } catch (const std::runtime_error& error) {
    throw std::runtime_error("library '" + law_or_file + "': " + error.what());
  }
}

}  // namespace

void add_list(CLI::App& app, int& code) {
  CLI::App* command = app.add_subcommand("list", "List the laws on the search path");
  command->footer("Example: ILAW_PATH=$HOME/my_laws ilaw list");
  command->callback([&code] { code = list_laws(); });
}

void add_describe(CLI::App& app, int& code) {
  struct Options {
    std::string law;
    bool as_json = false;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("describe", "Describe a law: parameters, state, references");
  command->add_option("law", options->law, "Name of a law, or path of a library")->required();
  command->add_flag("--json", options->as_json, "Print JSON");
  command->footer("Example: ilaw describe coulomb --json");
  command->callback([options, &code] { code = describe(options->law, options->as_json); });
}

}  // namespace ilaw::host
