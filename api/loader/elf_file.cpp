// SPDX-License-Identifier: BSD-3-Clause
#include "elf_file.hpp"

#include "refusal.hpp"

#include <elf.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <vector>

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

void check_identity(const std::string& path, const Elf64_Ehdr& header) {
  if (std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0) refuse(path, "not an ELF file");
  if (header.e_ident[EI_CLASS] != ELFCLASS64) refuse(path, "not a 64-bit ELF file");
  if (header.e_type != ET_DYN) refuse(path, "ELF file of type " + std::to_string(header.e_type));
  if (this_machine != EM_NONE && header.e_machine != this_machine)
    refuse(path, "ELF file for machine " + std::to_string(header.e_machine));
}

// Whether [offset, offset + size) lies in a file of that many bytes.
bool inside(std::uint64_t offset, std::uint64_t size, std::uint64_t bytes) {
  return offset <= bytes && size <= bytes - offset;
}

}  // namespace

void check_shared_object(const std::string& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) refuse(path, "a folder");
  if (!std::filesystem::is_regular_file(path, error)) refuse(path, "not a regular file");
  std::ifstream file(path, std::ios::binary);
  if (!file) refuse(path, "the file cannot be read");
  const std::uint64_t bytes = std::filesystem::file_size(path);
  const std::string truncated = "truncated at " + std::to_string(bytes) + " bytes";

  Elf64_Ehdr header{};
  file.read(reinterpret_cast<char*>(&header), sizeof header);
  if (file.gcount() < static_cast<std::streamsize>(SELFMAG)) refuse(path, "not an ELF file");
  check_identity(path, header);
  if (!file) refuse(path, truncated);
  if (header.e_phentsize != sizeof(Elf64_Phdr) ||
      !inside(header.e_phoff, std::uint64_t{header.e_phnum} * sizeof(Elf64_Phdr), bytes) ||
      !inside(header.e_shoff, std::uint64_t{header.e_shnum} * header.e_shentsize, bytes))
    refuse(path, truncated);

  std::vector<Elf64_Phdr> segments(header.e_phnum);
  file.seekg(static_cast<std::streamoff>(header.e_phoff));
  file.read(reinterpret_cast<char*>(segments.data()),
            static_cast<std::streamsize>(segments.size() * sizeof(Elf64_Phdr)));
  if (!file) refuse(path, truncated);
  for (const Elf64_Phdr& segment : segments)
    if (segment.p_type == PT_LOAD && !inside(segment.p_offset, segment.p_filesz, bytes))
      refuse(path, truncated);
}

}  // namespace ilaw::loading
