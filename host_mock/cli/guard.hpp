// guard.hpp - signals: a crash in a law's code names the call, and an interrupt ends a run at its next step.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace ilaw::host {

// From here on a law that crashes, aborts or calls exit on this thread is named, and the exit code is 1.
void name_crashes();
// The same, by overflow of their stacks, too, on the threads of OpenMP, which are made here if there are
// none.
void name_crashes_of_threads();
// From here on Ctrl-C, SIGTERM, and SIGHUP unless it is ignored, make stop_requested() true; a second one
// ends the program at once. Files under their final names are whole at any time.
void catch_interrupts();

// From here on the end of the process that started this one makes stop_requested() true.
void stop_with_parent();

}  // namespace ilaw::host
