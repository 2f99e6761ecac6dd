// elf_file.hpp - is a file a whole shared object of this machine? Asked before dlopen, which maps what the
// headers promise and dies of SIGBUS where a truncated file does not keep the promise.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace ilaw::loading {

// Throws refusal, naming what is wrong with the file.
void check_shared_object(const std::string& path);

}  // namespace ilaw::loading
