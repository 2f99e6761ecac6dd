// refusal.hpp - why a library or law is refused: a code of ilaw.h and one line for the user.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/ilaw.h>

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>

namespace ilaw::loading {

class refusal : public std::runtime_error {
 public:
  refusal(std::int32_t code, const std::string& text) : std::runtime_error(text), code_(code) {}
  std::int32_t code() const { return code_; }

 private:
  std::int32_t code_;
};

}  // namespace ilaw::loading
