// replaced_files.hpp - two builds of one library, put onto the disk in every way.
#pragma once

#include "support/program.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <stdexcept>
#include <string>

namespace ilaw::testing::replaced_files {

namespace fs = std::filesystem;
using programs::TemporaryFolder;

inline void must(bool well, const std::string& what) {
  if (!well) throw std::runtime_error(what);
}

inline const std::string& bytes_of(int version) {
  static const std::array<std::string, 2> both = {programs::text_of(ILAW_TEST_PLUGINS "/number_1.so"),
                                                  programs::text_of(ILAW_TEST_PLUGINS "/number_2.so")};
  return both.at(static_cast<std::size_t>(version - 1));
}

// Writes the bytes over those that are there. Each write has a time of its own, however coarse the clock is;
// or keeps the time, as cp -p does, and then differs in the time of the change alone.
inline void write_over(const fs::path& file, const std::string& bytes, int flags, bool keeps_time = false) {
  static std::int64_t clock = 1'000'000'000;
  const int out = open(file.c_str(), O_WRONLY | O_CREAT | flags, 0755);
  struct stat before {};
  must(out >= 0 && fstat(out, &before) == 0, "cannot open " + file.string());
  must(pwrite(out, bytes.data(), bytes.size(), 0) == static_cast<ssize_t>(bytes.size()), "cannot write");
  const timespec written = keeps_time ? before.st_mtim : timespec{++clock, 0};
  const std::array<timespec, 2> times = {written, written};
  must(futimens(out, times.data()) == 0, "cannot set the time");
  for (struct stat now = before; keeps_time && now.st_ctim.tv_sec == before.st_ctim.tv_sec &&
                                 now.st_ctim.tv_nsec == before.st_ctim.tv_nsec;) {
    usleep(100);
    must(futimens(out, times.data()) == 0 && fstat(out, &now) == 0, "cannot set the time");
  }
  must(close(out) == 0, "cannot close");
}

inline void install(const fs::path& file, int version) {
  const fs::path made = file.string() + ".made";
  write_over(made, bytes_of(version), 0);
  fs::rename(made, file);
}

// What a process of its own throws or dies of, empty where it does not.
template <class Run>
std::string fault_in_child(const Run& run) {
  std::array<int, 2> ends{};
  must(pipe(ends.data()) == 0, "no pipe");
  const pid_t child = fork();
  if (child == 0) {
    alarm(60);  // instead of waiting for a lock that a thread of the parent has
    std::string fault;
    try {
      run();
    } catch (const std::exception& error) {
      fault = error.what();
    }
    _exit(write(ends[1], fault.data(), fault.size()) == static_cast<ssize_t>(fault.size()) ? 0 : 1);
  }
  close(ends[1]);
  std::string fault(1024, '\0');
  const ssize_t got = read(ends[0], fault.data(), fault.size());
  close(ends[0]);
  int status = 0;
  must(waitpid(child, &status, 0) == child, "no child");
  fault.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
  if (WIFSIGNALED(status)) return "signal " + std::to_string(WTERMSIG(status));
  return fault.empty() && status != 0 ? "exit status " + std::to_string(status) : fault;
}

}  // namespace ilaw::testing::replaced_files
