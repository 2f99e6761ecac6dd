// files.hpp - the folder of the results, and files that are written whole or not at all: whatever
// fails or breaks off meanwhile, what has a file's name is complete. Symbolic links in the folder
// are replaced, never followed.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <ostream>
#include <stdexcept>
#include <streambuf>
#include <string>
#include <string_view>

namespace ilaw::host {

// A file that cannot be written, and why.
class WriteError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The folder that --out names: made if it does not exist, and held by this process alone. Throws
// InputError where that cannot be, and names the process that holds it.
class HeldFolder {
 public:
  // own: the file of results that the command writes there, if results of other commands are refused.
  explicit HeldFolder(const std::filesystem::path& folder, std::string_view own = {});
  ~HeldFolder();
  HeldFolder(const HeldFolder&) = delete;
  HeldFolder& operator=(const HeldFolder&) = delete;

 private:
  std::filesystem::path lock_;
  int descriptor_ = -1;
};

// The number of bytes and their CRC-32, which tell them from others.
struct FileMark {
  std::uintmax_t size = 0;
  std::uint32_t checksum = 0;
  bool operator==(const FileMark&) const = default;

  void add(const char* bytes, std::size_t count);
};

// Reads a file, but no symbolic link. Throws std::runtime_error with the file and the reason.
std::string read_whole(const std::filesystem::path& file);
// Throws std::runtime_error where the file, complete or not, does not begin with what was marked.
void check_begins_with(const std::filesystem::path& file, const FileMark& mark);

// Writes to a descriptor, every write checked. The first error stays.
class FileBuffer : public std::streambuf {
 public:
  void open(int descriptor, const FileMark& written);
  int close();  // 0 or the first error
  int error() const { return error_; }
  // The mark of all that was written, once the stream was flushed.
  const FileMark& mark() const { return mark_; }
  // All that was written is on the disk when this returns; 0 or the first error.
  int keep();

 protected:
  int_type overflow(int_type character) override;
  int sync() override;

 private:
  std::array<char, 1 << 14> room_{};
  int descriptor_ = -1, error_ = 0;
  FileMark mark_;
};

// A file that appears under its name only when it is complete and on the disk: written beside it,
// then renamed.
class AtomicFile {
 public:
  // written: by an earlier run, complete or not, which this one continues.
  explicit AtomicFile(std::filesystem::path file, const std::optional<FileMark>& written = {});
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  std::ostream& stream() { return stream_; }
  // Puts all that was written on the disk; returns its mark.
  FileMark flush();
  // Throws WriteError when the disk did not take all so far, as far as is known.
  void check() const;
  // Throws WriteError when the disk did not take it all.
  FileMark commit();
  // Instead, where the file cannot be completed: the whole lines that the disk took get its name.
  void keep_lines();

 private:
  [[noreturn]] void fail(int error) const;
  // Opens the partial file, with what was written or empty.
  int open_partial(const std::optional<FileMark>& written) const;

  std::filesystem::path file_, partial_;
  FileBuffer buffer_;
  std::ostream stream_{&buffer_};
  bool is_kept_ = false;
};

// A file with a text. Throws WriteError.
FileMark write_file(const std::filesystem::path& file, std::string_view text);

}  // namespace ilaw::host
