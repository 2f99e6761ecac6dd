// team.hpp - the caller's thread and others beside it, which sleep while there is no work for them; or
// threads of the host.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/coupled.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <thread>
#include <utility>
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
  std::size_t size() const {
    if (pool_.run) return count_.load(std::memory_order_relaxed);
    return others_ ? others_->size() + 1 : 1;
  }
  // Threads of the host instead of own ones, until the next call; run null: own ones.
  void use(const ilaw_threads& pool) { pool_ = pool; }

  // Calls work(thread), which throws nothing, on all threads, 0 being the caller's, and returns when all are
  // done.
  template <class Work>
  void run(const Work& work) {
    if (pool_.run) {
      if (asked_ > 1) return run_in_pool(work);
      count_ = 1;
      return work(std::size_t{0});
    }
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
    if (size() == 1) return;
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
  template <class Work>
  void run_in_pool(const Work& work) {
    std::pair<Team*, const Work*> given(this, &work);
    const auto part = [](void* opaque, std::uint32_t thread, std::uint32_t count) {
      const auto& [team, of_all] = *static_cast<const std::pair<Team*, const Work*>*>(opaque);
      team->count_.store(std::min(std::size_t{count}, team->asked_), std::memory_order_relaxed);
      if (thread < team->asked_) (*of_all)(std::size_t{thread});
    };
    pool_.run(pool_.context, static_cast<std::uint32_t>(asked_), part, &given);
  }
  void end();
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
  ilaw_threads pool_{};
  std::atomic<std::size_t> count_{1};  // of threads of the pool, within work
  pid_t process_ = 0;
  alignas(64) std::atomic<std::size_t> arrived_{0};  // all write it: apart from what they wait for
};

}  // namespace ilaw::coupled
