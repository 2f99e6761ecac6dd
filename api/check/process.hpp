// process.hpp - settings of the process and of this thread that a library must leave as it found them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>

namespace ilaw::check {

class ProcessState {
 public:
  // As it is now. Empties the x87 registers, so that the checker computes as ever.
  ProcessState();

  // Each setting that "after" has otherwise, from what to what; empty if none.
  std::string changes_to(const ProcessState& after) const;

 private:
  std::map<std::string, std::string> settings_;
  int x87_registers_ = 0;  // that were in use before they were emptied
};

}  // namespace ilaw::check
