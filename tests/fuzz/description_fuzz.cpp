// Any bytes as a library's description and as what an instance says of itself: pointers in it lead anywhere,
// into the bytes themselves, or into memory that is not there.
// SPDX-License-Identifier: BSD-3-Clause
#include <description.hpp>

#include <cstdint>
#include <cstring>
#include <string>

namespace {

using namespace ilaw::loading;

// All memory that there is: it ends with a page, since texts are read page by page.
struct {
  char* start = nullptr;
  std::size_t size = 0;
} memory;

// The bytes there, of which a word of the form 0x51AA'0000'0000'oooo leads back into them, to the byte of
// that offset: so the fuzzer finds structs within structs. All other words are the wild pointers that they
// are.
void relocate(const std::uint8_t* bytes, std::size_t size) {
  constexpr std::size_t page = 4096, room = 17 * page;
  alignas(page) static char pages[room];
  memory = {pages + room - size, size};
  if (size > 0) std::memcpy(memory.start, bytes, size);
  constexpr std::uint64_t mark = 0x51AA;
  for (std::size_t at = 0; at + 8 <= size; at += 8) {
    std::uint64_t word;
    std::memcpy(&word, memory.start + at, sizeof word);
    if (word >> 48 != mark || (word & 0xFFFF) >= size) continue;
    word = reinterpret_cast<std::uint64_t>(memory.start + (word & 0xFFFF));
    std::memcpy(memory.start + at, &word, sizeof word);
  }
}

// Reads all that a host may read of a checked description.
std::size_t letters_of(const ilaw_plugin& plugin) {
  std::size_t letters = std::strlen(plugin.name) + std::strlen(plugin.licence);
  for (std::uint32_t i = 0; i < plugin.law_count; ++i) {
    const ilaw_law& law = *plugin.laws[i];
    letters += std::strlen(law.id) + std::strlen(law.title);
    for (std::uint32_t p = 0; p < law.parameter_count; ++p) {
      letters += std::strlen(law.parameters[p]->name) + std::strlen(law.parameters[p]->doc);
      for (std::uint32_t c = 0; c < law.parameters[p]->choice_count; ++c)
        letters += std::strlen(law.parameters[p]->choices[c]);
      for (std::uint32_t a = 0; a < law.parameters[p]->axis_count; ++a)
        letters += std::strlen(law.parameters[p]->axes[a]);
    }
    for (std::uint32_t a = 0; a < law.amount_count; ++a) letters += std::strlen(law.amounts[a]->unit);
    for (std::uint32_t v = 0; v < law.state_variable_count; ++v)
      letters += std::strlen(law.state_variables[v]->name);
  }
  return letters;
}

}  // namespace

// The loader's asks the kernel, which would also read the sanitizer's own memory.
bool ilaw::loading::readable(const void* address, std::size_t size) {
  const auto first = reinterpret_cast<std::uintptr_t>(address);
  const auto start = reinterpret_cast<std::uintptr_t>(memory.start);
  return size > 0 && first >= start && first - start <= memory.size && size <= memory.size - (first - start);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  if (size > 65536) return 0;
  relocate(bytes, size);
  storage kept;
  try {
    if (letters_of(*checked_plugin("fuzzed", reinterpret_cast<const ilaw_plugin*>(memory.start), kept)) ==
        SIZE_MAX)
      return 1;
  } catch (const refusal&) {
  }
  try {
    ilaw_law law{};
    law.id = "fuzzed";
    ilaw_setup setup{};
    setup.dimension = 3;
    ilaw_instance_info info{};
    ilaw::sized::copy(&info, sizeof info, memory.start, size);
    const std::string file = "fuzzed";
    instance_descriptions known;
    instance_description* one = known.checked({file, law, ILAW_ABI_MINOR}, setup, info);
    if (known.checked({file, law, ILAW_ABI_MINOR}, setup, info) != one) return 1;
    for (int k = 0; k < 2; ++k) known.give_back(one);
  } catch (const refusal&) {
  }
  return 0;
}
