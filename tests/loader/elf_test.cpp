// Files that are no whole law libraries: dlopen would die of some, so it is not asked.
// SPDX-License-Identifier: BSD-3-Clause
#include <ilaw/loader.hpp>

#include <elf.h>
#include "support/program.hpp"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace {

using namespace ilaw::testing::matchers;
using namespace ilaw::testing::programs;
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

Elf64_Phdr& last_loaded(Bytes& bytes) {
  Elf64_Phdr* last = nullptr;
  for (std::uint64_t i = 0; i < header(bytes).e_phnum; ++i) {
    auto& found = entry_at<Elf64_Phdr>(bytes, header(bytes).e_phoff + i * sizeof(Elf64_Phdr));
    if (found.p_type == PT_LOAD) last = &found;
  }
  return *last;
}

struct File : TemporaryFolder {
  explicit File(const Bytes& bytes) {
    std::ofstream(name, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  }
  const std::string name = (path / "law.so").string();
};

// The code and message of opening those bytes, in a process of its own: some make the loader die.
std::string answer_to(const Bytes& bytes) {
  return run_command(ILAW_HOSTS "/search_host " + File(bytes).name + "; echo status $?").output;
}

TEST(ElfFile, WholeOneIsOpened) { EXPECT_EQ(answer_to(whole_library()), "0\nstatus 0\n"); }

// The loader's message on those bytes.
std::string refusal_of(const Bytes& bytes) {
  const File file(bytes);
  try {
    const ilaw::library library(file.name);
  } catch (const ilaw::error& error) {
    return error.what();
  }
  return "not refused";
}

// dlopen would refuse these, too, but not in these words.
TEST(ElfFile, IsRefusedByTheLoaderItself) {
  Bytes bytes = whole_library();
  header(bytes).e_machine = header(bytes).e_machine == EM_AARCH64 ? EM_X86_64 : EM_AARCH64;
  const std::string machine = "ELF file for machine " + std::to_string(header(bytes).e_machine);
  EXPECT_THAT(refusal_of(bytes), HasSubstr(machine));
}

TEST(ElfFile, IsRefusedInItsOwnWords) {
  const struct {
    const char* said;
    void (*done)(Bytes&);
  } cases[] = {{"not an ELF file", [](Bytes& b) { b.resize(3); }},
               {"not an ELF file", [](Bytes& b) { b[1] = 'e'; }},
               {"truncated at 10 bytes", [](Bytes& b) { b.resize(10); }},
               {"truncated at", [](Bytes& b) { b.resize(b.size() / 2); }},
               {"truncated at", [](Bytes& b) { b.resize(b.size() - 1); }},
               {"not a 64-bit ELF file", [](Bytes& b) { b[EI_CLASS] = ELFCLASS32; }},
               {"not a little-endian ELF file", [](Bytes& b) { b[EI_DATA] = ELFDATA2MSB; }},
               {"ELF file of type 2", [](Bytes& b) { header(b).e_type = ET_EXEC; }},
               {"truncated at", [](Bytes& b) { header(b).e_shoff = b.size() + 1; }},
               {"program headers of 57 bytes", [](Bytes& b) { header(b).e_phentsize = 57; }},
               {"truncated at", [](Bytes& b) { header(b).e_phoff = UINT64_MAX - 55; }},
               {"truncated at", [](Bytes& b) { segment(b, PT_LOAD).p_offset = UINT64_MAX - 55; }},
               // dlopen may refuse a file that the loader accepts.
               {"cannot be loaded: ", [](Bytes& b) {
                  const char* const text = "libc.so.6";
                  *std::search(b.begin(), b.end(), text, text + 9) = 'q';
                }}};
  int number = 0;
  for (const auto& one : cases) {
    Bytes bytes = whole_library();
    one.done(bytes);
    const std::string said = refusal_of(bytes);
    EXPECT_THAT(said, HasSubstr(std::string(": ") + one.said)) << "case " << number << ": "
                                                               << ", expected " << one.said;
    ++number;
  }
}

// Whatever is beyond the end of a file is a SIGBUS when dlopen clears the rest of its page.
TEST(ElfFile, IsRefusedWhenASegmentEndsBeyondIt) {
  Bytes bytes = whole_library();
  last_loaded(bytes).p_filesz += 1 << 20;
  last_loaded(bytes).p_memsz = last_loaded(bytes).p_filesz + 64;
  EXPECT_EQ(answer_to(bytes), std::to_string(ILAW_BAD_LIBRARY) + "\nstatus 0\n");
}

}  // namespace
