// SPDX-License-Identifier: BSD-3-Clause
#include "file.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <memory>

namespace ilaw::loading {
file_status status_of(const std::string& path) {
  struct statx found {};
  file_status status;
  if (statx(AT_FDCWD, path.c_str(), 0, STATX_BASIC_STATS, &found) != 0) return status;
  status.exists = true;
  status.folder = S_ISDIR(found.stx_mode);
  status.regular = S_ISREG(found.stx_mode);
  status.anyone_writes = (found.stx_mode & S_IWOTH) != 0;
  status.device = std::uint64_t{found.stx_dev_major} << 32 | found.stx_dev_minor;
  status.inode = found.stx_ino;
  status.size = found.stx_size;
  return status;
}

std::string canonical(const std::string& path) {
  const std::unique_ptr<char, decltype(&std::free)> real(realpath(path.c_str(), nullptr), &std::free);
  return real ? real.get() : "";
}

std::vector<std::string> names_in(const std::string& folder) {
  std::vector<std::string> names;
  const std::unique_ptr<DIR, int (*)(DIR*)> open(opendir(folder.c_str()), &closedir);
  if (!open) return names;
  while (const dirent* entry = readdir(open.get())) names.emplace_back(entry->d_name);
  std::sort(names.begin(), names.end());
  return names;
}

open_file::open_file(const std::string& path)
    : number_(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {}

open_file::~open_file() {
  if (number_ >= 0) close(number_);
}

bool open_file::copy(std::uint64_t offset, void* to, std::size_t size) const {
  auto* bytes = static_cast<unsigned char*>(to);
  for (std::size_t known = 0; known < size;) {
    const ssize_t more = pread(number_, bytes + known, size - known, static_cast<off_t>(offset + known));
    if (more <= 0) return false;  // or shorter than it was a moment ago
    known += static_cast<std::size_t>(more);
  }
  return true;
}

}  // namespace ilaw::loading
