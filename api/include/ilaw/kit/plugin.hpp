// plugin.hpp - the entry of a law library, made from its laws.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#ifndef ILAW_BUILDING_PLUGIN
#define ILAW_BUILDING_PLUGIN
#endif
#include <ilaw/kit/evaluate.hpp>

namespace ilaw::kit {

template <class Law>
inline constexpr ilaw_law abi_law{.struct_size = sizeof(ilaw_law),
                                  .dimensions = Law::card.dimensions,
                                  .delassus_forms = Law::card.delassus_forms,
                                  .inputs = Law::card.inputs | ILAW_INPUT_NORMAL | ILAW_INPUT_TANGENT,
                                  .outputs = ILAW_OUTPUT_VELOCITY | ILAW_OUTPUT_STATUS | ILAW_OUTPUT_ENERGY,
                                  .capabilities = Law::card.capabilities,
                                  .id = Law::card.id,
                                  .title = Law::card.title,
                                  .doc = Law::card.doc,
                                  .references = Law::references,
                                  .parameters = detail::description<Law>::parameter_pointers.data(),
                                  .state_variables = detail::description<Law>::state_variable_pointers.data(),
                                  .reference_count = std::size(Law::references),
                                  .parameter_count = detail::parameter_count<Law>,
                                  .state_variable_count = detail::state_variable_count<Law>,
                                  .reserved = 0,
                                  .create = create<Law>,
                                  .destroy = destroy<Law>,
                                  .info = info<Law>,
                                  .initialise = initialise<Law>,
                                  .evaluate = evaluate<Law>};

// The description of a library with these laws.
template <class... Laws>
const ilaw_plugin* describe(const char* name, const char* version, const char* vendor, const char* licence) {
  static const ilaw_law* const laws[] = {&abi_law<Laws>...};
  static const ilaw_plugin plugin{.struct_size = sizeof(ilaw_plugin),
                                  .abi_major = ILAW_ABI_MAJOR,
                                  .abi_minor = ILAW_ABI_MINOR,
                                  .name = name,
                                  .version = version,
                                  .vendor = vendor,
                                  .licence = licence,
                                  .laws = laws,
                                  .law_count = sizeof...(Laws),
                                  .reserved = 0};
  return &plugin;
}

}  // namespace ilaw::kit

// ILAW_PLUGIN(name, version, vendor, licence, Law...) makes the one exported symbol of a law library.
#define ILAW_PLUGIN(name, version, vendor, licence, ...)                     \
  extern "C" ILAW_EXPORT const ilaw_plugin* ILAW_ENTRY(void) {               \
    return ilaw::kit::describe<__VA_ARGS__>(name, version, vendor, licence); \
  }
