// SPDX-License-Identifier: BSD-3-Clause
#include "check/memory.hpp"

#include "check/sandbox.hpp"

#include <sys/mman.h>
#include <unistd.h>

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

}  // namespace ilaw::check
