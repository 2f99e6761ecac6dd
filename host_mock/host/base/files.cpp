// SPDX-License-Identifier: BSD-3-Clause
#include "base/files.hpp"

#include "base/scene_error.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>
#include <utility>

namespace ilaw::host {
namespace {

// A call of the system, again where a signal interrupted it.
template <class Call>
int retried(Call call) {
  int result = 0;
  do result = call();
  while (result < 0 && errno == EINTR);
  return result;
}

// A file may be no symbolic link, a folder may: links to scratch disks are usual.
class Descriptor {
 public:
  Descriptor(const std::filesystem::path& file, int flags)
      : number_(retried([&] {
          const int links = flags & O_DIRECTORY ? 0 : O_NOFOLLOW;
          return open(file.c_str(), flags | links | O_CLOEXEC | O_NONBLOCK, 0666);
        })) {}
  ~Descriptor() {
    if (number_ >= 0) close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int number() const { return number_; }
  int release() { return std::exchange(number_, -1); }

 private:
  int number_;
};

std::string reason_of(int error) {
  return error == ELOOP ? "found a symbolic link, expected a file" : std::strerror(error);
}

// A new entry of a folder outlives a loss of power once the folder was kept, too. File systems that
// cannot do that say so, and are believed to need none.
int keep_folder(const std::filesystem::path& file) {
  const Descriptor folder(file.parent_path().empty() ? "." : file.parent_path(), O_RDONLY | O_DIRECTORY);
  if (folder.number() < 0) return errno;
  return retried([&] { return fsync(folder.number()); }) == 0 || errno == EINVAL || errno == ENOTSUP ? 0
                                                                                                     : errno;
}

// Calls take with the file's bytes, at most count of them. Returns 0 or the error.
template <class Take>
int read_bytes(int descriptor, std::uintmax_t count, Take take) {
  std::array<char, 1 << 14> room{};
  while (count > 0) {
    const ssize_t got = read(descriptor, room.data(), std::min<std::uintmax_t>(count, room.size()));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return errno;
    if (got == 0) break;
    take(room.data(), static_cast<std::size_t>(got));
    count -= static_cast<std::uintmax_t>(got);
  }
  return 0;
}

std::filesystem::path partial_of(const std::filesystem::path& file) { return file.string() + ".partial"; }

std::filesystem::path found_of(const std::filesystem::path& file) {
  std::error_code ignored;
  const std::filesystem::path partial = partial_of(file);
  return std::filesystem::exists(std::filesystem::symlink_status(partial, ignored)) ? partial : file;
}

// Bytes up to the end of the last whole line.
std::uintmax_t size_of_lines(const std::filesystem::path& file) {
  std::uintmax_t size = 0;
  std::ifstream stream(file, std::ios::binary);
  for (std::string line; std::getline(stream, line) && !stream.eof();) size += line.size() + 1;
  return size;
}

// ---- who holds a folder ----

std::string process_name() {
  std::array<char, 256> host{};
  gethostname(host.data(), host.size() - 1);
  return "process " + std::to_string(getpid()) + " on " + host.data();
}

// Nothing where the holder has not said yet who it is.
std::string holder_of(int descriptor) {
  std::string text;
  lseek(descriptor, 0, SEEK_SET);
  read_bytes(descriptor, 200, [&](const char* bytes, std::size_t count) { text.append(bytes, count); });
  text = text.substr(0, text.find('\n'));
  return text.starts_with("process ") ? text : "another process";
}

// Whether a descriptor is what has the name now, and not what had it before it was removed.
bool is_still(int descriptor, const std::filesystem::path& file) {
  struct stat held {};
  struct stat named {};
  return fstat(descriptor, &held) == 0 && lstat(file.c_str(), &named) == 0 && held.st_dev == named.st_dev &&
         held.st_ino == named.st_ino;
}

}  // namespace

// ---- the folder -----------------------------------------------------------------------------------------

HeldFolder::HeldFolder(const std::filesystem::path& folder, std::string_view own)
    : lock_(folder / "ilaw.lock") {
  if (folder.empty()) throw InputError("--out: found an empty name, expected that of a folder");
  for (const char* other : {"summary.json", "sweep.csv", "converge.json", "study.json", "bench.csv"})
    if (std::error_code unknown;
        !own.empty() && own != other && std::filesystem::exists(folder / other, unknown))
      throw InputError("--out " + folder.string() + ": found " + other +
                       ", a result of another command, expected a folder of its own for each command");
  std::error_code unmade;
  std::filesystem::create_directories(folder, unmade);
  for (;;) {
    Descriptor lock(lock_, O_RDWR | O_CREAT);
    if (lock.number() < 0) {
      const std::string why = unmade ? unmade.message() : lock_.string() + ": " + reason_of(errno);
      throw InputError("--out " + folder.string() +
                       ": found a file or a place that cannot be written, expected a folder (" + why + ")");
    }
    // A file system without locks holds nobody back.
    if (flock(lock.number(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
      throw InputError("--out " + folder.string() + ": in use by " + holder_of(lock.number()) +
                       ", expected a folder of its own for each run");
    if (!is_still(lock.number(), lock_)) continue;  // its holder ended in between
    const std::string name = process_name() + "\n";
    // Only what is said to others depends on it.
    if (ftruncate(lock.number(), 0) == 0) [[maybe_unused]]
      const ssize_t told = pwrite(lock.number(), name.data(), name.size(), 0);
    descriptor_ = lock.release();
    return;
  }
}

HeldFolder::~HeldFolder() {
  unlink(lock_.c_str());
  close(descriptor_);
}

// ---- what is in a file ----------------------------------------------------------------------------------

void FileMark::add(const char* bytes, std::size_t count) {
  checksum =
      static_cast<std::uint32_t>(crc32_z(checksum, reinterpret_cast<const unsigned char*>(bytes), count));
  size += count;
}

std::string read_whole(const std::filesystem::path& file) {
  std::string text;
  const Descriptor descriptor(file, O_RDONLY);
  int error = descriptor.number() < 0 ? errno : 0;
  if (error == 0)
    error = read_bytes(descriptor.number(), UINTMAX_MAX,
                       [&](const char* bytes, std::size_t count) { text.append(bytes, count); });
  if (error != 0) throw std::runtime_error(file.string() + ": " + reason_of(error));
  return text;
}

void check_begins_with(const std::filesystem::path& file, const FileMark& mark) {
  const std::filesystem::path found = found_of(file);
  const std::string expected =
      ", expected the first " + std::to_string(mark.size) + " bytes of the run to resume";
  const Descriptor descriptor(found, O_RDONLY);
  FileMark read;
  int error = descriptor.number() < 0 ? errno : 0;
  if (error == 0)
    error = read_bytes(descriptor.number(), mark.size,
                       [&](const char* bytes, std::size_t count) { read.add(bytes, count); });
  if (error != 0) throw std::runtime_error(found.string() + ": " + reason_of(error) + expected);
  if (read.size < mark.size)
    throw std::runtime_error(found.string() + ": found " + std::to_string(read.size) + " bytes" + expected);
  if (read != mark) throw std::runtime_error(found.string() + ": found other bytes" + expected);
}

// ---- writing --------------------------------------------------------------------------------------------

void FileBuffer::open(int descriptor, const FileMark& written) {
  descriptor_ = descriptor;
  mark_ = written;
  setp(room_.data(), room_.data() + room_.size());
}

int FileBuffer::sync() {
  const char* next = pbase();
  while (next < pptr() && error_ == 0) {
    const ssize_t taken = write(descriptor_, next, static_cast<std::size_t>(pptr() - next));
    if (taken < 0 && errno == EINTR) continue;
    if (taken <= 0) {
      error_ = taken < 0 ? errno : EIO;
      break;
    }
    mark_.add(next, static_cast<std::size_t>(taken));
    next += taken;
  }
  setp(room_.data(), room_.data() + room_.size());
  return error_ == 0 ? 0 : -1;
}

FileBuffer::int_type FileBuffer::overflow(int_type character) {
  if (sync() != 0) return traits_type::eof();
  if (!traits_type::eq_int_type(character, traits_type::eof())) sputc(traits_type::to_char_type(character));
  return traits_type::not_eof(character);
}

int FileBuffer::keep() {
  sync();
  if (error_ == 0 && retried([this] { return fsync(descriptor_); }) != 0) error_ = errno;
  return error_;
}

int FileBuffer::close() {
  if (descriptor_ < 0) return error_;
  sync();
  if (::close(std::exchange(descriptor_, -1)) != 0 && error_ == 0) error_ = errno;
  return error_;
}

AtomicFile::AtomicFile(std::filesystem::path file, const std::optional<FileMark>& written)
    : file_(std::move(file)), partial_(partial_of(file_)), is_kept_(written.has_value()) {
  buffer_.open(open_partial(written), written.value_or(FileMark{}));
}

int AtomicFile::open_partial(const std::optional<FileMark>& written) const {
  if (written) check_begins_with(file_, *written);
  const std::filesystem::path found = written ? found_of(file_) : partial_;
  if (!written) unlink(partial_.c_str());
  Descriptor descriptor(found, O_WRONLY | (written ? O_APPEND : O_CREAT | O_EXCL));
  const off_t size = static_cast<off_t>(written.value_or(FileMark{}).size);
  if (descriptor.number() < 0 || retried([&] { return ftruncate(descriptor.number(), size); }) != 0 ||
      (found != partial_ && retried([&] { return std::rename(found.c_str(), partial_.c_str()); }) != 0))
    fail(errno);
  return descriptor.release();
}

AtomicFile::~AtomicFile() {
  buffer_.close();
  if (!is_kept_) unlink(partial_.c_str());
}

void AtomicFile::fail(int error) const {
  throw WriteError(file_.string() + ": cannot be written: " + reason_of(error));
}

void AtomicFile::check() const {
  if (buffer_.error() != 0) fail(buffer_.error());
}

FileMark AtomicFile::flush() {
  if (const int error = buffer_.keep(); error != 0) fail(error);
  return buffer_.mark();
}

FileMark AtomicFile::commit() {
  const FileMark mark = flush();
  if (const int error = buffer_.close(); error != 0) fail(error);
  if (retried([this] { return std::rename(partial_.c_str(), file_.c_str()); }) != 0) fail(errno);
  is_kept_ = true;
  if (const int error = keep_folder(file_); error != 0) fail(error);
  return mark;
}

void AtomicFile::keep_lines() {
  is_kept_ = true;
  std::error_code ignored;
  buffer_.keep();
  if (buffer_.close() != 0) std::filesystem::resize_file(partial_, size_of_lines(partial_), ignored);
  if (std::filesystem::file_size(partial_, ignored) == 0)
    unlink(partial_.c_str());
  else
    std::filesystem::rename(partial_, file_, ignored);
}

FileMark write_file(const std::filesystem::path& file, std::string_view text) {
  AtomicFile made(file);
  made.stream() << text;
  return made.commit();
}

}  // namespace ilaw::host
