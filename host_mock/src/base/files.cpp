// SPDX-License-Identifier: BSD-3-Clause
#include "base/files.hpp"

#include <cstdio>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

namespace ilaw::host {
namespace {

// Bytes up to the end of the last whole line.
std::uintmax_t size_of_lines(const std::filesystem::path& file) {
  std::uintmax_t size = 0;
  std::ifstream stream(file, std::ios::binary);
  for (std::string line; std::getline(stream, line) && !stream.eof();) size += line.size() + 1;
  return size;
}

}  // namespace

bool make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  const std::filesystem::path trial = folder / "ilaw.trial";
  const bool writable = std::ofstream(trial).is_open();
  std::filesystem::remove(trial, error);
  if (writable) return true;
  std::fprintf(stderr, "ilaw: --out %s: found a file or a place that cannot be written, expected a folder\n",
               folder.c_str());
  return false;
}

AtomicFile::AtomicFile(std::filesystem::path file)
    : file_(std::move(file)), partial_(file_.string() + ".partial"), stream_(partial_) {
  if (!stream_) throw std::runtime_error(partial_.string() + ": cannot be written");
}

AtomicFile::AtomicFile(std::filesystem::path file, std::uintmax_t size)
    : file_(std::move(file)), partial_(file_.string() + ".partial") {
  const std::filesystem::path found = std::filesystem::exists(partial_) ? partial_ : file_;
  const std::string expected = ", expected the first " + std::to_string(size) + " bytes of the run to resume";
  std::error_code error;
  const std::uintmax_t found_size = std::filesystem::file_size(found, error);
  if (error) throw std::runtime_error(found.string() + ": " + error.message() + expected);
  if (found_size < size)
    throw std::runtime_error(found.string() + ": found " + std::to_string(found_size) + " bytes" + expected);
  std::filesystem::rename(found, partial_, error);
  if (!error) std::filesystem::resize_file(partial_, size, error);
  if (error) throw std::runtime_error(partial_.string() + ": cannot be written: " + error.message());
  stream_.open(partial_, std::ios::app);
  if (!stream_) throw std::runtime_error(partial_.string() + ": cannot be written");
}

void AtomicFile::check() const {
  if (!stream_) throw std::runtime_error(file_.string() + ": could not be written whole; is the disk full?");
}

std::uintmax_t AtomicFile::flush() {
  stream_.flush();
  check();
  return std::filesystem::file_size(partial_);
}

AtomicFile::~AtomicFile() {
  std::error_code ignored;
  if (!committed_) std::filesystem::remove(partial_, ignored);
}

void AtomicFile::commit() {
  stream_.close();
  check();
  std::filesystem::rename(partial_, file_);
  committed_ = true;
}

void AtomicFile::keep_lines() {
  stream_.close();
  std::error_code ignored;
  if (!stream_) std::filesystem::resize_file(partial_, size_of_lines(partial_), ignored);
  std::filesystem::rename(partial_, file_, ignored);
  committed_ = true;
}

}  // namespace ilaw::host
