// SPDX-License-Identifier: BSD-3-Clause
#include "colours.hpp"

#include <algorithm>
#include <array>
#include <bit>

namespace ilaw::coupled {

void Colours::assign(const Contacts& contacts, std::int32_t group, const Bodies& bodies, Blocks& blocks,
                     std::vector<std::int32_t>& order) {
  sort(contacts, bodies);
  next_block_ = blocks.list().size();
  near_.clear();
  far_.clear();
  for (const std::int32_t k : sorted_) (contacts.is_out_of_reach(k, bodies) ? far_ : near_).push_back(k);
  add_blocks(near_, contacts, group, bodies, false, blocks, order);
  add_blocks(far_, contacts, group, bodies, true, blocks, order);
}

// By body, then by counterpart. Buckets are short: a body has few contacts.
void Colours::sort(const Contacts& contacts, const Bodies& bodies) {
  const auto count = static_cast<std::size_t>(contacts.count());
  const auto rank_of = [&](std::size_t k, std::uint32_t e) {
    return bodies.rank(contacts.end(static_cast<std::int64_t>(k), e));
  };
  sorted_.resize(count);
  start_.assign(static_cast<std::size_t>(bodies.count()) + 2, 0);
  for (std::size_t k = 0; k < count; ++k) ++start_[static_cast<std::size_t>(rank_of(k, 0)) + 1];
  for (std::size_t b = 1; b < start_.size(); ++b) start_[b] += start_[b - 1];
  for (std::size_t k = 0; k < count; ++k)
    sorted_[static_cast<std::size_t>(start_[static_cast<std::size_t>(rank_of(k, 0))]++)] =
        static_cast<std::int32_t>(k);
  const auto comes_first = [&](std::int32_t x, std::int32_t y) {
    const std::int32_t of_x = rank_of(static_cast<std::size_t>(x), contacts.body_count()),
                       of_y = rank_of(static_cast<std::size_t>(y), contacts.body_count());
    return of_x != of_y ? of_x < of_y : x < y;
  };
  std::int32_t first = 0;
  for (std::size_t b = 0; b + 1 < start_.size(); ++b) {
    std::sort(sorted_.begin() + first, sorted_.begin() + start_[b], comes_first);
    first = start_[b];
  }
}

void Colours::add_blocks(const std::vector<std::int32_t>& list, const Contacts& contacts, std::int32_t group,
                         const Bodies& bodies, bool asleep, Blocks& blocks,
                         std::vector<std::int32_t>& order) {
  if (list.empty()) return;
  used_.assign(static_cast<std::size_t>(bodies.count()) + 1, 0);
  for (std::size_t first = 0; first < list.size(); first += knobs::chunk) {
    const std::size_t count = std::min(knobs::chunk, list.size() - first);
    add_chunk(list.data() + first, count, contacts, group, bodies, blocks, order);
    for (; next_block_ < blocks.list().size(); ++next_block_) blocks.list()[next_block_].asleep = asleep;
    for (std::size_t i = first; i < first + count; ++i)
      for (std::uint32_t e = 0; e < contacts.ends(); ++e)
        used_[static_cast<std::size_t>(contacts.end(list[i], e))] = 0;
  }
}

void Colours::add_chunk(const std::int32_t* list, std::size_t count, const Contacts& contacts,
                        std::int32_t group, const Bodies& bodies, Blocks& blocks,
                        std::vector<std::int32_t>& order) {
  std::array<std::size_t, serial + 2> first{};
  colour_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    std::uint64_t taken = 0;
    for (std::uint32_t e = 0; e < contacts.ends(); ++e)
      if (const std::int32_t body = contacts.end(list[i], e); bodies.is_movable(body))
        taken |= used_[static_cast<std::size_t>(body)];
    const int colour = std::min(std::countr_one(taken), serial);
    for (std::uint32_t e = 0; e < contacts.ends(); ++e)
      used_[static_cast<std::size_t>(contacts.end(list[i], e))] |= std::uint64_t{1} << colour;
    colour_[i] = colour;
    ++first[static_cast<std::size_t>(colour) + 1];
  }
  for (std::size_t c = 1; c < first.size(); ++c) first[c] += first[c - 1];
  const std::size_t base = order.size();
  order.resize(base + count);
  std::array<std::size_t, serial + 2> next = first;
  for (std::size_t i = 0; i < count; ++i)
    order[base + next[static_cast<std::size_t>(colour_[i])]++] = list[i];
  for (std::size_t c = 0; c <= serial; ++c) {
    const std::size_t most = c == serial ? 1 : max_lanes;
    ++next_colour_;
    for (std::size_t at = first[c]; at < first[c + 1]; at += most) {
      if (c == serial) ++next_colour_;
      blocks.add(contacts.layout(), group, next_colour_, std::min(most, first[c + 1] - at)).order = base + at;
    }
  }
}

}  // namespace ilaw::coupled
