// SPDX-License-Identifier: BSD-3-Clause
#include "readable.hpp"

#include <fcntl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdint>

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
    // The call itself: a sanitizer's write would look at the address first.
    if (syscall(SYS_write, ends_[1], address, std::size_t{1}) != 1) return false;
    char drained = 0;
    return read(ends_[0], &drained, 1) == 1;
  }

 private:
  int ends_[2] = {-1, -1};
  bool open_;
};

}  // namespace

bool readable(const void* address, std::size_t size) {
  const auto first = reinterpret_cast<std::uintptr_t>(address);
  if (!address || size == 0 || size > UINTPTR_MAX - first) return false;
  static const auto page_size = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  probe pages;
  const std::uintptr_t last = first + (size - 1);
  for (std::uintptr_t at = first;;) {  // one byte in each page
    if (!pages.can_read(reinterpret_cast<const char*>(at))) return false;
    const std::uintptr_t next = (at | (page_size - 1)) + 1;
    if (next > last) return true;  // what can be read is below the last page of all
    at = next;
  }
}

}  // namespace ilaw::loading
