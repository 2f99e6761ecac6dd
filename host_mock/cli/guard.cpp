// Signal handlers, which may call little more than write and _exit.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/guard.hpp"

#include "base/exit_code.hpp"
#include "base/running_law.hpp"

#include <ilaw/ilaw.h>

#include <signal.h>
#include <string.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdlib>

namespace ilaw::host {
namespace {

constexpr std::array crashes{SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT, SIGSYS};
std::array<struct sigaction, crashes.size()> handlers_before;

volatile std::sig_atomic_t interrupts = 0, is_ending = 0;

// A line without an allocation, cut where it is too long.
class Line {
 public:
  Line& operator<<(const char* text) {
    for (; *text && size_ < text_.size(); ++text)
      text_[size_++] = (*text & 0xE0) && *text != 0x7F ? *text : '?';
    return *this;
  }
  Line& operator<<(std::int64_t number) {
    std::array<char, 24> digits{};
    std::size_t first = digits.size() - 1;
    do digits[--first] = static_cast<char>('0' + number % 10);
    while ((number /= 10) > 0 && first > 0);
    return *this << &digits[first];
  }
  void write_out() {
    text_[size_ < text_.size() ? size_++ : size_ - 1] = '\n';
    [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, text_.data(), size_);
  }

 private:
  std::array<char, 2048> text_{};
  std::size_t size_ = 0;
};

[[noreturn]] void end_now(int code) {
  for (;;) syscall(SYS_exit_group, code);
}

[[noreturn]] void end_by(const RunningLaw& law, const char* did, const char* how) {
  Line line;
  line << "ilaw: law '" << law.law() << "'";
  if (law.interface()) line << " of interface '" << law.interface() << "'";
  line << " (library " << law.library() << ") " << did << how;
  if (RunningLaw::step() > 0) line << " in step " << RunningLaw::step();
  line.write_out();
  end_now(exit_failed);
}

void on_crash(int signal) {
  if (const RunningLaw* law = RunningLaw::current()) end_by(*law, "crashed: ", sigdescr_np(signal));
  for (std::size_t k = 0; k < crashes.size(); ++k) sigaction(crashes[k], &handlers_before[k], nullptr);
  raise(signal);
}

void on_exit() {
  if (is_ending) return;
  if (const RunningLaw* law = RunningLaw::current()) end_by(*law, "ended the program", "");
  Line line;
  (line << "ilaw: code of a library ended the program").write_out();
  end_now(exit_failed);
}

// Whoever asks twice is given a second to see the step end.
void on_interrupt(int /*signal*/) {
  interrupts = interrupts + 1;
  if (interrupts > 1) alarm(1);
}

void on_alarm(int /*signal*/) {
  if (const RunningLaw* law = RunningLaw::current()) end_by(*law, "does not come back", "");
  alarm(1);
}

void handle(int signal, void (*handler)(int), int flags) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = flags;
  sigaction(signal, &action, nullptr);
}

// A stack that has overflown has no room for a handler.
void give_stack() {
  alignas(16) static thread_local std::array<char, 1 << 15> room;
  stack_t stack{};
  stack.ss_sp = room.data();
  stack.ss_size = room.size();
  sigaltstack(&stack, nullptr);
}

}  // namespace

void guard_against_laws() {
#pragma omp parallel
  give_stack();
  for (std::size_t k = 0; k < crashes.size(); ++k) {
    sigaction(crashes[k], nullptr, &handlers_before[k]);
    handle(crashes[k], on_crash, SA_ONSTACK);
  }
  std::atexit(on_exit);
  std::at_quick_exit(on_exit);
}

void catch_interrupts() {
  for (const int signal : {SIGINT, SIGTERM}) handle(signal, on_interrupt, SA_RESTART);
  handle(SIGALRM, on_alarm, SA_RESTART);
  handle(SIGXFSZ, SIG_IGN, 0);  // a file that may not grow is an error to report, not one to die of
  handle(SIGPIPE, SIG_IGN, 0);  // and so is a reader who has left
}

bool stop_requested() { return interrupts > 0; }

void end_guard() { is_ending = 1; }

}  // namespace ilaw::host

// In place of the C library's (exported by CMakeLists.txt): a law that calls them skips what atexit
// registered.
extern "C" ILAW_EXPORT void _exit(int code) {
  using ilaw::host::RunningLaw;
  if (const RunningLaw* law = RunningLaw::current()) ilaw::host::end_by(*law, "ended the program", "");
  ilaw::host::end_now(code);
}
extern "C" ILAW_EXPORT void _Exit(int code) { _exit(code); }
