// files.hpp - the folder of the results, and files that are written whole or not at all.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>

namespace ilaw::host {

// Makes the folder that --out names, if it does not exist, and tries whether files can be made in
// it; says on stderr why they cannot.
bool make_folder(const std::filesystem::path& folder);

// A file that appears under its name only when it is complete: written beside it, then renamed.
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path file);
  // Goes on after the first size bytes of what an earlier run left, complete or not.
  AtomicFile(std::filesystem::path file, std::uintmax_t size);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  std::ostream& stream() { return stream_; }
  // Bytes written so far, all of them in the file.
  std::uintmax_t flush();
  // Throws std::runtime_error when the disk did not take all so far, as far as is known.
  void check() const;
  // Throws std::runtime_error when the disk did not take it all.
  void commit();
  // Instead, where the file cannot be completed: the whole lines that the disk took get its name.
  void keep_lines();

 private:
  std::filesystem::path file_, partial_;
  std::ofstream stream_;
  bool committed_ = false;
};

}  // namespace ilaw::host
