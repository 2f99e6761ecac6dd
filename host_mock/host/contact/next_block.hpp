// next_block.hpp - contacts that a step takes at once: as many as stay in the first caches.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "contact/block_step.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace ilaw::host {

constexpr std::ptrdiff_t block_size = 192;  // below 256: statuses are counted in bytes

// Whether values count up by one. Most often the last tells that they do not.
inline bool follow_each_other(const std::int32_t* values, std::ptrdiff_t count) {
  if (values[count - 1] - values[0] != count - 1) return false;
  std::int32_t difference = 0;
  for (std::ptrdiff_t i = 0; i < count; ++i)
    difference |= values[i] - values[0] - static_cast<std::int32_t>(i);
  return difference == 0;
}

struct Block {
  NearContacts contacts;
  bool in_row;  // they follow each other
};

// The contacts that make the next block: those that follow each other, where they are enough to be
// worth a call of the law; what does not is copied to and fro.
inline Block next_block(NearContacts contacts) {
  constexpr std::ptrdiff_t enough = 24;
  contacts.count = std::min(block_size, contacts.count);
  if (follow_each_other(contacts.index, contacts.count)) return {contacts, true};
  std::ptrdiff_t row = 1;
  while (contacts.index[row] == contacts.index[row - 1] + 1) ++row;
  if (row < enough) return {contacts, false};
  contacts.count = row;
  return {contacts, true};
}

}  // namespace ilaw::host
