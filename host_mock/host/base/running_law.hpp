// running_law.hpp - whose code runs: a library that ends the program, or holds it up, can then be
// named by a signal handler.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>

namespace ilaw::host {

// From its making to its end, code of a library may run. Made by one thread; the names must live as
// long. interface may be null.
class RunningLaw {
 public:
  RunningLaw(const char* law, const char* library, const char* interface)
      : law_(law), library_(library), interface_(interface), before_(current()) {
    current_.store(this, std::memory_order_relaxed);
  }
  ~RunningLaw() { current_.store(before_, std::memory_order_relaxed); }
  RunningLaw(const RunningLaw&) = delete;
  RunningLaw& operator=(const RunningLaw&) = delete;

  const char* law() const { return law_; }
  const char* library() const { return library_; }
  const char* interface() const { return interface_; }

  // Null where none runs.
  static const RunningLaw* current() { return current_.load(std::memory_order_relaxed); }
  // The step that is being made; 0 before the first.
  static std::int64_t step() { return step_.load(std::memory_order_relaxed); }
  static void set_step(std::int64_t step) { step_.store(step, std::memory_order_relaxed); }

 private:
  static inline std::atomic<const RunningLaw*> current_ = nullptr;
  static inline std::atomic<std::int64_t> step_ = 0;

  const char *law_, *library_, *interface_;
  const RunningLaw* before_;
};

}  // namespace ilaw::host
