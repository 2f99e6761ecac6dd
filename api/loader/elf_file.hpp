// elf_file.hpp - is a file a whole shared object for this machine? Asked before dlopen, which maps the
// segments that the headers promise: in a file that was cut short it would raise SIGBUS.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "file.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

namespace ilaw::loading {

// Copies bytes of a file from an offset; false where it cannot.
using byte_source = std::function<bool(std::uint64_t offset, void* to, std::size_t size)>;

// Both throw refusal, naming what is wrong with the file, which path names. check_elf reads headers from a
// source of `size` bytes.
void check_shared_object(const std::string& path, const open_file& file);
void check_elf(const std::string& path, std::uint64_t size, const byte_source& bytes);

}  // namespace ilaw::loading
