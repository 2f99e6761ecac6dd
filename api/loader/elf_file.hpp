// elf_file.hpp - is a file a whole shared object of this machine? Asked before dlopen, which maps what the
// headers promise and believes every address in them: it dies of a file that does not keep the promise.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

namespace ilaw::loading {

// Copies bytes of a file from an offset; false where it cannot.
using byte_source = std::function<bool(std::uint64_t offset, void* to, std::size_t size)>;

// Throw refusal, naming what is wrong with the file. Little of it is read: headers, and what they point to.
// The second looks at bytes alone, wherever they are, of a file of this size.
void check_shared_object(const std::string& path);
void check_elf(const std::string& path, std::uint64_t size, byte_source bytes);

}  // namespace ilaw::loading
