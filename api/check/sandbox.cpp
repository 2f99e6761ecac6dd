// SPDX-License-Identifier: BSD-3-Clause
#include "check/sandbox.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <ucontext.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <thread>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define ILAW_INSTRUMENTED
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define ILAW_INSTRUMENTED
#endif
#endif

namespace ilaw::check {
namespace {

// Sanitizers take all addresses for themselves.
#if defined(ILAW_INSTRUMENTED)
constexpr bool is_instrumented = true;
#else
constexpr bool is_instrumented = false;
#endif

constexpr std::size_t most_result = 1U << 18, most_printed = 2000, most_written = 1U << 20;

// Memory that the child leaves for its parent, however the child ends.
struct Shared {
  std::array<char, 64> call;
  std::atomic<std::size_t> calls;
  std::array<char, 160> what;
  std::array<char, 2048> setting;
  bool returned;
  std::size_t size;
  std::array<char, most_result> result;
};

Shared* shared = nullptr;
DescribeAddress describe_address = nullptr;

// Cuts what is too long; for a signal handler too.
template <std::size_t N, class... Texts>
void put(std::array<char, N>& room, Texts... texts) {
  std::size_t at = 0;
  const auto append = [&](const char* text) {
    while (*text != '\0' && at + 1 < N) room[at++] = *text++;
  };
  (append(texts), ...);
  room[at] = '\0';
}

// The library may have written over the zero at its end.
template <std::size_t N>
std::string text_in(const std::array<char, N>& room) {
  return {room.begin(), std::find(room.begin(), room.end(), '\0')};
}

bool was_write(const void* context) {
#if defined(__x86_64__)
  return (static_cast<const ucontext_t*>(context)->uc_mcontext.gregs[REG_ERR] & 2) != 0;
#else
  static_cast<void>(context);
  return false;
#endif
}

void on_signal(int number, siginfo_t* info, void* context) {
  const char *name = sigabbrev_np(number), *access = "", *place = "";
  std::array<char, 40> call{};
  if (number == SIGSEGV || number == SIGBUS) {
    access = was_write(context) ? ", writing " : ", reading ";
    place = describe_address ? describe_address(info->si_addr) : nullptr;
    if (!place) place = "where nothing of the batch is";
  }
  if (number == SIGSYS)
    std::snprintf(call.data(), call.size(), ", making the system call %d", info->si_syscall);
  put(shared->what, "was ended by SIG", name ? name : "?", access, place, call.data());
  _exit(1);
}

// On a stack of their own: one that is full has no room for a handler.
void catch_signals() {
  alignas(16) static std::array<char, 1U << 16> stack;
  stack_t given{};
  given.ss_sp = stack.data();
  given.ss_size = stack.size();
  sigaltstack(&given, nullptr);
  struct sigaction action {};
  action.sa_sigaction = on_signal;
  action.sa_flags = SA_SIGINFO | SA_ONSTACK;
  for (const int number : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGSYS, SIGTERM, SIGPIPE, SIGXCPU,
                           SIGXFSZ, SIGTRAP, SIGALRM, SIGUSR1, SIGUSR2, SIGHUP})
    sigaction(number, &action, nullptr);
}

void limit(int resource, rlim_t amount) {
  const rlimit given{amount, amount};
  setrlimit(resource, &given);
}

std::size_t bytes_of_address_space() {
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

void set_limits(const Limits& limits) {
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, static_cast<rlim_t>(2.0 * limits.seconds) + 10);  // in case the parent is late
  limit(RLIMIT_FSIZE, most_written);
  if (!is_instrumented) limit(RLIMIT_AS, bytes_of_address_space() + limits.megabytes * (1U << 20));
}

[[noreturn]] void run_child(const Limits& limits, int output, const std::function<std::string()>& work) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  setpgid(0, 0);
  if (const int nothing = ::open("/dev/null", O_RDONLY | O_CLOEXEC); nothing >= 0)
    dup2(nothing, STDIN_FILENO);
  dup2(output, STDOUT_FILENO);
  dup2(output, STDERR_FILENO);
  set_limits(limits);
  catch_signals();
  try {
    const std::string result = work();
    shared->size = std::min(result.size(), most_result);
    std::memcpy(shared->result.data(), result.data(), shared->size);
    shared->returned = true;
  } catch (...) {
    put(shared->what, "threw an exception");
  }
  std::fflush(nullptr);
  _exit(0);
}

double seconds_on(clockid_t clock) {
  timespec time{};
  return clock_gettime(clock, &time) == 0
             ? static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec)
             : 0.0;
}

double processor_time_of(pid_t child) {
  clockid_t clock{};
  return clock_getcpuclockid(child, &clock) == 0 ? seconds_on(clock) : 0.0;
}

// Not so where a thread is ready and gets no processor, or waits for a disk.
bool all_threads_sleep(pid_t child) {
  std::error_code none;
  for (const auto& task :
       std::filesystem::directory_iterator("/proc/" + std::to_string(child) + "/task", none)) {
    std::string text;
    std::getline(std::ifstream(task.path() / "stat"), text);
    const std::size_t state = text.rfind(") ");
    const char letter = state == std::string::npos ? 'R' : text[state + 2];
    if (letter == 'R' || letter == 'D') return false;
  }
  return true;
}

enum class Waiting { goes_on, hangs, too_long };

// How a child gets on by the time that it has a processor: one call may take all of the limit, and so may
// all calls together. A call that sleeps, or wakes only to look at something, is timed by the clock.
class ChildWatch {
 public:
  ChildWatch(pid_t child, double seconds, const Shared& left)
      : child_(child), seconds_(seconds), left_(left) {}

  Waiting look() {
    const double now = seconds_on(CLOCK_MONOTONIC), used = processor_time_of(child_);
    const std::size_t calls = left_.calls;
    const bool is_next = calls != calls_;
    if (is_next) calls_ = calls, used_before_ = used, began_ = now;
    if (is_next || used > used_ + least + busy * (now - awake_)) used_ = used, awake_ = now;
    if (is_next && used > seconds_) return Waiting::too_long;
    if (used - used_before_ > seconds_) return Waiting::hangs;
    if (now - awake_ > seconds_ && all_threads_sleep(child_)) return Waiting::hangs;
    if (now - began_ > most_waiting * seconds_) return Waiting::hangs;
    return now - begin_ > most_waiting * seconds_ ? Waiting::too_long : Waiting::goes_on;
  }

 private:
  static constexpr double least = 1e-3, busy = 0.02, most_waiting = 60.0;

  const pid_t child_;
  const double seconds_, begin_ = seconds_on(CLOCK_MONOTONIC);
  const Shared& left_;
  std::size_t calls_ = 0;
  double used_before_ = 0.0, used_ = 0.0, awake_ = begin_, began_ = begin_;
};

// Anything but goes_on: the child had to be ended.
Waiting wait_for(pid_t child, ChildWatch watch, int& status) {
  auto pause = std::chrono::microseconds(100);
  Waiting waiting = Waiting::goes_on;
  for (;;) {
    const pid_t ended = waitpid(child, &status, WNOHANG);
    if (ended == child || (ended < 0 && errno != EINTR)) return Waiting::goes_on;
    waiting = watch.look();
    if (waiting != Waiting::goes_on) break;
    std::this_thread::sleep_for(pause);
    pause = std::min(pause * 3 / 2, std::chrono::microseconds(5000));
  }
  kill(-child, SIGKILL);
  kill(child, SIGKILL);
  waitpid(child, &status, 0);
  return waiting;
}

std::string read_printed(int output) {
  std::string text(most_printed, '\0');
  const ssize_t size = pread(output, text.data(), text.size(), 0);
  text.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
  for (char& c : text)
    if ((c < 0x20 && c != '\n') || c > 0x7E) c = '?';
  return text;
}

std::string how_it_ended(bool in_time, int status, double seconds) {
  std::array<char, 80> text{};
  if (!in_time)
    std::snprintf(text.data(), text.size(), "did not return within %g s", seconds);
  else if (WIFSIGNALED(status))
    std::snprintf(text.data(), text.size(), "was ended by signal %d", WTERMSIG(status));
  else
    std::snprintf(text.data(), text.size(), "ended the process with exit code %d", WEXITSTATUS(status));
  return text.data();
}

Ending ending_of(const Shared& left, Waiting waiting, int status, double seconds) {
  const bool in_time = waiting == Waiting::goes_on;
  Ending ending;
  ending.late = waiting == Waiting::too_long;
  ending.returned = in_time && left.returned;
  ending.result.assign(left.result.data(), std::min(left.size, most_result));
  if (!ending.returned)
    ending.how =
        in_time && left.what[0] != '\0' ? text_in(left.what) : how_it_ended(in_time, status, seconds);
  ending.call = text_in(left.call);
  ending.setting = text_in(left.setting);
  return ending;
}

}  // namespace

Ending run_apart(const Limits& limits, const std::function<std::string()>& work) {
  void* room = mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  const int output = memfd_create("printed", MFD_CLOEXEC);
  if (room == MAP_FAILED || output < 0) throw std::runtime_error("no memory for a child process");
  Shared* const own = static_cast<Shared*>(room);
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("a child process cannot be started");
  if (child == 0) {
    shared = own;
    run_child(limits, output, work);
  }
  int status = 0;
  const Waiting waiting = wait_for(child, ChildWatch(child, limits.seconds, *own), status);
  kill(-child, SIGKILL);  // what the library may have started
  Ending ending = ending_of(*own, waiting, status, limits.seconds);
  ending.printed = read_printed(output);
  close(output);
  munmap(room, sizeof(Shared));
  return ending;
}

void calling(const char* function) {
  if (!shared) return;
  put(shared->call, function);
  ++shared->calls;
}

void set_setting(const std::string& text) {
  if (shared) put(shared->setting, text.c_str());
}

void end_here(const char* what, const char* name) {
  put(shared->what, what, name);
  _exit(1);
}

void describe_addresses_by(DescribeAddress describe) { describe_address = describe; }

}  // namespace ilaw::check
