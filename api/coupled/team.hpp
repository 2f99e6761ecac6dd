// team.hpp - the caller's thread and others beside it, which sleep while there is no work for them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <thread>
#include <vector>

#include <sys/types.h>

namespace ilaw::coupled {

class Team {
 public:
  Team() = default;
  ~Team() { resize(1); }
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;

  // Number of threads, that of the caller among them. There are fewer where the system gives no more, and in
  // a child of fork, which does not have its parent's.
  void resize(std::size_t size);
  std::size_t size() const { return others_ ? others_->size() + 1 : 1; }

  // Calls work(thread), which throws nothing, on all threads, 0 being the caller's, and returns when all are
  // done.
  template <class Work>
  void run(const Work& work) {
    leave_parent();
    if (!others_) return work(std::size_t{0});
    work_ = &work;
    call_ = [](const void* of, std::size_t thread) { (*static_cast<const Work*>(of))(thread); };
    round_.fetch_add(1, std::memory_order_release);
    round_.notify_all();
    work(std::size_t{0});
    barrier();
  }
  // Within work: returns when all threads have called it.
  void barrier() {
    if (!others_) return;
    const std::uint32_t passed = passed_.load(std::memory_order_relaxed);
    if (arrived_.fetch_add(1, std::memory_order_acq_rel) + 1 == size()) {
      arrived_.store(0, std::memory_order_relaxed);
      passed_.store(passed + 1, std::memory_order_release);
      return;
    }
    wait_while(passed_, passed);
  }
  // The part of `count` things that a thread works on: from part(count, t) to part(count, t + 1).
  std::size_t part(std::size_t count, std::size_t thread) const { return count * thread / size(); }

 private:
  void serve(std::size_t thread, std::uint32_t seen);
  void leave_parent();
  // Yields after some microseconds, for the threads of a busy processor.
  static void wait_while(const std::atomic<std::uint32_t>& number, std::uint32_t value) {
    constexpr int tries = 4000;
    for (int k = 0; number.load(std::memory_order_acquire) == value; ++k)
      if (k > tries) std::this_thread::yield();
  }

  alignas(64) std::atomic<std::uint32_t> passed_{0};  // barriers
  std::atomic<std::uint32_t> round_{0};
  const void* work_ = nullptr;
  void (*call_)(const void*, std::size_t) = nullptr;  // null: the threads end
  std::unique_ptr<std::vector<std::thread>> others_;  // null: none
  std::size_t asked_ = 1;
  pid_t process_ = 0;
  alignas(64) std::atomic<std::size_t> arrived_{0};  // all write it: apart from what they wait for
};

}  // namespace ilaw::coupled
