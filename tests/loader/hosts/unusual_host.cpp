// unusual_host MODE LIBRARY... - runs the same random batches of all laws in a process set up as some
// industrial code sets up its own, and prints a digest of what the laws gave: the same in every mode.
// SPDX-License-Identifier: BSD-3-Clause
#include "../../abi/batch_source.hpp"

#include <dlfcn.h>
#include <fenv.h>
#include <unistd.h>
#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <thread>

namespace {

using namespace random_batches;

[[noreturn]] void fail(const std::string& what) {
  std::fprintf(stderr, "unusual_host: %s\n", what.c_str());
  std::exit(1);
}

constexpr int everything = FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW | FE_UNDERFLOW | FE_INEXACT;

// As gfortran -ffpe-trap=zero,invalid,overflow,underflow.
void trap() {
  feclearexcept(FE_ALL_EXCEPT);
  feenableexcept(FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW | FE_UNDERFLOW);
}
void trap_no_more() { fedisableexcept(FE_ALL_EXCEPT); }

void clear_flags() { feclearexcept(FE_ALL_EXCEPT); }
void expect_no_flags() {
  if (const int raised = fetestexcept(everything)) fail("a law raised flags " + std::to_string(raised));
}

void round_up() { fesetround(FE_UPWARD); }
void round_to_nearest() {
  if (fegetround() != FE_UPWARD) fail("a law changed the rounding mode");
  fesetround(FE_TONEAREST);
}

#if defined(__x86_64__)
constexpr unsigned flush_and_zero = 0x8040;  // FTZ and DAZ
void flush() { _mm_setcsr(_mm_getcsr() | flush_and_zero); }
void flush_no_more() {
  if ((_mm_getcsr() & flush_and_zero) != flush_and_zero) fail("a law changed flush-to-zero");
  _mm_setcsr(_mm_getcsr() & ~flush_and_zero);
}
#else
void flush() {}
void flush_no_more() {}
#endif

struct Mode {
  const char* name;
  void (*before)();
  void (*after)();
};
constexpr Mode modes[] = {{"plain", nullptr, nullptr},
                          {"trap", trap, trap_no_more},
                          {"flags", clear_flags, expect_no_flags},
                          {"upward", round_up, round_to_nearest},
                          {"flush", flush, flush_no_more},
                          {"threads", nullptr, nullptr},
                          {"twice", nullptr, nullptr},
                          {"global", nullptr, nullptr},
                          {"reload", nullptr, nullptr}};

std::uint64_t digest_of(const std::vector<ilaw::library>& libraries, const Mode& mode) {
  Tally tally;
  Arena arena;
  for (std::uint64_t seed = 1; seed <= 60 * libraries.size(); ++seed) {
    Draw draw(seed);
    const std::optional<Drawn> drawn = Drawn::of(libraries[seed % libraries.size()], draw);
    if (!drawn) continue;
    constexpr std::uint64_t odds[] = {0, 20, 200};
    Runner runner(*drawn, draw, {odds[draw.below(3)]}, arena);
    runner.before = mode.before;
    runner.after = mode.after;
    runner.run(10, tally);
  }
  if (!tally.wrong.empty()) fail(tally.wrong);
  if (tally.batches < 100) fail("only " + std::to_string(tally.batches) + " batches");
  return tally.digest;
}

std::vector<ilaw::library> opened(const std::vector<std::string>& paths) {
  std::vector<ilaw::library> libraries;
  for (const std::string& path : paths) libraries.emplace_back(path);
  return libraries;
}

// Each thread opens, creates and runs on its own; they share what the loader and the libraries share.
std::uint64_t in_threads(const std::vector<std::string>& paths, const Mode& mode) {
  std::vector<std::uint64_t> digests(4);
  std::vector<std::thread> threads;
  for (std::uint64_t& digest : digests)
    threads.emplace_back([&] { digest = digest_of(opened(paths), mode); });
  for (std::thread& thread : threads) thread.join();
  for (const std::uint64_t digest : digests)
    if (digest != digests[0]) fail("threads differ");
  return digests[0];
}

// A second copy of each library, from another file, is loaded and used while the first is.
std::uint64_t loaded_twice(const std::vector<std::string>& paths, const Mode& mode) {
  std::string folder = "/tmp/ilaw_twice_XXXXXX";
  if (!mkdtemp(folder.data())) fail("no folder for copies");
  std::vector<std::string> copies;
  for (const std::string& path : paths) {
    copies.push_back(folder + path.substr(path.rfind('/')));
    std::ofstream(copies.back(), std::ios::binary) << std::ifstream(path, std::ios::binary).rdbuf();
  }
  const std::vector<ilaw::library> first = opened(paths), second = opened(copies);
  for (const std::string& copy : copies) unlink(copy.c_str());
  rmdir(folder.c_str());
  const std::uint64_t digest = digest_of(first, mode);
  if (digest_of(second, mode) != digest || digest_of(first, mode) != digest) fail("the two differ");
  return digest;
}

// Somebody else in the process has loaded all libraries with RTLD_GLOBAL: their symbols must not meet.
std::uint64_t loaded_globally(const std::vector<std::string>& paths, const Mode& mode) {
  for (const std::string& path : paths)
    if (!dlopen(path.c_str(), RTLD_NOW | RTLD_GLOBAL)) fail(dlerror());
  return digest_of(opened(paths), mode);
}

std::uint64_t reloaded(const std::vector<std::string>& paths, const Mode& mode) {
  const std::uint64_t digest = digest_of(opened(paths), mode);
  for (int k = 0; k < 3; ++k) {
    for (const std::string& path : paths)
      if (dlopen(path.c_str(), RTLD_NOLOAD | RTLD_LAZY)) fail(path + " is still loaded");
    if (digest_of(opened(paths), mode) != digest) fail("another result after reloading");
  }
  return digest;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) fail("usage: unusual_host MODE LIBRARY...");
  const std::string name = argv[1];
  const std::vector<std::string> paths(argv + 2, argv + argc);
  for (const Mode& mode : modes) {
    if (name != mode.name) continue;
    try {
      const std::uint64_t digest = name == "threads"  ? in_threads(paths, mode)
                                   : name == "twice"  ? loaded_twice(paths, mode)
                                   : name == "global" ? loaded_globally(paths, mode)
                                   : name == "reload" ? reloaded(paths, mode)
                                                      : digest_of(opened(paths), mode);
      std::printf("%016llx\n", static_cast<unsigned long long>(digest));
      return 0;
    } catch (const std::exception& error) {
      fail(error.what());
    }
  }
  fail("no mode " + name);
}
