// SPDX-License-Identifier: BSD-3-Clause
#include "cli/child.hpp"

#include "base/child_process.hpp"

#include <ilaw/loader.hpp>

#include <stdexcept>

namespace ilaw::host {

// The first letter says whether the work returned or threw.
std::string in_child(const std::function<std::string()>& work) {
  constexpr unsigned max_seconds = 20;
  const ChildResult result = run_in_child(
      [&] {
        try {
          return "+" + work();
        } catch (const ilaw::error& error) {
          return std::string("-") + error.what();
        }
      },
      max_seconds);
  if (result.is_complete() && result.text.starts_with('+')) return result.text.substr(1);
  if (result.text.starts_with('-')) throw ilaw::error(ILAW_BAD_LIBRARY, result.text.substr(1));
  throw std::runtime_error("its code " + result.reason(max_seconds));
}

}  // namespace ilaw::host
