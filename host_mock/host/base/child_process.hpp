// child_process.hpp - work in processes of its own: code that may crash, and runs beside each other. To be
// called while the program has one thread: a copy of it has no others.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>

namespace ilaw::host {

// A process that ended before its work did: "crashed: ...", "did not end within ... s", "ended the program
// with code ...".
class ProcessEnded : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Returns what work returned in a process of its own. Throws what it threw, as SceneError, std::bad_alloc or
// else std::runtime_error; ProcessEnded; and std::runtime_error where no process can be started. 0: no limit
// of the seconds, and of the bytes that it may ask for.
std::string result_in_process(const std::function<std::string()>& work, unsigned max_seconds = 0,
                              unsigned long long max_bytes = 0);

// Several at a time, each with a number. A request to stop (stop_request.hpp) is passed on to them.
class Processes {
 public:
  struct Ended {
    std::size_t number;
    int code;
    std::string crash;  // "crashed: ..."; empty where it ended by itself
  };

  std::size_t count() const { return running_.size(); }
  // The exit code is what work returns, which throws nothing.
  void start(std::size_t number, const std::function<int()>& work);
  // Waits for one of those that run.
  Ended wait();

 private:
  std::map<pid_t, std::size_t> running_;
  bool has_passed_on_ = false;
};

}  // namespace ilaw::host
