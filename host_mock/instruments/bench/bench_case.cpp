// SPDX-License-Identifier: BSD-3-Clause
#include "bench/bench_case.hpp"

#include "base/words.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <utility>

namespace ilaw::host {
namespace {

using nlohmann::json;

std::string short_text(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return {text.data(), end};
}

std::string text_of_parameter(const std::string& name, const json& value) {
  if (value.is_string()) return name + "=" + value.get<std::string>();
  if (value.is_number()) return name + "=" + short_text(value.get<double>());
  return name + (value.contains("per_node") ? " per node" : " in time");
}

std::string text_of_parameters(const json& parameters) {
  std::string text;
  for (const auto& [name, value] : parameters.items())
    text += (text.empty() ? "" : " ") + text_of_parameter(name, value);
  return text;
}

// The words of an entry, or the default.
std::vector<std::string> words_in(const json& entry, const BenchWords& option) {
  if (!entry.contains(option.key)) return {option.words.front()};
  const json& found = entry[option.key];
  auto words =
      found.is_string() ? std::vector{found.get<std::string>()} : found.get<std::vector<std::string>>();
  for (const std::string& word : words)
    if (std::find(option.words.begin(), option.words.end(), word) == option.words.end())
      throw InputError(std::string(option.key) + ": found '" + word + "', expected one of " +
                       joined(option.words));
  return words;
}

// A law with a '/' is the path of a library, as on the command line.
void read_law(const json& entry, BenchCase& bench_case) {
  bench_case.law = entry.value("law", "");
  bench_case.library = entry.value("library", bench_case.law);
  if (bench_case.law.find('/') == std::string::npos) return;
  if (entry.contains("library"))
    throw InputError("law: found '" + bench_case.law + "', expected the name of a law of 'library'");
  bench_case.law.clear();
}

}  // namespace

const std::vector<BenchWords>& bench_words() {
  static const std::vector<BenchWords> words = {
      {"delassus",
       &BenchCase::delassus,
       {"scalar", "diagonal", "transverse", "full", "transverse_spin"},
       "Form of H"},
      {"frame", &BenchCase::frame, {"local", "global"}, "Axes of vectors and H"},
      {"layout", &BenchCase::layout, {"aos", "soa"}, "Components of a vector side by side, or apart"},
      {"outputs",
       &BenchCase::outputs,
       {"none", "motion", "all"},
       "Optional outputs: none, motion (velocity and status) or all (energies, too)"}};
  return words;
}

std::uint32_t form_of(const BenchCase& bench_case) {
  if (bench_case.delassus == "diagonal") return ILAW_DELASSUS_DIAGONAL;
  if (bench_case.delassus == "transverse") return ILAW_DELASSUS_TRANSVERSE;
  if (bench_case.delassus == "transverse_spin") return ILAW_DELASSUS_TRANSVERSE_SPIN;
  return bench_case.delassus == "full" ? ILAW_DELASSUS_FULL : ILAW_DELASSUS_SCALAR;
}

std::string text_of(const BenchCase& bench_case) {
  const std::string named =
      bench_case.what.empty() ? text_of_parameters(bench_case.parameters) : bench_case.what;
  std::string text = named.empty() ? "" : named + "; ";
  text += bench_case.delassus + " H " + bench_case.frame + " " + bench_case.layout;
  if (bench_case.outputs != "none") text += " outputs " + bench_case.outputs;
  if (bench_case.floats) text += " float";
  return text;
}

std::vector<BenchEntry> read_bench_entries(const std::filesystem::path& file) try {
  std::ifstream stream(file);
  if (!stream) throw InputError("no such file, expected one of cases (JSON)");
  std::vector<BenchEntry> entries;
  const json sections = json::parse(stream);
  for (const json& given : sections.at("benchmarks")) {
    entries.push_back({given, file.string() + ": /benchmarks/" + std::to_string(entries.size()) + ": "});
    if (!given.contains("law") && !given.contains("library"))
      entries.back().given["law"] = std::filesystem::absolute(file).parent_path().filename().string();
  }
  return entries;
} catch (const std::exception& error) {
  throw InputError(file.string() + ": " + error.what());
}

std::vector<BenchCase> cases_of(const BenchEntry& entry) try {
  BenchCase base;
  base.where = entry.where;
  read_law(entry.given, base);
  base.what = entry.given.value("what", "");
  base.parameters = entry.given.value("parameters", json::object());
  base.floats = entry.given.value("float", false);
  std::vector<BenchCase> cases = {base};
  for (const BenchWords& option : bench_words()) {
    const std::vector<BenchCase> before = std::exchange(cases, {});
    for (const BenchCase& one : before)
      for (const std::string& word : words_in(entry.given, option)) {
        cases.push_back(one);
        cases.back().*option.member = word;
      }
  }
  return cases;
} catch (const json::exception& error) {
  throw InputError(entry.where + error.what());
} catch (const InputError& refusal) {
  throw InputError(entry.where + refusal.what());
}

}  // namespace ilaw::host
