// Any bytes as a law library: the check answers or refuses, and what it accepts dlopen can map.
// SPDX-License-Identifier: BSD-3-Clause
#include <elf_file.hpp>
#include <refusal.hpp>

#include <cstdint>
#include <cstring>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  try {
    ilaw::loading::check_elf("fuzzed", size, [bytes](std::uint64_t offset, void* to, std::size_t count) {
      std::memcpy(to, bytes + offset, count);
      return true;
    });
  } catch (const ilaw::loading::refusal&) {
  }
  return 0;
}
