// Signal handlers, which may call little more than write and _exit.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/guard.hpp"

#include "base/exit_code.hpp"
#include "base/running_call.hpp"
#include "base/stop_request.hpp"

#include <signal.h>
#include <string.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>

namespace ilaw::host {
namespace {

constexpr std::array crashes{SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT, SIGSYS};
constexpr std::array interrupts{SIGINT, SIGTERM, SIGHUP};
std::array<struct sigaction, crashes.size()> handlers_before;

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

// Does nothing where this thread runs no law.
void end_in_call(const char* did, const char* how) {
  const LibraryCall* call = RunningCall::current();
  if (!call) return;
  Line line;
  line << "ilaw: law '" << call->law << "'";
  if (call->interface) line << " of interface '" << call->interface << "'";
  line << " (library " << call->library << ") " << did << how;
  if (call->step > 0.0 && call->time > 0.0) line << " in step " << std::llround(call->time / call->step);
  line.write_out();
  _exit(exit_failed);
}

void on_crash(int signal) {
  end_in_call("crashed: ", sigdescr_np(signal));
  for (std::size_t k = 0; k < crashes.size(); ++k) sigaction(crashes[k], &handlers_before[k], nullptr);
  raise(signal);
}

void on_exit() { end_in_call("ended the program", ""); }

void on_interrupt(int signal) {
  stop_signal = signal;
  for (const int each : interrupts) std::signal(each, SIG_DFL);
}

// May come once for each thread of the parent.
void on_end_of_parent(int /*signal*/) { stop_signal = SIGTERM; }

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

void name_crashes() {
  give_stack();
  for (std::size_t k = 0; k < crashes.size(); ++k) {
    sigaction(crashes[k], nullptr, &handlers_before[k]);
    handle(crashes[k], on_crash, SA_ONSTACK);
  }
  std::atexit(on_exit);
}

void name_crashes_of_threads() {
#pragma omp parallel
  give_stack();
}

void catch_interrupts() {
  for (const int signal : interrupts) {
    struct sigaction before {};
    sigaction(signal, nullptr, &before);
    if (signal != SIGHUP || before.sa_handler != SIG_IGN) handle(signal, on_interrupt, SA_RESTART);
  }
  handle(SIGXFSZ, SIG_IGN, 0);  // a file that may not grow is an error to report, not one to die of
  handle(SIGPIPE, SIG_IGN, 0);  // and so is a reader who has left
}

void stop_with_parent() {
  handle(SIGUSR1, on_end_of_parent, SA_RESTART);
  prctl(PR_SET_PDEATHSIG, SIGUSR1);
}

}  // namespace ilaw::host
