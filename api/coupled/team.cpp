// SPDX-License-Identifier: BSD-3-Clause
#include "team.hpp"

#include <system_error>

#include <unistd.h>

namespace ilaw::coupled {

void Team::end() {
  call_ = nullptr;
  round_.fetch_add(1, std::memory_order_release);
  round_.notify_all();
  if (others_)
    for (std::thread& thread : *others_) thread.join();
  others_.reset();
}

void Team::resize(std::size_t size) {
  leave_parent();
  if (pool_.run) {
    if (others_) end();
    asked_ = size;
    return;
  }
  if (size == asked_ && (others_ || size < 2)) return;
  end();
  asked_ = size;
  if (size < 2) return;
  process_ = getpid();
  others_ = std::make_unique<std::vector<std::thread>>();
  const std::uint32_t round = round_.load();
  try {
    for (std::size_t k = 1; k < size; ++k) others_->emplace_back([this, k, round] { serve(k, round); });
  } catch (const std::system_error&) {  // fewer threads than asked
  }
}

// Threads of the parent are not in this process. Nothing is done with them: their names may be those of
// others.
void Team::leave_parent() {
  if (!others_ || process_ == getpid()) return;
  static_cast<void>(others_.release());
  arrived_ = 0;
  asked_ = 1;
}

void Team::serve(std::size_t thread, std::uint32_t seen) {
  constexpr int tries = 2000;  // some microseconds: the next iteration is near
  for (;;) {
    for (int k = 0; k < tries && round_.load(std::memory_order_acquire) == seen; ++k)
      std::this_thread::yield();
    round_.wait(seen, std::memory_order_acquire);
    seen = round_.load(std::memory_order_acquire);
    if (!call_) return;
    call_(work_, thread);
    barrier();
  }
}

}  // namespace ilaw::coupled
