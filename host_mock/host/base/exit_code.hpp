// exit_code.hpp - exit codes of the program, as in its help.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace ilaw::host {

enum ExitCode { exit_done = 0, exit_failed = 1, exit_bad_input = 2, exit_missed = 3 };

}  // namespace ilaw::host
