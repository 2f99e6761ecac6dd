// Functions that throw, which C cannot do.
// SPDX-License-Identifier: BSD-3-Clause
#include <stdexcept>

extern "C" void throw_number() { throw 1; }
extern "C" void throw_error() { throw std::runtime_error("a table is missing"); }
