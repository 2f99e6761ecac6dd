// Source of the format: System V ABI, Executable and Linking Format, and its supplement for x86-64.
// SPDX-License-Identifier: BSD-3-Clause
#include "elf_file.hpp"

#include "refusal.hpp"

#include <elf.h>

#include <cstring>

namespace ilaw::loading {
namespace {

#if defined(__x86_64__)
constexpr Elf64_Half this_machine = EM_X86_64;
#elif defined(__aarch64__)
constexpr Elf64_Half this_machine = EM_AARCH64;
#else
constexpr Elf64_Half this_machine = EM_NONE;
#endif

[[noreturn]] void refuse(const std::string& path, const std::string& found) {
  throw refusal(ILAW_BAD_LIBRARY,
                path + ": " + found + ", expected a whole ELF shared library for this machine");
}

}  // namespace

void check_elf(const std::string& path, std::uint64_t size, const byte_source& bytes) {
  const std::string truncated = "truncated at " + std::to_string(size) + " bytes";
  const auto require = [&](std::uint64_t offset, std::uint64_t count) {
    if (offset > size || count > size - offset) refuse(path, truncated);
  };
  const auto read = [&](std::uint64_t offset, void* to, std::size_t count) {
    require(offset, count);
    if (!bytes(offset, to, count)) refuse(path, truncated);
  };
  Elf64_Ehdr header{};
  if (size < SELFMAG) refuse(path, "not an ELF file");
  read(0, &header, SELFMAG);
  if (std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0) refuse(path, "not an ELF file");
  read(0, &header, EI_NIDENT);
  if (header.e_ident[EI_CLASS] != ELFCLASS64) refuse(path, "not a 64-bit ELF file");
  if (header.e_ident[EI_DATA] != ELFDATA2LSB) refuse(path, "not a little-endian ELF file");
  read(0, &header, sizeof header);
  if (header.e_type != ET_DYN) refuse(path, "ELF file of type " + std::to_string(header.e_type));
  if (this_machine != EM_NONE && header.e_machine != this_machine)
    refuse(path, "ELF file for machine " + std::to_string(header.e_machine));
  if (header.e_phentsize != sizeof(Elf64_Phdr))
    refuse(path, "program headers of " + std::to_string(header.e_phentsize) + " bytes");
  // Section headers end most files: a file cut anywhere is seen by them.
  require(header.e_shoff, std::uint64_t{header.e_shnum} * header.e_shentsize);
  require(header.e_phoff, std::uint64_t{header.e_phnum} * sizeof(Elf64_Phdr));
  for (std::uint64_t i = 0; i < header.e_phnum; ++i) {
    Elf64_Phdr segment;
    read(header.e_phoff + i * sizeof segment, &segment, sizeof segment);
    if (segment.p_type == PT_LOAD) require(segment.p_offset, segment.p_filesz);
  }
}

void check_shared_object(const std::string& path, const open_file& file) {
  constexpr std::uint64_t max_bytes = std::uint64_t{1} << 30;
  const file_status status = file.status();
  if (status.folder) refuse(path, "a folder");
  if (!status.regular) refuse(path, "not a regular file");
  if (status.size > max_bytes) refuse(path, "larger than 1 GiB");
  if (!file.is_open()) refuse(path, "the file cannot be read");
  if (status.anyone_writes)
    throw refusal(ILAW_BAD_LIBRARY,
                  path + ": every user may write to the file, expected no such permission (chmod o-w)");
  check_elf(path, status.size, [&file](std::uint64_t offset, void* to, std::size_t count) {
    return file.copy(offset, to, count);
  });
}

}  // namespace ilaw::loading
