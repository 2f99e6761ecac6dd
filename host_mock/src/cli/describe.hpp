// describe.hpp - `ilaw list` and `ilaw describe`: what libraries say of themselves.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace ilaw::host {

// Prints the laws of all libraries on the search path; a broken library is listed with its refusal. Returns
// an ExitCode.
int list_laws();

// Prints all laws of a library, found by law name or file; as text or JSON. Returns an ExitCode.
int describe(const std::string& law_or_file, bool as_json);

}  // namespace ilaw::host
