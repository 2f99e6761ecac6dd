// Any bytes as the JSON file beside a library: it is refused, or everything that `ilaw list` reads is there.
// SPDX-License-Identifier: BSD-3-Clause
#include <description_file.hpp>
#include <refusal.hpp>

#include <cstdint>
#include <cstdlib>
#include <string>

namespace {

// A library that says little.
const ilaw_plugin& plugin() {
  static ilaw_parameter parameter{};
  static const ilaw_parameter* const parameters[] = {&parameter};
  static ilaw_law law{};
  static const ilaw_law* const laws[] = {&law};
  static ilaw_plugin made{};
  parameter.name = parameter.symbol = parameter.unit = parameter.doc = "";
  law.id = law.title = law.doc = "";
  law.parameters = parameters;
  law.parameter_count = 1;
  made.name = made.version = made.vendor = made.licence = "";
  made.laws = laws;
  made.law_count = 1;
  return made;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(bytes), size);
  try {
    const auto found = ilaw::loading::parse_description("law.json", text);
    if (!found) return 0;
    ilaw::loading::check_members(found->parsed, "law.json");
    for (const auto& law : found->parsed.find("laws")->elements)
      if (law.find("title")->letters.find('\033') != std::string::npos) std::abort();
    ilaw::loading::check_same(found->parsed, plugin(), "law.so");
  } catch (const ilaw::loading::refusal&) {
  }
  return 0;
}
