// SPDX-License-Identifier: BSD-3-Clause
#include "blocks.hpp"

#include <algorithm>

namespace ilaw::coupled {

namespace {

std::size_t stride_of(std::size_t count) { return (count + 7) / 8 * 8 + (count > max_lanes / 2 ? 8 : 0); }

}  // namespace

Block& Blocks::add(const Layout& layout, std::int32_t group, std::int32_t colour, std::size_t count) {
  Block& block = blocks_.emplace_back();
  block.layout = &layout;
  block.group = group;
  block.colour = colour;
  block.count = count;
  block.stride = stride_of(count);
  return block;
}

void Blocks::allocate() {
  std::size_t values = 8, integers = 0, bytes = 0;
  for (const Block& block : blocks_) {
    const Layout& layout = *block.layout;
    values += block.stride * static_cast<std::size_t>(layout.columns);
    integers += block.stride * static_cast<std::size_t>(layout.ends + 1);
    bytes += 2 * block.stride;
  }
  size_ = values;
  if (values_.size() < values) values_.resize(values + values / 4);
  if (integers_.size() < integers) integers_.resize(integers + integers / 4);
  if (bytes_.size() < bytes) bytes_.resize(bytes + bytes / 4);
  const auto misaligned = reinterpret_cast<std::uintptr_t>(values_.data()) % 64;
  double* next = values_.data() + (misaligned ? (64 - misaligned) / sizeof(double) : 0);
  std::int32_t* next_integer = integers_.data();
  std::uint8_t* next_byte = bytes_.data();
  for (Block& block : blocks_) {
    const Layout& layout = *block.layout;
    block.values = next;
    block.ends = next_integer;
    block.contact = next_integer + block.stride * static_cast<std::size_t>(layout.ends);
    block.status = next_byte;
    block.broken = next_byte + block.stride;
    // Unused lanes take part in loops over columns.
    for (int c = 0; c < layout.columns; ++c)
      std::fill(block.column(c) + block.count, block.column(c) + block.stride, 0.0);
    std::fill(block.status, block.status + 2 * block.stride, std::uint8_t{0});
    next += block.stride * static_cast<std::size_t>(layout.columns);
    next_integer += block.stride * static_cast<std::size_t>(layout.ends + 1);
    next_byte += 2 * block.stride;
  }
}

void Blocks::select(const Blocks& from, std::span<const Lane> lanes) {
  clear();
  origins_ = lanes;
  for (const Lane& lane : lanes) {
    const Block& source = from.blocks_[static_cast<std::size_t>(lane.block)];
    const bool fits = !blocks_.empty() && blocks_.back().group == source.group &&
                      blocks_.back().colour == source.colour && blocks_.back().count < max_lanes &&
                      blocks_.back().asleep == source.asleep;
    if (!fits) add(*source.layout, source.group, source.colour, 0).asleep = source.asleep;
    ++blocks_.back().count;
  }
  for (Block& block : blocks_) block.stride = stride_of(block.count);
  allocate();
  auto origin = origins_.begin();
  for (Block& block : blocks_) {
    const Layout& layout = *block.layout;
    for (std::size_t lane = 0; lane < block.count; ++lane, ++origin) {
      const Block& source = from.blocks_[static_cast<std::size_t>(origin->block)];
      const auto at = static_cast<std::size_t>(origin->lane);
      for (int c = 0; c < layout.columns; ++c) block.column(c)[lane] = source.column(c)[at];
      for (std::size_t e = 0; e < static_cast<std::size_t>(layout.ends); ++e)
        block.ends[e * block.stride + lane] = source.ends[e * source.stride + at];
      block.contact[lane] = source.contact[at];
      block.status[lane] = source.status[at];
      block.broken[lane] = source.broken[at];
      block.has_broken = block.has_broken || source.broken[at] != 0;
    }
  }
}

void Blocks::give_back(Blocks& to) const {
  auto origin = origins_.begin();
  for (const Block& block : blocks_) {
    const Layout& layout = *block.layout;
    for (std::size_t lane = 0; lane < block.count; ++lane, ++origin) {
      Block& target = to.blocks_[static_cast<std::size_t>(origin->block)];
      const auto at = static_cast<std::size_t>(origin->lane);
      for (const int first : {layout.impulse, layout.change, layout.asked})
        for (int c = first; c < first + layout.width; ++c) target.column(c)[at] = block.column(c)[lane];
      for (int c = 0; c < layout.state_size; ++c)
        target.column(layout.state_out + c)[at] = block.column(layout.state_out + c)[lane];
      target.status[at] = block.status[lane];
      target.broken[at] = block.broken[lane];
      target.has_broken = target.has_broken || block.broken[lane] != 0;
      target.asleep = target.asleep && block.asleep;
      if (!block.is_refused) continue;
      target.is_refused = true;
      target.reason = block.reason;
    }
  }
}

}  // namespace ilaw::coupled
