// sandbox.hpp - work in a child process with limits: whatever a library does there, the checker lives.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace ilaw::check {

// Seconds of the processor: a busy machine makes a law slow, but breaks no rule.
struct Limits {
  double seconds = 10.0;
  std::size_t megabytes = 1024;  // beside what the program has
};

// How work in a child process ended.
struct Ending {
  bool returned = false;
  bool late = false;    // call after call returned, until the time was over
  std::string result;   // what the work returned
  std::string how;      // else: "was ended by SIGSEGV", "ended the process with exit code 3"
  std::string call;     // the function of the library that ran last
  std::string setting;  // what it was called with, as said by set_setting
  std::string printed;  // on stdout and stderr
};

Ending run_apart(const Limits& limits, const std::function<std::string()>& work);

// In the child: what it calls next, so that the end of the process there has a name, and with what.
void calling(const char* function);
void set_setting(const std::string& text);

// Ends the child at once, with words for what the library did.
[[noreturn]] void end_here(const char* what, const char* name);

// Says what lies at an address that could not be read or written; null where it is not known.
using DescribeAddress = const char* (*)(const void* address);
void describe_addresses_by(DescribeAddress describe);

}  // namespace ilaw::check
