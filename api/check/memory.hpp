// memory.hpp - where the arrays of a batch stand: on the heap, or each between pages that nobody may touch.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

namespace ilaw::check {

enum class Use { input, output, unneeded };

class Memory {
 public:
  Memory() = default;
  Memory(const Memory&) = delete;
  Memory& operator=(const Memory&) = delete;
  virtual ~Memory() = default;

  virtual void* take(const char* name, std::size_t bytes, Use use) = 0;
  // Around a call of the library.
  virtual void before_call() {}
  virtual void after_call() {}
};

class Heap : public Memory {
 public:
  void* take(const char* name, std::size_t bytes, Use use) override;

 private:
  std::vector<std::vector<double>> blocks_;
};

// Arrays flush with the page after them, or the one before. During a call nobody may write inputs nor read
// what is not needed.
class GuardedPages : public Memory {
 public:
  enum class Flush { with_the_end, with_the_beginning };
  // Arrays of this use; others are on the heap.
  GuardedPages(Flush flush, Use guarded) : flush_(flush), guarded_(guarded) {}
  ~GuardedPages() override;

  void* take(const char* name, std::size_t bytes, Use use) override;
  void before_call() override;
  void after_call() override;

 private:
  struct Block {
    char *begin, *data;  // of all pages, of the array
    std::size_t pages, bytes;
    const char* name;
    Use use;
  };
  static const char* describe(const void* address);
  void protect(const Block& block, int rights) const;

  Flush flush_;
  Use guarded_;
  std::vector<Block> blocks_;
  Heap plain_;
  static inline const GuardedPages* current_ = nullptr;
};

}  // namespace ilaw::check
