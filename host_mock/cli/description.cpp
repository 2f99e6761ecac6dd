// SPDX-License-Identifier: BSD-3-Clause
#include "cli/description.hpp"

#include "base/child_process.hpp"

#include <ilaw/loader.hpp>

#include <stdexcept>

namespace ilaw::host {
namespace {

// Whatever code of the library does, the program goes on. The first letter says whether it can be described.
std::string describe_in_child(const std::string& name_or_path) {
  constexpr unsigned max_seconds = 20;
  const ChildResult result = run_in_child(
      [&] {
        try {
          return "+" + ilaw::library(name_or_path).describe();
        } catch (const ilaw::error& error) {
          return std::string("-") + error.what();
        }
      },
      max_seconds);
  if (result.is_complete() && result.text.starts_with('+')) return result.text.substr(1);
  if (result.text.starts_with('-')) throw ilaw::error(ILAW_BAD_LIBRARY, result.text.substr(1));
  throw std::runtime_error("its code " + result.reason(max_seconds));
}

}  // namespace

nlohmann::json description_of(const std::string& name_or_path) {
  const std::string text = ilaw::read_description(name_or_path);
  return nlohmann::json::parse(text.empty() ? describe_in_child(name_or_path) : text);
}

}  // namespace ilaw::host
