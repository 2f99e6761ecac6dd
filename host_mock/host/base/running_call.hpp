// running_call.hpp - the code of a library that a thread runs: a handler of signals names it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace ilaw::host {

struct LibraryCall {
  const char *law, *library, *interface = nullptr;  // interface: null where it has none
  double time = 0.0, step = 0.0;                    // of its batch
};

// From its making to its end, this thread makes the call, whose names must live as long. A plain pointer per
// thread, which a handler may read.
class RunningCall {
 public:
  explicit RunningCall(const LibraryCall& call) : call_(call), before_(current_) { current_ = &call_; }
  ~RunningCall() { current_ = before_; }
  RunningCall(const RunningCall&) = delete;
  RunningCall& operator=(const RunningCall&) = delete;

  // Of the calling thread; null where it makes none.
  static const LibraryCall* current() { return current_; }

 private:
  static inline constinit thread_local const LibraryCall* current_ = nullptr;

  LibraryCall call_;
  const LibraryCall* before_;
};

}  // namespace ilaw::host
