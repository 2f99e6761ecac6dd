// SPDX-License-Identifier: BSD-3-Clause
#include "file.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string_view>

namespace ilaw::loading {
namespace {

std::int64_t nanoseconds(const struct statx_timestamp& time) {
  return time.tv_sec * std::int64_t{1'000'000'000} + time.tv_nsec;
}

file_status status_at(int folder, const char* path, int flags) {
  struct statx found {};
  file_status status;
  if (statx(folder, path, flags, STATX_BASIC_STATS, &found) != 0) return status;
  status.exists = true;
  status.folder = S_ISDIR(found.stx_mode);
  status.regular = S_ISREG(found.stx_mode);
  status.anyone_writes = (found.stx_mode & S_IWOTH) != 0;
  status.sticky = (found.stx_mode & S_ISVTX) != 0;
  status.device = std::uint64_t{found.stx_dev_major} << 32 | found.stx_dev_minor;
  status.inode = found.stx_ino;
  status.links = found.stx_nlink;
  status.size = found.stx_size;
  status.written = nanoseconds(found.stx_mtime);
  status.changed = nanoseconds(found.stx_ctime);
  return status;
}

}  // namespace

file_status status_of(const std::string& path) { return status_at(AT_FDCWD, path.c_str(), 0); }

std::string canonical(const std::string& path) {
  const std::unique_ptr<char, decltype(&std::free)> real(realpath(path.c_str(), nullptr), &std::free);
  return real ? real.get() : "";
}

// Source of the format: proc_pid_maps(5). Not by sscanf, a new symbol of glibc 2.38.
std::string mapped_file(const void* address) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> maps(std::fopen("/proc/self/maps", "re"),
                                                             &std::fclose);
  const auto wanted = reinterpret_cast<std::uintptr_t>(address);
  struct line {
    char* text = nullptr;
    std::size_t room = 0;
    ~line() { std::free(text); }
  } read;
  while (maps && getline(&read.text, &read.room, maps.get()) > 0) {
    const std::string_view text(read.text, std::strcspn(read.text, "\n"));
    std::uintptr_t first = 0, end = 0;
    const char* dash = std::from_chars(text.begin(), text.end(), first, 16).ptr;
    if (dash != text.end()) std::from_chars(dash + 1, text.end(), end, 16);
    if (wanted >= first && wanted < end)
      return std::string(text.substr(std::min(text.find('/'), text.size())));
  }
  return "";
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
    : path_(path),
      number_(status_of(path).regular ? open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK) : -1) {}

open_file::~open_file() {
  if (number_ >= 0) close(number_);
}

file_status open_file::status() const {
  return is_open() ? status_at(number_, "", AT_EMPTY_PATH) : status_of(path_);
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
