// SPDX-License-Identifier: BSD-3-Clause
#include "check/memory.hpp"

#include "check/sandbox.hpp"
#include "check/trial.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <new>

namespace ilaw::check {
namespace {

std::size_t page() { return static_cast<std::size_t>(sysconf(_SC_PAGESIZE)); }

}  // namespace

void* Heap::take(const char*, std::size_t bytes, Use) {
  blocks_.emplace_back(bytes / sizeof(double) + 1);
  return blocks_.back().data();
}

GuardedPages::~GuardedPages() {
  for (const Block& block : blocks_) munmap(block.begin, (block.pages + 2) * page());
}

void* GuardedPages::take(const char* name, std::size_t bytes, Use use) {
  if (use != guarded_) return plain_.take(name, bytes, use);
  const std::size_t pages = bytes / page() + 1;
  void* room = mmap(nullptr, (pages + 2) * page(), PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (room == MAP_FAILED) throw std::bad_alloc();
  char* const begin = static_cast<char*>(room);
  char* const data = flush_ == Flush::with_the_end ? begin + (pages + 1) * page() - bytes : begin + page();
  blocks_.push_back({begin, data, pages, bytes, name, use});
  protect(blocks_.back(), PROT_READ | PROT_WRITE);
  return data;
}

void GuardedPages::protect(const Block& block, int rights) const {
  mprotect(block.begin + page(), block.pages * page(), rights);
}

void GuardedPages::before_call() {
  current_ = this;
  describe_addresses_by(describe);
  for (const Block& block : blocks_)
    if (block.use != Use::output) protect(block, block.use == Use::input ? PROT_READ : PROT_NONE);
}

void GuardedPages::after_call() {
  for (const Block& block : blocks_) protect(block, PROT_READ | PROT_WRITE);
  describe_addresses_by(nullptr);
  current_ = nullptr;
}

// Called by the handler of a signal.
const char* GuardedPages::describe(const void* address) {
  static std::array<char, 120> text;
  const char* const at = static_cast<const char*>(address);
  for (const Block& block : current_->blocks_) {
    if (at < block.begin || at >= block.begin + (block.pages + 2) * page()) continue;
    const char* place = block.use == Use::unneeded       ? "not asked for: "
                        : at < block.data                ? "before the beginning of "
                        : at >= block.data + block.bytes ? "beyond the end of "
                                                         : "inside ";
    std::snprintf(text.data(), text.size(), "%sthe array %s", place, block.name);
    return text.data();
  }
  return nullptr;
}

Field::Field(Memory& memory, const char* name, std::size_t components, std::size_t room, Order order, Use use,
             ilaw_number_type numbers, std::size_t spread)
    : name_(name), components_(components), is_backward_(order == Order::backward) {
  node_stride_ = order == Order::by_component ? 1
                 : order == Order::spread     ? 2 * components + 1 + spread
                                              : components;
  component_stride_ = order == Order::by_component ? room + 3 : order == Order::spread ? 2 : 1;
  size_ = components == 0 ? 0 : (room - 1) * node_stride_ + (components - 1) * component_stride_ + 1;
  if (numbers == ILAW_NUMBERS_FLOAT)
    floats_ = static_cast<float*>(memory.take(name, size_ * sizeof(float), use));
  else
    values_ = static_cast<double*>(memory.take(name, size_ * sizeof(double), use));
  clear();
}

void Field::put(std::size_t node, std::size_t component, double value) {
  if (floats_)
    floats_[place(node, component)] = static_cast<float>(value);
  else
    values_[place(node, component)] = value;
}
template <class Array>
Array Field::array() const {
  const std::size_t first = size_ > 0 ? place(0, 0) : 0;
  return {values_ ? values_ + first : nullptr, floats_ ? floats_ + first : nullptr, stride(node_stride_),
          stride(component_stride_)};
}
ilaw_input Field::input() const { return array<ilaw_input>(); }
ilaw_output Field::output() const { return array<ilaw_output>(); }
void Field::clear() {
  if (floats_)
    std::fill_n(floats_, size_, static_cast<float>(sentinel));
  else
    std::fill_n(values_, size_, sentinel);
}

bool Field::is_untouched_beside(const std::vector<std::size_t>& nodes) {
  std::vector<bool> used(size_);
  for (const std::size_t node : nodes)
    for (std::size_t c = 0; c < components_; ++c) used[place(node, c)] = true;
  for (std::size_t k = 0; k < size_; ++k)
    if (!used[k] && !same_bits(number(k), sentinel)) return false;
  return true;
}

}  // namespace ilaw::check
