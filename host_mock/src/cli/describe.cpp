// `ilaw describe`: all laws of a library, found by law name or file, as text or JSON.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/commands.hpp"

#include "base/exit_code.hpp"
#include "base/words.hpp"
#include "cli/child.hpp"
#include "cli/terminal.hpp"

#include <ilaw/loader.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace ilaw::host {
namespace {

using nlohmann::json;

constexpr auto replace = json::error_handler_t::replace;  // names of files need not be UTF-8

struct Bit {
  std::uint32_t value;
  const char* name;
};
constexpr Bit dimension_bits[] = {{ILAW_DIMENSION_1, "1"}, {ILAW_DIMENSION_2, "2"}, {ILAW_DIMENSION_3, "3"}};
constexpr Bit form_bits[] = {{ILAW_DELASSUS_SCALAR, "scalar"},
                             {ILAW_DELASSUS_DIAGONAL, "diagonal"},
                             {ILAW_DELASSUS_FULL, "full"},
                             {ILAW_DELASSUS_TRANSVERSE, "transverse"}};
constexpr Bit input_bits[] = {{ILAW_INPUT_GAP, "gap"},
                              {ILAW_INPUT_V_PREVIOUS, "v_previous"},
                              {ILAW_INPUT_AREA, "area"},
                              {ILAW_INPUT_NORMAL, "normal"},
                              {ILAW_INPUT_TANGENT, "tangent"}};
constexpr Bit capability_bits[] = {{ILAW_CAN_ADHERE, "adhere"},
                                   {ILAW_CAN_STORE_ENERGY, "store_energy"},
                                   {ILAW_CAN_ACT_AT_DISTANCE, "act_at_distance"},
                                   {ILAW_CAN_REST, "rest"}};
constexpr Bit varying_bits[] = {{ILAW_MAY_BE_TABLE, "table"}, {ILAW_MAY_BE_PER_NODE, "per_node"}};
constexpr const char* state_kinds[] = {"scalar", "vector", "history", "axis", "tangential"};

template <std::size_t N>
json names_of(std::uint32_t mask, const Bit (&bits)[N]) {
  json names = json::array();
  for (const Bit& bit : bits)
    if (mask & bit.value) names.push_back(bit.name);
  return names;
}

json number_or_inf(double value) { return std::isinf(value) ? json("inf") : json(value); }

json describe_parameter(const ilaw_parameter& p) {
  json out = {{"name", p.name}, {"symbol", p.symbol},          {"unit", p.unit},
              {"doc", p.doc},   {"required", p.required != 0}, {"may_be", names_of(p.may_be, varying_bits)}};
  if (p.kind == ILAW_PARAMETER_CHOICE) {
    out["choices"] = std::vector<std::string>(p.choices, p.choices + p.choice_count);
    if (!p.required) out["default"] = p.choices[static_cast<std::size_t>(p.default_value)];
    return out;
  }
  out["kind"] = p.kind == ILAW_PARAMETER_COUNT ? "whole number" : "number";
  out["minimum"] = p.minimum;
  out["minimum_excluded"] = p.minimum_excluded != 0;
  const bool unbounded = p.maximum == std::numeric_limits<double>::max();
  out["maximum"] = unbounded ? json("inf") : json(p.maximum);
  out["infinity_allowed"] = p.infinity_allowed != 0;
  if (!p.required) out["default"] = number_or_inf(p.default_value);
  return out;
}

json describe_law(const ilaw_law& law) {
  json out = {{"id", law.id},
              {"title", law.title},
              {"doc", law.doc},
              {"references", std::vector<std::string>(law.references, law.references + law.reference_count)},
              {"dimensions", names_of(law.dimensions, dimension_bits)},
              {"delassus_forms", names_of(law.delassus_forms, form_bits)},
              {"inputs", names_of(law.inputs, input_bits)},
              {"capabilities", names_of(law.capabilities, capability_bits)},
              {"parameters", json::array()},
              {"state", json::array()}};
  for (std::uint32_t i = 0; i < law.parameter_count; ++i)
    out["parameters"].push_back(describe_parameter(*law.parameters[i]));
  for (std::uint32_t i = 0; i < law.state_variable_count; ++i) {
    const ilaw_state_variable& v = *law.state_variables[i];
    const char* kind = v.kind < std::size(state_kinds) ? state_kinds[v.kind] : "unknown";
    const bool internal = (v.flags & ILAW_VARIABLE_INTERNAL) != 0;
    out["state"].push_back(
        {{"name", v.name}, {"unit", v.unit}, {"doc", v.doc}, {"kind", kind}, {"internal", internal}});
  }
  return out;
}

json describe_library(const ilaw::library& library) {
  const ilaw_plugin& plugin = library.plugin();
  json out = {{"file", library.path()},    {"name", plugin.name},
              {"version", plugin.version}, {"vendor", plugin.vendor},
              {"licence", plugin.licence}, {"abi", {plugin.abi_major, plugin.abi_minor}},
              {"laws", json::array()}};
  for (std::uint32_t i = 0; i < plugin.law_count; ++i) out["laws"].push_back(describe_law(*plugin.laws[i]));
  return out;
}

std::string unquoted(const json& value) {
  return value.is_string() ? value.get<std::string>() : value.dump();
}

std::string listed(const json& values) {
  std::vector<std::string> words;
  for (const json& value : values) words.push_back(unquoted(value));
  return joined(words);
}

std::string range_of(const json& p) {
  if (p.contains("choices")) return "one of " + listed(p["choices"]);
  const bool closed = p["infinity_allowed"].get<bool>() || p["maximum"] != "inf";
  return std::string(p["minimum_excluded"].get<bool>() ? "(" : "[") + unquoted(p["minimum"]) + ", " +
         unquoted(p["infinity_allowed"].get<bool>() ? json("inf") : p["maximum"]) + (closed ? "]" : ")");
}

Row row_of_parameter(const json& p) {
  return {unquoted(p["name"]),
          unquoted(p["unit"]),
          range_of(p),
          p["required"].get<bool>() ? "required" : "default " + unquoted(p["default"]),
          p["may_be"].empty() ? "constant" : "or " + listed(p["may_be"]),
          unquoted(p["doc"])};
}

void print_law(const json& law) {
  std::printf("\n%s - %s\n  %s\n", unquoted(law["id"]).c_str(), unquoted(law["title"]).c_str(),
              unquoted(law["doc"]).c_str());
  std::printf("  dimensions: %s; H: %s; may read: %s\n", listed(law["dimensions"]).c_str(),
              listed(law["delassus_forms"]).c_str(), listed(law["inputs"]).c_str());
  if (!law["capabilities"].empty()) std::printf("  can: %s\n", listed(law["capabilities"]).c_str());
  std::printf("  parameters:\n");
  std::vector<Row> rows;
  for (const json& p : law["parameters"]) rows.push_back(row_of_parameter(p));
  print_rows(rows, "    ");
  rows.clear();
  for (const json& v : law["state"])
    rows.push_back({unquoted(v["name"]), unquoted(v["unit"]),
                    unquoted(v["kind"]) + (v["internal"].get<bool>() ? ", internal" : ""),
                    unquoted(v["doc"])});
  if (!rows.empty()) std::printf("  state:\n");
  print_rows(rows, "    ");
  std::printf("  references:\n");
  for (const json& reference : law["references"]) std::printf("    %s\n", unquoted(reference).c_str());
}

int describe(const std::string& law_or_file, bool as_json) {
  try {
    warn_of_search_path();
    const json description = json::parse(
        in_child([&] { return describe_library(ilaw::library(law_or_file)).dump(-1, ' ', false, replace); }));
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
  } catch (const ilaw::error& error) {
    complain(error.what());
    return exit_bad_input;
  } catch (const std::runtime_error& error) {
    complain("library '" + law_or_file + "': " + error.what());
    return exit_failed;
  }
}

}  // namespace

void add_describe(CLI::App& app, Action& chosen) {
  struct Options {
    std::string law;
    bool as_json = false;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("describe", "Describe a law: parameters, state, references");
  command->add_option("law", options->law, "Name of a law, or path of a library")->required();
  command->add_flag("--json", options->as_json, "Print JSON");
  command->footer("Example: ilaw describe coulomb --json");
  command->callback(
      [options, &chosen] { chosen = [options] { return describe(options->law, options->as_json); }; });
}

}  // namespace ilaw::host
