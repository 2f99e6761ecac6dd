// The user library of OpenRadioss: a user window keeps the state of a law in the engine's restart file, and
// books its energy. sync(context) of the deck calls ilaw_openradioss_sync at the end of a cycle, where the
// law acts with all forces known (ilaw_openradioss_window.py). The window is not a place for it: it has those
// of the step before.
// SPDX-License-Identifier: BSD-3-Clause
#include "window.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <iterator>
#include <memory>
#include <stdexcept>

extern "C" void set_user_window_nodes_(const int* nodes, const int* count)
    __attribute__((weak));  // the starter has it

namespace {

using ilaw::openradioss::Arrays;
using ilaw::openradioss::Window;

struct Run {
  std::unique_ptr<Window> window;
  Arrays arrays{};         // as the call before the first cycle shows them
  double last_step = 0.0;  // of the run that this one continues
};
Run the_run;  // An engine is a process.

[[noreturn]] void stop(const char* where, const std::string& why) {
  std::fprintf(stderr, "\n ilaw: %s: %s\n", where, why.c_str());
  std::exit(2);
}

std::string scratch_file(const char* kind, const char* root, int length) {
  return kind + std::string(root, static_cast<std::size_t>(length)) + "_0001.scr";
}

std::string lines_of(const char* root, int length) {
  std::ifstream file(scratch_file("SI", root, length));
  return {std::istreambuf_iterator<char>(file), {}};
}

void tell_starter(const std::string& text, const char* root, int length) {
  std::ofstream(scratch_file("SO", root, length)) << text << '\n';
}

// The lines in the restart file: their length, and a number per character.
std::string lines_from(const int* numbers) {
  std::string lines(static_cast<std::size_t>(numbers[0]), ' ');
  std::transform(numbers + 1, numbers + 1 + numbers[0], lines.begin(),
                 [](int number) { return static_cast<char>(number); });
  return lines;
}

void begin_run(const int* text, double* memory, int memory_size) {
  if (!the_run.arrays.user)
    throw std::runtime_error(
        "found no call of sync, expected a def sync(context) in the deck that calls "
        "ilaw_openradioss_window.sync");
  auto made = std::make_unique<Window>(lines_from(text));
  if (made->memory_size() != static_cast<std::size_t>(memory_size))
    throw std::runtime_error("restart file: found " + std::to_string(memory_size) + " numbers, expected " +
                             std::to_string(made->memory_size()) +
                             ": start with the library that the run goes on with");
  made->bind(the_run.arrays, memory, the_run.last_step);
  the_run.window = std::move(made);
}

}  // namespace

extern "C" {

// Arguments that are not used have no name. The starter's and the engine's types are C's, by reference.

void userlib_id(int* version) { *version = 1; }

// The starter asks for the sizes of the memory.
void st_userwis_ini_(const char* root, const int* length, int*, const int*, const int*, const double*,
                     const double*, const double*, const double*, const double*, int* numbers,
                     int* integers) try {
  const std::string lines = lines_of(root, *length);
  const Window made(lines);
  const std::vector<int>& nodes = made.settings().nodes;
  const int one = 1;  // the starter of August 2026 writes a number per node into an empty list
  set_user_window_nodes_(nodes.data(), &one);
  *numbers = static_cast<int>(made.memory_size());
  *integers = static_cast<int>(lines.size()) + 1;
  tell_starter(
      "\n     INTERFACE LAW " + made.settings().law + " AT " + std::to_string(nodes.size()) + " NODES\n",
      root, *length);
} catch (const std::exception& problem) {
  stop("/USERWI", problem.what());
}

// The starter fills it.
void st_userwis_(const char* root, const int* length, const int*, const int*, const double*, const double*,
                 const double*, const double*, const double*, const int*, const int*, double*,
                 int* integers) {
  const std::string lines = lines_of(root, *length);
  integers[0] = static_cast<int>(lines.size());
  std::copy(lines.begin(), lines.end(), integers + 1);
  tell_starter("", root, *length);
}

// The engine, at the start of a cycle.
void eng_userwi_(const char*, const int*, const int* memory_size, const int*, const int*, const int*,
                 const int*, const int* text, const int*, const double*, const double*, double*, double*,
                 double* external_work, double* memory, const double*, const double*, const double*,
                 const double*, const double*, const double*, const double*, const double*, double*, double*,
                 double*) try {
  if (!the_run.window) begin_run(text, memory, *memory_size);
  *external_work += the_run.window->take_work();
} catch (const std::exception& problem) {
  stop("/USERWI", problem.what());
}

// For sync(context): before the first cycle, and at the end of each one.
void ilaw_openradioss_sync(double time, double step, long count, const int* user, const int* kinematic,
                           double* x, double* v, double* d, const double* mass) try {
  if (!the_run.arrays.user) {
    the_run.arrays = {static_cast<std::size_t>(count), user, kinematic, x, v, d, mass};
    the_run.last_step = step;
  } else if (!the_run.window) {
    throw std::runtime_error("found no window, expected a /USERWI in the deck");
  } else {
    the_run.window->apply(time, step);
  }
} catch (const std::exception& problem) {
  stop("sync", problem.what());
}

// OpenRadioss takes no library without these. Decks call them for user materials, properties and sensors.
#define ILAW_UNUSED(name) \
  void name() { stop(#name, "this user library has a user window only"); }
ILAW_UNUSED(st_lecg_)
ILAW_UNUSED(st_lecguser_)
ILAW_UNUSED(st_lecm_)
ILAW_UNUSED(st_lecr_)
ILAW_UNUSED(st_lecm99_)
ILAW_UNUSED(st_lecsen_)
ILAW_UNUSED(st_riniuser_)
ILAW_UNUSED(st_siniusr_)
ILAW_UNUSED(st_get_userbuf_var_)
ILAW_UNUSED(eng_ruser_)
ILAW_UNUSED(eng_sigeps_)
ILAW_UNUSED(eng_sigepsc_)
ILAW_UNUSED(eng_flaw_)
ILAW_UNUSED(eng_flawc_)
ILAW_UNUSED(eng_suser_)
ILAW_UNUSED(eng_userint_)
ILAW_UNUSED(eng_get_uintbuf_var_)
ILAW_UNUSED(eng_user_sens_)
ILAW_UNUSED(eng_get_lawc_user_var_)
ILAW_UNUSED(eng_sigeps99c_)
ILAW_UNUSED(eng_set_lawc_user_var_)
ILAW_UNUSED(eng_get_law_user_var_)
ILAW_UNUSED(eng_sigeps99_)
ILAW_UNUSED(eng_set_law_user_var_)
#undef ILAW_UNUSED
}
