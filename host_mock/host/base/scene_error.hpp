// scene_error.hpp - a mistake in a scene, and where it stands.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>

namespace ilaw::host {

// A mistake in a scene: JSON pointer, what was found, what is allowed. Without pointer: one of the
// whole file.
class SceneError : public std::runtime_error {
 public:
  explicit SceneError(const std::string& found_and_expected) : std::runtime_error(found_and_expected) {}
  SceneError(const std::string& pointer, const std::string& found_and_expected)
      : std::runtime_error((pointer.empty() ? "/" : pointer) + ": " + found_and_expected) {}
};

}  // namespace ilaw::host
