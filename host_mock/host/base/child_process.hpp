// child_process.hpp - code that may crash, run in a process of its own.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

namespace ilaw::host {

struct ChildResult {
  std::string text;  // what the work returned, as far as it came
  int status = 0;    // of waitpid

  bool is_complete() const;
  // "crashed: ...", "did not end within ... s", "ended the program with code ...".
  std::string reason(unsigned max_seconds) const;
};

// max_bytes: of memory that the child may ask for; 0: as many as there are. Throws std::runtime_error where
// no process can be started.
ChildResult run_in_child(const std::function<std::string()>& work, unsigned max_seconds,
                         unsigned long long max_bytes = 0);

}  // namespace ilaw::host
