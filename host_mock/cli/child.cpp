// SPDX-License-Identifier: BSD-3-Clause
#include "cli/child.hpp"

#include <ilaw/loader.hpp>

#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <stdexcept>

namespace ilaw::host {
namespace {

constexpr unsigned most_seconds = 20;

[[noreturn]] void answer(int pipe, const std::function<std::string()>& work) {
  alarm(most_seconds);  // code that never ends
  std::string text;
  try {
    text = "+" + work();
  } catch (const ilaw::error& error) {
    text = std::string("-") + error.what();
  }
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t written = write(pipe, text.data() + done, text.size() - done);
    if (written <= 0) _exit(1);
    done += static_cast<std::size_t>(written);
  }
  _exit(0);
}

std::string read_all(int pipe) {
  std::string text;
  std::array<char, 4096> part{};
  for (;;) {
    const ssize_t got = read(pipe, part.data(), part.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return text;
    text.append(part.data(), static_cast<std::size_t>(got));
  }
}

std::string end_of(int status) {
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM)
    return "did not end within " + std::to_string(most_seconds) + " s";
  if (WIFSIGNALED(status)) return std::string("crashed: ") + sigdescr_np(WTERMSIG(status));
  return "ended the program with code " + std::to_string(WEXITSTATUS(status));
}

}  // namespace

std::string in_child(const std::function<std::string()>& work) {
  std::array<int, 2> ends{};
  std::fflush(nullptr);  // or the child would print what is still to be printed
  const pid_t child = pipe(ends.data()) == 0 ? fork() : -1;
  if (child < 0) throw std::runtime_error(std::string("no process can be started: ") + strerror(errno));
  if (child == 0) {
    close(ends[0]);
    answer(ends[1], work);
  }
  close(ends[1]);
  const std::string text = read_all(ends[0]);
  close(ends[0]);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0 && text.starts_with('+')) return text.substr(1);
  if (text.starts_with('-')) throw ilaw::error(ILAW_BAD_LIBRARY, text.substr(1));
  throw std::runtime_error("its code " + end_of(status));
}

}  // namespace ilaw::host
