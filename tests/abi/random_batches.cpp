// random_batches - hostile batches for the laws of libraries, meant to run under sanitizers: what a law is
// given may be wrong in any way but its addresses. Stops at the first promise broken, with all that is needed
// to repeat it. Its last number is a digest of what the laws gave: the same in every mode, in which the
// process is set up as some industrial code sets up its own. Usage: random_batches [--mode MODE] [--batches
// N] [--seed S] LIBRARY...
// SPDX-License-Identifier: BSD-3-Clause
#include "batch_source.hpp"

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

// In a mode's own words; it may stand within a law's call, which is no place for an exception.
[[noreturn]] void fail(const std::string& what) {
  std::fprintf(stderr, "random_batches: %s\n", what.c_str());
  std::exit(1);
}

// ---- modes: what the host sets before each call, and looks at after it ------------------------------------

// As gfortran -ffpe-trap=zero,invalid,overflow,underflow.
void trap() {
  feclearexcept(FE_ALL_EXCEPT);
  feenableexcept(FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW | FE_UNDERFLOW);
}
void trap_no_more() { fedisableexcept(FE_ALL_EXCEPT); }

void clear_flags() { feclearexcept(FE_ALL_EXCEPT); }
void expect_no_flags() {
  if (const int raised = fetestexcept(FE_ALL_EXCEPT)) fail("a law raised flags " + std::to_string(raised));
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

struct Options;
Tally opened_and_run(const Options& options);
Tally in_threads(const Options& options);
Tally loaded_twice(const Options& options);
Tally loaded_globally(const Options& options);
Tally reloaded(const Options& options);

struct Mode {
  const char* name;
  Tally (*run)(const Options&);
  void (*before)() = nullptr;
  void (*after)() = nullptr;
};
constexpr Mode modes[] = {{"plain", opened_and_run},
                          {"trap", opened_and_run, trap, trap_no_more},
                          {"flags", opened_and_run, clear_flags, expect_no_flags},
                          {"upward", opened_and_run, round_up, round_to_nearest},
                          {"flush", opened_and_run, flush, flush_no_more},
                          {"threads", in_threads},
                          {"twice", loaded_twice},
                          {"global", loaded_globally},
                          {"reload", reloaded}};

struct Options {
  const Mode* mode = modes;
  std::uint64_t batches = 100000, seed = 1;
  std::vector<std::string> libraries;
};

Options options_of(int argc, char** argv) {
  Options options;
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k];
    const bool is_option = word == "--mode" || word == "--batches" || word == "--seed";
    if (word.rfind("--", 0) != 0) {
      options.libraries.push_back(word);
      continue;
    }
    if (!is_option || k + 1 == argc)
      throw std::runtime_error("usage: random_batches [--mode MODE] [--batches N] [--seed S] LIBRARY...");
    const std::string value = argv[++k];
    if (word != "--mode") {
      (word == "--seed" ? options.seed : options.batches) = std::strtoull(value.c_str(), nullptr, 10);
      continue;
    }
    options.mode = nullptr;
    for (const Mode& mode : modes)
      if (value == mode.name) options.mode = &mode;
    if (!options.mode) throw std::runtime_error("no mode " + value);
  }
  if (options.libraries.empty()) throw std::runtime_error("no LIBRARY given");
  return options;
}

// ---- runs
// ---------------------------------------------------------------------------------------------------

// Every run has a seed of its own, so that the last one can be repeated alone.
void run(const std::vector<ilaw::library>& libraries, std::uint64_t seed, const Mode& mode, Arena& arena,
         Tally& tally) {
  Draw draw(seed);
  const std::optional<Drawn> drawn = Drawn::of(libraries[draw.below(libraries.size())], draw);
  if (!drawn) return;
  constexpr std::uint64_t odds[] = {0, 5, 30, 300};
  for (int k = 0; k < 8 && tally.wrong.empty(); ++k) {
    Runner runner(*drawn, draw, {odds[draw.below(4)]}, arena);
    runner.before = mode.before;
    runner.after = mode.after;
    runner.run(1 + static_cast<int>(draw.below(20)), tally);
  }
}

Tally run_all(const std::vector<ilaw::library>& libraries, const Options& options) {
  Arena arena;
  Tally tally;
  std::uint64_t seed = options.seed;
  for (; tally.batches < options.batches && tally.wrong.empty(); ++seed)
    run(libraries, seed, *options.mode, arena, tally);
  if (!tally.wrong.empty()) tally.wrong += "; repeat with --batches 1 --seed " + std::to_string(seed - 1);
  return tally;
}

std::vector<ilaw::library> opened(const std::vector<std::string>& paths) {
  std::vector<ilaw::library> libraries;
  for (const std::string& path : paths) libraries.emplace_back(path);
  return libraries;
}
Tally opened_and_run(const Options& options) { return run_all(opened(options.libraries), options); }

// Each thread opens, creates and runs on its own; they share what the loader and the libraries share.
Tally in_threads(const Options& options) {
  std::vector<Tally> tallies(4);
  std::vector<std::thread> threads;
  for (Tally& tally : tallies) threads.emplace_back([&] { tally = opened_and_run(options); });
  for (std::thread& thread : threads) thread.join();
  for (const Tally& tally : tallies)
    if (tally.digest != tallies[0].digest) fail("threads differ");
  return tallies[0];
}

// A second copy of each library, from another file, is loaded and used while the first is.
Tally loaded_twice(const Options& options) {
  std::string folder = "/tmp/ilaw_twice_XXXXXX";
  if (!mkdtemp(folder.data())) fail("no folder for copies");
  std::vector<std::string> copies;
  for (const std::string& path : options.libraries) {
    copies.push_back(folder + path.substr(path.rfind('/')));
    std::ofstream(copies.back(), std::ios::binary) << std::ifstream(path, std::ios::binary).rdbuf();
  }
  const std::vector<ilaw::library> first = opened(options.libraries), second = opened(copies);
  for (const std::string& copy : copies) unlink(copy.c_str());
  rmdir(folder.c_str());
  const Tally tally = run_all(first, options);
  if (run_all(second, options).digest != tally.digest || run_all(first, options).digest != tally.digest)
    fail("the two differ");
  return tally;
}

// Somebody else in the process has loaded all libraries with RTLD_GLOBAL: their symbols must not meet.
Tally loaded_globally(const Options& options) {
  for (const std::string& path : options.libraries)
    if (!dlopen(path.c_str(), RTLD_NOW | RTLD_GLOBAL)) fail(dlerror());
  return opened_and_run(options);
}

Tally reloaded(const Options& options) {
  const Tally tally = opened_and_run(options);
  for (int k = 0; k < 3; ++k) {
    for (const std::string& path : options.libraries)
      if (dlopen(path.c_str(), RTLD_NOLOAD | RTLD_LAZY)) fail(path + " is still loaded");
    if (opened_and_run(options).digest != tally.digest) fail("another result after reloading");
  }
  return tally;
}

unsigned long long number(std::uint64_t value) { return value; }

}  // namespace

int main(int argc, char** argv) {
  try {
    const Options options = options_of(argc, argv);
    const Tally tally = options.mode->run(options);
    std::printf(
        "%llu batches, %llu of floats, %llu nodes, %llu of them bad, %llu calls refused, digest %016llx\n",
        number(tally.batches), number(tally.of_floats), number(tally.nodes), number(tally.bad),
        number(tally.refused), number(tally.digest));
    if (!tally.wrong.empty()) fail(tally.wrong);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "random_batches: %s\n", error.what());
    return 2;
  }
}
