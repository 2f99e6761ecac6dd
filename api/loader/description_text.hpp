// description_text.hpp - a description as JSON text. Written by hand: nlohmann's writer needs a newer glibc
// and C++ library than the loader may.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/ilaw.h>

#include <string>
#include <string_view>

namespace ilaw::loading {

inline constexpr const char* description_format = "ilaw-description/1";

// Names of bits and kinds of newer minor versions are left out (a kind is null). Members that later minor
// versions append are to be written only where they are not zero: an older library has none.
std::string description_text(const ilaw_plugin& plugin);

// A JSON text and number; infinity is "inf", all digits are kept.
std::string quoted_text(std::string_view text);
std::string number_text(double value);

}  // namespace ilaw::loading
