// memory.hpp - the arrays of a batch, of doubles or floats, in any order; where they stand: on the heap, or
// each between pages that nobody may touch.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/ilaw.h>

#include <cstddef>
#include <cstdint>
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

inline constexpr double sentinel = 123456.75;
inline constexpr std::uint8_t status_sentinel = 99;

// backward: as interleaved, from the last number to the first, by negative strides.
enum class Order { interleaved, by_component, spread, backward };

// An array of nodes with some components each, of doubles or floats, between sentinels. spread: added to the
// node stride of Order::spread, so that arrays of one batch have different ones.
class Field {
 public:
  Field() = default;
  Field(Memory& memory, const char* name, std::size_t components, std::size_t room, Order order, Use use,
        ilaw_number_type numbers, std::size_t spread = 0);

  bool given() const { return values_ || floats_; }
  double get(std::size_t node, std::size_t component) const { return number(place(node, component)); }
  void put(std::size_t node, std::size_t component, double value);
  ilaw_input input() const;
  ilaw_output output() const;
  void clear();
  // Whether all that belongs to no node of the list still is as clear left it.
  bool is_untouched_beside(const std::vector<std::size_t>& nodes);
  const char* name() const { return name_; }
  std::size_t components() const { return components_; }

 private:
  template <class Array>
  Array array() const;
  std::size_t place(std::size_t node, std::size_t component) const {
    const std::size_t at = node * node_stride_ + component * component_stride_;
    return is_backward_ ? size_ - 1 - at : at;
  }
  std::int64_t stride(std::size_t forward) const {
    return is_backward_ ? -static_cast<std::int64_t>(forward) : static_cast<std::int64_t>(forward);
  }
  double number(std::size_t at) const { return floats_ ? double{floats_[at]} : values_[at]; }

  const char* name_ = "";
  double* values_ = nullptr;
  float* floats_ = nullptr;
  std::size_t components_ = 0, node_stride_ = 0, component_stride_ = 0, size_ = 0;
  bool is_backward_ = false;
};

}  // namespace ilaw::check
