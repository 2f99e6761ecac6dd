// SPDX-License-Identifier: BSD-3-Clause
#include "cli/description.hpp"

#include "base/child_process.hpp"

#include <ilaw/loader.hpp>

#include <stdexcept>

namespace ilaw::host {
namespace {

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

}  // namespace

nlohmann::json description_of(const std::string& name_or_path) {
  const std::string text = ilaw::read_description(name_or_path);
  return nlohmann::json::parse(text.empty() ? describe_in_process(name_or_path) : text);
}

}  // namespace ilaw::host
