// SPDX-License-Identifier: BSD-3-Clause
#include "base/child_process.hpp"

#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <stdexcept>

namespace ilaw::host {
namespace {

// Address sanitizers map more than any limit.
#ifdef __SANITIZE_ADDRESS__
constexpr bool can_limit_memory = false;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
constexpr bool can_limit_memory = false;
#else
constexpr bool can_limit_memory = true;
#endif
#else
constexpr bool can_limit_memory = true;
#endif

void limit(int resource, unsigned long long amount) {
  const rlimit given{amount, amount};
  setrlimit(static_cast<decltype(RLIMIT_AS)>(resource), &given);
}

[[noreturn]] void answer(int pipe, const std::function<std::string()>& work) {
  const std::string text = work();
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t written = write(pipe, text.data() + done, text.size() - done);
    if (written <= 0) _exit(1);
    done += static_cast<std::size_t>(written);
  }
  _exit(0);
}

std::string read_all(int pipe) {
  std::string text;
  std::array<char, 1 << 16> part{};
  for (;;) {
    const ssize_t got = read(pipe, part.data(), part.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return text;
    text.append(part.data(), static_cast<std::size_t>(got));
  }
}

}  // namespace

bool ChildResult::is_complete() const { return WIFEXITED(status) && WEXITSTATUS(status) == 0; }

std::string ChildResult::reason(unsigned max_seconds) const {
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM)
    return "did not end within " + std::to_string(max_seconds) + " s";
  if (WIFSIGNALED(status)) return std::string("crashed: ") + sigdescr_np(WTERMSIG(status));
  return "ended the program with code " + std::to_string(WEXITSTATUS(status));
}

ChildResult run_in_child(const std::function<std::string()>& work, unsigned max_seconds,
                         unsigned long long max_bytes) {
  std::array<int, 2> ends{};
  std::fflush(nullptr);  // or the child would print what is still to be printed
  const pid_t child = pipe(ends.data()) == 0 ? fork() : -1;
  if (child < 0) throw std::runtime_error(std::string("no process can be started: ") + strerror(errno));
  if (child == 0) {
    close(ends[0]);
    alarm(max_seconds);  // code that never ends
    limit(RLIMIT_CORE, 0);
    if (max_bytes > 0 && can_limit_memory) limit(RLIMIT_AS, max_bytes);
    answer(ends[1], work);
  }
  close(ends[1]);
  ChildResult result{read_all(ends[0])};
  close(ends[0]);
  while (waitpid(child, &result.status, 0) < 0 && errno == EINTR) continue;
  return result;
}

}  // namespace ilaw::host
