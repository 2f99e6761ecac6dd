// SPDX-License-Identifier: BSD-3-Clause
#include "cli/description.hpp"

#include "cli/child.hpp"

#include <ilaw/loader.hpp>

namespace ilaw::host {

nlohmann::json description_of(const std::string& name_or_path) {
  std::string text = ilaw::read_description(name_or_path);
  if (text.empty()) text = in_child([&] { return ilaw::library(name_or_path).describe(); });
  return nlohmann::json::parse(text);
}

}  // namespace ilaw::host
