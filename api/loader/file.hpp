// file.hpp - what the loader asks of the file system. By statx, of glibc 2.28: what <filesystem> and stat
// call became new symbols in 2.33, which older machines lack. Nothing here throws but for want of memory.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace ilaw::loading {

struct file_status {
  bool exists = false, folder = false, regular = false;
  bool anyone_writes = false;  // every user may change the file, or put files into the folder
  std::uint64_t device = 0, inode = 0, size = 0;
};

file_status status_of(const std::string& path);

// Absolute, without symbolic links and dots; empty where there is no such file.
std::string canonical(const std::string& path);

// Names in a folder, sorted; none where it cannot be read.
std::vector<std::string> names_in(const std::string& folder);

// A file of which parts are read.
class open_file {
 public:
  explicit open_file(const std::string& path);
  ~open_file();
  open_file(const open_file&) = delete;
  open_file& operator=(const open_file&) = delete;

  bool is_open() const { return number_ >= 0; }
  // False where these bytes cannot be read.
  bool copy(std::uint64_t offset, void* to, std::size_t size) const;

 private:
  int number_;
};

}  // namespace ilaw::loading
