// Files that are almost law libraries: dlopen would die of what is wrong with them, so it is not asked.
// SPDX-License-Identifier: BSD-3-Clause
#include <ilaw/loader.hpp>

#include <elf.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

namespace {

using Bytes = std::vector<char>;

Bytes whole_library() {
  std::ifstream file(ILAW_TEST_PLUGINS "/good.so", std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

template <class Entry>
Entry& entry_at(Bytes& bytes, std::uint64_t offset) {
  return *reinterpret_cast<Entry*>(bytes.data() + offset);  // tables of ELF are aligned
}

Elf64_Ehdr& header(Bytes& bytes) { return entry_at<Elf64_Ehdr>(bytes, 0); }

Elf64_Phdr& segment(Bytes& bytes, Elf64_Word type) {
  for (std::uint64_t i = 0; i < header(bytes).e_phnum; ++i) {
    auto& found = entry_at<Elf64_Phdr>(bytes, header(bytes).e_phoff + i * sizeof(Elf64_Phdr));
    if (found.p_type == type) return found;
  }
  throw std::runtime_error("no such segment");
}

Elf64_Dyn& dynamic(Bytes& bytes, Elf64_Sxword tag) {
  for (std::uint64_t at = segment(bytes, PT_DYNAMIC).p_offset;; at += sizeof(Elf64_Dyn)) {
    auto& found = entry_at<Elf64_Dyn>(bytes, at);
    if (found.d_tag == tag) return found;
    if (found.d_tag == DT_NULL) throw std::runtime_error("no such entry");
  }
}

Elf64_Phdr& last_loaded(Bytes& bytes) {
  Elf64_Phdr* last = nullptr;
  for (std::uint64_t i = 0; i < header(bytes).e_phnum; ++i) {
    auto& found = entry_at<Elf64_Phdr>(bytes, header(bytes).e_phoff + i * sizeof(Elf64_Phdr));
    if (found.p_type == PT_LOAD) last = &found;
  }
  return *last;
}

// The last byte of the table of names, in the first loaded segment, which begins the file.
char& end_of_names(Bytes& bytes) {
  return bytes[dynamic(bytes, DT_STRTAB).d_un.d_ptr + dynamic(bytes, DT_STRSZ).d_un.d_val - 1];
}

// The code and message of opening those bytes, in a process of its own: some make the loader die.
std::string answer_to(const Bytes& bytes) {
  const std::string path = testing::TempDir() + "ilaw_elf_" + std::to_string(getpid()) + ".so";
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  FILE* pipe = popen((ILAW_HOSTS "/search_host " + path + " 2>&1; echo status $?").c_str(), "r");
  std::string text;
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) text += static_cast<char>(c);
  pclose(pipe);
  unlink(path.c_str());
  return text;
}

TEST(ElfFile, WholeOneIsOpened) { EXPECT_EQ(answer_to(whole_library()), "0\nstatus 0\n"); }

// What the loader says of those bytes.
std::string refusal_of(const Bytes& bytes) {
  const std::string path = testing::TempDir() + "ilaw_refused_" + std::to_string(getpid()) + ".so";
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  std::string said = "not refused";
  try {
    const ilaw::library library(path);
  } catch (const ilaw::error& error) {
    said = error.what();
  }
  unlink(path.c_str());
  return said;
}

// dlopen would refuse these, too, but not in these words.
TEST(ElfFile, IsRefusedByTheLoaderItself) {
  Bytes bytes = whole_library();
  header(bytes).e_machine = header(bytes).e_machine == EM_AARCH64 ? EM_X86_64 : EM_AARCH64;
  const std::string machine = "ELF file for machine " + std::to_string(header(bytes).e_machine);
  EXPECT_NE(refusal_of(bytes).find(machine), std::string::npos) << refusal_of(bytes);
  bytes = whole_library();
  end_of_names(bytes) = 'x';
  EXPECT_NE(refusal_of(bytes).find("a table of names without end"), std::string::npos) << refusal_of(bytes);
}

Elf64_Phdr& first_segment(Bytes& bytes) { return entry_at<Elf64_Phdr>(bytes, header(bytes).e_phoff); }

TEST(ElfFile, IsRefusedInItsOwnWords) {
  const struct {
    const char* said;
    void (*done)(Bytes&);
  } cases[] = {
      {"not an ELF file", [](Bytes& b) { b.resize(3); }},
      {"not an ELF file", [](Bytes& b) { b[1] = 'e'; }},
      {"truncated at 10 bytes", [](Bytes& b) { b.resize(10); }},
      {"not a 64-bit ELF file", [](Bytes& b) { b[EI_CLASS] = ELFCLASS32; }},
      {"not a little-endian ELF file", [](Bytes& b) { b[EI_DATA] = ELFDATA2MSB; }},
      {"ELF version 7", [](Bytes& b) { header(b).e_version = 7; }},
      {"ELF file of type 2", [](Bytes& b) { header(b).e_type = ET_EXEC; }},
      {"truncated at", [](Bytes& b) { header(b).e_shoff = b.size() + 1; }},
      {"program headers of 57 bytes", [](Bytes& b) { header(b).e_phentsize = 57; }},
      {"program headers of 56 bytes", [](Bytes& b) { header(b).e_phnum = PN_XNUM; }},
      {"a segment that cannot be loaded, at",
       [](Bytes& b) { last_loaded(b).p_vaddr = first_segment(b).p_vaddr; }},
      {"a segment that cannot be loaded, at", [](Bytes& b) { last_loaded(b).p_align = 0; }},
      {"a segment that cannot be loaded, at",
       [](Bytes& b) { last_loaded(b).p_align = std::uint64_t{1} << 40; }},
      {"a segment that cannot be loaded, at", [](Bytes& b) { last_loaded(b).p_vaddr += 8; }},
      {"a dynamic section without end",
       [](Bytes& b) {
         const Elf64_Phdr found = segment(b, PT_DYNAMIC);
         for (std::uint64_t at = found.p_offset; at + sizeof(Elf64_Dyn) <= b.size(); at += sizeof(Elf64_Dyn))
           if (entry_at<Elf64_Dyn>(b, at).d_tag == DT_NULL) entry_at<Elf64_Dyn>(b, at).d_tag = DT_DEBUG;
       }},
      {"no table of symbols", [](Bytes& b) { dynamic(b, DT_SYMTAB).d_tag = DT_DEBUG; }},
      {"no hash table of symbols", [](Bytes& b) { dynamic(b, DT_GNU_HASH).d_tag = DT_DEBUG; }},
      {"a table that reaches beyond its segment, entry 7",
       [](Bytes& b) { dynamic(b, DT_RELASZ).d_un.d_val = 1 << 30; }},
      {"a dynamic section that points outside the file, entry 12",
       [](Bytes& b) { dynamic(b, DT_INIT).d_un.d_ptr = 0x7000000000; }},
      {"a name outside the table of names", [](Bytes& b) { dynamic(b, DT_NEEDED).d_un.d_val = 1 << 30; }},
      // What the loader lets pass, dlopen may not.
      {"cannot be loaded: ", [](Bytes& b) {
         const char* const text = "libc.so.6";
         *std::search(b.begin(), b.end(), text, text + 9) = 'q';
       }}};
  int number = 0;
  for (const auto& one : cases) {
    Bytes bytes = whole_library();
    one.done(bytes);
    const std::string said = refusal_of(bytes);
    EXPECT_NE(said.find(std::string(": ") + one.said), std::string::npos)
        << "case " << number << ": " << said << ", expected " << one.said;
    ++number;
  }
}

struct Damage {
  const char* name;
  std::function<void(Bytes&)> done;

  friend void PrintTo(const Damage& damage, std::ostream* out) { *out << damage.name; }
};

class DamagedElfFile : public testing::TestWithParam<Damage> {};

TEST_P(DamagedElfFile, IsRefused) {
  Bytes bytes = whole_library();
  GetParam().done(bytes);
  EXPECT_EQ(answer_to(bytes), std::to_string(ILAW_BAD_LIBRARY) + "\nstatus 0\n");
}

constexpr std::uint64_t nowhere = 0x7000000000;

INSTANTIATE_TEST_SUITE_P(
    Loader, DamagedElfFile,
    testing::Values(
        Damage{"BigEndian", [](Bytes& b) { b[EI_DATA] = ELFDATA2MSB; }},
        Damage{"OtherVersion", [](Bytes& b) { header(b).e_version = 7; }},
        Damage{"WrappingHeaders", [](Bytes& b) { header(b).e_phoff = UINT64_MAX - 55; }},
        Damage{"NothingToLoad",
               [](Bytes& b) {
                 for (std::uint64_t i = 0; i < header(b).e_phnum; ++i) {
                   auto& s = entry_at<Elf64_Phdr>(b, header(b).e_phoff + i * sizeof(Elf64_Phdr));
                   if (s.p_type == PT_LOAD) s.p_type = PT_NULL;
                 }
               }},
        Damage{"NoDynamicSegment", [](Bytes& b) { segment(b, PT_DYNAMIC).p_type = PT_NULL; }},
        Damage{"DynamicSegmentElsewhere", [](Bytes& b) { segment(b, PT_DYNAMIC).p_vaddr = nowhere; }},
        Damage{"HugeSegment", [](Bytes& b) { segment(b, PT_LOAD).p_memsz = UINT64_MAX / 2; }},
        Damage{"SegmentLessThanItsFile", [](Bytes& b) { segment(b, PT_LOAD).p_memsz = 8; }},
        Damage{"SegmentFarAway", [](Bytes& b) { segment(b, PT_LOAD).p_vaddr = nowhere << 12; }},
        // What is beyond the end of a file is a SIGBUS when dlopen clears the rest of its page.
        Damage{"SegmentBeyondTheFile",
               [](Bytes& b) {
                 last_loaded(b).p_filesz += 1 << 20;
                 last_loaded(b).p_memsz = last_loaded(b).p_filesz + 64;
               }},
        Damage{"OddAlignment", [](Bytes& b) { segment(b, PT_LOAD).p_align = 12288; }},
        Damage{"NamesElsewhere", [](Bytes& b) { dynamic(b, DT_STRTAB).d_un.d_ptr = nowhere; }},
        Damage{"SymbolsElsewhere", [](Bytes& b) { dynamic(b, DT_SYMTAB).d_un.d_ptr = nowhere; }},
        Damage{"NoSymbols", [](Bytes& b) { dynamic(b, DT_SYMTAB).d_tag = DT_DEBUG; }},
        Damage{"NoNames", [](Bytes& b) { dynamic(b, DT_STRTAB).d_tag = DT_DEBUG; }},
        Damage{"HashesElsewhere", [](Bytes& b) { dynamic(b, DT_GNU_HASH).d_un.d_ptr = nowhere; }},
        Damage{"RelocationsElsewhere", [](Bytes& b) { dynamic(b, DT_RELA).d_un.d_ptr = nowhere; }},
        Damage{"RelocationsWithoutEnd", [](Bytes& b) { dynamic(b, DT_RELASZ).d_un.d_val = 1 << 30; }},
        Damage{"InitialiserElsewhere", [](Bytes& b) { dynamic(b, DT_INIT).d_un.d_ptr = nowhere; }},
        Damage{"NeededNameElsewhere", [](Bytes& b) { dynamic(b, DT_NEEDED).d_un.d_val = 1 << 30; }},
        Damage{"NoHashes", [](Bytes& b) { dynamic(b, DT_GNU_HASH).d_tag = DT_DEBUG; }}),
    [](const auto& drawn) { return drawn.param.name; });

}  // namespace
