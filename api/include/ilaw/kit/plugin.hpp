// plugin.hpp - the entry of a law library, made from its laws.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#if defined(ILAW_KIT_DEVICE)
#include <ilaw/device/kernel.hpp>
#else

#ifndef ILAW_BUILDING_PLUGIN
#define ILAW_BUILDING_PLUGIN
#endif
#include <ilaw/ext/draft/profile.h>
#include <ilaw/kit/detail/evaluate.hpp>
#include <ilaw/kit/detail/law_checks.hpp>
#if defined(ILAW_HAS_PTX) || defined(ILAW_HAS_SPIRV)
#include <ilaw/device/extension.hpp>
#endif

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// The parts of this level, in the order of the laws.
template <template <class> class... Laws>
inline constexpr ilaw_kit_part parts[] = {part_of<Laws<double> >...};

// The functions of the law at a place of its library, which the law does not know.
template <std::size_t Place, class Law>
struct functions {
  static const ilaw_law& abi();

  static ilaw_result ILAW_CALL create(const char* id, const ilaw_setup* setup, ilaw_instance** result,
                                      char* text, std::size_t text_size) {
    ilaw_message error = ilaw_message_in(Law::card.id, text, text_size);
    if (!result) return ILAW_INVALID_ARGUMENT;
    if (const char* cap = unknown_level()) {
      *result = nullptr;
      return ilaw_refuse(&error, ILAW_UNSUPPORTED, "ILAW_ISA is '%s', expected baseline, v3 or v4", cap);
    }
    const ilaw_kit_part* best = best_parts();
    return detail::create<Law>(abi(), id, setup, best ? best[Place] : part_of<Law>, result, error);
  }

  // The level whose loops an instance uses.
  static const char* ILAW_CALL instruction_set(const ilaw_instance* opaque) {
    [[maybe_unused]] const ilaw_kit_part* part = of<Law>(opaque).part;
#if defined(ILAW_KIT_OTHER_LEVELS)
    for (const other_level& level : other_levels)
      if (level.parts && part == &level.parts()[Place]) return level.name;
#endif
    return "baseline";
  }
  static constexpr ilaw_profile profile{.struct_size = sizeof(ilaw_profile),
                                        .reserved = 0,
                                        .instruction_set = instruction_set,
                                        .evaluate_counting = evaluate_counting<Law>};

  static const void* ILAW_CALL extension(const char* name) {
    if (name && std::strcmp(name, ILAW_PROFILE) == 0) return &profile;
#if defined(ILAW_HAS_PTX) || defined(ILAW_HAS_SPIRV)
    if constexpr (serves_devices<Law>)
      if (name && std::strcmp(name, ILAW_DEVICE) == 0) return &device_functions<Place, Law>::law;
#endif
    if constexpr (requires { Law::extension(name); })
      return Law::extension(name);
    else
      return nullptr;
  }
};

template <std::size_t Place, class Law>
inline constexpr ilaw_law abi_law = [] {
  using described = typename instance<Law>::description_type;
  using own = functions<Place, Law>;
  return ilaw_law{.struct_size = sizeof(ilaw_law),
                  .dimensions = Law::card.dimensions,
                  .delassus_forms = Law::card.delassus_forms,
                  .frames = ILAW_FRAME_LOCAL | ILAW_FRAME_GLOBAL,
                  .numbers = ILAW_NUMBERS_DOUBLE | ILAW_NUMBERS_FLOAT,
                  .inputs = Law::card.inputs | ILAW_INPUT_NORMAL | ILAW_INPUT_TANGENT |
                            flag_if(gives_heat<Law>, ILAW_INPUT_AREA),
                  .outputs = ILAW_OUTPUT_VELOCITY | ILAW_OUTPUT_STATUS | ILAW_OUTPUT_ENERGY,
                  .capabilities = Law::card.capabilities,
                  .permissions = Law::card.permissions,
                  .reserved = 0,
                  .id = Law::card.id,
                  .title = Law::card.title,
                  .doc = Law::card.doc,
                  .references = Law::references,
                  .parameters = described::parameter_pointers.data(),
                  .state_variables = described::state_variable_pointers.data(),
                  .reference_count = std::size(Law::references),
                  .parameter_count = static_cast<std::uint32_t>(parameter_count<Law>),
                  .state_variable_count = static_cast<std::uint32_t>(state_variable_count<Law>),
                  .amount_count = static_cast<std::uint32_t>(amount_count<Law>),
                  .amounts = described::amount_pointers.data(),
                  .create = own::create,
                  .destroy = destroy<Law>,
                  .info = info<Law>,
                  .initialise = initialise<Law>,
                  .evaluate = evaluate<Law>,
                  .extension = own::extension};
}();

template <std::size_t Place, class Law>
const ilaw_law& functions<Place, Law>::abi() {
  return abi_law<Place, Law>;
}

// The description of a library with these laws; Checked: whether all of them are laws.
template <bool Checked, class... Laws>
class library {
 public:
  static const ilaw_plugin* describe(const char* name, const char* version, const char* vendor,
                                     const char* licence) {
    static const ilaw_plugin plugin{.struct_size = sizeof(ilaw_plugin),
                                    .abi_major = ILAW_ABI_MAJOR,
                                    .abi_minor = ILAW_ABI_MINOR,
                                    .name = name,
                                    .version = version,
                                    .vendor = vendor,
                                    .licence = licence,
                                    .laws = pointers.data(),
                                    .law_count = sizeof...(Laws),
                                    .reserved = 0,
                                    .extension = nullptr};
    return &plugin;
  }

 private:
  template <std::size_t... Places>
  static constexpr std::array<const ilaw_law*, sizeof...(Laws)> all(std::index_sequence<Places...>) {
    return {&abi_law<Places, Laws>...};
  }
  static constexpr auto pointers = all(std::index_sequence_for<Laws...>{});
};
template <class... Laws>
class library<false, Laws...> {
 public:
  static const ilaw_plugin* describe(const char*, const char*, const char*, const char*) { return nullptr; }
};

template <template <class> class... Laws>
using library_of = library<(checked<Laws>() && ...), Laws<double>...>;

}  // namespace ilaw::kit::detail

// ILAW_PLUGIN(name, version, vendor, licence, law...) makes the one exported symbol of a law library; at the
// other levels, the hidden one that gives their parts.
#if defined(ILAW_KIT_PARTS)
#define ILAW_PLUGIN(name, version, vendor, licence, ...) \
  extern "C" const ilaw_kit_part* ILAW_KIT_PARTS() { return ilaw::kit::detail::parts<__VA_ARGS__>; }
#else
#define ILAW_PLUGIN(name, version, vendor, licence, ...)                                         \
  extern "C" ILAW_EXPORT const ilaw_plugin* ILAW_CALL ILAW_ENTRY(void) {                         \
    return ilaw::kit::detail::library_of<__VA_ARGS__>::describe(name, version, vendor, licence); \
  }
#endif

#endif
