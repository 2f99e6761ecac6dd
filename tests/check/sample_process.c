/* What a library may not change of the process that loads it, each thing for a rule to find. */
#include "sample.h"

#include <fcntl.h>
#include <fenv.h>
#include <locale.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/personality.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <unistd.h>

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

static void change_mask_of_files(void) { umask(0077); }
static void change_locale(void) { setlocale(LC_ALL, "C.UTF-8"); }
static void change_locale_of_thread(void) { uselocale(newlocale(LC_ALL_MASK, "C", (locale_t)0)); }
static void change_variable(void) { setenv("HOME", "/nowhere", 1); }
static void add_variable(void) { setenv("ILAW_SAMPLE_WAS_HERE", "1", 1); }
static void leave_descriptor(void) { (void)!open("/dev/null", O_RDONLY); }
static void change_directory(void) { (void)!chdir("/"); }
static void ignore_signal(void) { signal(SIGINT, SIG_IGN); }
static void on_signal(int number) { (void)number; }
static void handle_signal(void) { signal(SIGWINCH, on_signal); }
static void round_upward(void) { fesetround(FE_UPWARD); }

static void block_signal(void) {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGINT);
  sigprocmask(SIG_BLOCK, &set, NULL);
}

static void replace_signal_stack(void) {
  stack_t stack = {.ss_flags = SS_DISABLE};
  sigaltstack(&stack, NULL);
}

static void set_timer(void) {
  const struct itimerval timer = {.it_value = {.tv_sec = 1000}};
  setitimer(ITIMER_REAL, &timer, NULL);
}

static void limit_descriptors(void) {
  struct rlimit limit;
  getrlimit(RLIMIT_NOFILE, &limit);
  limit.rlim_cur = limit.rlim_cur > 99 ? 99 : limit.rlim_cur - 1;
  setrlimit(RLIMIT_NOFILE, &limit);
}

static void change_personality(void) { personality(ADDR_NO_RANDOMIZE | (unsigned)personality(0xffffffff)); }

/* It waits for ever in the C library: this one may be unloaded before it has begun. */
static void start_thread(void) {
  pthread_t thread;
  pthread_create(&thread, NULL, (void* (*)(void*))(void (*)(void))pause, NULL);
}

/* On a machine of one processor there is nothing to change. */
static void bind_to_one_processor(void) {
  cpu_set_t all, one;
  int k = 0;
  sched_getaffinity(0, sizeof all, &all);
  while (!CPU_ISSET(k, &all)) ++k;
  CPU_ZERO(&one);
  CPU_SET(k, &one);
  sched_setaffinity(0, sizeof one, &one);
}

#if defined(__x86_64__)
static void flush_to_zero(void) { _mm_setcsr(_mm_getcsr() | 0x8040); } /* as g++ -shared -ffast-math does */
static void shorten_x87(void) {
  const unsigned short word = 0x27f; /* 53 bits */
  __asm__ volatile("fldcw %0" : : "m"(word));
}
static void fill_x87(void) {
  int k;
  for (k = 0; k < 8; ++k) __asm__ volatile("fld1");
}
#endif

static const struct {
  const char* name;
  void (*change)(void);
} changes[] = {{"locale", change_locale},
               {"locale of thread", change_locale_of_thread},
               {"variable", change_variable},
               {"new variable", add_variable},
               {"descriptor", leave_descriptor},
               {"directory", change_directory},
               {"ignored signal", ignore_signal},
               {"handled signal", handle_signal},
               {"blocked signal", block_signal},
               {"stack of handlers", replace_signal_stack},
               {"timer", set_timer},
               {"limit", limit_descriptors},
               {"personality", change_personality},
               {"thread", start_thread},
               {"processors", bind_to_one_processor},
#if defined(__x86_64__)
               {"flushing", flush_to_zero},
               {"x87 control", shorten_x87},
               {"x87 registers", fill_x87},
#endif
               {"rounding", round_upward}};

void disturb(const char* rule) {
  char text[96];
  size_t k;
  if (breaks(rule)) change_mask_of_files();
  for (k = 0; k < sizeof changes / sizeof *changes; ++k) {
    snprintf(text, sizeof text, "%s: %s", rule, changes[k].name);
    if (breaks(text)) changes[k].change();
  }
}
