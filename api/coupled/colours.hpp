// colours.hpp - contacts of a group in colors, so that no two of a color share a movable body and one call of
// the law can evaluate them at once.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "blocks.hpp"
#include "bodies.hpp"
#include "contacts.hpp"

#include <cstdint>
#include <vector>

namespace ilaw::coupled {

class Colours {
 public:
  // For the first group.
  void begin() { next_colour_ = 0; }
  // Adds the blocks of a group, and to `order` its contacts in the order of their lanes. Contacts are colored
  // in the order of their bodies' global numbers, whatever their order in the arrays.
  void assign(const Contacts& contacts, std::int32_t group, const Bodies& bodies, Blocks& blocks,
              std::vector<std::int32_t>& order);

 private:
  static constexpr int serial = knobs::serial_color;

  void sort(const Contacts& contacts, const Bodies& bodies);
  void add_blocks(const std::vector<std::int32_t>& list, const Contacts& contacts, std::int32_t group,
                  const Bodies& bodies, bool asleep, Blocks& blocks, std::vector<std::int32_t>& order);

  void add_chunk(const std::int32_t* list, std::size_t count, const Contacts& contacts, std::int32_t group,
                 const Bodies& bodies, Blocks& blocks, std::vector<std::int32_t>& order);

  std::int32_t next_colour_ = 0;  // blocks of one number may be joined
  std::size_t next_block_ = 0;
  std::vector<std::int32_t> sorted_, start_, near_, far_, colour_;
  std::vector<std::uint64_t> used_;  // per body, a bit per color
};

}  // namespace ilaw::coupled
