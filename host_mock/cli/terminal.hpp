// terminal.hpp - what the program says: no text of a scene or library steers the terminal, and what
// stdout does not take is no success.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace ilaw::host {

// Where a stream was closed at the start, the next file opened would take its place, and messages
// would land in results: they go nowhere instead.
void open_standard_streams();

// Control characters as \x1b, so that a terminal shows them.
std::string printable(std::string_view text);

// On stderr, after the program's name; the lines after the first are indented.
void complain(std::string_view text);

// Complains of folders in ILAW_PATH that the loader leaves out.
void warn_of_search_path();

// Complains of an instruction set in ILAW_ISA that no law knows: a law would take another one in silence.
bool knows_instruction_set();

// code, or exit_failed where stdout did not take all that was printed.
int after_output(int code);

}  // namespace ilaw::host
