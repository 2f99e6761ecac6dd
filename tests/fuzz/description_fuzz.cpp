// Any bytes as a library's description and as what an instance says of itself: pointers in it lead anywhere, into the
// bytes themselves, or into memory that is not there.
// SPDX-License-Identifier: BSD-3-Clause
#include <description.hpp>

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace {

using namespace ilaw::loading;

// A word of the form 0x51AA'0000'0000'oooo becomes a pointer to the byte of that offset, so that the fuzzer finds
// structs within structs; all other words stay the wild pointers and numbers that they are.
std::vector<std::uint64_t> relocated(const std::uint8_t* bytes, std::size_t size) {
  std::vector<std::uint64_t> words(size / 8 + 1);
  std::memcpy(words.data(), bytes, size);
  constexpr std::uint64_t mark = 0x51AA;
  for (std::uint64_t& word : words)
    if (word >> 48 == mark && (word & 0xFFFF) < size)
      word = reinterpret_cast<std::uint64_t>(reinterpret_cast<const char*>(words.data()) + (word & 0xFFFF));
  return words;
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
    }
    for (std::uint32_t v = 0; v < law.state_variable_count; ++v)
      letters += std::strlen(law.state_variables[v]->name);
  }
  return letters;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const std::vector<std::uint64_t> words = relocated(bytes, size);
  const void* start = words.data();
  storage kept;
  try {
    if (letters_of(*checked_plugin("fuzzed", static_cast<const ilaw_plugin*>(start), kept)) == SIZE_MAX) return 1;
  } catch (const refusal&) {
  }
  try {
    ilaw_law law{};
    law.id = "fuzzed";
    ilaw_setup setup{};
    setup.dimension = 3;
    ilaw_instance_info info{};
    copy_sized(&info, sizeof info, start, size);
    const std::string file = "fuzzed";
    check_instance_info({file, law, ILAW_ABI_MINOR}, setup, info, kept);
  } catch (const refusal&) {
  }
  return 0;
}
