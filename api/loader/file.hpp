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
  bool sticky = false;         // but rename and remove only files of his own there
  std::uint64_t device = 0, inode = 0, links = 0, size = 0;
  std::int64_t written = 0, changed = 0;  // times in ns: of the content, and of anything

  bool is_same_file(const file_status& other) const { return device == other.device && inode == other.inode; }
  // The time of any change tells of a copy that sets the other time back; a new hard link is no change.
  bool is_unchanged(const file_status& now) const {
    return exists && now.exists && is_same_file(now) && size == now.size && written == now.written &&
           (changed == now.changed || links != now.links);
  }
};

file_status status_of(const std::string& path);

// Absolute, without symbolic links and dots; empty where there is no such file.
std::string canonical(const std::string& path);

// Path of the file that is mapped at an address, with " (deleted)" behind it where another one took its
// place; empty where none is, or where nobody knows.
std::string mapped_file(const void* address);

// Names in a folder, sorted; none where it cannot be read.
std::vector<std::string> names_in(const std::string& folder);

// A regular file of which parts are read; others are not opened, since a device may act on it.
class open_file {
 public:
  explicit open_file(const std::string& path);
  ~open_file();
  open_file(const open_file&) = delete;
  open_file& operator=(const open_file&) = delete;

  bool is_open() const { return number_ >= 0; }
  // Of the file that is read, whatever has its path by now; of the path, where it is not open.
  file_status status() const;
  // False where these bytes cannot be read.
  bool copy(std::uint64_t offset, void* to, std::size_t size) const;

 private:
  std::string path_;
  int number_;
};

}  // namespace ilaw::loading
