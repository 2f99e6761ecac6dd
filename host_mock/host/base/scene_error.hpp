// scene_error.hpp - bad input, and where it stands in a scene.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>

namespace ilaw::host {

// Bad input, found before anything ran.
class InputError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

// A mistake in a scene: JSON pointer, what was found, what is allowed. Without pointer: one of the
// whole file.
class SceneError : public InputError {
 public:
  explicit SceneError(const std::string& found_and_expected) : InputError(found_and_expected) {}
  SceneError(const std::string& pointer, const std::string& found_and_expected)
      : InputError((pointer.empty() ? "/" : pointer) + ": " + found_and_expected) {}
};

}  // namespace ilaw::host
