// SPDX-License-Identifier: BSD-3-Clause
#include "bench/bench_case.hpp"

#include "base/words.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>

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

void check_word(const BenchWords& option, const std::string& word) {
  if (std::find(option.words.begin(), option.words.end(), word) != option.words.end()) return;
  throw InputError(std::string(option.key) + ": found '" + word + "', expected one of " +
                   joined(option.words));
}

std::vector<std::string> words_in(const json& entry, const char* key) {
  if (!entry.contains(key)) return {};
  const json& found = entry[key];
  if (found.is_string()) return {found.get<std::string>()};
  std::vector<std::string> words;
  for (const json& word : found) words.push_back(word.get<std::string>());
  return words;
}

double share_in(const json& entry, const char* key, double usual) {
  const double share = entry.value(key, usual);
  if (share >= 0.0 && share <= 1.0) return share;
  throw InputError(std::string(key) + ": found " + short_text(share) + ", expected a number from 0 to 1");
}

// A law with a '/' is the path of a library, as on the command line.
void read_law(const json& entry, const std::string& law_of_folder, BenchCase& bench_case) {
  bench_case.law = entry.value("law", entry.contains("library") ? "" : law_of_folder);
  bench_case.library = entry.value("library", bench_case.law);
  if (bench_case.law.find('/') == std::string::npos) return;
  if (entry.contains("library"))
    throw InputError("law: found '" + bench_case.law + "', expected the name of a law of 'library'");
  bench_case.law.clear();
}

std::vector<BenchCase> cases_of_entry(const json& entry, const std::string& law_of_folder) {
  BenchCase base;
  read_law(entry, law_of_folder, base);
  base.what = entry.value("what", "");
  base.parameters = entry.value("parameters", json::object());
  base.touching = share_in(entry, "touching", base.touching);
  base.pressed = share_in(entry, "pressed", base.pressed);
  std::vector<std::vector<std::string>> words;
  for (const BenchWords& option : bench_words()) words.push_back(words_in(entry, option.key));
  return combinations(base, words);
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
  if (bench_case.touching != 0.5) text += " touching " + short_text(bench_case.touching);
  if (bench_case.pressed != 0.5) text += " pressed " + short_text(bench_case.pressed);
  if (bench_case.floats) text += " float";
  return text;
}

std::vector<BenchCase> combinations(const BenchCase& base,
                                    const std::vector<std::vector<std::string>>& words_of_options) {
  std::vector<BenchCase> cases = {base};
  for (std::size_t k = 0; k < words_of_options.size(); ++k) {
    if (words_of_options[k].empty()) continue;
    const BenchWords& option = bench_words()[k];
    std::vector<BenchCase> more;
    for (const BenchCase& one : cases)
      for (const std::string& word : words_of_options[k]) {
        check_word(option, word);
        more.push_back(one);
        more.back().*option.member = word;
      }
    cases = std::move(more);
  }
  return cases;
}

std::vector<BenchCase> read_bench_cases(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) throw InputError(file.string() + ": no such file, expected one of cases (JSON)");
  std::string where = file.string() + ": ";
  try {
    const std::string law = std::filesystem::absolute(file).parent_path().filename();
    std::vector<BenchCase> cases;
    const json sections = json::parse(stream);
    const json& entries = sections.at("benchmarks");
    for (std::size_t k = 0; k < entries.size(); ++k) {
      where = file.string() + ": /benchmarks/" + std::to_string(k) + ": ";
      for (BenchCase& one : cases_of_entry(entries.at(k), law)) {
        one.entry = where;
        cases.push_back(std::move(one));
      }
    }
    return cases;
  } catch (const json::exception& error) {
    throw InputError(where + error.what());
  } catch (const InputError& refusal) {
    throw InputError(where + refusal.what());
  }
}

}  // namespace ilaw::host
