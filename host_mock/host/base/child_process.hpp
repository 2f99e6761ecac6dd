// child_process.hpp - work in a process of its own: code that may crash. To be called while the program has
// one thread: a copy of it has no others.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
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

}  // namespace ilaw::host
