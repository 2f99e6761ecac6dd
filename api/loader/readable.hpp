// readable.hpp - may an address that a library gave be read? Asked before reading it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string_view>

namespace ilaw::loading {

// Whether size bytes from address can be read without a fault.
bool readable(const void* address, std::size_t size);

// Whether text is null-terminated within readable memory and at most 64 KiB long.
bool readable_text(const char* text);

// Whether a text is UTF-8 without control characters (RFC 3629; a newline and a tab are none where it may
// have several lines): such a text cannot play tricks on the terminal or the file that it is written to.
bool clean_text(std::string_view text, bool lines_allowed);

}  // namespace ilaw::loading
