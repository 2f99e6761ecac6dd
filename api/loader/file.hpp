// file.hpp - what the loader asks of the file system. By statx, of glibc 2.28: what <filesystem> and stat
// call became new symbols in 2.33, which older machines lack. Nothing here throws but for want of memory.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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

// False where it cannot be read.
bool read_whole(const std::string& path, std::vector<unsigned char>& bytes);

}  // namespace ilaw::loading
