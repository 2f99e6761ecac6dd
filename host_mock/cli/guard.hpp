// guard.hpp - what becomes of a run where a signal comes, or a law ends the program: it is named,
// and the exit code is not 0.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace ilaw::host {

// From here on a law that crashes, aborts or calls exit is named. After set_threads.
void guard_against_laws();
// Ctrl-C and kill end the run at the end of its step, with whole files. Where a law does not come
// back from it, a second one ends the program.
void catch_interrupts();
bool stop_requested();
// The program ends by itself from here on.
void end_guard();

}  // namespace ilaw::host
