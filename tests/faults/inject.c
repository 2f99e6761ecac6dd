/* Preloaded: the n-th of some calls that a program makes in one folder fails, is cut short, or is where it
 * gets a signal. ILAW_INJECT="folder:call:n:how"; call: open, write, fsync, rename or any of these, malloc
 * once a file of the folder is open, or worker, which is malloc in other threads than the first; how: fail,
 * full (no room from here on), kill, or int, term, hup and stop, after which the call goes on.
 * ILAW_INJECT_COUNT names a file that gets the number of such calls. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>
#include <unistd.h>

enum { most_descriptors = 1024 };
static char folder[PATH_MAX], call[16], how[16];
static long chosen, seen;
static int is_full, has_begun;
static unsigned char is_ours[most_descriptors];

__attribute__((constructor)) static void start(void) {
  const char* said = getenv("ILAW_INJECT");
  if (said) sscanf(said, "%4000[^:]:%15[^:]:%ld:%15s", folder, call, &chosen, how);
}

__attribute__((destructor)) static void tell(void) {
  const char* file = getenv("ILAW_INJECT_COUNT");
  char text[32];
  if (!file || !*file) return;
  const int descriptor = (int)syscall(SYS_openat, AT_FDCWD, file, O_WRONLY | O_CREAT | O_TRUNC, 0666);
  const int length = snprintf(text, sizeof text, "%ld\n", seen);
  if (syscall(SYS_write, descriptor, text, (size_t)length) != length) abort();
  syscall(SYS_close, descriptor);
}

static int is_inside(const char* path) {
  const size_t length = strlen(folder);
  return length > 0 && path && strncmp(path, folder, length) == 0 && path[length] == '/';
}

static void send(int signal) { syscall(SYS_kill, syscall(SYS_getpid), signal); }

/* The signal after which the call goes on, or 0. */
static int signal_of(const char* name) {
  static const struct {
    const char* name;
    int number;
  } signals[] = {{"int", SIGINT}, {"term", SIGTERM}, {"hup", SIGHUP}, {"stop", SIGSTOP}};
  for (size_t k = 0; k < sizeof signals / sizeof *signals; ++k)
    if (strcmp(name, signals[k].name) == 0) return signals[k].number;
  return 0;
}

/* Whether this call is the one that fails; does not come back where it is to be killed before a call that
 * does nothing by halves. */
static int is_chosen(const char* name) {
  if (strcmp(call, name) != 0 && (strcmp(call, "any") != 0 || strcmp(name, "malloc") == 0)) return 0;
  if (__atomic_add_fetch(&seen, 1, __ATOMIC_RELAXED) != chosen) return 0;
  if (strcmp(how, "full") == 0) is_full = 1;
  if (strcmp(how, "kill") == 0 && strcmp(name, "write") != 0) send(SIGKILL);
  const int signal = signal_of(how);
  if (signal) send(signal);
  return !signal;
}

static int opened(const char* path, int flags, mode_t mode) {
  const int matters = is_inside(path) && (flags & (O_WRONLY | O_RDWR));
  if (matters && is_chosen("open")) {
    errno = ENOSPC;
    return -1;
  }
  if (matters) has_begun = 1;
  const int descriptor = (int)syscall(SYS_openat, AT_FDCWD, path, flags, mode);
  if (descriptor >= 0 && descriptor < most_descriptors) is_ours[descriptor] = (unsigned char)matters;
  return descriptor;
}

int open(const char* path, int flags, ...) {
  va_list list;
  va_start(list, flags);
  const mode_t mode = flags & O_CREAT ? va_arg(list, mode_t) : 0;
  va_end(list);
  return opened(path, flags, mode);
}
int open64(const char* path, int flags, ...) {
  va_list list;
  va_start(list, flags);
  const mode_t mode = flags & O_CREAT ? va_arg(list, mode_t) : 0;
  va_end(list);
  return opened(path, flags, mode);
}

ssize_t write(int descriptor, const void* bytes, size_t count) {
  const int matters = descriptor >= 0 && descriptor < most_descriptors && is_ours[descriptor];
  if (matters && !is_full && is_chosen("write")) {
    if (strcmp(how, "fail") == 0) {
      errno = EIO;
      return -1;
    }
    const ssize_t half = (ssize_t)syscall(SYS_write, descriptor, bytes, count / 2);
    if (strcmp(how, "kill") == 0) send(SIGKILL);
    return half > 0 ? half : 1;
  }
  if (matters && is_full) {
    errno = ENOSPC;
    return -1;
  }
  return (ssize_t)syscall(SYS_write, descriptor, bytes, count);
}

int fsync(int descriptor) {
  if (descriptor >= 0 && descriptor < most_descriptors && is_ours[descriptor] && is_chosen("fsync")) {
    errno = EIO;
    return -1;
  }
  return (int)syscall(SYS_fsync, descriptor);
}

int rename(const char* from, const char* to) {
  if (is_inside(to) && is_chosen("rename")) {
    errno = EIO;
    return -1;
  }
  return (int)syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0);
}

extern void* __libc_malloc(size_t size);
void* malloc(size_t size) {
  const int is_shared = strcmp(call, "worker") == 0;
  if (is_shared ? syscall(SYS_gettid) != syscall(SYS_getpid) && is_chosen(call)
                : has_begun && is_chosen("malloc")) {
    errno = ENOMEM;
    return NULL;
  }
  return __libc_malloc(size);
}
