// SPDX-License-Identifier: BSD-3-Clause
#include "base/child_process.hpp"

#include "base/scene_error.hpp"

#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <new>

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

enum Outcome : char { returned = '+', out_of_memory = 'm', scene_error = 's', other_error = '-' };

// Its first letter says what became of the work.
std::string answer_of(const std::function<std::string()>& work) {
  try {
    return char{returned} + work();
  } catch (const std::bad_alloc&) {
    return {out_of_memory};
  } catch (const SceneError& error) {
    return char{scene_error} + std::string(error.what());
  } catch (const std::exception& error) {
    return char{other_error} + std::string(error.what());
  }
}

[[noreturn]] void answer(int pipe, const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t written = write(pipe, text.data() + done, text.size() - done);
    if (written <= 0) _exit(1);
    done += static_cast<std::size_t>(written);
  }
  std::fflush(nullptr);
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

std::string reason_of(int status, unsigned max_seconds) {
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM)
    return "did not end within " + std::to_string(max_seconds) + " s";
  if (WIFSIGNALED(status)) return std::string("crashed: ") + sigdescr_np(WTERMSIG(status));
  return "ended the program with code " + std::to_string(WEXITSTATUS(status));
}

}  // namespace

std::string result_in_process(const std::function<std::string()>& work, unsigned max_seconds,
                              unsigned long long max_bytes) {
  std::array<int, 2> ends{};
  std::fflush(nullptr);  // or the child would print what is still to be printed
  const pid_t child = pipe(ends.data()) == 0 ? fork() : -1;
  if (child < 0) throw std::runtime_error(std::string("no process can be started: ") + strerror(errno));
  if (child == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);  // where this process ends before it
    close(ends[0]);
    std::signal(SIGALRM, SIG_DFL);
    alarm(max_seconds);  // code that never ends
    limit(RLIMIT_CORE, 0);
    if (max_bytes > 0 && can_limit_memory) limit(RLIMIT_AS, max_bytes);
    answer(ends[1], answer_of(work));
  }
  close(ends[1]);
  const std::string text = read_all(ends[0]);
  close(ends[0]);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || text.empty())
    throw ProcessEnded(reason_of(status, max_seconds));
  if (text[0] == out_of_memory) throw std::bad_alloc();
  if (text[0] == scene_error) throw SceneError(text.substr(1));
  if (text[0] == other_error) throw std::runtime_error(text.substr(1));
  return text.substr(1);
}

}  // namespace ilaw::host
