// SPDX-License-Identifier: BSD-3-Clause
#include "results/expectations.hpp"

#include "base/words.hpp"
#include "results/quantities.hpp"
#include "scene/json_text.hpp"

#include <algorithm>
#include <cmath>

namespace ilaw::host {

using nlohmann::json;

namespace {

// "inf" is how a summary writes infinity; a text of another kind is no quantity. A time that has not come
// is null.
bool is_quantity(const json& value) { return value.is_number() || value.is_null() || value == "inf"; }

double number_named(const std::string& name, const json& summary, const std::filesystem::path& folder) {
  const std::map<std::string, json> numbers = numbers_of(summary);
  const auto found = numbers.find(name);
  if (found == numbers.end()) return value_of(history_quantity(name), folder).value_or(std::nan(""));
  if (found->second.is_null()) return std::nan("");
  return found->second.is_number() ? found->second.get<double>() : HUGE_VAL;
}

}  // namespace

void check_expectations(const json& expected, const json& summary, const std::vector<std::string>& columns) {
  std::vector<std::string> numbers;
  for (const auto& [name, value] : numbers_of(summary))
    if (is_quantity(value)) numbers.push_back(name);
  const auto has = [](const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  for (std::size_t k = 0; k < expected.size(); ++k) {
    const std::string name = expected[k]["what"], column = name.substr(0, name.rfind(':'));
    if (has(numbers, name)) continue;
    if (!has(columns, column)) {
      std::vector<std::string> all = numbers;
      all.insert(all.end(), columns.begin(), columns.end());
      throw mistake(at("/expect", k) + "/what", "'" + name + "'",
                    "a number of summary.json, one of " + joined(numbers) +
                        "; or a column of history.csv, one of " + joined(columns) + suggestion(column, all));
    }
    history_quantity(name);  // refuses a kind that there is not
  }
}

json judge_expectations(const json& expected, const json& summary, const std::filesystem::path& folder) {
  json judged = expected;
  for (json& one : judged) {
    const double found = number_named(one["what"], summary, folder);
    one["found"] = found;
    one["within"] = std::abs(found - one["value"].get<double>()) <= one["tolerance"].get<double>();
  }
  return judged;
}

std::string describe_judged(const json& judged) {
  const json& found = judged["found"];
  return judged["what"].get<std::string>() + ": expected " + in_digits(judged["value"], 9) + " to " +
         in_digits(judged["tolerance"], 3) + ", found " +
         in_digits(found.is_number() ? found.get<double>() : std::nan(""), 9);
}

}  // namespace ilaw::host
