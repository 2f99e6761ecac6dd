// SPDX-License-Identifier: BSD-3-Clause
#include "readable.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>

namespace ilaw::loading {
namespace {

// Length of the UTF-8 sequence at the start of a text, and its character; 0 where there is none.
std::size_t sequence(std::string_view text, std::uint32_t& character) {
  const auto byte = [&text](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned first = byte(0);
  const std::size_t length = first < 0x80       ? 1
                             : first >> 5 == 6  ? 2
                             : first >> 4 == 14 ? 3
                             : first >> 3 == 30 ? 4
                                                : 0;
  if (length == 0 || length > text.size()) return 0;
  character = length == 1 ? first : first & (0xFFU >> (length + 1));
  for (std::size_t i = 1; i < length; ++i) {
    if (byte(i) >> 6 != 2) return 0;
    character = character << 6 | (byte(i) & 0x3FU);
  }
  constexpr std::uint32_t smallest[] = {0, 0, 0x80, 0x800, 0x10000};
  const bool surrogate = character >= 0xD800 && character <= 0xDFFF;
  return character < smallest[length] || character > 0x10FFFF || surrogate ? 0 : length;
}

}  // namespace

bool readable_text(const char* text) {
  constexpr std::size_t longest = 65536, page = 4096;  // no smaller page is known
  std::size_t known = 0;
  while (known < longest) {
    const auto at = reinterpret_cast<std::uintptr_t>(text) + known;
    const std::size_t chunk = std::min<std::size_t>(page - (at & (page - 1)), longest - known);
    if (!readable(text + known, chunk)) return false;
    if (std::memchr(text + known, '\0', chunk)) return true;
    known += chunk;
  }
  return false;
}

bool clean_text(std::string_view text, bool lines_allowed) {
  while (!text.empty()) {
    std::uint32_t character = 0;
    const std::size_t length = sequence(text, character);
    if (length == 0) return false;
    const bool control = character < 0x20 || (character >= 0x7F && character < 0xA0);
    if (control && !(lines_allowed && (character == '\n' || character == '\t'))) return false;
    text.remove_prefix(length);
  }
  return true;
}

}  // namespace ilaw::loading
