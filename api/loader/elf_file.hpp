// elf_file.hpp - is a file a whole shared object of this machine? Asked before dlopen, which maps what the
// headers promise and believes every address in them: it dies of a file that does not keep the promise.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>

namespace ilaw::loading {

// Throw refusal, naming what is wrong with the file; the second looks at its bytes alone.
void check_shared_object(const std::string& path);
void check_elf(const std::string& path, const unsigned char* bytes, std::size_t size);

}  // namespace ilaw::loading
