// Source of the format: System V ABI, Executable and Linking Format, and its supplement for x86-64.
// SPDX-License-Identifier: BSD-3-Clause
#include "elf_file.hpp"

#include "file.hpp"
#include "refusal.hpp"

#include <elf.h>

#include <array>
#include <cstring>
#include <utility>
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

// Whether [offset, offset + size) lies in that many bytes.
bool inside(std::uint64_t offset, std::uint64_t size, std::uint64_t bytes) {
  return offset <= bytes && size <= bytes - offset;
}

class elf_check {
 public:
  elf_check(const std::string& path, std::uint64_t size, byte_source bytes)
      : path_(path), size_(size), bytes_(std::move(bytes)) {}

  void run() {
    check_identity();
    read_segments();
    check_segments();
    read_dynamic();
    for (const Elf64_Dyn& entry : dynamic_) check_address(entry);
    check_tables();
    check_names();
  }

 private:
  [[noreturn]] void refuse(const std::string& found) const {
    throw refusal(ILAW_BAD_LIBRARY,
                  path_ + ": " + found + ", expected a whole ELF shared library for this machine");
  }
  [[noreturn]] void refuse_truncated() const { refuse("truncated at " + std::to_string(size_) + " bytes"); }

  template <class Entry>
  Entry read(std::uint64_t offset) const {
    Entry entry;
    if (!inside(offset, sizeof entry, size_) || !bytes_(offset, &entry, sizeof entry)) refuse_truncated();
    return entry;
  }

  void check_identity() {
    using magic = std::array<unsigned char, SELFMAG>;
    if (size_ < SELFMAG || std::memcmp(read<magic>(0).data(), ELFMAG, SELFMAG) != 0)
      refuse("not an ELF file");
    const auto identity = read<std::array<unsigned char, EI_NIDENT>>(0);
    if (identity[EI_CLASS] != ELFCLASS64) refuse("not a 64-bit ELF file");
    if (identity[EI_DATA] != ELFDATA2LSB) refuse("not a little-endian ELF file");
    header_ = read<Elf64_Ehdr>(0);
    if (header_.e_version != EV_CURRENT) refuse("ELF version " + std::to_string(header_.e_version));
    if (header_.e_type != ET_DYN) refuse("ELF file of type " + std::to_string(header_.e_type));
    if (this_machine != EM_NONE && header_.e_machine != this_machine)
      refuse("ELF file for machine " + std::to_string(header_.e_machine));
    if (!inside(header_.e_shoff, std::uint64_t{header_.e_shnum} * header_.e_shentsize, size_))
      refuse_truncated();
  }

  void read_segments() {
    if (header_.e_phentsize != sizeof(Elf64_Phdr) || header_.e_phnum == PN_XNUM)
      refuse("program headers of " + std::to_string(header_.e_phentsize) + " bytes");
    for (std::uint64_t i = 0; i < header_.e_phnum; ++i) {
      // Each offset is checked by itself: e_phoff + i entries may wrap round.
      if (!inside(header_.e_phoff, (i + 1) * sizeof(Elf64_Phdr), size_)) refuse_truncated();
      segments_.push_back(read<Elf64_Phdr>(header_.e_phoff + i * sizeof(Elf64_Phdr)));
    }
  }

  // Loaded segments lie in the file, go up in memory and do not overlap: what dlopen takes for granted.
  void check_segments() const {
    std::uint64_t end = 0;
    bool any = false;
    for (const Elf64_Phdr& s : segments_) {
      if (s.p_type != PT_LOAD) continue;
      if (!inside(s.p_offset, s.p_filesz, size_)) refuse_truncated();
      constexpr std::uint64_t most = std::uint64_t{1} << 40;  // of addresses; the processor has 2^47
      const bool aligned = s.p_align != 0 && (s.p_align & (s.p_align - 1)) == 0 &&
                           s.p_align <= (std::uint64_t{1} << 30) &&
                           s.p_vaddr % s.p_align == s.p_offset % s.p_align;
      if (s.p_filesz > s.p_memsz || s.p_memsz > most || s.p_vaddr > most || s.p_vaddr < end || !aligned)
        refuse("a segment that cannot be loaded, at " + std::to_string(s.p_vaddr));
      end = s.p_vaddr + s.p_memsz;
      any = true;
    }
    if (!any) refuse("no segment to load");
  }

  // Bytes of the file from an address to the end of its segment's; 0 where the address is none of the file's.
  std::uint64_t bytes_from(std::uint64_t address) const {
    for (const Elf64_Phdr& s : segments_)
      if (s.p_type == PT_LOAD && address >= s.p_vaddr && address - s.p_vaddr < s.p_filesz)
        return s.p_filesz - (address - s.p_vaddr);
    return 0;
  }
  std::uint64_t offset_of(std::uint64_t address) const {
    for (const Elf64_Phdr& s : segments_)
      if (s.p_type == PT_LOAD && address >= s.p_vaddr && address - s.p_vaddr < s.p_filesz)
        return s.p_offset + (address - s.p_vaddr);
    return size_;
  }

  void read_dynamic() {
    const Elf64_Phdr* found = nullptr;
    for (const Elf64_Phdr& s : segments_)
      if (s.p_type == PT_DYNAMIC) found = &s;
    if (!found) refuse("no dynamic segment");
    // dlopen reads it in memory, not in the file.
    const std::uint64_t room = bytes_from(found->p_vaddr), start = offset_of(found->p_vaddr);
    for (std::uint64_t at = 0; at + sizeof(Elf64_Dyn) <= room; at += sizeof(Elf64_Dyn)) {
      const auto entry = read<Elf64_Dyn>(start + at);
      if (entry.d_tag == DT_NULL) return;
      dynamic_.push_back(entry);
    }
    refuse("a dynamic section without end");
  }

  // 0 where the section has no such entry.
  std::uint64_t value_of(Elf64_Sxword tag) const {
    std::uint64_t value = 0;
    for (const Elf64_Dyn& entry : dynamic_)
      if (entry.d_tag == tag) value = entry.d_un.d_val;  // the last one counts, as in dlopen
    return value;
  }

  void check_address(const Elf64_Dyn& entry) const {
    switch (entry.d_tag) {
      case DT_STRTAB:
      case DT_SYMTAB:
      case DT_HASH:
      case DT_GNU_HASH:
      case DT_RELA:
      case DT_JMPREL:
      case DT_INIT_ARRAY:
      case DT_FINI_ARRAY:
      case DT_INIT:
      case DT_FINI:
      case DT_VERSYM:
      case DT_VERDEF:
      case DT_VERNEED:
      case DT_PREINIT_ARRAY:
        if (bytes_from(entry.d_un.d_ptr) == 0)
          refuse("a dynamic section that points outside the file, entry " + std::to_string(entry.d_tag));
        break;
      default:
        break;
    }
  }

  void check_tables() const {
    const struct {
      Elf64_Sxword table, size;
    } sized[] = {{DT_STRTAB, DT_STRSZ},
                 {DT_RELA, DT_RELASZ},
                 {DT_JMPREL, DT_PLTRELSZ},
                 {DT_INIT_ARRAY, DT_INIT_ARRAYSZ},
                 {DT_FINI_ARRAY, DT_FINI_ARRAYSZ}};
    for (const auto& pair : sized)
      if (value_of(pair.size) > 0 && bytes_from(value_of(pair.table)) < value_of(pair.size))
        refuse("a table that reaches beyond its segment, entry " + std::to_string(pair.table));
    if (value_of(DT_STRTAB) == 0 || value_of(DT_STRSZ) == 0 || value_of(DT_SYMTAB) == 0)
      refuse("no table of symbols");
    if (value_of(DT_HASH) == 0 && value_of(DT_GNU_HASH) == 0) refuse("no hash table of symbols");
  }

  // Texts of the dynamic section stand in a table of texts that ends with a zero.
  void check_names() const {
    const std::uint64_t texts = value_of(DT_STRSZ);
    for (const Elf64_Dyn& entry : dynamic_)
      if ((entry.d_tag == DT_NEEDED || entry.d_tag == DT_SONAME || entry.d_tag == DT_RPATH ||
           entry.d_tag == DT_RUNPATH) &&
          entry.d_un.d_val >= texts)
        refuse("a name outside the table of names");
    if (read<char>(offset_of(value_of(DT_STRTAB)) + texts - 1) != 0) refuse("a table of names without end");
  }

  const std::string& path_;
  std::uint64_t size_;
  byte_source bytes_;
  Elf64_Ehdr header_{};
  std::vector<Elf64_Phdr> segments_;
  std::vector<Elf64_Dyn> dynamic_;
};

}  // namespace

void check_elf(const std::string& path, std::uint64_t size, byte_source bytes) {
  elf_check(path, size, std::move(bytes)).run();
}

void check_shared_object(const std::string& path) {
  const auto refuse = [&path](const char* found) {
    throw refusal(ILAW_BAD_LIBRARY,
                  path + ": " + found + ", expected a whole ELF shared library for this machine");
  };
  constexpr std::uint64_t most = std::uint64_t{1} << 30;
  const file_status status = status_of(path);
  if (status.folder) refuse("a folder");
  if (!status.regular) refuse("not a regular file");
  if (status.size > most) refuse("larger than 1 GiB");
  const open_file file(path);
  if (!file.is_open()) refuse("the file cannot be read");
  check_elf(path, status.size, [&file](std::uint64_t offset, void* to, std::size_t count) {
    return file.copy(offset, to, count);
  });
}

}  // namespace ilaw::loading
