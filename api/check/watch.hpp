// watch.hpp - what a library does beside computing: symbols that it exports, functions of others that
// evaluate calls, globals that it changes, system calls.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace ilaw::check {

// A symbol of a loaded library that others may bind to.
struct Exported {
  std::string name;  // as its source has it
  bool is_weak = false, is_unique = false;
};
// From the dynamic symbol table, without the names that linkers add. None if the table was not found.
std::optional<std::vector<Exported>> exported_symbols(const std::string& library);

// Kinds of functions that evaluate may not call.
enum class Forbidden { allocation, lock, input_output, clock, ending };

// From here on a call from the library into such a function ends the process, with its name. Other libraries
// that it brings along are not watched. False where nothing can be watched (no ELF file of this machine).
class CallWatch {
 public:
  CallWatch(const std::string& library, Forbidden kind);
  CallWatch(const CallWatch&) = delete;
  CallWatch& operator=(const CallWatch&) = delete;
  ~CallWatch();

 private:
  struct Slot {
    void** place;
    void* value;
  };
  std::vector<Slot> slots_;
};

// Copies of the memory that a library may write: its globals.
class Globals {
 public:
  explicit Globals(const std::string& library);
  bool found() const { return !parts_.empty(); }
  // How many bytes differ from the copy.
  std::size_t changed() const;

 private:
  struct Part {
    const char* begin;
    std::vector<char> copy;
  };
  std::vector<Part> parts_;
};

// From here on any system call but writing and ending ends the process, with its number. For good. False
// where the system has no such filter.
bool forbid_system_calls();

}  // namespace ilaw::check
