// SPDX-License-Identifier: BSD-3-Clause
#include "check/process.hpp"

#include <sched.h>
#include <sys/personality.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <unistd.h>

#include <array>
#include <bit>
#include <cfenv>
#include <clocale>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <iterator>
#include <new>

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

namespace ilaw::check {
namespace {

namespace fs = std::filesystem;
using Settings = std::map<std::string, std::string>;

std::string formatted(const char* format, std::uint64_t value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), format, static_cast<unsigned long long>(value));
  return text.data();
}
std::string hexadecimal(std::uint64_t value) { return formatted("0x%llx", value); }
std::string octal(std::uint64_t value) { return formatted("0%03llo", value); }

std::string signal_name(int number) {
  const char* name = sigabbrev_np(number);
  return name ? std::string("SIG") + name : "signal " + std::to_string(number);
}

std::string signals_in(const sigset_t& set) {
  std::string text;
  for (int number = 1; number < NSIG; ++number)
    if (sigismember(&set, number) == 1) text += (text.empty() ? "" : " ") + signal_name(number);
  return text.empty() ? "none" : text;
}

#if defined(__x86_64__)
// What fnstenv stores in 64-bit mode: Intel 64 manual, volume 1, figure 8-9.
struct X87Environment {
  std::uint32_t control, status, tags;
  std::array<std::uint32_t, 4> last_instruction;
};

// fnstenv masks all exceptions, so that they are loaded again.
X87Environment x87_environment() {
  X87Environment found{};
  asm volatile("fnstenv %0\n\tfldenv %0" : "+m"(found));
  return found;
}

// Two bits for each of the eight registers, 3 for an empty one.
int registers_in_use(std::uint32_t tags) {
  int used = 0;
  for (int k = 0; k < 8; ++k) used += ((tags >> (2 * k)) & 3U) != 3U;
  return used;
}
#endif

const char* name_of_rounding(int mode) {
  return mode == FE_TONEAREST    ? "to nearest"
         : mode == FE_UPWARD     ? "upward"
         : mode == FE_DOWNWARD   ? "downward"
         : mode == FE_TOWARDZERO ? "toward zero"
                                 : "unknown";
}

int empty_x87_registers() {
#if defined(__x86_64__)
  const int used = registers_in_use(x87_environment().tags);
  if (used > 0) asm volatile("emms");
  return used;
#else
  return 0;
#endif
}

// Exception flags are left out: they are no settings, and float-flags judges them.
void add_numbers(Settings& settings) {
#if defined(__x86_64__)
  settings["x87 control word"] = hexadecimal(x87_environment().control & 0xFFFFU);
  settings["MXCSR without flags"] = hexadecimal(_mm_getcsr() & ~0x3FU);
#elif defined(__aarch64__)
  std::uint64_t fpcr = 0;
  asm volatile("mrs %0, fpcr" : "=r"(fpcr));
  settings["FPCR"] = hexadecimal(fpcr);
#endif
  settings["rounding mode"] = name_of_rounding(std::fegetround());
}

void add_signals(Settings& settings) {
  for (int number = 1; number < NSIG; ++number) {
    struct sigaction action {};
    if (sigaction(number, nullptr, &action) != 0) continue;
    const auto handler = std::bit_cast<std::uintptr_t>(action.sa_handler);
    const std::string name = action.sa_handler == SIG_DFL   ? "default"
                             : action.sa_handler == SIG_IGN ? "ignored"
                                                            : "the function " + hexadecimal(handler);
    const auto flags = static_cast<unsigned>(action.sa_flags);
    settings["handler of " + signal_name(number)] = name + (flags ? ", flags " + hexadecimal(flags) : "");
  }
  sigset_t blocked;
  sigemptyset(&blocked);
  pthread_sigmask(SIG_BLOCK, nullptr, &blocked);
  settings["blocked signals"] = signals_in(blocked);
  stack_t stack{};
  sigaltstack(nullptr, &stack);
  settings["stack of signal handlers"] = hexadecimal(std::bit_cast<std::uintptr_t>(stack.ss_sp));
  itimerval timer{};
  getitimer(ITIMER_REAL, &timer);
  settings["timer of SIGALRM"] = timer.it_value.tv_sec || timer.it_value.tv_usec ? "set" : "not set";
}

void add_locale(Settings& settings) {
  const char* name = std::setlocale(LC_ALL, nullptr);
  settings["locale"] = name ? name : "unknown";
  const locale_t own = uselocale(nullptr);
  settings["locale of the thread"] =
      own == LC_GLOBAL_LOCALE ? "that of the process" : hexadecimal(std::bit_cast<std::uintptr_t>(own));
}

void add_environment(Settings& settings) {
  for (char** entry = environ; entry && *entry; ++entry) {
    const std::string text = *entry;
    const std::size_t end = text.find('=');
    const std::string value = end == std::string::npos ? "" : text.substr(end + 1);
    settings["environment variable " + text.substr(0, end)] = "'" + value + "'";
  }
}

// A folder of /proc that is read has a descriptor, too.
void add_files(Settings& settings) {
  std::error_code none;
  const auto target_of = [&](const fs::path& link) { return fs::read_symlink(link, none).string(); };
  settings["current directory"] = target_of("/proc/self/cwd");
  const mode_t mask = umask(0);
  umask(mask);
  settings["umask"] = octal(mask);
  const std::string own = "/proc/" + std::to_string(getpid()) + "/fd";
  for (const fs::path& file : fs::directory_iterator("/proc/self/fd", none))
    if (const std::string target = target_of(file); target != own)
      settings["descriptor " + file.filename().string()] = target;
}

std::string amount_of(rlim_t amount) {
  return amount == RLIM_INFINITY ? "unlimited" : std::to_string(amount);
}

void add_limits(Settings& settings) {
  struct Limit {
    int resource;
    const char* name;
  };
  constexpr std::array limits{Limit{RLIMIT_CPU, "processor time"}, Limit{RLIMIT_FSIZE, "size of files"},
                              Limit{RLIMIT_DATA, "data"},          Limit{RLIMIT_STACK, "stack"},
                              Limit{RLIMIT_CORE, "core files"},    Limit{RLIMIT_NPROC, "processes"},
                              Limit{RLIMIT_NOFILE, "descriptors"}, Limit{RLIMIT_MEMLOCK, "locked memory"},
                              Limit{RLIMIT_AS, "address space"}};
  for (const Limit& limit : limits) {
    rlimit found{};
    getrlimit(limit.resource, &found);
    settings[std::string("limit of ") + limit.name] =
        amount_of(found.rlim_cur) + " of " + amount_of(found.rlim_max);
  }
  settings["personality"] = hexadecimal(static_cast<unsigned>(personality(0xFFFFFFFFUL)));
}

void add_threads(Settings& settings) {
  std::error_code none;
  settings["number of threads"] =
      std::to_string(std::distance(fs::directory_iterator("/proc/self/task", none), {}));
  cpu_set_t processors;
  CPU_ZERO(&processors);
  if (sched_getaffinity(0, sizeof processors, &processors) == 0)
    settings["number of processors to run on"] = std::to_string(CPU_COUNT(&processors));
}

void add_handlers(Settings& settings) {
  const auto described = [](auto handler) {
    return handler ? "the function " + hexadecimal(std::bit_cast<std::uintptr_t>(handler)) : "none";
  };
  settings["handler of std::terminate"] = described(std::get_terminate());
  settings["handler of failed new"] = described(std::get_new_handler());
}

}  // namespace

ProcessState::ProcessState() : x87_registers_(empty_x87_registers()) {
  add_numbers(settings_);
  add_signals(settings_);
  add_locale(settings_);
  add_environment(settings_);
  add_files(settings_);
  add_limits(settings_);
  add_threads(settings_);
  add_handlers(settings_);
}

std::string ProcessState::changes_to(const ProcessState& after) const {
  const auto value_in = [](const Settings& settings, const std::string& name) {
    const auto found = settings.find(name);
    return found == settings.end() ? std::string("none") : found->second;
  };
  Settings both = settings_;
  both.insert(after.settings_.begin(), after.settings_.end());
  std::string text;
  const auto add = [&text](const std::string& name, const std::string& from, const std::string& to) {
    if (from != to) text.append(text.empty() ? "" : "; ").append(name + " from " + from + " to " + to);
  };
  add("number of x87 registers in use", "0", std::to_string(after.x87_registers_));
  for (const auto& [name, value] : both)
    add(name, value_in(settings_, name), value_in(after.settings_, name));
  return text;
}

}  // namespace ilaw::check
