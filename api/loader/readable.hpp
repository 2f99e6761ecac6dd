// readable.hpp - may an address that a library gave be read? Asked before reading it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace ilaw::loading {

// Whether size bytes from address can be read without a fault.
bool readable(const void* address, std::size_t size);

// Whether text is null-terminated within readable memory and at most 64 KiB long.
bool readable_text(const char* text);

}  // namespace ilaw::loading
