// SPDX-License-Identifier: BSD-3-Clause
#include "readable.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstring>

namespace ilaw::loading {
namespace {

// The kernel copies into a pipe what it can read, and answers EFAULT instead of raising a signal.
class probe {
 public:
  probe() : open_(pipe2(ends_, O_CLOEXEC | O_NONBLOCK) == 0) {}
  ~probe() {
    if (!open_) return;
    close(ends_[0]);
    close(ends_[1]);
  }
  probe(const probe&) = delete;
  probe& operator=(const probe&) = delete;

  // Without a pipe (no descriptors left) addresses are taken on trust.
  bool can_read(const char* address) {
    if (!open_) return true;
    if (write(ends_[1], address, 1) != 1) return false;
    char drained = 0;
    return read(ends_[0], &drained, 1) == 1;
  }

 private:
  int ends_[2] = {-1, -1};
  bool open_;
};

std::uintptr_t page_size() {
  static const auto size = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  return size;
}

}  // namespace

bool readable(const void* address, std::size_t size) {
  const auto first = reinterpret_cast<std::uintptr_t>(address);
  if (!address || size == 0 || size > UINTPTR_MAX - first) return false;
  probe pages;
  const std::uintptr_t last = first + (size - 1);
  for (std::uintptr_t at = first;;) {  // one byte in each page
    if (!pages.can_read(reinterpret_cast<const char*>(at))) return false;
    const std::uintptr_t next = (at | (page_size() - 1)) + 1;
    if (next > last || next == 0) return true;
    at = next;
  }
}

bool readable_text(const char* text) {
  constexpr std::size_t longest = 65536;
  std::size_t known = 0;
  while (known < longest) {
    const auto at = reinterpret_cast<std::uintptr_t>(text) + known;
    const std::size_t chunk = std::min<std::size_t>(page_size() - (at & (page_size() - 1)), longest - known);
    if (!readable(text + known, chunk)) return false;
    if (std::memchr(text + known, '\0', chunk)) return true;
    known += chunk;
  }
  return false;
}

}  // namespace ilaw::loading
